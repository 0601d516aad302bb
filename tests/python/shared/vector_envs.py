"""What the tests of vector environments share: making and driving them, and comparing what they give."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from manyhands.envs import ArmVectorEnv

N = 6


def native(name: str = "PandaReach-v3", num_envs: int = N, **kwargs: Any) -> ArmVectorEnv:
    env = gymnasium.make_vec(name, num_envs=num_envs, **kwargs)
    assert isinstance(env, ArmVectorEnv)
    return env


def actions_for(env: ArmVectorEnv, obs: dict[str, NDArray[np.float32]], rng: np.random.Generator) -> NDArray[Any]:
    """Toward the goal in half of the worlds, so that some succeed early; at random in the others."""
    size = env.single_action_space.shape
    assert size is not None
    actions = rng.uniform(-1, 1, (env.num_envs, *size)).astype(np.float32)
    if size == (3,):
        actions[::2] = np.clip(5 * (obs["desired_goal"] - obs["achieved_goal"])[::2], -1, 1)
    return actions


def assert_same(actual: Any, expected: Any, where: str) -> None:
    """Equal values, keys and types, recursively."""
    assert type(actual) is type(expected), where
    if isinstance(expected, dict):
        assert actual.keys() == expected.keys(), where
        for key in expected:
            assert_same(actual[key], expected[key], f"{where}[{key!r}]")
    elif isinstance(expected, tuple):
        assert len(actual) == len(expected), where
        for i, one in enumerate(expected):
            assert_same(actual[i], one, f"{where}[{i}]")
    elif isinstance(expected, np.ndarray):
        assert actual.dtype == expected.dtype, where
        assert actual.shape == expected.shape, where
        if expected.dtype == object:
            for i, one in enumerate(expected):
                assert_same(actual[i], one, f"{where}[{i}]")
        else:
            np.testing.assert_array_equal(actual, expected, where)
    else:
        assert actual == expected, where
