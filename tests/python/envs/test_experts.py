"""The scripted experts through Python: one environment and many."""

import gymnasium
import numpy as np
import pytest

from manyhands.envs import Expert


def test_expert_solves_a_vector_of_environments():
    envs = gymnasium.make_vec("PandaPickAndPlace-v3", num_envs=50, num_threads=2, autoreset_mode="Disabled")
    expert = Expert("PandaPickAndPlace-v3")
    observation, _ = envs.reset(seed=3)
    solved = np.zeros(50, bool)
    for _ in range(50):
        observation, _, terminated, _, _ = envs.unwrapped.step(expert(observation))
        solved |= terminated
        if terminated.any():
            observation, _ = envs.reset(options={"reset_mask": terminated})
    assert solved.all()


def test_expert_acts_in_one_environment_as_in_many():
    env = gymnasium.make("PandaPush-v3")
    many = gymnasium.make_vec("PandaPush-v3", num_envs=2)
    one, _ = env.reset(seed=9)
    both, _ = many.reset(seed=[8, 9])
    action = Expert("PandaPush-v3")(one)
    assert action.shape == (3,)
    assert action.dtype == np.float32
    assert np.array_equal(action, Expert("PandaPush-v3")(both)[1])


def test_expert_refuses_what_it_cannot_do():
    with pytest.raises(ValueError, match=r"train with it, or use that of PandaReach-v3"):
        Expert("PandaReachJoints-v3")
    with pytest.raises(ValueError, match=r"no expert for 'PandaJuggle-v3'; there are .*PandaReachDense-v3"):
        Expert("PandaJuggle-v3")
    observation, _ = gymnasium.make("PandaReach-v3").reset(seed=0)
    with pytest.raises(ValueError, match="observations have length"):
        Expert("PandaPush-v3")(observation)
    for nonsense in (np.zeros(6), None, {"observation": np.zeros(6)}):
        with pytest.raises(ValueError, match=r"'observation' \(6,\) and 'desired_goal' \(3,\)"):
            Expert("PandaReach-v3")(nonsense)  # pyright: ignore[reportArgumentType]


def test_an_expert_is_named_with_or_without_a_version():
    observation, _ = gymnasium.make("PandaReach-v3").reset(seed=0)
    assert np.array_equal(Expert("PandaReach")(observation), Expert("PandaReach-v3")(observation))
