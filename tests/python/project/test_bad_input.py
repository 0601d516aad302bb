"""Every argument of kinematics, control, planning, robots, perception and vision, with what it cannot be: the error
names it, in this project's words."""

import inspect
import re
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

import manyhands as mh
from manyhands import control, perception, planning, robots, vision
from manyhands import kinematics as kin

online = pytest.importorskip("manyhands.planning.online")
replanning = pytest.importorskip("manyhands.planning.replanning")
pytest.importorskip("cv2")

WRONG: dict[str, Any] = {
    "none": None,
    "text": "?",
    "object": object(),
    "dict": {"?": 1},
    "complex": 1j,
    "ragged": [[1, 2], [3]],
    "nan": np.nan,
    "empty": [],
    "shape": np.zeros((2, 3, 5)),
    "nans": np.full(7, np.nan),
}
FOREIGN = re.compile(
    r"has no attribute|not supported|ambiguous|not iterable|not callable|convert|broadcast together|unhashable"
    r"|inhomogeneous|ONNXRuntime|OpenCV|inp\.|loop with signature|arg\d|float\(\) argument|int\(\) argument"
)
FREE = ("shorten", "upright", "fixed_base", "inverse", "respect_limits")  # true or false, of anything
OTHER_NAMES = {
    "cup": "name",
    "hand": "name",
    "frame": "name",
    "pose": "position",
    "x": "F",
}  # by which some are told, too


class Case(NamedTuple):
    call: Callable[..., Any]
    given: dict[str, Any]


def cases() -> dict[str, Case]:
    panda, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)
    six = robots.load("six_axis")
    q, v = np.array([0.0, -0.5, 0.0, -2.2, 0.0, 1.8, 0.8, 0.02, 0.02]), np.zeros(9)
    place = kin.forward(panda, q, "panda_grasptarget")
    posed = {"model": panda, "frame": "panda_grasptarget", "position": place[0], "quaternion": place[1]}
    far = kin.forward(six, np.full(6, 0.3), "flange")
    world = mh.World(panda)
    world.q = q
    world.add_box("cube", (0.02, 0.02, 0.02), position=(0.5, 0.3, 0.14))
    planner = planning.Planner(world, "panda_grasptarget")
    plan = planner.plan(q[:7] + 0.1)
    motion = plan.trajectory(acceleration=5.0)
    lone = mh.World(six)
    arm = robots.Arm(lone, "flange")
    state = {"model": panda, "q": q, "v": v}
    wanted = {"q_desired": q, "v_desired": v, "a_desired": v}
    cloud = np.random.default_rng(0).uniform(1, 2, (30, 3))
    limits = {"velocity": 1.0, "acceleration": 2.0, "jerk": 10.0}
    points = np.array([[0.0, 0], [1, 1], [2, 0]])
    one, unit = np.eye(2), np.tile([0.0, 0, 0, 1], (2, 1))
    camera = mh.Camera.perspective(64, 48, 1.0)
    left, right = (camera.look_at([x, 0, 1.0], [x, 0, 0.0], up=[0, 1, 0]) for x in (0.0, 0.1))
    rig, board = vision.StereoRig(left, right, disparities=16), vision.Chessboard()
    picture = np.zeros((48, 64, 3), np.uint8)
    kalman = control.KalmanFilter(one, [[1.0, 0]], one, [[1.0]], x=[0.0, 0])
    pid = control.Pid(1.0, dt=0.01)
    calls: list[tuple[Callable[..., Any], dict[str, Any]]] = [
        (kin.forward, {"model": panda, "q": q, "frame": "panda_hand"}),
        (kin.jacobian, {"model": panda, "q": q, "frame": "panda_hand", "form": "mixed"}),
        (kin.jacobian_derivative, {**state, "frame": "panda_hand", "form": "mixed"}),
        (kin.is_singular, {"model": panda, "q": q, "frame": "panda_hand", "part": "all", "tolerance": 1e-3}),
        (kin.screw_axes, {"model": panda, "frame": "panda_hand", "q0": q, "form": "space"}),
        (kin.screw_coordinates, {"model": panda, "q": q, "q0": q}),
        (kin.product_of_exponentials, {"screws": kin.screw_axes(panda, "panda_hand"), "theta": v}),
        (kin.workspace, {"model": panda, "frame": "panda_hand", "samples": 5, "seed": 0}),
        (kin.inverse, {**posed, "posture": q, "start": q, "restarts": 2, "avoid": None, "position_weight": 1.0}),
        (kin.inverse_kinematics, {**posed, "start": q, "restarts": 2, "seed": 0, "position_tolerance": 1e-5}),
        (kin.inverse_all, {"model": six, "frame": "flange", "position": far[0], "quaternion": far[1]}),
        (kin.matrix, {"position": place[0], "quaternion": place[1]}),
        (kin.pose, {"T": np.eye(4)}),
        (kin.exp6, {"twist": np.ones(6)}),
        (control.pd_gravity, {**state, "q_desired": q, "kp": 1.0, "kd": 1.0}),
        (control.computed_torque, {**state, **wanted, "kp": 1.0, "kd": 1.0, "ki": 0.0, "integral": v}),
        (control.sliding_mode, {**state, **wanted, "slope": 1.0, "kd": 1.0, "robust": 1.0, "boundary": 0.1}),
        (control.Adaptive, {"model": panda, "slope": 1.0, "kd": 1.0, "rate": 0.1, "dt": 0.01, "inertia": None}),
        (control.Pid, {"kp": 1.0, "ki": 0.0, "kd": 0.0, "dt": 0.01, "max_force": 1.0, "max_integral": 1.0}),
        (pid.force, {"error": [1.0, 2], "rate": [0.0, 0]}),
        (control.limited, {"force": [1.0, 2], "most": [1.0, 1]}),
        (control.rate_limited, {"force": [1.0, 2], "last": [0.0, 0], "most_rate": [1.0, 1], "dt": 0.01}),
        (control.impedance, {**state, **posed, "stiffness": 1.0, "rotational_damping": 1.0}),
        (control.operational_space, {**state, **posed, "directions": ["motion"] * 6, "kp": 1.0, "force": np.ones(6)}),
        (control.Admittance, {"dt": 0.01, "mass": 1.0, "damping": 1.0, "inertia": 1.0}),
        (control.KalmanFilter, {"F": one, "H": [[1.0, 0]], "Q": one, "R": [[1.0]], "x": [0.0, 0], "P": one}),
        (control.KalmanFilter.of_joints, {"q": [0.0], "dt": 0.01, "acceleration_noise": 1.0, "position_noise": 1.0}),
        (kalman.update, {"z": [0.0]}),
        (kalman.predict, {"push": [0.0, 0]}),
        (control.step_response, {"time": [0, 1.0], "response": [0, 1.0], "set_point": 1.0, "start": 0.0}),
        (control.stability_margins, {"numerator": [1.0], "denominator": [1.0, 1], "delay": 0.0}),
        (control.ziegler_nichols, {"ultimate_gain": 1.0, "ultimate_period": 1.0, "kind": "PID"}),
        (planning.cubic, {"times": [0, 1, 2], "waypoints": points, "velocity": np.zeros((3, 2))}),
        (planning.spline, {"times": [0, 1, 2], "waypoints": points, "degree": 1}),
        (planning.trapezoid, {"waypoints": points, "velocity": 1.0, "acceleration": 1.0}),
        (planning.cartesian, {"position": np.zeros((2, 3)), "quaternion": unit, "law": [0, 1], "path": "straight"}),
        (planning.joined, {"motions": [motion, motion]}),
        (motion.part, {"start": 0.0, "end": 0.1}),
        (motion.sample, {"t": 0.1}),
        (planning.time_optimal, {"path": motion, "velocity": 1.0, "intervals": 20, "start_speed": 0.0}),
        (planning.Planner, {"scene": world, "frame": "panda_hand", "attached": {}, "allowed": [], "margin": 0.0}),
        (planning.Planner, {"scene": panda, "joints": ["panda_joint1"], "q": q, "cloud": cloud, "cloud_radius": 0.01}),
        (planner.is_free, {"planned": q[:7]}),
        (planner.least_distance, {"waypoints": [q[:7]], "step": 0.01}),
        (planner.free_until, {"motion": motion, "start": 0.0, "keep": ()}),
        (planner.with_cloud, {"points": cloud, "radius": 0.01}),
        (planner.plan, {"goal": q[:7], "start": q[:7], "keep": (), "time_limit": 0.1, "seed": 0, "blend": 0.5}),
        (plan.trajectory, {"acceleration": 5.0, "velocity": 1.0, "intervals": 20}),
        (planning.AxisConstraint, {"frame": "cube", "axis": (0, 0, 1), "within": 0.1, "direction": (0, 0, 1)}),
        (planning.PositionConstraint, {"frame": "cube", "lower": (0, 0, 0), "upper": (1, 1, 1), "position": (0, 0, 0)}),
        (planning.ParallelGripper, {"opening": 0.08, "depth": 0.05, "palm": (0.1, 0.1, 0.1)}),
        (planning.grasps, {"shape": mh.collision.Box([0.02] * 3), "gripper": None, "com": (0, 0, 0)}),
        (planning.grasps_in, {"scene": world, "link": "cube", "gripper": None, "obstacles": ()}),
        (online.jerk_limited, {"start": [0.0], "goal": [1.0], **limits, "goal_velocity": [0.0]}),
        (online.Follower, {"start": [0.0], "dt": 0.01, **limits}),
        (replanning.replan, {"planner": planner, "motion": motion, "now": 0.1, "goal": q[:7], "keep": (),
                             "acceleration": 5.0, "jerk": 100.0, "time_limit": 0.05}),
        (robots.load, {"name": "six_axis", "gripper": None}),
        (robots.split, {"text": "six_axis"}),
        (robots.Arm, {"world": lone, "hand": "flange"}),
        (arm.go_to, {"pose": arm.pose, "seconds": 0.01, "on_step": None}),
        (robots.Vacuum, {"world": lone, "cup": "flange"}),
        (robots.Vacuum(lone, "flange").on, {"reach": 0.003}),
        (perception.dbscan, {"points": cloud, "reach": 0.1, "min_samples": 3}),
        (perception.find_plane, {"points": cloud, "threshold": 0.1, "iterations": 9, "seed": 0, "least_share": 0.1}),
        (perception.nearest, {"points": cloud, "queries": cloud}),
        (perception.by_colour, {"rgb": picture, "colour": (1, 0, 0), "tolerance": 0.1}),
        (vision.Chessboard, {"columns": 9, "rows": 6, "side": 0.03}),
        (board.find, {"picture": picture}),
        (vision.things, {"segmentation": np.zeros((4, 4), int)}),
        (vision.Lens, {"size": (64, 48), "K": rig.left.K, "X": np.eye(4), "distortion": np.zeros(5)}),
        (vision.Lens.of, {"camera": left}),
        (vision.StereoRig, {"left": left, "right": right, "disparities": 16, "block": 5}),
        (rig.rectify, {"left": picture, "right": picture}),
        (rig.points, {"disparity": np.ones((48, 64))}),
    ]  # fmt: skip
    return {f"{i} {call.__name__}": Case(call, given) for i, (call, given) in enumerate(calls)}


CASES = cases()


@pytest.mark.parametrize("name", CASES)
def test_what_an_argument_cannot_be_is_told_by_its_name(name: str) -> None:
    call, given = CASES[name]
    parameters = inspect.signature(call).parameters
    for argument in given.keys() - set(FREE):
        default = parameters[argument].default if argument in parameters else None
        told = rf"\b({argument}|{OTHER_NAMES.get(argument, argument)})\b|'\?'"
        for kind, value in WRONG.items():
            if (
                value is default
                or (kind == "none" and default is None)
                or (kind == "empty" and is_list(given[argument]))
            ):
                continue
            text = error_of(call, given | {argument: value})
            if text is None:
                assert kind in ("nan", "empty", "shape", "nans", "text"), f"{argument}={kind} is taken in silence"
                continue
            assert not FOREIGN.search(text), f"{argument}={kind}: {text}"
            assert re.search(told, text), f"{argument}={kind} is not named: {text}"


def is_list(value: Any) -> bool:
    return isinstance(value, list | tuple | dict | np.ndarray)


def error_of(call: Callable[..., Any], arguments: dict[str, Any]) -> str | None:
    try:
        call(**arguments)
    except (TypeError, ValueError, KeyError) as error:
        return str(error)
    return None
