"""What `Simulation` promises beyond its page's examples."""

import logging
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import manyhands.pybullet as p
from manyhands.manipulapy import sim as sim_module
from manyhands.manipulapy.ManipulaPy_data import get_robot_urdf
from manyhands.manipulapy.sim import Simulation

SIX = [(-np.pi, np.pi)] * 6


@pytest.fixture(autouse=True)
def headless(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(sim_module.CONNECT, " Direct")


@pytest.fixture
def sim() -> Iterator[Simulation]:
    made = Simulation(get_robot_urdf("xarm6"), SIX, real_time_factor=0)
    yield made
    made.close_simulation()


def test_two_simulations_live_side_by_side(sim: Simulation) -> None:
    other = Simulation(get_robot_urdf("ur5"), SIX, real_time_factor=None)
    assert other.physics_client != sim.physics_client
    sim.run_trajectory([[0.3] * 6] * 50)
    assert np.abs(other.get_joint_positions()).max() < 0.01
    other.close_simulation()
    other.close_simulation()
    assert sim.get_joint_positions()[0] == pytest.approx(0.3, abs=5e-3), "closing one leaves the other as it was"


def test_a_given_client_is_used_and_kept() -> None:
    client = p.connect(p.DIRECT)
    sim = Simulation(get_robot_urdf("xarm6"), SIX, physics_client=client, real_time_factor=0)
    assert p.getNumBodies(physicsClientId=client) == 2
    sim.close_simulation()
    assert p.isConnected(client)
    p.disconnect(client)


def test_gravity_and_step_are_set(sim: Simulation) -> None:
    engine = p.getPhysicsEngineParameters(physicsClientId=sim.client)
    assert engine["gravityAccelerationZ"] == -9.81 and engine["fixedTimeStep"] == 0.01


def test_stepping_keeps_the_world(sim: Simulation) -> None:
    sim.step_simulation()
    assert p.getNumBodies(physicsClientId=sim.client) == 2


def test_connecting_again_builds_the_scene_again(sim: Simulation) -> None:
    sim.run_trajectory([[0.3] * 6] * 20)
    sim.connect_simulation()
    assert p.getNumBodies(physicsClientId=sim.client) == 2
    assert np.abs(sim.get_joint_positions()).max() == 0


@pytest.mark.parametrize("named", ["torque_limits", "forces"])
def test_motors_are_no_stronger_than_they_may_be(named: str) -> None:
    weak: Any = [(-10, 10), (-20, 5), (-3, 30), (-1, 1), (-1, 1), (-1, 1)]
    sim = Simulation(get_robot_urdf("xarm6"), SIX, torque_limits=weak if named == "torque_limits" else None)
    sim.set_joint_positions([1.0] * 6, None if named == "torque_limits" else [10, 20, 30, 1, 1, 1])
    sim.step_simulation()
    torques = [abs(state[3]) for state in sim._joint_states()]
    assert np.all(torques <= np.array([10, 20, 30, 1, 1, 1]) + 1e-9) and max(torques) > 19
    sim.close_simulation()


def test_what_run_controller_refuses(sim: Simulation) -> None:
    for nonsense, says in (([], "empty"), ([0.0] * 6, "shape"), ([[0.0] * 5], r"5.*6"), ([[np.nan] * 6], "finite")):
        with pytest.raises(ValueError, match=says):
            sim.run_controller(nonsense)
    with pytest.raises(ValueError, match="empty"):
        sim.run_trajectory([])
    with pytest.raises(TypeError):
        sim.run_controller([[0.0] * 6], 1, 2, 3, 4, 5)  # type: ignore[call-arg]
    place = sim.run_controller([0.01 * k] * 6 for k in range(30))
    assert len(place) == 3


def test_rows_are_paced_by_the_clock(monkeypatch: pytest.MonkeyPatch, sim: Simulation) -> None:
    slept: list[float] = []
    monkeypatch.setattr(time, "sleep", slept.append)
    sim.real_time_factor = 2.0
    sim.run_trajectory([[0.0] * 6] * 10)
    assert sum(slept) > 0 and max(slept) <= 0.01 / 2 * 10
    slept.clear()
    sim.real_time_factor = 0
    sim.run_trajectory([[0.0] * 6] * 10)
    assert not slept


def test_more_steps_a_row_arrive(sim: Simulation) -> None:
    rows = np.linspace([0.0] * 6, [0.19] * 6, 20)
    sim.run_trajectory(rows)
    lagging = sim.get_joint_positions()[0]
    sim.run_trajectory(rows[-1:], steps_per_row=60)
    assert lagging < 0.15 and sim.get_joint_positions()[0] == pytest.approx(0.19, abs=1e-3)


def test_the_button_wants_a_click(sim: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    sim.add_reset_button()
    sim.press_reset()  # long before
    steps = []

    def act(self: Simulation) -> None:
        steps.append(1)
        if len(steps) == 30:
            self.press_reset()

    monkeypatch.setattr(Simulation, "on_step", act)
    sim.manual_control()
    assert len(steps) == 30


def test_ctrl_c_ends_manual_control_and_others_go_on(monkeypatch: pytest.MonkeyPatch) -> None:
    for error, raised in ((KeyboardInterrupt(), None), (RuntimeError("a fault"), RuntimeError)):
        sim = Simulation(get_robot_urdf("xarm6"), SIX, real_time_factor=0)

        def act(self: Simulation, error: BaseException = error) -> None:
            raise error

        with monkeypatch.context() as patch:
            patch.setattr(Simulation, "on_step", act)
            if raised is None:
                sim.manual_control()
            else:
                with pytest.raises(raised):
                    sim.manual_control()
        assert sim.physics_client is None


def test_sliders_of_gravity_and_time(sim: Simulation) -> None:
    with pytest.raises(AttributeError):
        sim.update_simulation_parameters()
    sim.add_additional_parameters()
    sim.add_additional_parameters()
    assert sim.gravity_param is not None and sim.time_step_param is not None
    sim.set_parameter(sim.gravity_param, -1.6)
    sim.set_parameter(sim.time_step_param, 0.02)
    sim.step_simulation()
    engine = p.getPhysicsEngineParameters(physicsClientId=sim.client)
    assert engine["gravityAccelerationZ"] == -1.6 and engine["fixedTimeStep"] == 0.02 == sim.time_step
    with pytest.raises(ValueError, match="-20"):
        sim.set_parameter(sim.gravity_param, -100)


def test_sliders_begin_within_their_range() -> None:
    sim = Simulation(get_robot_urdf("xarm6"), [(0.5, 1.0), *SIX[1:]], real_time_factor=0)
    sim.add_joint_parameters()
    sim.add_joint_parameters()
    assert sim.get_joint_parameters() == [0.5, 0, 0, 0, 0, 0]
    sim.close_simulation()


def test_settling_takes_a_time(sim: Simulation) -> None:
    sim.simulate_robot_with_desired_angles(np.full(6, 0.1), duration=1.0)
    np.testing.assert_allclose(sim.get_joint_positions(), 0.1, atol=1e-3)
    assert sim.time_step == 0.01


def test_the_way_is_seen_and_not_touched(sim: Simulation) -> None:
    client = sim.client
    way = [[0.3, y, 0.3] for y in np.linspace(-0.2, 0.2, 20)]
    bodies = sim.plot_trajectory(way, line_width=2.5, color=(0, 1, 0))
    assert len(bodies) == 19 and len(sim.trajectory_body_ids) == 24
    assert not any(p.getCollisionShapeData(body, -1, physicsClientId=client) for body in sim.trajectory_body_ids)
    view = p.computeViewMatrix([1, 0, 0.3], [0, 0, 0.3], [0, 0, 1])
    projection = p.computeProjectionMatrixFOV(60, 1, 0.1, 3)
    seen = p.getCameraImage(256, 256, view, projection, physicsClientId=client)[4]
    assert set(bodies) & set(np.unique(seen).tolist())
    before = p.getNumBodies(physicsClientId=client)
    assert sim.plot_trajectory(way[:1]) == [] and sim.trajectory_body_ids == []
    assert p.getNumBodies(physicsClientId=client) == before - 24
    assert len(sim.plot_trajectory([[0, 0, 0], [0, 0, 0], [0, 0, -1]])) == 1, "no way between equal places"


def test_self_collision_and_pairs() -> None:
    folded = [0.0, -2.0, -3.8, 0.0, 0.0, 0.0]
    touching: dict[str, list[Any]] = {}
    for name, pairs in (("all", None), ("few", [("link_base", "link4"), ("link_base", "link5"), ("no", "link1")])):
        sim = Simulation(
            get_robot_urdf("xarm6"), SIX, enable_self_collision=True, disable_pairs=pairs, real_time_factor=0
        )
        for k, angle in zip(sim.non_fixed_joints, folded, strict=True):
            p.resetJointState(sim.robot_id, k, angle, physicsClientId=sim.client)
        p.performCollisionDetection(physicsClientId=sim.client)
        touching[name] = sim.check_collisions()
        sim.close_simulation()
    assert all(isinstance(a, int) and isinstance(b, int) and len(place) == 3 for a, b, place in touching["all"])
    assert len(touching["few"]) <= len(touching["all"])
    sim = Simulation(get_robot_urdf("xarm6"), SIX, real_time_factor=0)
    assert sim.check_collisions() == []
    sim.close_simulation()


def test_what_the_constructor_refuses(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"none\.urdf"):
        Simulation("none.urdf", SIX)
    with pytest.raises(p.error):
        Simulation("none.urdf", SIX)
    with pytest.raises(ValueError, match="5 joint limits"):
        Simulation(get_robot_urdf("xarm6"), SIX[:5])
    with pytest.raises(ValueError, match="time_step"):
        Simulation(get_robot_urdf("xarm6"), SIX, time_step=0)


def test_one_handler_however_often() -> None:
    for _ in range(3):
        sim = Simulation(get_robot_urdf("xarm6"), SIX)
        sim.close_simulation()
    logger = logging.getLogger("SimulationLogger")
    ours = [handler for handler in logger.handlers if type(handler) is logging.StreamHandler]
    assert len(ours) == 1 and logger.level == logging.DEBUG and not logger.propagate


def test_csv_goes_there_and_back(sim: Simulation, tmp_path: Path) -> None:
    sim.run_trajectory([[0.1] * 6] * 5)
    sim.save_joint_states(str(tmp_path / "states.csv"))
    rows = np.loadtxt(tmp_path / "states.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(rows[:, 0], sim.get_joint_positions())
