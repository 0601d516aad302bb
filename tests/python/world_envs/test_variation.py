"""The nine kinds of domain randomisation, each alone, on one world and on batches."""

import math
from typing import Any

import gymnasium
import numpy as np
import pytest

import manyhands as mh
from manyhands.world_envs import RANGES, KukaReach

GIVEN = {  # what is asked for
    "mass": 1.5,
    "friction": 0.4,
    "joint_damping": 2.0,
    "motor_force": 0.01,
    "camera": 0.3,
    "light": 0.6,
    "observation_noise": 0.05,
    "target": 0.1,
    "action_latency": 3,
}
USUAL = dict.fromkeys(GIVEN, 1.0) | {"joint_damping": 0, "camera": 0, "observation_noise": 0, "action_latency": 0}


class Witness:
    """A world that keeps what it was told last."""

    def __init__(self, world: mh.World) -> None:
        self._world = world
        self.told: dict[str, Any] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._world, name)

    def set_motors(self, **told: Any) -> None:
        self.told |= told
        self._world.set_motors(**told)

    def render(self, camera: mh.Camera, **told: Any) -> mh.Picture:
        self.told |= {"camera": camera, **told}
        return self._world.render(camera, **told)


def measured(env: KukaReach, seed: int = 4) -> dict[str, float]:
    """What the nine kinds come to in an episode, in the units of `RANGES`."""
    seen = env.reset(seed=seed)[0]
    exact = env.look()
    world = env.world
    links = [link.name for link in env.model.links if link.mass > 0 and link.body > 0]
    middle, half = np.add(*env.TARGETS) / 2, np.subtract(*env.TARGETS[::-1]) / 2
    share = (env.goal - middle) / half
    witness = env.world = Witness(world)  # pyright: ignore[reportAttributeAccessIssue]
    env.render()
    eye = witness.told["camera"].position - env._view.target
    late = 0
    env.step(np.ones(7))
    while np.array_equal(witness.told["target_q"], env.HOME):
        env.step(np.ones(7))
        late += 1
    env.world = world
    return {
        "mass": sum(map(world.mass, links)),
        "friction": world.friction("floor"),
        "joint_damping": world.damping("kuka/lbr_iiwa_joint_4"),
        "motor_force": witness.told["max_force"],
        "camera": math.atan2(eye[1], eye[0]),
        "light": witness.told["look"].sun,
        "observation_noise": float(np.abs(seen - exact).max()),
        "target": float(np.abs(share).max()),
        "action_latency": late,
    }


def test_there_are_nine() -> None:
    assert len(RANGES) == 9 and list(RANGES) == list(GIVEN)
    assert {name: kind.usual for name, kind in RANGES.items()} == USUAL


@pytest.mark.parametrize("name", GIVEN)
def test_each_changes_what_it_says_and_nothing_else(name: str) -> None:
    usual = measured(KukaReach(render_mode="rgb_array"))
    varied = measured(KukaReach(render_mode="rgb_array", randomize={name: GIVEN[name]}))
    if name == "observation_noise":
        assert usual[name] < 1e-6 and GIVEN[name] < varied[name] < 5 * GIVEN[name]
    elif USUAL[name] == 1:  # a factor
        assert varied[name] == pytest.approx(GIVEN[name] * usual[name], rel=1e-5)
    else:
        assert varied[name] == pytest.approx(GIVEN[name] + usual[name], rel=1e-5)
    for other in set(GIVEN) - {name}:
        assert varied[other] == usual[other], other


@pytest.mark.parametrize("name", GIVEN)
def test_an_episode_knows_nothing_of_the_one_before(name: str) -> None:
    """What is drawn is drawn from the world as it was made; and again for a seed."""
    kind = RANGES[name]
    low, high = (GIVEN[name], GIVEN[name] * 1.2) if not kind.whole else (1, 5)
    used = KukaReach(render_mode="rgb_array", randomize={name: (low, high)})
    first = [measured(used, seed)[name] for seed in (1, 2, 3)]
    assert len(set(first)) > 1
    for seed, value in zip((3, 2, 1), first[::-1], strict=True):
        assert measured(used, seed)[name] == value
        assert measured(KukaReach(render_mode="rgb_array", randomize={name: (low, high)}), seed)[name] == value


def test_values_stand_in_info_and_do_not_depend_on_company() -> None:
    alone = KukaReach(randomize={"friction": (0.5, 2.0, "log")})
    both = KukaReach(randomize={"mass": (0.5, 2.0), "friction": (0.5, 2.0, "log")})
    seen = []
    for seed in range(20):
        info = both.reset(seed=seed)[1]
        assert alone.reset(seed=seed)[1]["randomized"]["friction"] == info["randomized"]["friction"]
        assert both.step(np.zeros(7))[4]["randomized"] == info["randomized"]
        np.testing.assert_array_equal(alone.goal, both.goal)
        seen.append(info["randomized"]["friction"])
    assert 0.5 <= min(seen) < 0.8 and 1.3 < max(seen) <= 2.0
    assert "randomized" not in KukaReach().reset()[1]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"colour": 1.0}, r"\['colour'\]; there are mass, friction"),
        ({"mass": (2.0, 1.0)}, "low <= high"),
        ({"mass": 0.0}, "within"),
        ({"mass": float("nan")}, "within"),
        ({"friction": (0.0, 1.0, "log")}, "logarithm"),
        ({"friction": (0.1, 1.0, "even")}, r"expected a number, \(low, high\)"),
        ({"friction": "much"}, "expected numbers"),
        ({"action_latency": 1.5}, "whole"),
    ],
)
def test_bad_ranges_are_refused(given: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        KukaReach(randomize=given)


# ---- batches -----------------------------------------------------------------------------------------------------

PHYSICS = {
    "mass": {"object_mass": (0.5, 2.0)},
    "friction": {"table_friction": (0.5, 2.0)},
    "joint_damping": {"joint_damping": (0.0, 2.0)},
    "motor_force": {"motor_force": (0.5, 1.0)},
    "observation_noise": {"observation_noise": (0.01, 0.02)},
    "action_latency": {"action_latency": (1, 8)},
}
PICTURES = {"camera": {"position": 0.05, "direction": 0.1}, "light": {"light": 0.3, "brightness": 0.3}}
N = 8


def batch(randomize: Any = None, vary: Any = None) -> tuple[dict[str, Any], dict[str, Any]]:
    envs = gymnasium.make_vec(
        "PandaPush-v3",
        num_envs=N,
        randomize=randomize,
        cameras={"front": {"width": 32, "height": 32, "vary": vary or {}}},
    )
    return envs.reset(seed=0)


def test_batches_have_them_all() -> None:
    assert {*PHYSICS, *PICTURES, "target"} == set(RANGES)


@pytest.mark.parametrize("name", PHYSICS)
def test_worlds_of_a_batch_differ(name: str) -> None:
    usual, _ = batch()
    seen, info = batch(PHYSICS[name])
    drawn = info["randomized"][next(iter(PHYSICS[name]))]
    assert len(set(drawn.tolist())) > 3
    np.testing.assert_array_equal(seen["desired_goal"], usual["desired_goal"])
    np.testing.assert_array_equal(seen["front"], usual["front"])
    assert np.array_equal(seen["observation"], usual["observation"]) == (name != "observation_noise")


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_of_a_batch_differ(name: str) -> None:
    usual, _ = batch()
    seen, _ = batch(vary=PICTURES[name])
    assert all((a != b).any() for a, b in zip(seen["front"], usual["front"], strict=True))
    np.testing.assert_array_equal(seen["observation"], usual["observation"])


def test_targets_of_a_batch_differ() -> None:
    assert len(np.unique(batch()[0]["desired_goal"], axis=0)) == N


def test_a_batch_of_ones_own_takes_them_world_by_world() -> None:
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"))
    usual, worlds = mh.Batch(model, 2), mh.Batch(model, 2)
    worlds.set_mass("panda_hand", [0.73, 3.0])
    worlds.set_damping("panda_joint2", [0.0, 5.0])
    worlds.set_friction("panda_leftfinger", [0.5, 1.0])
    force = np.full((2, 9), 87.0) * [[1.0], [0.1]]  # of the motors
    cameras = [mh.Camera.perspective(32, 32, 0.8).orbit([0, 0, 0.4], 1.5, yaw, -0.4) for yaw in (0.5, 0.6)]
    looks = [mh.Look(sun=sun) for sun in (0.72, 0.4)]
    for each in (usual, worlds):
        each.q = np.tile([0.0, 0.4, 0.0, -1.2, 0.0, 2.0, 0.7, 0.02, 0.02], (2, 1))
        each.set_motors(target_q=each.q, max_force=force if each is worlds else 87.0)
        each.step(50)
    difference = np.abs(worlds.q - usual.q).max(axis=1)
    assert difference[0] < 1e-4 < 1e-2 < difference[1]
    pictures = [usual.render(cameras, look=looks).colour, usual.render(cameras[0], look=looks[0]).colour]
    np.testing.assert_array_equal(pictures[0][0], pictures[1][0])
    assert (pictures[0][1] != pictures[1][1]).any()
