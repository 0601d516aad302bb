"""Policies that ship act as their files say, as well as their cards say, without Python in the loop."""

import re
import sys
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import onnx
import onnxruntime
import pytest

import manyhands as mh
from manyhands import cli
from manyhands._core.envs import env_ids, make_adviser, make_env_batch
from manyhands._core.learn import PolicyRunner, Trainer, TrainerConfig, read_policy
from manyhands.policies import Policy, policy_ids
from manyhands.policies.card import Card, read_card
from manyhands.training.evaluation import PolicyFile, evaluate
from manyhands.training.policy_file import save_model, save_policy, to_onnx
from manyhands.training.recipe import find_recipe

PAGE = Path(__file__).parents[3] / "docs/policies.md"
FEW_POINTS = 0.05  # of success: three standard deviations of 200 episodes at 95 % are 0.046


def zeros(*shape: int) -> dict[str, np.ndarray]:
    """What Reach shows, in an array of this shape."""
    sizes = {"observation": 6, "achieved_goal": 3, "desired_goal": 3}
    return {name: np.zeros((*shape, size), np.float32) for name, size in sizes.items()}


def observations(env_id: str, count: int) -> dict[str, np.ndarray]:
    """Rows as wide as the environment's, and wilder."""
    spec, rng = make_env_batch(env_id, 1).spec, np.random.default_rng(0)
    sizes = {"observation": spec.observation_dim, "achieved_goal": spec.goal_dim, "desired_goal": spec.goal_dim}
    return {name: rng.normal(scale=0.5, size=(count, size)).astype(np.float32) for name, size in sizes.items()}


@pytest.mark.parametrize("env_id", policy_ids())
def test_each_does_as_well_as_its_card_says(env_id: str) -> None:
    policy = mh.policy(env_id)
    assert policy.env_id == policy.card.environment == env_id
    assert policy.card.success >= 0.8
    result = policy.evaluate(episodes=200, first_seed=77)
    assert result.success_rate == pytest.approx(policy.card.success, abs=FEW_POINTS)


@pytest.mark.parametrize("env_id", ["PandaPush-v3", "PandaReachJoints-v3"])
def test_a_card_is_measured_by_this_command(env_id: str) -> None:
    """To the episode: what is shipped is what was measured."""
    policy = mh.policy(env_id)
    card = policy.card
    result = policy.evaluate(episodes=card.episodes, first_seed=card.first_seed)
    assert result.success_rate == pytest.approx(card.success, abs=0.01)  # other lanes, other last bits
    assert result.mean_length == pytest.approx(card.mean_length, abs=0.5)


@pytest.mark.parametrize("env_id", policy_ids())
def test_cpp_acts_as_onnxruntime_does(env_id: str) -> None:
    policy, obs = mh.policy(env_id), observations(env_id, 300)
    session = onnxruntime.InferenceSession(policy.path)
    expected = np.asarray(session.run(None, obs)[0])
    actions = policy(obs)
    np.testing.assert_allclose(actions, expected, atol=2e-5)
    assert np.ptp(actions) > 0.5 and np.abs(actions).max() <= 1
    one = {name: rows[7] for name, rows in obs.items()}
    np.testing.assert_allclose(policy(one), actions[7], atol=1e-6)
    np.testing.assert_array_equal(policy(one), policy(one))


def test_every_card_is_whole_and_stands_in_the_table_of_the_page() -> None:
    cards = [mh.policy(env_id).card for env_id in policy_ids()]
    shown = [line for line in PAGE.read_text().splitlines() if line.startswith("| Panda")]
    assert shown == [
        f"| {card.environment} | {card.success:.1%} | {card.weights} | {card.training_seconds:,.0f} s | "
        f"{card.env_steps:,} | {card.beyond} | {card.seed}{f', best of {card.seeds}' if card.seeds > 1 else ''} |"
        for card in cards
    ]
    for card in cards:
        recipe = find_recipe(Path(card.recipe).stem)
        assert recipe is not None and card.environment.replace("Dense", "") == recipe.env_id.replace("Dense", "")
        assert card.beyond == (", ".join(recipe.beyond) or "nothing")
        assert card.episodes == 1000 and card.version and card.weights in ("float16", "float32")
        held = {tensor.data_type for tensor in onnx.load(mh.policy(card.environment).path).graph.initializer}
        assert (onnx.TensorProto.FLOAT16 in held) == (card.weights == "float16")


def test_a_card_says_what_it_knows(tmp_path: Path) -> None:
    card = mh.policy("PandaPush").card
    assert f"success: {card.success}" in str(card) and "recipe: PandaPush-v3.yaml" in str(card)
    card.save(tmp_path / "card.yaml")
    assert read_card(tmp_path / "card.yaml") == card
    (tmp_path / "card.yaml").write_text(str(card).replace("seed: 0\n", ""))
    with pytest.raises(ValueError, match=r"card.yaml is no card of a policy: seed are there or missing"):
        read_card(tmp_path / "card.yaml")
    (tmp_path / "card.yaml").write_text(str(card).replace("seed: 0\n", "seed: none\n"))
    with pytest.raises(ValueError, match=r"card.yaml is no card of a policy: .*'none'"):
        read_card(tmp_path / "card.yaml")
    assert isinstance(card, Card)


def test_no_two_files_hold_the_same_policy() -> None:
    """Where training gives the same weights the cards name one file, which is of a plain task."""
    folder = mh.policy("PandaReach").path.parent
    named = {mh.policy(env_id).path for env_id in policy_ids()}
    assert named == set(folder.glob("*.onnx"))
    graphs = [onnx.load(path).graph.SerializeToString() for path in named]
    assert len(set(graphs)) == len(graphs)
    dense = mh.policy("PandaStackDense")
    assert dense.path == mh.policy("PandaStack").path and dense.env_id == "PandaStackDense-v3"


def test_imitation_alone_learns_the_same_from_both_rewards() -> None:
    """So that what is trained with one reward ships for the other, to the bit."""
    small = {"hidden_layers": [32, 32], "warmup_transitions": 500, "updates_per_iteration": 2}
    trainers = []
    for env_id in ("PandaStack-v3", "PandaStackDense-v3"):
        recipe = find_recipe(env_id)
        assert recipe is not None
        config = recipe.settings(overrides=small, num_threads=1).trainer_config()
        trainers.append(Trainer(make_env_batch(env_id, 32), None, config, make_adviser(env_id)))
    for trainer in trainers:
        trainer.advance(120)
    sparse, dense = (trainer.policy() for trainer in trainers)
    for (weight, bias), (other_weight, other_bias) in zip(sparse.layers, dense.layers, strict=True):
        np.testing.assert_array_equal(weight, other_weight)
        np.testing.assert_array_equal(bias, other_bias)


def test_ids_come_with_or_without_their_version() -> None:
    assert mh.policy("PandaReach").path == mh.policy("PandaReach-v3").path
    assert "PandaReach-v3" in repr(mh.policy("PandaReach"))


def test_every_environment_has_a_policy() -> None:
    assert policy_ids() == sorted(env_ids())


def test_what_has_no_policy_says_which_have_one_and_how_to_train(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    mh.policy("PandaReach").card.save(tmp_path / "PandaReach-v3.yaml")
    monkeypatch.setattr(sys.modules["manyhands.policies.policy"], "_FOLDER", tmp_path)  # whose name the function has
    says = "no trained policy ships for PandaPush-v3, but for PandaReach-v3; train one: manyhands train PandaPush-v3"
    with pytest.raises(ValueError, match=f"^{re.escape(says)}$"):
        mh.policy("PandaPush")
    for command in (["evaluate", "PandaPush"], ["record", "PandaPush", "--out", str(tmp_path / "push.gif")]):
        assert cli.main([*command, "--policy", "trained"]) == 2
        assert says in capsys.readouterr().err
    with pytest.raises(ValueError, match="did you mean PandaReach-v3"):
        mh.policy("PandaReech")


def test_it_acts_in_gymnasiums_environments() -> None:
    policy = mh.policy("PandaReach")
    env = gymnasium.make("PandaReach-v3")
    obs, _ = env.reset(seed=0)
    success = False
    for _ in range(50):
        obs, _, terminated, truncated, info = env.step(policy(obs))
        success = bool(info["is_success"])
        if terminated or truncated:
            break
    assert success
    envs = gymnasium.make_vec("PandaReach-v3", num_envs=8)
    obs, _ = envs.reset(seed=0)
    assert policy(obs).shape == (8, 3) and policy(obs).dtype == np.float32


@pytest.mark.parametrize(
    ("obs", "message"),
    [
        (3.0, "not float"),
        ({"observation": np.zeros(6)}, "not 'observation'"),
        (zeros() | {"observation": np.zeros(7)}, r"not of shapes \(7,"),
        (zeros(2) | {"desired_goal": np.zeros(3)}, r"not of shapes"),
        (zeros(2, 2), "not of shapes"),
    ],
)
def test_what_is_no_observation_is_told(obs: Any, message: str) -> None:
    with pytest.raises(ValueError, match=r"PandaReach-v3 expects a dict with 'observation' \(6,\).*" + message):
        mh.policy("PandaReach")(obs)


@pytest.mark.parametrize(("algorithm", "half"), [("TD3", False), ("TD3", True), ("SAC", False), ("PPO", True)])
def test_files_are_read_as_they_were_written(algorithm: str, half: bool, tmp_path: Path) -> None:
    config = TrainerConfig()
    config.algorithm, config.hidden_layers, config.activation = algorithm, [16, 24], "tanh"
    config.differences = [3, 0, 1, 2]
    policy = Trainer(make_env_batch("PandaReach-v3", 16), None, config).policy()
    path = tmp_path / "policy.onnx"
    save_model(to_onnx(policy, "PandaReach-v3", half=half), path)
    read = read_policy(path)
    for name in ("env_id", "observation_dim", "goal_dim", "action_dim", "clip", "differences", "activation", "output"):
        assert getattr(read, name) == getattr(policy, name), name
    np.testing.assert_array_equal(read.mean, policy.mean)
    np.testing.assert_array_equal(read.scale, policy.scale)
    for (weight, bias), (expected_weight, expected_bias) in zip(read.layers, policy.layers, strict=True):
        kind = np.float16 if half else np.float32
        np.testing.assert_array_equal(weight, expected_weight.astype(kind).astype(np.float32))
        np.testing.assert_array_equal(bias, expected_bias.astype(kind).astype(np.float32))
    obs = observations("PandaReach-v3", 50)
    np.testing.assert_allclose(Policy(path)(obs), PolicyFile(path)(obs), atol=1e-5)


def test_a_cubes_rotation_is_seen_by_file_and_trainer_alike(tmp_path: Path) -> None:
    config = TrainerConfig()
    config.hidden_layers, config.cube_rotation, config.differences = [16, 24], 10, [7, 0]
    trainer = Trainer(make_env_batch("PandaFlip-v3", 16), None, config)
    trainer.advance(60)
    path = tmp_path / "policy.onnx"
    save_policy(trainer.policy(), "PandaFlip-v3", path)
    assert read_policy(path).cube_rotation == 10
    obs = observations("PandaFlip-v3", 50)
    np.testing.assert_allclose(Policy(path)(obs), PolicyFile(path)(obs), atol=2e-5)
    names = ("observation", "achieved_goal", "desired_goal")
    np.testing.assert_allclose(Policy(path)(obs), trainer.predict(*(obs[name] for name in names)), atol=1e-6)


def test_halves_of_all_sizes_are_read(tmp_path: Path) -> None:
    """Every finite number of 16 bits, as numpy knows them."""
    every = np.arange(2**16, dtype=np.uint16).view(np.float16)
    every = every[np.isfinite(every)]
    path = tmp_path / "policy.onnx"
    save_policy(Trainer(make_env_batch("PandaReach-v3", 4), None, TrainerConfig()).policy(), "PandaReach-v3", path)
    model = onnx.load(path)
    constants = {tensor.name: tensor for tensor in model.graph.initializer}
    # As the bias of a hidden layer that is wide enough: weights follow.
    widths = {"weight_0": (len(every), 12), "bias_0": (len(every),), "weight_1": (64, len(every))}
    for name, shape in widths.items():
        values = every if name == "bias_0" else np.zeros(shape, np.float16)
        constants[name].CopyFrom(onnx.numpy_helper.from_array(values, name))
    onnx.save(model, path)
    np.testing.assert_array_equal(read_policy(path).layers[0][1], every.astype(np.float32))


def test_other_files_are_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "policy.onnx"
    with pytest.raises(ValueError, match="there is no file"):
        Policy(path)
    path.write_bytes(b"no graph")
    with pytest.raises(ValueError, match=r"policy.onnx cannot be read as a policy: "):
        Policy(path)
    model = onnx.load(mh.policy("PandaReach").path)
    model.graph.node.pop()
    onnx.save(model, path)
    with pytest.raises(ValueError, match=r"no policy that a trainer of ours made: its operations are Sub, Concat"):
        Policy(path)
    model = onnx.load(mh.policy("PandaReach").path)
    mean = next(tensor for tensor in model.graph.initializer if tensor.name == "mean")
    mean.CopyFrom(onnx.numpy_helper.from_array(np.zeros(5, np.float32), "mean"))
    onnx.save(model, path)
    with pytest.raises(ValueError, match=r"cannot be read as a policy: the policy makes no sense: mean and scale"):
        Policy(path)


def test_damaged_files_never_crash(tmp_path: Path) -> None:
    whole, rng = mh.policy("PandaReach").path.read_bytes(), np.random.default_rng(0)
    path = tmp_path / "policy.onnx"
    refused = 0
    for _ in range(400):
        damaged = bytearray(whole[: rng.integers(1, len(whole))] if rng.random() < 0.3 else whole)
        for at in rng.integers(0, len(damaged), 8):
            damaged[at] = rng.integers(256)
        path.write_bytes(damaged)
        try:
            PolicyRunner(read_policy(path))
        except (ValueError, UnicodeDecodeError):
            refused += 1
    assert refused > 100


def test_evaluation_in_cpp_is_that_through_python() -> None:
    policy = mh.policy("PandaPush")
    in_cpp = evaluate(policy, "PandaPush-v3", 100, 5, num_threads=1)
    in_python = evaluate(PolicyFile(policy.path), "PandaPush-v3", 100, 5, num_threads=1)
    assert in_cpp.success_rate == pytest.approx(in_python.success_rate, abs=0.02)
    assert in_cpp.mean_length == pytest.approx(in_python.mean_length, abs=0.5)


def test_commands_take_the_policy_that_ships(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["evaluate", "PandaReach", "--policy", "trained", "--episodes", "50"]) == 0
    assert capsys.readouterr().out.startswith("PandaReach-v3: success 100.0% on 50 episodes")
    out = tmp_path / "reach.gif"
    assert cli.main(["record", "PandaReach", "--policy", "trained", "--episodes", "1", "--out", str(out)]) == 0
    assert out.read_bytes().startswith(b"GIF")
    assert cli.main(["evaluate", "PandaReach"]) == 2
    assert "PandaReach is an environment: say what acts there, for example --policy trained" in capsys.readouterr().err
    assert cli.main(["evaluate", "PandaReach", "--policy", "trained", "--env", "PandaPush"]) == 2
    assert "--env PandaPush names a second environment" in capsys.readouterr().err


def test_a_policy_of_other_sizes_is_refused() -> None:
    policy = mh.policy("PandaReach")
    with pytest.raises(ValueError, match=r"does not fit PandaPush-v3: .*expected 18, 3 and 3"):
        policy.evaluate("PandaPush")
    with pytest.raises(ValueError, match="the policy of PandaReach-v3 does not fit PandaPush-v3"):
        policy.require_fit(make_env_batch("PandaPush-v3", 1).spec)


@pytest.mark.parametrize("name", [None, 3])
def test_what_is_no_name_is_said(name: Any) -> None:
    with pytest.raises(TypeError, match=f"the environment is {name}, expected a name"):
        mh.policy(name)


def test_of_other_environments_the_trainer_is_named() -> None:
    with pytest.raises(ValueError, match=r"'CartPole-v1' is stepped in Python, .* manyhands.learn trains in any"):
        mh.policy("CartPole-v1")
