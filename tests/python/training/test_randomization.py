"""Training where robot and objects differ: critics see it, the policy does not, and success over each range is told."""

import json
from pathlib import Path

import numpy as np
import onnx
import pytest

import manyhands as mh
from manyhands import cli
from manyhands._core.envs import env_ids, make_env_batch
from manyhands._core.learn import Trainer, TrainerConfig
from manyhands.envs import TRANSFER, transfer_ranges
from manyhands.envs.spaces import as_range
from manyhands.training.announcement import announce
from manyhands.training.randomization import RandomizedRun, randomized, run_randomized, table, wilson
from manyhands.training.randomization_picture import draw_randomization
from manyhands.training.recipe import find_recipe
from manyhands.training.run_folder import RunFolder
from manyhands.training.settings import TrainSettings

PNG = b"\x89PNG\r\n"
SHORT = ("--num-envs", "16", "--episodes", "20", "--set", "stop_streak=0", "--set", "warmup_transitions=400")


def train(parent: Path, *arguments: str) -> RunFolder:
    """The folder of a run that ended well."""
    before = set(parent.glob("*"))
    assert cli.main(["train", *arguments, "--runs", str(parent)]) == 0
    (path,) = set(parent.glob("*")) - before
    return RunFolder(path)


@pytest.mark.parametrize("env_id", env_ids())
def test_the_ranges_of_transfer_are_those_of_every_task(env_id: str) -> None:
    ranges = transfer_ranges(env_id)
    batch = make_env_batch(env_id, 2, randomize=[as_range(name, value) for name, value in ranges.items()])
    assert batch.spec.randomized == list(ranges)
    assert (set(TRANSFER) - set(ranges) != set()) == ("Reach" in env_id)
    assert not any(name.startswith("object") for name in ranges) or "Reach" not in env_id


def test_intervals_are_wilsons() -> None:
    """statsmodels 0.14, proportion_confint(..., method="wilson")."""
    assert wilson(0.5, 10) == pytest.approx((0.23659309, 0.76340691), abs=1e-4)
    assert wilson(1.0, 10) == pytest.approx((0.72246725, 1.0), abs=1e-4)
    assert wilson(float("nan"), 0) == (0.0, 1.0)


def made_up() -> RandomizedRun:
    """Success below the middle of the mass; latencies say nothing."""
    rng = np.random.default_rng(0)
    mass = np.exp(rng.uniform(np.log(0.5), np.log(2.0), 4000)).astype(np.float32)
    latency = rng.integers(0, 3, 4000).astype(np.float32)
    ranges = {"object_mass": (0.5, 2.0, True), "action_latency": (0.0, 2.0, False)}
    return RandomizedRun(ranges, {"object_mass": mass, "action_latency": latency}, mass < 1)


def test_bins_hold_equal_parts_of_a_range() -> None:
    run = made_up()
    bins = run.bins("object_mass", 4)
    np.testing.assert_allclose([one.low for one in bins], [0.5, 2**-0.5, 1, 2**0.5], rtol=1e-6)
    assert [one.success for one in bins] == [1, 1, 0, 0]
    assert all(900 < one.episodes < 1100 for one in bins) and sum(one.episodes for one in bins) == 4000
    latencies = run.bins("action_latency", 4)
    assert [(one.low, one.high) for one in latencies] == [(-0.5, 0.5), (0.5, 1.5), (1.5, 2.5)]
    assert all(one.interval[0] < 0.5 < one.interval[1] for one in latencies)


def test_table_and_picture(tmp_path: Path) -> None:
    run = made_up()
    lines = table(run).splitlines()
    assert lines[0].split() == [
        "object_mass",
        "0.5",
        "to",
        "2",
        "100.0%",
        "100.0%",
        *lines[0].split()[6:7],
        "0.0%",
        "0.0%",
    ]
    assert lines[1].startswith("  action_latency  0 to 2") and lines[1].count("%") == 3
    draw_randomization(tmp_path / "picture.png", run, "made up")
    assert (tmp_path / "picture.png").read_bytes().startswith(PNG)


def test_what_is_told_of_each_episode_is_what_it_had() -> None:
    """The same episodes one by one, in gymnasium's words."""
    policy, ranges = mh.policy("PandaReach"), {"action_latency": (0, 12), "observation_noise": (0.0, 0.1)}
    run = run_randomized(policy, "PandaReach-v3", ranges, 60, first_seed=3, num_threads=1)
    assert 0.1 < run.success.mean() < 0.95, "there is something to tell apart"
    for k in range(0, 60, 7):
        env = mh.envs.ArmEnv("PandaReach", randomize=ranges)
        obs, info = env.reset(seed=3 + k)
        assert info["randomized"]["action_latency"] == run.values["action_latency"][k]
        assert info["randomized"]["observation_noise"] == run.values["observation_noise"][k]
        for _ in range(50):
            obs, _, terminated, _, info = env.step(policy(obs))
            if terminated:
                break
        assert bool(info["is_success"]) == run.success[k]


def test_nothing_to_look_at_is_told() -> None:
    with pytest.raises(ValueError, match="nothing of PandaReach-v3 is randomised"):
        run_randomized(mh.policy("PandaReach"), "PandaReach-v3", {})


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    return train(tmp_path_factory.mktemp("runs"), "PandaReach", "--randomize", *SHORT, "--max-steps", "3200")


def test_the_first_screen_says_what_differs_and_who_sees_it(whole: RunFolder) -> None:
    recipe = find_recipe("PandaReach-v3")
    settings = whole.read_settings()
    for text in ("\n".join(announce(recipe, settings)), "\n".join(announce(None, settings))):
        assert (
            "randomised in every episode: joint_damping 0 to 2, motor_gain 0.75 to 1.5, action_latency 0 to 1" in text
        )
        assert "critics see what was drawn, the policy does not" in text
        assert "Expect" not in text
    blind = TrainSettings("PandaReach-v3", randomize=settings.randomize)
    assert "neither critics nor policy see" in "\n".join(announce(recipe, blind))


def test_an_expert_who_does_not_know_of_delays_is_judged() -> None:
    recipe = find_recipe("PandaPush-v3")
    assert recipe is not None
    settings = randomized(recipe.settings(), {}, None)
    assert settings.overrides == recipe.trainer | {"privileged_critic": True, "cloning_filter": True}
    assert settings.max_env_steps == 6 * recipe.max_env_steps
    assert "its answers count where critics expect more of them" in "\n".join(announce(recipe, settings))
    own = randomized(recipe.settings(), {"cloning_filter": False}, 10)
    assert own.overrides["cloning_filter"] is False and own.max_env_steps == 10


def test_the_folder_holds_the_picture_and_a_policy_that_sees_what_is_observed(whole: RunFolder) -> None:
    assert whole.randomization.read_bytes().startswith(PNG)
    config = json.loads(whole.config.read_text())
    assert config["settings"]["randomize"].keys() == transfer_ranges("PandaReach-v3").keys()
    assert config["trainer"]["privileged_critic"] is True
    sizes = {one.name: one.type.tensor_type.shape.dim[-1].dim_value for one in onnx.load(whole.policy).graph.input}
    assert sizes == {"observation": 6, "achieved_goal": 3, "desired_goal": 3}


def test_a_resumed_run_is_the_uninterrupted_run(whole: RunFolder, tmp_path: Path) -> None:
    parted = train(tmp_path, "PandaReach", "--randomize", *SHORT, "--max-steps", "2000")
    assert cli.main(["train", "--resume", str(parted.path), "--max-steps", "3200"]) == 0
    weights = [[one.raw_data for one in onnx.load(run.policy).graph.initializer] for run in (whole, parted)]
    assert weights[0] == weights[1]
    assert parted.evaluation.read_text() == whole.evaluation.read_text()


def test_it_is_learned_under_the_ranges(tmp_path: Path) -> None:
    run = train(tmp_path, "PandaReach", "--randomize", "--max-steps", "60000", "--episodes", "300")
    assert run.read_success() is not None and (run.read_success() or 0) > 0.95


def test_evaluate_tells_success_over_each_range(
    whole: RunFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole.randomization.unlink(missing_ok=True)
    assert cli.main(["evaluate", str(whole.path), "--randomize", "--episodes", "100"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("PandaReach-v3: success ") and "on 100 episodes under these ranges" in text
    assert f"  {'motor_gain':<17}  0.75 to 1.5" in text
    assert whole.randomization.read_bytes().startswith(PNG)

    monkeypatch.chdir(tmp_path)
    command = ["evaluate", "PandaReach", "--policy", "trained", "--randomize", "--episodes", "50", "--json"]
    assert cli.main(command) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["episodes"] == 50 and told["ranges"].keys() == transfer_ranges("PandaReach-v3").keys()
    assert (tmp_path / "randomization.png").is_file()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["manyhands/KukaReach-v0", "--randomize"], "there is no environment"),
        (["PandaReach", "--set", "privileged_critic=true"], "needs PandaReach-v3 to be randomised: add --randomize"),
        (["--resume", "nowhere", "--randomize"], "leave out --randomize"),
    ],
)
def test_what_cannot_be_randomised_is_refused(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["train", *arguments, "--runs", str(tmp_path)]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_critics_need_something_to_see() -> None:
    config = TrainerConfig()
    config.privileged_critic = True
    with pytest.raises(ValueError, match="PandaReach-v3 randomises nothing that critics could see"):
        Trainer(make_env_batch("PandaReach-v3", 4), None, config)
