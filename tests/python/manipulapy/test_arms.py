"""Kinematics, dynamics, planning, control and fields of arms, against independent truth."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from manyhands import dynamics
from manyhands.manipulapy import utils
from manyhands.manipulapy.control import ManipulatorController
from manyhands.manipulapy.dynamics import ManipulatorDynamics
from manyhands.manipulapy.ik_helpers import adaptive_multi_start_ik, workspace_heuristic_guess
from manyhands.manipulapy.kinematics import SerialManipulator, TracIKSolver, trac_ik_solve
from manyhands.manipulapy.ManipulaPy_data import ROBOT_DATABASE, get_robot_urdf, list_robots
from manyhands.manipulapy.path_planning import TrajectoryPlanning
from manyhands.manipulapy.perception import Perception
from manyhands.manipulapy.potential_field import CollisionChecker, PotentialField
from manyhands.manipulapy.singularity import Singularity
from manyhands.manipulapy.urdf import URDF
from manyhands.manipulapy.urdf_processor import URDFToSerialManipulator

Array = NDArray[np.float64]
G = np.array([0.0, 0.0, -9.81])
NONE = np.zeros(6)


@pytest.fixture(scope="module", params=sorted(ROBOT_DATABASE))
def arm(request: pytest.FixtureRequest) -> URDFToSerialManipulator:
    return URDFToSerialManipulator(get_robot_urdf(request.param))


@pytest.fixture(scope="module")
def xarm() -> URDFToSerialManipulator:
    return URDFToSerialManipulator(get_robot_urdf("xarm6"))


def states(arm: URDFToSerialManipulator, n: int, seed: int = 0) -> tuple[Array, Array, Array]:
    rng = np.random.default_rng(seed)
    low, high = arm.joint_limits_array.T
    shape = (n, arm.num_dofs)
    return rng.uniform(low, high, shape), rng.normal(size=shape), rng.normal(size=shape)


def test_screws_are_the_model(arm: URDFToSerialManipulator) -> None:
    q, v, a = states(arm, 20)
    model, names = arm.robot.model, arm.joint_names
    rows = np.stack([arm.robot.configuration(dict(zip(names, row, strict=True))) for row in q])
    at = [arm.robot.get_joint(name).iq for name in names]
    T = arm.forward_kinematics(q)
    for k in range(20):
        found = arm.robot.link_fk(dict(zip(names, q[k], strict=True)), use_names=True)[arm.tip_link]
        np.testing.assert_allclose(T[k], found, atol=1e-12)
    M = np.stack([arm.dynamics.mass_matrix(row) for row in q])
    np.testing.assert_allclose(M, dynamics.crba(model, rows)[:, at][:, :, at], atol=1e-12)
    full_v, full_a = np.zeros_like(rows), np.zeros_like(rows)
    full_v[:, at], full_a[:, at] = v, a
    expected = dynamics.rnea(model, rows, full_v, full_a)[:, at]
    found = np.stack([arm.dynamics.inverse_dynamics(q[k], v[k], a[k], G, NONE) for k in range(20)])
    np.testing.assert_allclose(found, expected, atol=1e-10)


def test_jacobians_are_derivatives(arm: URDFToSerialManipulator) -> None:
    q, h = states(arm, 1)[0][0], 1e-6
    Js, Jb, T = arm.jacobian(q), arm.jacobian(q, "body"), arm.forward_kinematics(q)
    np.testing.assert_allclose(Js, utils.adjoint_transform(T) @ Jb, atol=1e-12)
    for k in range(arm.num_dofs):
        step = h * np.eye(arm.num_dofs)[k]
        moved = utils.logm(arm.forward_kinematics(q + step) @ utils.TransInv(arm.forward_kinematics(q - step)))
        np.testing.assert_allclose(moved / (2 * h), Js[:, k], atol=1e-7)


def test_inverse_kinematics_reaches(arm: URDFToSerialManipulator) -> None:
    q = states(arm, 100, 3)[0]
    low, high = arm.joint_limits_array.T
    reached = 0
    for row in q:
        theta, success, _, strategy = arm.serial_manipulator.robust_inverse_kinematics(arm.forward_kinematics(row))
        assert (theta >= low - 1e-12).all() and (theta <= high + 1e-12).all() and isinstance(strategy, str)
        reached += success
        if success:
            np.testing.assert_allclose(arm.forward_kinematics(theta), arm.forward_kinematics(row), atol=5e-3)
    assert reached >= 99


def test_inverse_kinematics_says_when_it_fails(xarm: URDFToSerialManipulator) -> None:
    far = np.eye(4)
    far[:3, 3] = 100
    solver = xarm.serial_manipulator
    assert not solver.iterative_inverse_kinematics(far, np.zeros(6))[1]
    theta, success, seconds = solver.trac_ik(far, timeout=0.05)
    assert not success and seconds < 1 and theta.shape == (6,)
    with pytest.raises(ValueError, match="strategy"):
        solver.smart_inverse_kinematics(far, "by magic")


def test_forward_dynamics_undoes_inverse_dynamics(arm: URDFToSerialManipulator) -> None:
    q, v, a = (rows[0] for rows in states(arm, 1))
    push = np.array([0.1, -0.2, 0.3, 4.0, 5.0, -6.0])
    tau = arm.dynamics.inverse_dynamics(q, v, a, G, push)
    np.testing.assert_allclose(arm.dynamics.forward_dynamics(q, v, tau, G, push), a, atol=1e-9)
    plain = arm.dynamics.inverse_dynamics(q, v, a, G, NONE)
    np.testing.assert_allclose(tau - plain, arm.jacobian(q).T @ push, atol=1e-10)
    parts = arm.dynamics.mass_matrix(q) @ a + arm.dynamics.velocity_quadratic_forces(q, v)
    np.testing.assert_allclose(plain, parts + arm.dynamics.gravity_forces(q), atol=1e-10)


def planar(l1: float = 1.0, l2: float = 0.7, m1: float = 2.0, m2: float = 1.5) -> ManipulatorDynamics:
    """Two thin rods in the xy plane, gravity along -y in the formulas below."""
    M = np.eye(4)
    M[0, 3] = l1 + l2
    omega = np.array([[0, 0], [0, 0], [1, 1.0]])
    r = np.array([[0, 0, 0], [l1, 0, 0.0]])
    S = utils.extract_screw_list(omega, r)
    inertias, centres = [], []
    for mass, length, x in ((m1, l1, l1 / 2), (m2, l2, l1 + l2 / 2)):
        rod = mass * length**2 / 12
        inertias.append(np.diag([0, rod, rod, mass, mass, mass]))
        centre = np.eye(4)
        centre[0, 3] = x
        centres.append(centre)
    B = utils.adjoint_transform(utils.TransInv(M)) @ S
    return ManipulatorDynamics(M, omega, r, None, S, B, inertias, centres)


def test_two_rods_have_the_mass_matrix_of_the_book() -> None:
    l1, l2, m1, m2 = 1.0, 0.7, 2.0, 1.5
    arm, q = planar(l1, l2, m1, m2), np.array([0.4, -0.9])
    a = m1 * l1**2 / 3 + m2 * (l1**2 + l2**2 / 3 + l1 * l2 * math.cos(q[1]))
    b, c = m2 * (l2**2 / 3 + l1 * l2 / 2 * math.cos(q[1])), m2 * l2**2 / 3
    np.testing.assert_allclose(arm.mass_matrix(q), [[a, b], [b, c]], atol=1e-12)
    h = -m2 * l1 * l2 / 2 * math.sin(q[1])
    v = np.array([0.7, -1.2])
    coriolis = [h * (2 * v[0] * v[1] + v[1] ** 2), -h * v[0] ** 2]
    np.testing.assert_allclose(arm.velocity_quadratic_forces(q, v), coriolis, atol=1e-12)
    g1 = (m1 * l1 / 2 + m2 * l1) * 9.81 * math.cos(q[0]) + m2 * l2 / 2 * 9.81 * math.cos(q.sum())
    g2 = m2 * l2 / 2 * 9.81 * math.cos(q.sum())
    np.testing.assert_allclose(arm.gravity_forces(q, [0, -9.81, 0]), [g1, g2], atol=1e-12)
    assert arm.partial_derivative(0, 1, 1, q) == pytest.approx(-m2 * l1 * l2 / 2 * math.sin(q[1]), abs=1e-8)


def test_a_chain_of_screws_may_be_given_by_halves() -> None:
    whole = planar()
    half = SerialManipulator(whole.M_list, whole.omega_list, r_list=whole.r_list)
    other = SerialManipulator(whole.M_list, whole.omega_list, B_list=whole.B_list)
    for arm in (half, other):
        np.testing.assert_allclose(arm.jacobian([0.3, 0.2]), whole.jacobian([0.3, 0.2]), atol=1e-12)
    np.testing.assert_allclose(whole.forward_kinematics([0.5]), whole.forward_kinematics([0.5, 0.0]))
    assert whole.jacobian([]).shape == (6, 0)
    with pytest.raises(ValueError, match="frame"):
        whole.forward_kinematics([0, 0], frame="tool")  # type: ignore[arg-type]


def test_trajectories(xarm: URDFToSerialManipulator) -> None:
    planner = TrajectoryPlanning(
        xarm.serial_manipulator, xarm.urdf_name, xarm.dynamics, xarm.robot_data["joint_limits"], [(-30, 30)] * 6
    )
    start, end = np.zeros(6), np.array([0.5, 0.3, -0.2, 0.1, 0.4, 0.0])
    for method in (3, 5):
        found = planner.joint_trajectory(start, end, 2.0, 101, method)
        assert all(rows.shape == (101, 6) and rows.dtype == np.float32 for rows in found.values())
        np.testing.assert_allclose(found["positions"][[0, -1]], [start, end], atol=1e-6)
        np.testing.assert_allclose(found["velocities"][[0, -1]], 0, atol=1e-6)
        v = np.gradient(found["positions"].astype(float), 0.02, axis=0)
        np.testing.assert_allclose(found["velocities"][2:-2], v[2:-2], atol=2e-3)
        batch = planner.batch_joint_trajectory([start, end], [end, start], 2.0, 101, method)
        np.testing.assert_allclose(batch["positions"][0], found["positions"], atol=1e-6)
    assert planner.joint_trajectory(start, end, 1.0, 1, 3)["positions"].shape == (1, 6)
    held = planner.joint_trajectory(start, np.full(6, 9.0), 1.0, 50, 5)
    assert (held["positions"] <= np.array(planner.joint_limits)[:, 1] + 1e-6).all()
    assert (held["velocities"][-1] == 0).all() and (held["velocities"][45] == 0).all()
    with pytest.raises(ValueError, match="method"):
        planner.joint_trajectory(start, end, 1.0, 10, 4)
    rows = found["positions"], found["velocities"], found["accelerations"]
    tau = planner.inverse_dynamics_trajectory(*rows)
    assert tau.shape == (101, 6) and np.abs(tau).max() <= 30
    np.testing.assert_allclose(
        tau[50], xarm.dynamics.inverse_dynamics(rows[0][50], rows[1][50], rows[2][50], G), atol=1e-4
    )
    fallen = planner.forward_dynamics_trajectory(start, start, np.zeros((20, 6)), G, np.zeros((20, 6)), 0.01, 4)
    np.testing.assert_array_equal(fallen["positions"][0], 0)
    assert fallen["positions"].shape == (20, 6)


def test_a_straight_line_of_poses(xarm: URDFToSerialManipulator) -> None:
    planner = TrajectoryPlanning(xarm.serial_manipulator, "no such file", xarm.dynamics, [(-3, 3)] * 6)
    assert planner.collision_checker is None
    A, B = np.eye(4), np.eye(4)
    B[:3, :3], B[:3, 3] = utils.euler_to_rotation_matrix([0, 0, 90]), [1, 2, 3]
    found = planner.cartesian_trajectory(A, B, 2.0, 21, 5)
    np.testing.assert_allclose(found["positions"][10], [0.5, 1, 1.5], atol=1e-6)
    np.testing.assert_allclose(found["orientations"][10], utils.euler_to_rotation_matrix([0, 0, 45]), atol=1e-6)


def test_obstacles_push_a_path_aside(xarm: URDFToSerialManipulator) -> None:
    planner = TrajectoryPlanning(xarm.serial_manipulator, xarm.urdf_name, xarm.dynamics, [(-3, 3)] * 6)
    plain = np.array(planner.plan_trajectory([0.0] * 6, [1.0] * 6, []))
    np.testing.assert_allclose(plain, np.linspace([0.0] * 6, [1.0] * 6, 6))
    obstacle = np.array([[0.42, 0.38, 0.4, 0.4, 0.4, 0.4]])
    pushed = np.array(planner.plan_trajectory([0.0] * 6, [1.0] * 6, obstacle))
    assert np.linalg.norm(pushed[2] - obstacle) > np.linalg.norm(plain[2] - obstacle) + 0.05
    np.testing.assert_array_equal(pushed[[0, -1]], plain[[0, -1]])


def test_the_field_has_the_gradient_of_its_potentials() -> None:
    field, rng = PotentialField(), np.random.default_rng(2)
    goal, obstacles = rng.normal(size=3), rng.normal(size=(5, 3))
    for q in rng.normal(size=(20, 3)):
        q = obstacles[0] + 0.2 * q / np.linalg.norm(q)
        numeric = [
            (
                sum(
                    s * (field.compute_attractive_potential(x, goal) + field.compute_repulsive_potential(x, obstacles))
                    for s, x in ((1, q + step), (-1, q - step))
                )
            )
            / 2e-6
            for step in 1e-6 * np.eye(3)
        ]
        np.testing.assert_allclose(field.compute_gradient(q, goal, obstacles), numeric, rtol=1e-5, atol=1e-4)
    near = obstacles[0] + [0.1, 0, 0]
    assert field.compute_repulsive_potential(near, obstacles[:1]) == pytest.approx(20 * 100 * (1 / 0.1 - 1 / 0.5) ** 2)
    assert np.isfinite(field.compute_gradient(obstacles[0], goal, obstacles)).all()
    assert field.compute_gradient(goal, goal, []).tolist() == [0, 0, 0]


def test_a_folded_arm_touches_itself() -> None:
    checker = CollisionChecker(get_robot_urdf("panda"))
    assert checker.convex_hulls
    home = {f"panda_joint{k + 1}": x for k, x in enumerate([0, -0.5, 0, -2.2, 0, 1.8, 0.8])}
    assert not checker.check_collision(home)
    folded = {**home, "panda_joint2": 1.7, "panda_joint4": -3.07, "panda_joint6": 0.0}
    found = [checker.check_collision({**folded, "panda_joint6": x}) for x in np.linspace(0.0, 3.7, 20)]
    assert any(found) and all(isinstance(hit, bool) for hit in found)


def test_controllers_follow_their_formulas(xarm: URDFToSerialManipulator) -> None:
    control, rng = ManipulatorController(xarm.dynamics), np.random.default_rng(4)
    q_d, v_d, a_d, q, v = rng.normal(size=(5, 6))
    tau = control.computed_torque_control(q_d, v_d, a_d, q, v, G, 0.01, 100.0, 10.0, 20.0)
    wanted = a_d + 100 * (q_d - q) + 10 * 0.01 * (q_d - q) + 20 * (v_d - v)
    np.testing.assert_allclose(xarm.dynamics.forward_dynamics(q, v, tau, G, NONE), wanted, rtol=1e-9)
    control.reset()
    for _ in range(5):
        control.pid_control(q_d, v_d, q, v, 1.0, 1, 1, 1, i_clamp=0.5)
    assert control.eint is not None and np.abs(control.eint).max() <= 0.5
    with pytest.raises(ValueError, match="i_clamp"):
        control.pid_control(q_d, v_d, q, v, 1.0, 1, 1, 1, i_clamp=-1)
    T, h = xarm.forward_kinematics(q), 1e-6
    J = np.stack(
        [(xarm.forward_kinematics(q + h * e) - xarm.forward_kinematics(q - h * e))[:3, 3] / (2 * h) for e in np.eye(6)],
        1,
    )
    goal = T[:3, 3] + [0.1, 0, 0]
    tau = control.cartesian_space_control(goal, q, v, 50.0, np.diag([1.0, 2.0, 3.0]))
    np.testing.assert_allclose(tau, J.T @ ([5.0, 0, 0] - np.array([1.0, 2, 3]) * (J @ v)), atol=1e-6)
    assert control.ziegler_nichols_tuning(10, 2) == (6, 6, 1.5)
    with pytest.raises(ValueError, match="Tu"):
        control.ziegler_nichols_tuning(10, 0, "PI")


def test_the_kalman_filter_couples_angles_and_velocities(xarm: URDFToSerialManipulator) -> None:
    control, noise = ManipulatorController(xarm.dynamics), 1e-4 * np.eye(12)
    with pytest.raises(ValueError, match="predict"):
        control.kalman_filter_update(np.zeros(12), noise)
    q, v, tau = np.zeros(6), np.full(6, 0.5), xarm.dynamics.gravity_forces(np.zeros(6))
    angle, rate = control.kalman_filter_control(q, v, q, v, tau, G, NONE, 0.01, noise, noise)
    assert angle.shape == rate.shape == (6,) and control.P is not None
    assert np.abs(control.P[:6, 6:]).max() > 0
    with pytest.raises(ValueError, match=r"Q has shape"):
        control.kalman_filter_predict(q, v, tau, G, NONE, 0.01, np.eye(3))


def test_step_responses(xarm: URDFToSerialManipulator) -> None:
    control, t = ManipulatorController(xarm.dynamics), np.linspace(0, 10, 1001)
    x = 2 * (1 - np.exp(-t))
    assert control.calculate_rise_time(t, x, 2) == pytest.approx(math.log(9), abs=0.02)
    assert control.calculate_settling_time(t, x, 2) == pytest.approx(math.log(50), abs=0.02)
    assert (
        control.calculate_percent_overshoot([0, 2.5, 2], 2) == 25 and control.calculate_percent_overshoot([1], 0) == 0
    )
    assert control.calculate_steady_state_error(x, 2) == pytest.approx(0, abs=1e-3)
    assert math.isinf(control.calculate_rise_time(t, 0 * t, 2))


def test_singular_postures() -> None:
    judge = Singularity(URDFToSerialManipulator(get_robot_urdf("ur5")).serial_manipulator)
    bent, stretched = np.array([0.3, -0.9, 1.1, 0.2, 0.8, 0.1]), np.array([0.3, -0.9, 1.1, 0.2, 0.0, 0.1])
    assert not judge.singularity_analysis(bent) and judge.singularity_analysis(stretched)
    assert judge.condition_number(bent) < 100 and judge.condition_number(stretched) > 1e10
    assert not judge.near_singularity_detection(bent) and judge.near_singularity_detection(stretched)
    assert not judge.near_singularity_detection(bent, 100)


def test_logarithms_undo_exponentials_everywhere() -> None:
    rng = np.random.default_rng(5)
    for angle in (0.0, 1e-12, 1e-6, 1.0, math.pi - 1e-9, math.pi):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        R = utils.MatrixExp3(utils.VecToso3(angle * axis))
        np.testing.assert_allclose(utils.MatrixExp3(utils.MatrixLog3(R)), R, atol=1e-9)
        T = utils.MatrixExp6(utils.VecTose3(np.concatenate([angle * axis, rng.normal(size=3)])))
        np.testing.assert_allclose(utils.MatrixExp6(utils.MatrixLog6(T)), T, atol=1e-9)
        assert utils.rotation_logm(R)[1] == pytest.approx(angle, abs=1e-6)
    rpy = np.array([0.3, -0.4, 2.0])
    np.testing.assert_allclose(
        utils.rotation_matrix_to_euler_angles(utils.euler_to_rotation_matrix(np.degrees(rpy))), rpy, atol=1e-12
    )
    with pytest.raises(ValueError, match="shape"):
        utils.MatrixExp6(np.eye(3))


def test_descriptions(arm: URDFToSerialManipulator) -> None:
    assert arm.print_joint_info()["num_joints"] == len(arm.robot.joints)
    assert arm.validate()["valid"] and arm.end_effector_name in arm.link_names
    batch = arm.batch_forward_kinematics(np.zeros((3, arm.robot.num_dofs)), arm.end_effector_name)
    np.testing.assert_allclose(batch[1], arm.robot_data["M"], atol=1e-12)
    with pytest.raises(ValueError, match="no link"):
        arm.batch_forward_kinematics(np.zeros((3, arm.robot.num_dofs)), "none")
    other = URDF.load(arm.urdf_name).to_manipulator_dynamics(arm.tip_link)
    q = np.full(arm.num_dofs, 0.3)
    np.testing.assert_allclose(other.mass_matrix(q), arm.dynamics.mass_matrix(q), atol=1e-12)
    with pytest.raises(FileNotFoundError):
        URDF.load("none.urdf")
    with pytest.raises(ValueError, match="backend"):
        URDF.load(arm.urdf_name, backend="other")


def test_robots_by_name() -> None:
    assert get_robot_urdf("Franka-Panda") == get_robot_urdf("panda") and "xarm6" in list_robots()
    with pytest.raises(ValueError, match="there are"):
        get_robot_urdf("no such robot")


def test_an_arm_may_be_given_by_its_functions(xarm: URDFToSerialManipulator) -> None:
    robot, goal = xarm.serial_manipulator, np.array([0.3, -0.4, -0.9, 0.2, 0.8, 0.1])
    T = robot.forward_kinematics(goal)
    solver = TracIKSolver(robot.forward_kinematics, robot.jacobian, robot.joint_limits, 6)
    for theta, success, seconds in (solver.solve(T, goal + 0.1, timeout=2.0), trac_ik_solve(robot, T, timeout=2.0)):
        assert success and seconds > 0
        np.testing.assert_allclose(robot.forward_kinematics(theta), T, atol=2e-4)
    assert TracIKSolver(robot.forward_kinematics, robot.jacobian, [(None, 1.0)] * 6, 6).bounds[0] == (-2 * math.pi, 1)
    with pytest.raises(ValueError, match="space Jacobian"):
        TracIKSolver(robot.forward_kinematics, lambda q: robot.jacobian(q, "body"), robot.joint_limits, 6).solve(T)
    with pytest.raises(ValueError, match="n_joints"):
        TracIKSolver(robot.forward_kinematics, robot.jacobian, robot.joint_limits, 7)
    with pytest.raises(NotImplementedError, match="error_func"):
        TracIKSolver(robot.forward_kinematics, robot.jacobian, robot.joint_limits, 6, lambda *_: None).solve(T)


def test_many_starts_that_all_fail_give_the_first() -> None:
    tried: list[str] = []

    def solver(T: Array, strategy: str, **options: float) -> tuple[Array, bool, int]:
        tried.append(strategy)
        return np.full(2, float(len(tried))), False, 3

    theta, success, iterations, strategy = adaptive_multi_start_ik(solver, np.eye(4), max_attempts=4)
    assert tried == ["workspace_heuristic", "midpoint", "random", "random"]
    assert theta.tolist() == [1.0, 1.0] and not success and iterations == 12 and strategy == "none (failed)"


def test_a_camera_of_the_programs_own_may_see_nothing() -> None:
    class Blind:
        def capture_image(self, camera_index: int) -> tuple[Array, Array]:
            return np.zeros((4, 4, 3)), np.ones((4, 4))

        def detect_obstacles(self, *arguments: object, **options: object) -> tuple[None, None]:
            return None, None

    points, labels = Perception(Blind()).detect_and_cluster_obstacles()  # type: ignore[arg-type]
    assert points.shape == (0, 3) and labels.shape == (0,)


def test_guesses_above_the_base_point_ahead() -> None:
    above, aside = np.eye(4), np.eye(4)
    above[2, 3], aside[0, 3], aside[2, 3] = 1.0, 1.0, 1.0
    limits = [(-math.pi, math.pi)] * 6
    assert workspace_heuristic_guess(above, 6, limits)[1] == 0.0
    assert workspace_heuristic_guess(aside, 6, limits)[1] == pytest.approx(math.pi / 4)


def test_screws_from_rows_of_numbers() -> None:
    omega, r = [0.0, 0.0, 1.0, 0.0, 1.0, 0.0], [0.1, 0.2, 0.0, 0.3, 0.0, 0.4]
    S = utils.extract_screw_list(omega, r)
    np.testing.assert_allclose(S.T, [[0, 0, 1, 0.2, -0.1, 0], [0, 1, 0, -0.4, 0, 0.3]], atol=1e-15)
    through_origin = [[0, 0, 1, 0, 0, 0], [0, 1, 0, 0, 0, 0]]
    for nowhere in (None, []):
        np.testing.assert_array_equal(utils.extract_screw_list(omega, nowhere).T, through_origin)
    assert utils.extract_screw_list(None, None) is None
    with pytest.raises(ValueError, match="omega_list"):
        utils.extract_screw_list([1.0, 2.0], r)


def test_singularity_answers_in_numpy_types(xarm: URDFToSerialManipulator) -> None:
    singularity = Singularity(xarm.serial_manipulator)
    q = np.array([0.3, -0.4, -0.9, 0.2, 0.8, 0.1])
    assert isinstance(singularity.condition_number(q), np.float64)
    assert isinstance(singularity.near_singularity_detection(q), np.bool_)
    assert isinstance(singularity.near_singularity_detection(q, 100.0), np.bool_)
