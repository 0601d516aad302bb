"""Each of the environments on a `World`: by the book, the same for a seed, and solved by rule."""

import sys
import warnings
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import controllers
import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from manyhands import dynamics
from manyhands.world_envs import DrawerOpen, KukaReach, Quadrotors, QuadrotorTeam, QuadrupedWalk, WorldEnv

IDS = ["DrawerOpen", "KukaReach", "QuadrotorHover", "QuadrotorTeam", "QuadrupedWalk"]


def make(name: str, **options: Any) -> WorldEnv:
    env = gymnasium.make(f"{name}-v0", **options).unwrapped
    assert isinstance(env, WorldEnv)
    return env


@pytest.mark.parametrize("name", IDS)
def test_gymnasium_checks_without_a_warning(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(make(name), skip_render_check=True)
        env = make(name, render_mode="rgb_array")
        env.reset(seed=0)
        picture = env.render()
    assert picture is not None and picture.shape == (480, 720, 3) and picture.dtype == np.uint8
    assert picture.std() > 10


@pytest.mark.parametrize("name", IDS)
def test_a_seed_decides_the_episode(name: str) -> None:
    def play(env: WorldEnv) -> list[Any]:
        seen = [env.reset(seed=5)[0]]
        for action in np.random.default_rng(0).uniform(-1, 1, (20, *env.action_space.shape)):
            observation, reward, *_ = env.step(action)
            seen += [observation, reward]
        return [*seen, env.reset()[0]]  # and the next one

    used = make(name)
    play(used)
    for a, b, c in zip(play(used), play(make(name)), play(make(name)), strict=True):
        np.testing.assert_array_equal(a, b)
        np.testing.assert_array_equal(b, c)


@pytest.mark.parametrize("name", IDS)
def test_bad_actions_are_refused(name: str) -> None:
    env = make(name)
    env.reset(seed=0)
    before = env.world.state_hash()
    for bad in (np.zeros(1), np.full(env.action_space.shape, np.nan)):
        with pytest.raises(ValueError, match=r"the action is .*, expected \d+ numbers"):
            env.step(bad)
    assert env.world.state_hash() == before


@pytest.mark.parametrize("name", ["DrawerOpen", "KukaReach", "QuadrupedWalk"])  # who does nothing flies away
def test_time_limits_truncate(name: str) -> None:
    env = gymnasium.make(f"{name}-v0")
    env.reset(seed=0)
    assert env.spec is not None and env.spec.max_episode_steps is not None
    still = np.zeros(env.action_space.shape or ())
    ends = [env.step(still)[2:4] for _ in range(env.spec.max_episode_steps)]
    assert ends[-1] == (False, True) and not any(map(any, ends[:-1]))


def test_render_modes_that_are_not_there_are_refused() -> None:
    with pytest.raises(ValueError, match="render_mode is 'depth_array'"):
        KukaReach(render_mode="depth_array")


def test_what_numbers_cannot_bear_truncates(monkeypatch: pytest.MonkeyPatch) -> None:
    env = KukaReach()
    env.reset(seed=0)
    env.world.v = np.full(7, 1e200)
    with pytest.warns(RuntimeWarning, match="unstable=True"):
        _, _, terminated, truncated, info = env.step(np.zeros(7))
    assert truncated and not terminated and info["unstable"]


# ---- each is solved by rule --------------------------------------------------------------------------------------


def test_the_kuka_reaches() -> None:
    for seed in range(20):
        _, total, is_over, info = controllers.run(KukaReach(), seed, lambda e, seen, _: controllers.reach(e, seen), 100)
        assert is_over and info["is_success"] and info["distance"] < KukaReach.CLOSE and total > 0


def test_every_target_of_the_kuka_is_within_its_reach() -> None:
    """The shoulder is 0.36 m high; the flange comes 0.9 m away from it."""
    low, high = np.array(KukaReach.TARGETS)
    far = np.maximum(np.abs(low - [0, 0, 0.36]), np.abs(high - [0, 0, 0.36]))
    shoulder = dynamics.frame_pose(KukaReach().model, np.zeros(7), "kuka/lbr_iiwa_link_2")[0]
    flange = dynamics.frame_pose(KukaReach().model, np.zeros(7), "kuka/lbr_iiwa_link_7")[0]
    assert np.linalg.norm(far) < np.linalg.norm(flange - shoulder) + KukaReach.CLOSE


def test_the_drawer_is_pulled_open_by_its_handle() -> None:
    env = DrawerOpen()
    for seed in range(8):
        act = controllers.OpenDrawer()
        _, total, is_over, info = controllers.run(env, seed, lambda e, seen, _, act=act: act(e, seen), 100)
        assert is_over and info["is_success"] and info["opening"] > DrawerOpen.OPEN and total > 0
        position, _ = env.world.body_pose("drawer/case")
        assert abs(position[2] - DrawerOpen.CHEST[2]) < 2e-3  # the chest has stayed where it stood


def test_a_drawer_that_nobody_pulls_stays_shut() -> None:
    _, _, is_over, info = controllers.run(DrawerOpen(), 0, lambda *_: np.array([0, 0, 0, -1.0]), 100)
    assert not is_over and abs(info["opening"]) < 1e-6


@pytest.mark.parametrize("drones", [1, 3])
def test_quadrotors_hover_within_two_centimetres(drones: int) -> None:
    env = Quadrotors(drones)
    for seed in range(5):
        _, total, is_over, info = controllers.run(env, seed, lambda e, seen, _: controllers.hover(e, seen), 250)
        assert not is_over and info["is_success"] and (info["distances"] < 0.02).all() and total > 200


def test_rotors_pull_as_their_speeds_squared_and_lag() -> None:
    """At hovering speed the craft does not accelerate; without power it falls; diagonal pairs turn it about."""
    env = Quadrotors()
    env.reset(seed=0)
    world, rotors, link = env.world, env._rotors, "drone0/base_link"
    assert 4 * rotors.THRUST * rotors.hovering**2 == pytest.approx(world.mass(link) * 9.81)
    world.set_body_pose(link, [0, 0, 1])
    rotors.step(np.ones((1, 4)))
    omega, velocity = world.body_velocity(link)
    np.testing.assert_allclose([*omega, *velocity], 0, atol=1e-12)
    before = rotors.speeds.copy()
    rotors.step(np.zeros((1, 4)))
    np.testing.assert_allclose(rotors.speeds, before * np.exp(-world.time_step / rotors.TIME_CONSTANT))
    rotors.reset()
    world.set_body_velocity(link)
    turn = 0.0
    for _ in range(40):
        rotors.step(np.array([[1.2, 0.8, 1.2, 0.8]]))
        front, left, behind, right = rotors.THRUST * rotors.speeds[0] ** 2
        turn += rotors.DRAG * (front - left + behind - right) * world.time_step / 0.0064  # the inertia about z
    omega, velocity = world.body_velocity(link)
    np.testing.assert_allclose(omega, [0, 0, turn], rtol=1e-4, atol=1e-9)
    lone = Quadrotors()
    lone.reset(seed=0)
    lone.world.set_body_pose(link, [0, 0, 1])
    is_down = False
    for _ in range(61):
        is_down = is_down or lone.step(-np.ones(4))[2]
    assert is_down and lone.world.body_pose(link)[0][2] < 0.2  # on the ground


def test_the_walker_stands_for_five_seconds() -> None:
    env = QuadrupedWalk()
    seen, total, is_over, _ = controllers.run(env, 0, lambda *_: np.zeros(12), 250)
    assert not is_over and abs(seen[0] - env.HEIGHT) < 0.01 and seen[3] < -0.999 and total > 250


def test_the_walker_falls_when_its_motors_are_off() -> None:
    env = QuadrupedWalk(randomize={"motor_force": 0.0})
    _, _, is_over, _ = controllers.run(env, 0, lambda *_: np.zeros(12), 100)
    assert is_over


@pytest.mark.parametrize("speed", [0.2, 0.4])
def test_the_walker_trots_ahead(speed: float) -> None:
    env = QuadrupedWalk()
    _, _, is_over, _ = controllers.run(env, 0, lambda e, _, step: controllers.trot(e, step, speed), 250)
    walked = env.world.body_pose("a1/trunk")[0]
    assert not is_over and 0.7 * 5 * speed < walked[0] < 5 * speed and abs(walked[1]) < 0.4


# ---- agents of their own -----------------------------------------------------------------------------------------


def test_a_team_of_agents_is_the_environment_of_all() -> None:
    team, env = QuadrotorTeam(), make("QuadrotorTeam")
    seen, infos = team.reset(seed=3)
    assert list(seen) == team.agents == team.possible_agents == ["drone0", "drone1", "drone2"] == list(infos)
    np.testing.assert_array_equal(np.concatenate(list(seen.values())), env.reset(seed=3)[0])
    rng = np.random.default_rng(0)
    for _ in range(10):
        actions = {name: rng.uniform(-0.1, 0.1, 4).astype(np.float32) for name in team.agents}
        seen, rewards, terminated, truncated, _ = team.step(actions)
        expected, reward, *_ = env.step(np.concatenate(list(actions.values())))
        np.testing.assert_array_equal(np.concatenate(list(seen.values())), expected)
        assert np.mean(list(rewards.values())) == pytest.approx(reward)
        assert all(team.observation_space(name).contains(row) for name, row in seen.items())
        assert not any({**terminated, **truncated}.values())
    np.testing.assert_array_equal(team.state(), expected)


def test_a_team_ends_together() -> None:
    team = QuadrotorTeam(2)
    team.reset(seed=0)
    steps = 0
    while team.agents:
        _, _, terminated, truncated, _ = team.step({name: team.action_space(name).high * 0 for name in team.agents})
        steps += 1
    assert set(terminated.values()) in ({True}, {False}) and (any(terminated.values()) or steps == team.MAX_STEPS)
    assert set(truncated) == {"drone0", "drone1"}


def test_a_team_is_pettingzoos_where_that_is(monkeypatch: pytest.MonkeyPatch) -> None:
    class ParallelEnv:
        pass

    from manyhands.world_envs import parallel

    monkeypatch.setitem(sys.modules, "pettingzoo", SimpleNamespace(ParallelEnv=ParallelEnv))  # pyright: ignore[reportArgumentType]
    load: Callable[..., Any] = parallel.__loader__.get_code  # pyright: ignore[reportOptionalMemberAccess, reportAttributeAccessIssue]
    names: dict[str, Any] = {"__name__": "again"}
    exec(load("manyhands.world_envs.parallel"), names)
    assert issubclass(names["QuadrotorTeam"], ParallelEnv)


def test_no_drones_are_refused() -> None:
    with pytest.raises(ValueError, match="drones is 0"):
        Quadrotors(0)
