"""Policies that see are trained, kept, evaluated and filmed by the commands that train others."""

import argparse
import json
from pathlib import Path

import numpy as np
import onnx
import pytest
from numpy.typing import NDArray

from manyhands import cli
from manyhands._core.envs import make_env_batch
from manyhands.cli import view
from manyhands.envs.registration import make_vector_env
from manyhands.training.evaluation import FrameStacks, PolicyFile, evaluate
from manyhands.training.recipe import find_recipe, load_recipe

SMALL = """\
environment: PandaPush-v3
num_envs: 4
max_env_steps: 160
cameras: ["front", "wrist"]

looks:
  light: 0.3
  colour: 0.1

beyond:
  expert: shows the way

trainer:
  algorithm: DAgger
  cloning_weight: 1
  cloning_filter: false
  hidden_layers: [16]
  channels: [4, 6]
  batch_size: 16
  warmup_transitions: 40
  updates_per_iteration: 1
  replay_capacity: 100
  expert_rate: 0.5
  evaluation_interval: 20
  evaluation_episodes: 2
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recipe") / "small.yaml"
    path.write_text(SMALL)
    return path


@pytest.fixture(scope="module")
def trained(small: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run's folder."""
    runs = tmp_path_factory.mktemp("runs")
    assert cli.main(["train", "PandaPush", "--recipe", str(small), "--episodes", "12", "--runs", str(runs)]) == 0
    (folder,) = runs.iterdir()
    return folder


def test_a_policy_sees_pictures_and_the_robot_itself(trained: Path) -> None:
    policy = PolicyFile(trained)
    assert sorted(policy.inputs) == ["front", "observation", "wrist"]
    assert policy.cameras == {name: {"vary": {"light": 0.3, "colour": 0.1}} for name in ("front", "wrist")}
    graph = onnx.load(trained / "policy.onnx").graph
    shapes = {one.name: [size.dim_value for size in one.type.tensor_type.shape.dim][1:] for one in graph.input}
    assert shapes == {"observation": [6], "front": [2, 84, 84, 3], "wrist": [2, 84, 84, 3]}
    assert [node.op_type for node in graph.node].count("Conv") == 4


def test_a_file_acts_as_the_trainer(trained: Path) -> None:
    """Through onnxruntime and Python's environments as in C++: 12 episodes of up to 50 steps go the same way."""
    by_trainer = json.loads((trained / "evaluation.json").read_text())
    by_file = evaluate(PolicyFile(trained), "PandaPush-v3", 12, by_trainer["first_seed"], num_threads=1)
    assert by_file.success_rate == by_trainer["success_rate"]
    assert by_file.mean_length == pytest.approx(by_trainer["mean_length"], abs=0.5)


def test_it_acts_upon_what_it_sees(trained: Path) -> None:
    policy = PolicyFile(trained)
    env = make_vector_env("PandaPush-v3", 8, cameras=policy.cameras)
    seen, _ = env.reset(seed=1)
    action = policy(seen)
    assert action.shape == (8, 3) and np.abs(action).max() <= 1
    dark = {name: np.zeros_like(each) if name == "front" else each for name, each in seen.items()}
    assert np.abs(policy(dark) - action).max() > 1e-4
    blurred = {**seen, "observation": seen["observation"].copy()}
    blurred["observation"][:, 6:] = 0  # where the cube is
    np.testing.assert_array_equal(PolicyFile(trained)(blurred), action)


def test_an_environment_without_its_cameras_is_told(trained: Path) -> None:
    seen, _ = make_vector_env("PandaPush-v3", 2).reset(seed=1)
    with pytest.raises(ValueError, match=r"front, wrist is not in the observation; make the environment with cameras="):
        PolicyFile(trained)(seen)


def test_stacks_begin_anew_with_an_episode() -> None:
    stacks = FrameStacks({"front": 3})

    def seen(*colours: int) -> NDArray[np.uint8]:
        pictures = np.array(colours, np.uint8)[:, None, None, None]
        return np.broadcast_to(pictures, (len(colours), 4, 4, 3))

    def newest_first(goals: list[float], *colours: int) -> list[list[int]]:
        goal = np.array(goals, np.float32)[:, None]
        return stacks({"front": seen(*colours), "desired_goal": goal})["front"][:, :, 0, 0, 0].tolist()

    assert newest_first([1, 2], 10, 20) == [[10, 10, 10], [20, 20, 20]]
    assert newest_first([1, 2], 11, 21) == [[11, 10, 10], [21, 20, 20]]
    assert newest_first([1, 3], 12, 30) == [[12, 11, 10], [30, 30, 30]]
    assert newest_first([1, 3], 13, 31) == [[13, 12, 11], [31, 30, 30]]
    assert newest_first([1], 40) == [[40, 40, 40]]


def test_a_run_resumes_exactly(small: Path, trained: Path, tmp_path: Path) -> None:
    arguments = ["--recipe", str(small), "--episodes", "12", "--runs", str(tmp_path), "--max-steps", "100"]
    assert cli.main(["train", "PandaPush", *arguments]) == 0
    (folder,) = tmp_path.iterdir()
    assert cli.main(["train", "--resume", str(folder), "--max-steps", "160"]) == 0
    assert (folder / "policy.onnx").read_bytes() == (trained / "policy.onnx").read_bytes()


def test_it_is_evaluated_and_filmed_by_its_own_cameras(
    trained: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["evaluate", str(trained), "--episodes", "3"]) == 0
    assert "PandaPush-v3: success" in capsys.readouterr().out
    parser = argparse.ArgumentParser()
    view.add_arguments(parser)
    page = view.shown(parser.parse_args(["PandaPush", "--policy", str(trained), "--port", "0"]))
    page.close()
    film = tmp_path / "film.gif"
    size = ["--size", "64", "48", "--episodes", "1", "--out", str(film)]
    assert cli.main(["record", "PandaPush", "--policy", str(trained), *size]) == 0
    assert film.stat().st_size > 1000
    assert cli.main(["evaluate", str(trained), "--env", "PandaStack", "--episodes", "3"]) == 2
    assert "does not fit PandaStack-v3" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ('["front", "wrist"]', '["front", "side"]', 4, "'side' needs an eye and a target"),
        ("light: 0.3", "light: 3", 6, "off by 3"),
        ("light: 0.3", "lamp: 0.3", 6, "varies {'lamp'"),
        ('cameras: ["front", "wrist"]\n', "", 5, "no cameras whose looks could vary"),
        ("algorithm: DAgger", "algorithm: TD3", 14, "only DAgger learns from pictures"),
        ("[4, 6]", "[4, 0]", 18, "one of channels is 0"),
        ("batch_size: 16", "frame_stack: 99", 19, "frame_stack is 99"),
    ],
)
def test_errors_name_the_line(old: str, new: str, line: int, message: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    assert old in SMALL
    path.write_text(SMALL.replace(old, new))
    with pytest.raises(ValueError) as caught:
        load_recipe(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["PandaStack", "--recipe", "pixels"], "no recipe pixels is shipped for PandaStack-v3; there are PandaPush-v3"),
        (["PandaReach", "--recipe", "pixels", "--set", "algorithm=TD3"], "only DAgger learns from pictures"),
        (["PandaReach", "--recipe", "pixels", "--set", "channels=[8,8,8,8,8]"], "too small"),
    ],
)
def test_wrong_commands_give_one_clear_line(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["train", *arguments, "--runs", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1


@pytest.mark.parametrize("env_id", ["PandaReach-v3", "PandaPush-v3"])
def test_shipped_recipes_say_what_they_use(env_id: str) -> None:
    recipe = find_recipe(env_id, "pixels")
    assert recipe is not None and recipe.env_id == env_id
    assert recipe.settings().trainer_config().wants_expert
    assert {"expert", "state"} <= recipe.beyond.keys()
    assert list(recipe.cameras) == ["front", "wrist"]


def test_environments_say_what_a_robot_knows_of_itself() -> None:
    assert make_env_batch("PandaPush-v3", 1).spec.robot_dim == 6
    assert make_env_batch("PandaPickAndPlaceJoints-v3", 1).spec.robot_dim == 7  # with the fingers' width
