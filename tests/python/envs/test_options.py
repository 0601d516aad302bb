"""Other robots, other controls and obstacles: through gymnasium.make and make_vec."""

import copy
import math
import pickle
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import manyhands as mh
from manyhands.envs import ArmSpec, Expert, Obstacle

CONTROLS = {"ee": 3, "joints": 7, "ee_pose": 6, "joint_velocity": 7, "joint_torque": 7, "impedance": 6}
ARM6 = ArmSpec(
    urdf=mh.asset_path("arm6/arm6.urdf"),
    joints=[f"arm6_joint{i}" for i in range(1, 7)],
    fingers=["arm6_finger_joint1", "arm6_finger_joint2"],
    hand="arm6_grasptarget",
    neutral=[-0.209817, -1.198085, 1.524398, -1.89711, -1.570796, -0.209817, 0, 0],
    max_force=[150, 150, 150, 28, 28, 28, 235, 235],
)
WALL = Obstacle("box", [0.01, 0.2, 0.2], position=[0.16, 0, 0.2])


def rollout(env: Any, steps: int = 20) -> list[Any]:
    env.action_space.seed(0)
    return [env.reset(seed=3), *(env.step(env.action_space.sample()) for _ in range(steps))]


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("robot", ["panda", "arm6"])
def test_every_control_passes_gymnasiums_checks(robot: str, control: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make("PandaPickAndPlace-v3", robot=robot, control_type=control)
        check_env(env.unwrapped)
    size = CONTROLS[control] - (robot == "arm6" and CONTROLS[control] == 7) + 1
    assert env.action_space == gymnasium.spaces.Box(-1, 1, (size,), np.float32)


@pytest.mark.parametrize("control", CONTROLS)
def test_one_world_is_any_of_many(control: str) -> None:
    options: dict[str, Any] = {"robot": "arm6", "control_type": control, "obstacles": [WALL]}
    one = gymnasium.make("PandaPush-v3", **options)
    many = gymnasium.make_vec("PandaPush-v3", num_envs=5, num_threads=2, **options)
    observation, _ = many.reset(seed=10)
    alone, _ = one.reset(seed=12)
    many.action_space.seed(1)
    for _ in range(20):
        np.testing.assert_equal(alone["observation"], observation["observation"][2])
        actions = many.action_space.sample()
        observation, *_ = many.step(actions)
        alone, *_ = one.step(actions[2])


@pytest.mark.parametrize("task", ["Reach", "Push", "Slide", "PickAndPlace", "Stack", "Flip"])
def test_every_task_has_the_second_robot(task: str) -> None:
    env = gymnasium.make(f"Panda{task}-v3", robot="arm6")
    observation, _ = env.reset(seed=0)
    np.testing.assert_allclose(observation["observation"][:3], [0.04, 0, 0.2], atol=1e-4)
    expert = Expert(f"Panda{task}-v3")
    for _ in range(10):
        observation, *_ = env.step(expert(observation))
    assert np.isfinite(observation["observation"]).all()


def test_an_arm_spec_of_ones_own_is_the_robot_it_describes() -> None:
    def make(robot: str | ArmSpec) -> Any:
        return gymnasium.make("PandaPickAndPlace-v3", robot=robot, control_type="joints").unwrapped

    ours, shipped = rollout(make(ARM6)), rollout(make("arm6"))
    np.testing.assert_equal(ours, shipped)
    env = make(ARM6)
    for other in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        np.testing.assert_equal(rollout(other), shipped)


@pytest.mark.parametrize("gripper", ["two_finger", "parallel", "three_finger"])
@pytest.mark.parametrize("arm", ["six_axis", "six_axis_compact", "six_axis_slim", "seven_axis"])
def test_any_arm_with_any_gripper_picks_and_places(arm: str, gripper: str) -> None:
    """By the Panda's expert, which knows neither; three fingers shift a cube as they close."""
    envs = gymnasium.make_vec("PandaPickAndPlace-v3", num_envs=100, robot=f"{arm}+{gripper}")
    expert = Expert("PandaPickAndPlace-v3")
    observation, _ = envs.reset(seed=500)
    np.testing.assert_allclose(observation["observation"][:, :3], np.tile([0.04, 0, 0.2], (100, 1)), atol=1e-4)
    solved, over = np.zeros(100, bool), np.zeros(100, bool)
    for _ in range(50):
        observation, _, terminated, truncated, _ = envs.step(expert(observation))
        solved |= terminated & ~over
        over |= terminated | truncated
    assert solved.sum() >= (90 if gripper == "three_finger" else 98)


def test_a_suction_cup_pushes_but_cannot_grasp() -> None:
    observation, _ = gymnasium.make("PandaPush-v3", robot="six_axis+vacuum").reset(seed=0)
    np.testing.assert_allclose(observation["observation"][:3], [0.04, 0, 0.2], atol=1e-4)
    with pytest.raises(ValueError, match="the task needs a gripper, but the arm has no fingers"):
        gymnasium.make("PandaPickAndPlace-v3", robot="six_axis+vacuum")


@pytest.mark.parametrize(
    ("arm", "where"),
    [
        ("gantry", {"position": (-0.12, 0, 0)}),
        ("scara", {"position": (-0.4, 0, 0.1), "start": (0, 0, 0.15)}),
        ("desktop", {"position": (-0.18, 0, 0), "start": (0, 0, 0.1)}),
    ],
)
def test_arms_of_other_kinds_stand_where_they_are_put(arm: str, where: dict[str, Any]) -> None:
    spec = ArmSpec.of(arm, None if arm == "desktop" else "two_finger", **where)
    env = gymnasium.make("PandaPickAndPlace-v3", robot=spec)
    observation, _ = env.reset(seed=0)
    np.testing.assert_allclose(observation["observation"][:3], where.get("start", (0.04, 0, 0.2)), atol=1e-4)
    np.testing.assert_allclose(observation["observation"][6], 0, atol=1e-3)
    open_wide = np.array([0, 0, 0, 1], np.float32)
    for _ in range(5):
        observation, *_ = env.step(open_wide)
    widest = 0.085 if arm != "desktop" else 0.05
    assert observation["observation"][6] > 0.98 * widest


def test_a_gripper_goes_on_a_model_of_any_arm() -> None:
    ur5e, _ = mh.load_urdf(mh.asset_path("bullet/universal/ur5e.urdf"))  # its base hangs on a link called "world"
    spec = ArmSpec.of(ur5e, "two_finger", flange="tool0", posture=[0, -1.2, 1.5, -1.9, -1.6, 0])
    env = gymnasium.make("PandaPickAndPlace-v3", robot=spec)
    expert = Expert("PandaPickAndPlace-v3")
    solved = 0
    for seed in range(10):
        observation, _ = env.reset(seed=seed)
        np.testing.assert_allclose(observation["observation"][:3], [0.04, 0, 0.2], atol=1e-4)
        for _ in range(50):
            observation, _, terminated, truncated, _ = env.step(expert(observation))
            if terminated or truncated:
                break
        solved += terminated
    assert solved == 10
    with pytest.raises(ValueError, match="no link or frame 'nowhere'"):
        ArmSpec.of(ur5e, "two_finger", flange="nowhere")
    with pytest.raises(ValueError, match="''"):
        ArmSpec.of(ur5e, "two_finger")
    with pytest.raises(ValueError, match="posture has 2 numbers; expected one for each of shoulder_pan_joint"):
        ArmSpec.of(ur5e, "two_finger", flange="tool0", posture=[0, 1])


def test_a_gripper_whose_fingers_turn_has_the_same_bits_in_one_world_and_in_many() -> None:
    spec = ArmSpec.of("six_axis", "two_finger")
    one = gymnasium.make("PandaPickAndPlace-v3", robot="six_axis + two_finger", obstacles=[WALL])
    many = gymnasium.make_vec("PandaPickAndPlace-v3", num_envs=5, num_threads=2, robot=spec, obstacles=[WALL])
    observation, _ = many.reset(seed=10)
    alone, _ = one.reset(seed=12)
    many.action_space.seed(1)
    for _ in range(20):
        np.testing.assert_equal(alone["observation"], observation["observation"][2])
        actions = many.action_space.sample()
        observation, *_ = many.step(actions)
        alone, *_ = one.step(actions[2])


def test_an_arm_from_a_model_is_copied_and_pickled() -> None:
    def env() -> Any:
        return gymnasium.make("PandaPickAndPlace-v3", robot=ArmSpec.of("seven_axis", "parallel")).unwrapped

    expected = rollout(env())
    for other in (copy.deepcopy(env()), pickle.loads(pickle.dumps(env()))):
        np.testing.assert_equal(rollout(other), expected)


def test_an_arm_stands_where_it_is_put() -> None:
    turned = ArmSpec(**{**vars(ARM6), "position": [0.6, 0, 0.1], "quaternion": [0, 0, 1, 0]})
    observation, _ = gymnasium.make("PandaReach-v3", robot=turned).reset(seed=0)
    np.testing.assert_allclose(observation["observation"][:3], [-0.04, 0, 0.3], atol=1e-4)


def test_obstacles_stop_the_hand() -> None:
    def end(**options: Any) -> float:
        env = gymnasium.make("PandaReach-v3", **options).unwrapped
        env.reset(seed=0)
        for _ in range(40):
            observation, *_ = env.step(np.array([0.4, 0, 0]))
        return float(observation["observation"][0])

    assert end() > 0.18
    assert 0.08 < end(obstacles=[WALL]) < 0.15


def test_a_stiffer_hand_lags_less() -> None:
    def lag(stiffness: float) -> float:
        env = gymnasium.make("PandaReach-v3", control_type="impedance", stiffness=(stiffness, 50)).unwrapped
        start = env.reset(seed=0)[0]["observation"][0]
        observation, *_ = env.step(np.array([1.0, 0, 0, 0, 0, 0]))
        return float(0.05 - (observation["observation"][0] - start))

    assert lag(4000) < lag(1000) < lag(200)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"robot": "pandaa"}, "robot is 'pandaa', expected 'panda', 'arm6' or an ArmSpec"),
        ({"robot": "six_axis+five_finger"}, "there is no gripper 'five_finger'"),
        ({"robot": "desktop"}, "desktop stands at x = -0.6 m, or nearer"),
        ({"robot": ArmSpec(**{**vars(ARM6), "hand": "palm"})}, "'palm'"),
        ({"robot": ArmSpec(**{**vars(ARM6), "neutral": [0] * 7})}, "has 7 numbers in neutral"),
        ({"robot": ArmSpec(**{**vars(ARM6), "quaternion": [0, 0, 0, 2]})}, "length 1"),
        ({"control_type": "magic"}, "control_type is 'magic', expected one of"),
        ({"obstacles": [WALL, Obstacle("sphere", 0.1, position=[0, 0, 0.3])]}, "obstacle 1 touches the arm's link"),
        ({"control_type": "impedance", "damping": (-1, 0)}, "impedance holds -1"),
    ],
)
def test_what_cannot_be_is_refused(options: dict[str, Any], message: str) -> None:
    for make in (gymnasium.make, gymnasium.make_vec):
        with pytest.raises(ValueError, match=message):
            make("PandaPush-v3", **options)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"foo": 3}, "no option 'foo' .*there are .*n_substeps, .*cameras"),
        ({"render": True}, "no option 'render' .*render_mode"),
        ({"n_substeps": 1.5}, "n_substeps is 1.5, expected a whole number"),
        ({"n_substeps": 2**40}, "n_substeps is"),
        ({"time_step": "2 ms"}, "time_step is '2 ms', expected a number"),
        ({"terminate_on_success": 1}, "terminate_on_success is 1, expected True or False"),
        ({"object_shape": None}, "object_shape is None, expected 'box'"),
        ({"stiffness": 400}, "stiffness is 400, expected two numbers"),
        ({"damping": (1, 2, 3)}, "damping is"),
        ({"randomize": {1: 2}}, "randomize: 1 is no name"),
        ({"render_width": 1.5}, "render_width is 1.5"),
        ({"render_target_position": [[1], [2, 3]]}, "render_target_position is"),
        ({"cameras": ["front"]}, r"cameras is \['front'\], expected a dict"),
        ({"cameras": "front"}, "cameras is 'front', expected a dict"),
        ({"robot": 3}, "robot is 3, expected 'panda', 'arm6' or an ArmSpec"),
        ({"robot": mh.asset_path("arm6/arm6.urdf")}, r"ArmSpec\(urdf="),
        ({"robot": str(mh.asset_path("arm6/arm6.urdf"))}, r"ArmSpec\(urdf="),
        ({"robot": ArmSpec(**{**vars(ARM6), "hand": 3})}, "ArmSpec: hand is 3; expected str"),
        ({"obstacles": [{"shape": "box"}]}, r"obstacles\[0\] is {'shape': 'box'}, expected a manyhands.envs.Obstacle"),
        ({"obstacles": WALL}, "expected a list of manyhands.envs.Obstacle"),
    ],
)
def test_options_of_another_type_are_refused_by_name(options: dict[str, Any], message: str) -> None:
    for make in (gymnasium.make, gymnasium.make_vec):
        with pytest.raises(TypeError, match=message):
            make("PandaPush-v3", **options)


@pytest.mark.parametrize(
    ("what", "error", "message"),
    [
        (("cone", 0.1), ValueError, "no shape 'cone'; there are 'box' 'sphere' 'cylinder' 'capsule'"),
        (("plane", []), ValueError, "no shape 'plane'; there are 'box'"),
        (("box", [1]), ValueError, "size of 3 numbers, not 1"),
        (("box", [-1, 1, 1]), ValueError, "a size is -1.0* m; expected a finite number above 0"),
        (("sphere", 0.1, [math.nan, 0, 0]), ValueError, "pose must be finite"),
        (("sphere", 0.1, [0, 0]), ValueError, "Obstacle: position has 2 numbers; expected 3"),
        (("sphere", 0.1, [0, 0, 1], [0, 0, 0, 2]), ValueError, "length 1"),
        (("sphere", 0.1, [0, 0, 1], [0, 0, 0, 1], -1), ValueError, "frictions"),
        (("box", "big"), TypeError, "Obstacle: size is 'big'; expected float"),
    ],
)
def test_an_obstacle_that_cannot_be_is_refused_at_once(
    what: tuple[Any, ...], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        Obstacle(*what)


def test_none_is_the_panda_and_no_obstacle() -> None:
    given = gymnasium.make("PandaPush-v3", robot=None, obstacles=None, cameras=None)
    np.testing.assert_equal(rollout(given.unwrapped), rollout(gymnasium.make("PandaPush-v3").unwrapped))


def test_numbers_may_be_numpys() -> None:
    numpys: dict[str, Any] = {"n_substeps": np.int64(10), "time_step": np.float64(0.004), "stiffness": np.ones(2)}
    ours = {"n_substeps": 10, "time_step": 0.004, "stiffness": (1, 1)}
    made = [gymnasium.make("PandaReach-v3", **options).unwrapped for options in (numpys, ours)]
    np.testing.assert_equal(rollout(made[0]), rollout(made[1]))
