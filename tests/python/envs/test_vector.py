"""The native vector environment equals Gymnasium's SyncVectorEnv over single environments, to the bit."""

import copy
import pickle
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from numpy.typing import NDArray
from snapshots import sealed, worlds_of
from vector_envs import N, actions_for, assert_same, native

from manyhands._core.envs import env_ids
from manyhands.envs import ArmVectorEnv

CASES = [("PandaReach-v3", mode) for mode in AutoresetMode]
CASES += [("PandaReachJointsDense-v3", AutoresetMode.NEXT_STEP), ("PandaPush-v3", AutoresetMode.SAME_STEP)]
CASES += [("PandaStackJoints-v3", AutoresetMode.SAME_STEP), ("PandaFlipDense-v3", AutoresetMode.NEXT_STEP)]


@pytest.mark.parametrize(("name", "mode"), CASES)
def test_equals_sync_vector_env(name: str, mode: AutoresetMode) -> None:
    ours = native(name, num_threads=2, autoreset_mode=mode)
    theirs = SyncVectorEnv([lambda: gymnasium.make(name)] * N, autoreset_mode=mode)
    assert ours.metadata["autoreset_mode"] is mode
    for space in ("observation_space", "action_space", "single_observation_space", "single_action_space"):
        assert getattr(ours, space) == getattr(theirs, space)

    result = ours.reset(seed=7)
    assert_same(result, theirs.reset(seed=7), "reset")
    obs, rng = result[0], np.random.default_rng(7)
    ended = np.zeros(2, int)
    for t in range(120):
        actions = actions_for(ours, obs, rng)
        result, expected = ours.step(actions), theirs.step(actions)
        assert_same(result, expected, f"step {t}")
        obs, _, terminated, truncated, _ = result
        ended += terminated.sum(), truncated.sum()
        done = terminated | truncated
        if mode == AutoresetMode.DISABLED and done.any():
            again = ours.reset(options={"reset_mask": done})
            assert_same(again, theirs.reset(options={"reset_mask": done}), f"reset after step {t}")
            obs = again[0]
    assert ended[1] > 0, "no episode was truncated: the test shows nothing"
    assert ended[0] > 0 or name != "PandaReach-v3", "no episode succeeded: the test shows nothing"


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_an_unstable_world_is_truncated_as_in_sync_vector_env(mode: AutoresetMode) -> None:
    lost = 2
    ours = native("PandaPush-v3", autoreset_mode=mode)
    theirs = SyncVectorEnv([lambda: gymnasium.make("PandaPush-v3")] * N, autoreset_mode=mode)
    assert_same(ours.reset(seed=1), theirs.reset(seed=1), "reset")
    single: Any = theirs.envs[lost].unwrapped
    fast = np.frombuffer(np.float32(1e38).tobytes(), np.uint8)  # finite, but not for long
    velocity = 4 * single.bodies.model.nq  # a state begins with q and v, float32

    def with_speed(snapshot: bytes, world: int, n: int) -> bytes:
        rows = worlds_of(snapshot, n)
        rows[world, velocity : velocity + 4] = fast
        return sealed(snapshot, rows)

    ours._envs.restore(with_speed(ours._envs.snapshot(), lost, N))  # pyright: ignore[reportPrivateUsage]
    single.restore_state(with_speed(single.save_state(), 0, 1))
    actions = np.random.default_rng(1).uniform(-1, 1, (N, 3)).astype(np.float32)
    with pytest.warns(RuntimeWarning, match="unstable"):
        result = ours.step(actions)
    with pytest.warns(RuntimeWarning, match="unstable"):
        assert_same(result, theirs.step(actions), "the step that is lost")
    obs, _, _, truncated, info = result
    assert np.flatnonzero(truncated).tolist() == [lost]
    assert np.flatnonzero(info.get("final_info", info)["unstable"]).tolist() == [lost]
    assert all(np.isfinite(rows).all() for rows in obs.values())
    if mode != AutoresetMode.DISABLED:
        assert_same(ours.step(actions), theirs.step(actions), "the step after it")


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_another_episode_limit_equals_that_of_the_wrapper(mode: AutoresetMode) -> None:
    ours = native(max_episode_steps=3, autoreset_mode=mode)
    theirs = SyncVectorEnv([lambda: gymnasium.make("PandaReach-v3", max_episode_steps=3)] * N, autoreset_mode=mode)
    assert_same(ours.reset(seed=1), theirs.reset(seed=1), "reset")
    rng = np.random.default_rng(1)
    for t in range(3 if mode == AutoresetMode.DISABLED else 10):
        actions = rng.uniform(-1, 1, (N, 3)).astype(np.float32)
        assert_same(ours.step(actions), theirs.step(actions), f"step {t}")


def test_lists_of_seeds_and_reset_masks_equal_sync_vector_env() -> None:
    ours, theirs = native(), SyncVectorEnv([lambda: gymnasium.make("PandaReach-v3")] * N)
    assert_same(ours.reset(seed=3), theirs.reset(seed=3), "reset")
    rng = np.random.default_rng(0)
    mask = np.array([1, 0, 1, 1, 0, 0], bool)
    for t, (seed, options) in enumerate(
        [
            ([5, None, 2**40, 0, None, 1], None),
            (None, {"reset_mask": mask}),
            ([9, 8, None, 7, 6, 5], {"reset_mask": mask}),
        ]
    ):
        actions = rng.uniform(-1, 1, (N, 3)).astype(np.float32)
        assert_same(ours.step(actions), theirs.step(actions), f"step {t}")
        expected = theirs.reset(seed=seed, options=None if options is None else dict(options))
        assert_same(ours.reset(seed=seed, options=options), expected, f"reset {t}")
    assert options is not None and "reset_mask" in options, "the caller's options were changed"


@pytest.mark.parametrize("name", env_ids())
def test_a_world_is_the_single_environment_whatever_the_batch_and_threads(name: str) -> None:
    episodes = []
    for count, threads in ((1, 1), (5, 1), (37, 2)):
        env = native(name, count, num_threads=threads, autoreset_mode=AutoresetMode.DISABLED)
        world = count // 2
        first = 100 if "Reach" in name else 204  # seeds whose world does not succeed at once
        obs, _ = env.reset(seed=[first + i - world for i in range(count)])
        rng = np.random.default_rng(4)
        rows = [obs["observation"][world], obs["desired_goal"][world]]
        for _ in range(20):
            action = rng.uniform(-1, 1, env.single_action_space.shape)
            others = np.random.default_rng(count).uniform(-1, 1, env.action_space.shape or ())
            others[world] = action
            obs, *_, terminated, truncated, _ = env.step(others)
            rows.append(obs["observation"][world])
            if (done := terminated | truncated).any():
                assert not done[world], "choose another seed"
                env.reset(options={"reset_mask": done})
        episodes.append(np.concatenate(rows))
    np.testing.assert_array_equal(episodes[0], episodes[1])
    np.testing.assert_array_equal(episodes[0], episodes[2])


def test_make_vec_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in env_ids():
            env = native(name, 3)
            obs, _ = env.reset(seed=0)
            assert obs in env.observation_space
            assert env.step(env.action_space.sample())[0] in env.observation_space
            env.close()


def test_returned_arrays_are_the_callers() -> None:
    env = native()
    obs, info = env.reset(seed=0)
    results = [obs, info, *env.step(np.ones((N, 3)))]
    kept = [repr(one) for one in results]
    env.step(-np.ones((N, 3)))
    env.reset()
    assert [repr(one) for one in results] == kept


def test_without_copy_observations_are_views() -> None:
    env = native(copy=False)
    obs, _ = env.reset(seed=0)
    before = obs["observation"].copy()
    after = env.step(np.ones((N, 3)))[0]["observation"]
    np.testing.assert_array_equal(obs["observation"], after)
    assert (before != after).any()
    with pytest.raises(ValueError, match="read-only"):
        after[0, 0] = 1
    del env
    np.testing.assert_array_equal(obs["observation"], after)  # the memory outlives the environment


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        (np.zeros(3), r"shape \(3,\), expected \(6, 3\)"),
        (np.zeros((N, 7)), r"shape \(6, 7\), expected \(6, 3\)"),
        (np.full((N, 3), np.nan), "finite"),
    ],
)
def test_bad_actions_are_refused_and_change_nothing(actions: NDArray[Any], message: str) -> None:
    env, other = native(), native()
    env.reset(seed=1)
    other.reset(seed=1)
    with pytest.raises(ValueError, match=message):
        env.step(actions)
    good = np.ones((N, 3), np.float32)
    assert_same(env.step(good), other.step(good), "after the refusal")


def test_wrong_use_is_refused() -> None:
    env = native(autoreset_mode="Disabled", max_episode_steps=1)
    good = np.zeros((N, 3), np.float32)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(good)
    for bad in (1.5, "7", -3, [1.0] * N, ["1"] * N, [-1] * N, "123456", [[1] * N], np.ones(N), np.array(3.0), {1: 2}):
        seed: Any = bad
        with pytest.raises(ValueError, match="seed: expected a whole number of 0 or more, None, or a list of num_envs"):
            env.reset(seed=seed)
    for seed in ([1, 2], [2**64] * N, 2**64 - 1):
        with pytest.raises(ValueError, match="seed"):
            env.reset(seed=seed)
    env.reset(seed=0)
    env.step(good)
    with pytest.raises(RuntimeError, match="world 0 has ended its episode"):
        env.step(good)
    for mask, error in (
        (np.zeros(N, bool), ValueError),
        (np.ones(N + 1, bool), ValueError),
        ([True] * N, TypeError),
        (np.ones(N), TypeError),
    ):
        with pytest.raises(error, match="reset_mask"):
            env.reset(options={"reset_mask": mask})
    with pytest.raises(ValueError, match="AutoresetMode"):
        native(autoreset_mode="Sometimes")
    with pytest.raises(ValueError, match="'ansi', expected None or one of"):
        ArmVectorEnv(2, render_mode="ansi")


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("num_envs", [0, -1, 2.0, "4", None, True, 2**20 + 1]),
        ("num_threads", [0, -1, 1.5, "2", 1025]),
        ("max_episode_steps", [-2, 0, 2.5, "50", 2**31]),
    ],
)
def test_numbers_that_make_no_sense_are_refused_by_name(name: str, values: list[Any]) -> None:
    for value in values:
        arguments: dict[str, Any] = {"num_envs": 2} | {name: value}
        with pytest.raises(ValueError, match=f"{name} is {value!r}, expected"):
            ArmVectorEnv(**arguments)
    arguments = {"num_envs": np.int64(2), name: np.int64(2)}
    ArmVectorEnv(**arguments)


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_python_threads_that_share_an_environment_take_turns(mode: AutoresetMode) -> None:
    env, alone = native(num_envs=64, autoreset_mode=mode), native(num_envs=64, autoreset_mode=mode)
    env.reset(seed=0)
    alone.reset(seed=0)
    actions = np.full((64, 3), 0.5, np.float32)

    def work() -> None:
        for _ in range(50):
            env.step(actions)

    with ThreadPoolExecutor(4) as pool:
        for task in [pool.submit(work) for _ in range(4)]:
            task.result()
    for _ in range(200):
        alone.step(actions)
    assert_same(env.step(actions), alone.step(actions), "after 200 steps")


def test_threads_come_from_the_environment_variable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MANYHANDS_THREADS", "no number")
    with pytest.raises(ValueError, match="MANYHANDS_THREADS"):
        native()
    native(num_threads=1)
    monkeypatch.setenv("MANYHANDS_THREADS", "2")
    native().reset(seed=0)


def test_other_python_threads_run_during_a_step() -> None:
    env = native(num_envs=4096, num_threads=1)
    env.reset(seed=0)
    actions = np.zeros((4096, 3), np.float32)
    ticks, stop = [], threading.Event()

    def tick() -> None:
        while not stop.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.0005)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    for _ in range(10):
        env.step(actions)
    end = time.perf_counter()
    stop.set()
    thread.join()
    assert sum(begin < t < end for t in ticks) > 10 * 1.5, "the interpreter lock was held while stepping"


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_states_copies_and_pickles_continue_where_the_worlds_are(mode: AutoresetMode) -> None:
    envs = native(max_episode_steps=7, autoreset_mode=mode, randomize={"action_latency": (0, 2)}, num_threads=2)

    def play(worlds: ArmVectorEnv, obs: Any, steps: int) -> tuple[Any, ...]:
        results: list[Any] = []
        rng = np.random.default_rng(2)
        for _ in range(steps):
            results.append(worlds.step(actions_for(worlds, obs, rng)))
            obs, _, terminated, truncated, _ = results[-1]
            if mode == AutoresetMode.DISABLED and (terminated | truncated).any():
                results.append(worlds.reset(options={"reset_mask": terminated | truncated}))
                obs = results[-1][0]
        return tuple(results)

    obs = play(envs, envs.reset(seed=4)[0], 12)[-1][0]
    state, twins = envs.save_state(), [copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))]
    expected = play(envs, obs, 12)
    assert_same(envs.restore_state(state), obs, "what is observed there")
    for continued in (envs, *twins):
        assert continued.spec == envs.spec
        assert_same(play(continued, obs, 12), expected, mode.name)
    for wrong in (state[:-1], state[:5]):
        with pytest.raises(ValueError, match=r"snapshot"):
            envs.restore_state(wrong)


def test_a_copy_waits_for_its_reset_as_the_original_does() -> None:
    envs = native(max_episode_steps=2, autoreset_mode=AutoresetMode.DISABLED)
    envs.reset(seed=0)
    for _ in range(2):
        envs.step(np.zeros((N, 3), np.float32))
    with pytest.raises(RuntimeError, match="reset it first"):
        copy.deepcopy(envs).step(np.zeros((N, 3), np.float32))
