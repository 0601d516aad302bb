"""A page that shows a world of many, stepped by a loop."""

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import manyhands as mh
from manyhands import rotations
from manyhands.envs.vector import ArmVectorEnv
from manyhands.viewer import Viewer
from manyhands.viewer.batches import BatchSource
from manyhands.viewer.neighbours import places


def reaching(envs: Any, steps: int) -> list[tuple[Any, ...]]:
    """What an expert's steps bring."""
    expert = mh.envs.Expert("PandaReach-v3")
    observation, _ = envs.reset(seed=3)
    seen = []
    for _ in range(steps):
        observation, *rest = envs.step(expert(observation))
        seen.append((observation, *rest))
    return seen


@pytest.fixture
def envs() -> Iterator[ArmVectorEnv]:
    envs = ArmVectorEnv(5, "PandaReach", num_threads=1)
    yield envs
    envs.close()


# ---- counting ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_episodes_are_counted_as_single_environments_would(mode: AutoresetMode) -> None:
    """Under the same actions, one by one, with a limit of 6 steps that some random episodes meet."""
    n, limit = 6, 6
    envs = ArmVectorEnv(n, "PandaReach", max_episode_steps=limit, autoreset_mode=mode, distance_threshold=0.15)
    tally = envs.count_episodes()
    envs.reset(seed=0)
    singles = [gymnasium.make("PandaReach-v3", max_episode_steps=limit, distance_threshold=0.15) for _ in range(n)]
    for k, single in enumerate(singles):
        single.reset(seed=k)
    length, episodes, successes = np.zeros((3, n), int)
    total = np.zeros(n)
    over = np.zeros(n, bool)
    rng = np.random.default_rng(1)
    for _ in range(40):
        actions = rng.uniform(-1, 1, (n, 3)).astype(np.float32)
        _, _, terminated, truncated, _ = envs.step(actions)
        for k, single in enumerate(singles):
            if over[k]:  # what NEXT_STEP does with this step
                single.reset()
                length[k], total[k], over[k] = 0, 0.0, False
                continue
            _, reward, done, late, info = single.step(actions[k])
            length[k], total[k] = length[k] + 1, total[k] + float(reward)
            if done or late:
                episodes[k], successes[k] = episodes[k] + 1, successes[k] + info["is_success"]
                if mode == AutoresetMode.NEXT_STEP:
                    over[k] = True
                else:
                    single.reset()
                    length[k], total[k] = 0, 0.0
        if mode == AutoresetMode.DISABLED and (terminated | truncated).any():
            envs.reset(options={"reset_mask": terminated | truncated})
        assert np.array_equal(tally.length, length)
        assert np.allclose(tally.total, total)
        assert np.array_equal(tally.episodes, episodes)
        assert np.array_equal(tally.successes, successes)
    assert (episodes > successes).any() and successes.any()


# ---- what is shown -----------------------------------------------------------------------------------------------


def test_the_chosen_world_is_shown_where_it_is_observed(envs: ArmVectorEnv) -> None:
    observation, _ = envs.reset(seed=0)
    source = BatchSource(envs, "reach")
    hand = [link.name for link in source.model.links].index("panda_grasptarget")
    for world in (0, 3, 4):
        source.choose(world)
        (marker,) = source.markers()
        assert np.allclose(marker.position, observation["desired_goal"][world])
        observation, *_ = envs.step(np.full((5, 3), 0.3))
        source.tick()
        assert np.allclose(source.poses()[0][hand], observation["achieved_goal"][world], atol=2e-3)
    assert source.time == pytest.approx(3 * 0.04)


def test_worlds_beside_it_are_the_next_ones(envs: ArmVectorEnv) -> None:
    observation, _ = envs.reset(seed=0)
    source = BatchSource(envs, "reach")
    assert source.neighbours() is None
    source.choose(3, count=4)
    shown = source.neighbours()
    assert shown is not None and shown.worlds == [3, 4, 0, 1]
    hand = [link.name for link in source.model.links].index("panda_grasptarget")
    assert np.allclose(shown.positions[:, hand], observation["achieved_goal"][shown.worlds], atol=2e-3)
    goals = [markers[0].position for markers in shown.markers]
    assert np.allclose(goals, observation["desired_goal"][shown.worlds])
    assert np.array_equal(source.poses()[0], shown.positions[0])  # the chosen one is where it always is


def test_looking_back_leaves_the_worlds_alone(envs: ArmVectorEnv) -> None:
    envs.reset(seed=0)
    source = BatchSource(envs, "reach")
    source.choose(2)
    past, then = source.save(), source.q.copy()
    envs.step(np.full((5, 3), 0.5))
    source.tick()
    now, bits = source.q.copy(), envs._envs.state_hash
    assert not np.array_equal(now, then)
    source.restore(past)
    assert np.array_equal(source.q, then) and source.time == 0
    source.step()
    source.reset()
    assert envs._envs.state_hash == bits
    assert np.array_equal(source.q, now) and source.time == pytest.approx(0.04)


def test_human_mode_changes_no_bits_and_keeps_time() -> None:
    watched = gymnasium.make_vec("PandaReach-v3", num_envs=4, render_mode="human", num_threads=1)
    assert watched.render_mode == "human"
    start = time.perf_counter()
    seen = reaching(watched, 12)
    assert time.perf_counter() - start > 0.4  # 13 steps of 0.04 s
    unseen = reaching(gymnasium.make_vec("PandaReach-v3", num_envs=4, num_threads=1), 12)
    for one, other in zip(seen, unseen, strict=True):
        assert np.array_equal(one[0]["observation"], other[0]["observation"])
        assert all(np.array_equal(a, b) for a, b in zip(one[1:4], other[1:4], strict=True))
    inner: Any = watched.unwrapped
    page = inner._page._viewer
    assert page is not None and page.source.tally.episodes.sum() == sum(int((s[2] | s[3]).sum()) for s in seen)
    watched.close()
    assert page.is_closed


def test_unknown_modes_are_refused() -> None:
    with pytest.raises(ValueError, match=r"expected None or one of \('human', 'rgb_array', 'depth_array'\)"):
        ArmVectorEnv(2, "PandaReach", render_mode="ansi")
    with pytest.raises(TypeError, match="expected an environment of this package"):
        mh.view(gymnasium.make_vec("CartPole-v1", num_envs=2, vectorization_mode="sync"), port=18480)


# ---- the page ----------------------------------------------------------------------------------------------------


def test_a_browser_that_hangs_holds_up_no_step(envs: ArmVectorEnv, monkeypatch: pytest.MonkeyPatch) -> None:
    release = threading.Event()
    with Viewer(envs, port=18470, announce=False) as viewer:
        viewer.speed = float("inf")
        monkeypatch.setattr(viewer.player, "_draw", lambda _: release.wait(20.0) and None)
        envs.reset(seed=0)
        start = time.perf_counter()
        for _ in range(300):
            envs.step(np.zeros((5, 3)))
            viewer.sync()
        taken = time.perf_counter() - start
        release.set()
    assert taken < 5.0  # 12 s at the worlds' own pace


def test_the_page_never_moves_the_worlds(envs: ArmVectorEnv) -> None:
    """Also when the loop takes long between two steps, as learners do."""
    with Viewer(envs, port=18470, announce=False) as viewer:
        envs.reset(seed=0)
        before = envs._envs.state_hash
        viewer.play()
        viewer.step(3)
        viewer.reset()
        time.sleep(0.3)
        assert viewer.player.do(lambda: None, wait=5.0)
        assert envs._envs.state_hash == before
        assert viewer.panel.teleop is None and viewer.panel.worlds is not None
        with pytest.raises(TypeError, match="no environment in which 'me' could act"):
            viewer.actor("me", lambda _: np.zeros(3))


def test_worlds_are_gone_through(envs: ArmVectorEnv) -> None:
    with Viewer(envs, port=18470, announce=False) as viewer:
        panel = viewer.panel.worlds
        assert panel is not None
        for by, expected in ((1, 1), (1, 2), (-1, 1), (-1, 0), (-1, 4), (1, 0)):
            panel._go(by)
            assert viewer.player.do(lambda: None, wait=5.0)
            assert panel._source.chosen == expected == panel._world.value
        reaching(envs, 30)
        panel.refresh(viewer.player._frame)  # pyright: ignore[reportArgumentType]
        tally = panel._source.tally
        assert f"All 5 worlds: {tally.episodes.sum()} episodes" in panel._status.content
        assert tally.successes.sum() == tally.episodes.sum() > 5


def test_worlds_beside_it_are_drawn_apart() -> None:
    """Each geom where its own world has it, computed here for one world at a time."""
    envs = ArmVectorEnv(6, "PandaStack", num_threads=1)
    envs.reset(seed=0)
    with Viewer(envs, port=18470, announce=False) as viewer:
        panel, stage = viewer.panel.worlds, viewer.stage.neighbours
        assert panel is not None and panel._count.options == ("1", "4", "6")
        panel._count.value = "4"
        until(lambda: "goals/target object2" in stage._batches)  # the last
        model = viewer.source.model
        assert [label.text for label in stage._labels] == ["0", "1", "2", "3"]
        apart = places(4)
        assert np.ptp(apart, axis=0)[:2].min() > 1.0  # no arm reaches its neighbours' table
        for number in (name for name in stage._batches if name.isdigit()):
            geom, batch = model.geoms[int(number)], stage._batches[number]
            for k in range(1, 4):
                q = envs.bodies.configuration(k)
                positions, quaternions = mh.dynamics.forward_kinematics(model, q)
                turned, at = quaternions[geom.link], positions[geom.link]
                place = apart[k] + at + rotations.rotate(turned, geom.position)
                wxyz = np.roll(rotations.multiply(turned, geom.quaternion), 1)
                assert np.allclose(batch.batched_positions[k - 1], place, atol=1e-5)
                assert np.allclose(batch.batched_wxyzs[k - 1], wxyz, atol=1e-5)
        seen = {model.geoms[int(name)].link for name in stage._batches if name.isdigit()}
        assert seen == {
            int(body.name.split("/")[2].split()[0]) for body in viewer.stage._bodies if has_mesh(body, viewer)
        }
        panel._count.value = "1"
        until(lambda: not stage._batches and not stage._labels)
    envs.close()


def has_mesh(body: Any, viewer: Viewer) -> bool:
    """Whether anything is drawn on a link of the world that is shown."""
    nodes = viewer.server.scene._handle_from_node_name
    return any(name.startswith(f"{body.name}/") and handle.visible for name, handle in nodes.items())


def until(condition: Callable[[], object], seconds: float = 10.0) -> None:
    deadline = time.perf_counter() + seconds
    while not condition():
        assert time.perf_counter() < deadline, "it did not come about"
        time.sleep(0.02)
