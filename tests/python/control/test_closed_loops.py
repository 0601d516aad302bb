"""Controllers close their loops around worlds: what they promise, measured."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import manyhands as mh
from manyhands import control, dynamics, kinematics, planning

Array = NDArray[np.float64]

HAND = "panda_grasptarget"
HOME = np.array([0.0, -0.5, 0.0, -2.2, 0.0, 1.8, 0.8, 0.02, 0.02])
DOWN = np.array([1.0, 0.0, 0.0, 0.0])  # xyzw: the hand points at the floor
H = 1e-3


@pytest.fixture(scope="module")
def panda() -> mh.Model:
    return mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]


def world_of(model: mh.Model, q: Array) -> mh.World:
    world = mh.World(model, time_step=H)
    world.q = q
    return world


def circle(model: mh.Model, speed: float, radius: float) -> tuple[planning.Trajectory, Array, float]:
    """Twice around, from rest and back to rest: joint positions, the centre, and the time of it."""
    turns, n = 2, 240
    centre = np.array([0.5, 0.0, 0.45])
    angle = np.linspace(0, 2 * np.pi * turns, n + 1)
    position = centre + radius * np.stack([0 * angle, np.sin(angle), np.cos(angle)], axis=1)
    joints, start = [], HOME
    for point in position:
        found = kinematics.inverse(model, HAND, position=point, quaternion=DOWN, start=start, posture=HOME)
        start = found.q
        joints.append(start)
    return planning.spline(radius * angle / speed, np.array(joints), 5, np.zeros((2, 0, model.nq))), centre, radius


def test_computed_torque_follows_a_circle_at_a_metre_a_second(panda: mh.Model) -> None:
    path, centre, radius = circle(panda, 1.0, 0.15)
    q, v, a = path.sample(0.0)
    world = world_of(panda, q)
    world.v = v
    errors = []
    for step in range(int(path.duration / H)):
        q, v, a = path.sample(step * H)
        world.tau = control.computed_torque(panda, world.q, world.v, q, v, a, kp=10_000, kd=200)
        world.step()
        position, _ = kinematics.forward(panda, world.q, HAND)
        wanted, _ = kinematics.forward(panda, path.sample(world.time).q, HAND)
        errors.append(np.linalg.norm(position - wanted))
        assert abs(np.linalg.norm((position - centre)[1:]) - radius) < 1e-3
    assert max(errors) < 1e-3, max(errors)


@pytest.mark.parametrize("slide", [0.0, 0.03])
def test_operational_space_control_pushes_with_ten_newtons(panda: mh.Model, slide: float) -> None:
    world = mh.World(time_step=H)
    world.add(mh.asset_path("panda/panda.urdf"), name="panda")
    world.add_box("wall", [0.2, 0.2, 0.05], position=[0.5, 0, 0.15], fixed=True)  # its top at 0.2 m
    above = kinematics.inverse(panda, HAND, position=[0.5, 0, 0.24], quaternion=DOWN, start=HOME)
    world.q = above.q
    stiffness, damping = np.array([0.0] * 7 + [100.0] * 2), 10 * dynamics.crba(panda, HOME).diagonal()
    pushed = []
    for step in range(3000):
        goal = [0.5 + slide * np.sin(step * H), 0.0, 0.2]
        second = stiffness * (HOME - world.q) - damping * world.v  # fingers stay where they are
        world.tau = control.operational_space(
            panda, HAND, world.q, world.v, goal, DOWN, posture=second, force=[0, 0, 0, 0, 0, 10],
            directions=("motion",) * 5 + ("force",),
        )  # fmt: skip
        world.step()
        if step >= 1000:
            pushed.append(-world.contact_wrench("wall").normal[5])
    off = np.abs(np.array(pushed) - 10)
    if slide == 0:
        assert off.max() < 0.2
    else:  # where it rocks, a finger tip strikes the wall within one step
        assert np.sort(off)[-2] < 0.2 and abs(np.mean(pushed) - 10) < 0.05


def test_an_impedance_yields_as_a_spring_does(panda: mh.Model) -> None:
    world = world_of(panda, HOME)
    position, quaternion = kinematics.forward(panda, HOME, HAND)
    damping = 5 * dynamics.crba(panda, HOME).diagonal()
    for _ in range(4000):
        world.apply_force("panda_hand", [0, 12.0, 0], point=position)
        spring = control.impedance(panda, HAND, world.q, world.v, position, quaternion, stiffness=600, damping=60)
        world.tau = spring - damping * world.v  # what the hand leaves free comes to rest, too
        world.step()
    moved = kinematics.forward(panda, world.q, HAND)[0] - position
    np.testing.assert_allclose(moved, [0, 12 / 600, 0], atol=2e-3)


def test_pd_on_gravity_comes_to_rest_where_it_should(panda: mh.Model) -> None:
    world, goal = world_of(panda, HOME), HOME + np.array([0.3, 0.2, -0.2, 0.3, 0.1, -0.2, 0.2, 0.0, 0.0])
    M = dynamics.crba(panda, HOME).diagonal()
    for _ in range(3000):
        world.tau = control.pd_gravity(panda, world.q, world.v, goal, kp=100 * M, kd=20 * M)
        world.step()
    np.testing.assert_allclose(world.q, goal, atol=1e-4)


def heavier(model: mh.Model, share: float) -> mh.World:
    world = world_of(model, HOME)
    for link in model.links:
        if link.mass > 0:
            world.set_mass(link.name, link.mass * share)
    return world


def swing(t: float) -> tuple[Array, Array, Array]:
    w, far = 2.0, np.array([0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.0, 0.0])
    return HOME + far * (1 - np.cos(w * t)), far * w * np.sin(w * t), far * w * w * np.cos(w * t)


def worst_error(world: mh.World, torque: Callable[[Array, Array, Array, Array, Array], Array], steps: int) -> float:
    """Of the arm's joints in the last second."""
    errors = []
    for step in range(steps):
        world.tau = torque(world.q, world.v, *swing(step * H))
        world.step()
        errors.append(np.abs(swing(world.time)[0] - world.q)[:7].max())
    return max(errors[-1000:])


def test_sliding_mode_stays_in_its_layer_with_a_wrong_model(panda: mh.Model) -> None:
    slope, boundary, kd = 10.0, 0.5, 20 * dynamics.crba(panda, HOME).diagonal()
    robust = np.array([20, 30, 20, 20, 3, 3, 0.3, 1, 1])

    def with_robust(share: float) -> float:
        def torque(*state: Array) -> Array:
            return control.sliding_mode(panda, *state, slope=slope, kd=kd, robust=share * robust, boundary=boundary)

        return worst_error(heavier(panda, 1.2), torque, 3000)

    assert with_robust(1.0) < boundary / slope
    assert with_robust(1.0) < 0.5 * with_robust(0.0)


def test_adaptive_control_learns_what_the_robot_weighs(panda: mh.Model) -> None:
    kd = 20 * dynamics.crba(panda, HOME).diagonal()

    def with_rate(rate: float) -> float:
        adaptive = control.Adaptive(panda, slope=10.0, kd=kd, rate=rate, dt=H)
        return worst_error(heavier(panda, 1.3), adaptive.torque, 10_000)

    learned, known = with_rate(0.5), with_rate(0.0)
    assert learned < 0.2 * known
