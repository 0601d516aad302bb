"""`randomize` and `object_shape` through Gymnasium: what is drawn stands in `info`, in all ways to step alike."""

import pickle
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from vector_envs import N, actions_for, assert_same, native

from manyhands.envs import ArmEnv

RANGES: dict[str, Any] = {
    "object_mass": (0.5, 2.0, "log"),
    "table_friction": (0.5, 1.5),
    "action_latency": (0, 2),
    "observation_noise": 0.01,
}


def make(name: str, **kwargs: Any) -> ArmEnv:
    env = gymnasium.make(name, **kwargs).unwrapped
    assert isinstance(env, ArmEnv)
    return env


def test_sampled_values_are_in_the_info_of_reset_and_step() -> None:
    env = make("PandaPush-v3", randomize=RANGES)
    seen = []
    for seed in (3, None, 3):
        _, info = env.reset(seed=seed)
        values = info["randomized"]
        assert list(values) == list(RANGES)
        assert 0.5 <= values["object_mass"] <= 2 and 0.5 <= values["table_friction"] <= 1.5
        assert values["action_latency"] in (0, 1, 2)
        assert values["observation_noise"] == np.float32(0.01)
        assert env.step(np.zeros(3, np.float32))[4]["randomized"] == values
        seen.append(values)
    assert seen[0] == seen[2] != seen[1]
    assert "randomized" not in make("PandaPush-v3").reset()[1]


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_equals_sync_vector_env(mode: AutoresetMode) -> None:
    ours = native("PandaPush-v3", num_threads=2, autoreset_mode=mode, randomize=RANGES)
    theirs = SyncVectorEnv([lambda: gymnasium.make("PandaPush-v3", randomize=RANGES)] * N, autoreset_mode=mode)
    result = ours.reset(seed=7)
    assert_same(result, theirs.reset(seed=7), "reset")
    rng = np.random.default_rng(7)
    for t in range(60):
        actions = actions_for(ours, result[0], rng)
        result = ours.step(actions)
        assert_same(result, theirs.step(actions), f"step {t}")
        done = result[2] | result[3]
        if mode == AutoresetMode.DISABLED and done.any():
            result = ours.reset(options={"reset_mask": done})
            assert_same(result, theirs.reset(options={"reset_mask": done}), f"reset after step {t}")


def test_gymnasium_checks_a_randomized_environment() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(make("PandaPickAndPlace-v3", randomize=RANGES, object_shape="cylinder"))


def test_states_and_pickles_keep_what_was_drawn() -> None:
    env = make("PandaPush-v3", randomize=RANGES)
    env.reset(seed=1)
    actions = np.random.default_rng(0).uniform(-1, 1, (20, 3)).astype(np.float32)
    for action in actions[:10]:
        env.step(action)
    state = env.save_state()
    expected = [env.step(action) for action in actions[10:]]
    env.reset()
    env.restore_state(state)
    other = pickle.loads(pickle.dumps(env))
    other.restore_state(state)
    for continued in (env, other):
        for action, step in zip(actions[10:], expected, strict=True):
            observation, reward, _, _, info = continued.step(action)
            np.testing.assert_array_equal(observation["observation"], step[0]["observation"])
            assert (reward, info) == (step[1], step[4])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"randomize": {"colour": (0, 1)}}, r"no 'colour'; there are: object_mass .*observation_noise"),
        ({"randomize": {"object_mass": (2, 1)}}, r"'object_mass' has the range 2.* to 1.*low <= high"),
        ({"randomize": {"object_mass": (0, 1)}}, "both from 0.001"),
        ({"randomize": {"gravity": (0, 1, "log")}}, "logarithm"),
        ({"randomize": {"gravity": (0, 1, "normal")}}, "'gravity' is .*expected a number, .low, high"),
        ({"randomize": {"gravity": "much"}}, "'gravity' is 'much'"),
        ({"randomize": {"action_latency": (0, 0.5)}}, "whole numbers"),
        ({"randomize": [("gravity", 1)]}, "expected a dict"),
        ({"object_shape": "pyramid"}, "object_shape is 'pyramid'; expected box, cylinder, sphere, capsule"),
    ],
)
def test_nonsense_is_refused_by_name(options: dict[str, Any], message: str) -> None:
    for env in (lambda: make("PandaPush-v3", **options), lambda: native("PandaPush-v3", **options)):
        with pytest.raises(ValueError, match=message):
            env()


@pytest.mark.parametrize(
    ("name", "message"),
    [("PandaReach-v3", "no object"), ("PandaFlip-v3", "expected box"), ("PandaStack-v3", "box, cyl")],
)
def test_shapes_are_refused_where_they_make_no_sense(name: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make(name, object_shape="sphere")
