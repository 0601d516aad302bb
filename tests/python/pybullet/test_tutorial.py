"""The code blocks of a PyBullet tutorial as people type them, with only `import pybullet` resolved to this module.

What the page leaves to the reader (a loop's functions, a robot that was loaded before) stands before its block. Waiting
in real time is taken out, and long loops end early.
"""

import sys
import time
import types
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import manyhands.pybullet

pybullet_data = pytest.importorskip("pybullet_data")


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, Any]]:
    """The names that one block leaves to the next."""
    monkeypatch.setitem(sys.modules, "pybullet", manyhands.pybullet)
    monkeypatch.setattr(time, "sleep", lambda seconds: None)
    yield {"__name__": "tutorial"}
    for client in range(8):
        if manyhands.pybullet.isConnected(client):
            manyhands.pybullet.disconnect(client)


def run(page: dict[str, Any], *blocks: str) -> None:
    for block in blocks:
        exec(compile(block, "tutorial", "exec"), page)


IMPORTS = """
import time
import pybullet as p
import pybullet_data
"""

FIRST_SCENE = """
physics_client = p.connect(p.GUI)
p.setAdditionalSearchPath(
    pybullet_data.getDataPath()
)
p.setGravity(0, 0, -9.81)
plane_id = p.loadURDF("plane.urdf")
robot_id = p.loadURDF(
    "r2d2.urdf",
    basePosition=[0, 0, 0.1]
)
for _ in range(10_000):
    p.stepSimulation()
    time.sleep(1 / 240)
p.disconnect()
"""

LOOP = """
while True:
    observation = get_observation()
    action = choose_action(observation)
    apply_action(action)
    p.stepSimulation()
    reward = calculate_reward()
    if episode_finished():
        reset_world()
"""

LOAD = """
robot_id = p.loadURDF(
    "kuka_iiwa/model.urdf",
    basePosition=[0, 0, 0],
    useFixedBase=True,
)
"""

INSPECT = """
num_joints = p.getNumJoints(robot_id)
for joint_index in range(num_joints):
    joint_info = p.getJointInfo(
        robot_id,
        joint_index,
    )
    joint_name = joint_info[1].decode("utf-8")
    joint_type = joint_info[2]
    print(joint_index, joint_name, joint_type)
"""

POSITION = """
p.setJointMotorControl2(
    bodyUniqueId=robot_id,
    jointIndex=2,
    controlMode=p.POSITION_CONTROL,
    targetPosition=0.5,
    force=200,
)
"""

POSITIONS = """
joint_indices = [0, 1, 2, 3, 4, 5, 6]
target_positions = [
    0.0,
    0.3,
    0.0,
    -1.2,
    0.0,
    0.8,
    0.0,
]
p.setJointMotorControlArray(
    bodyUniqueId=robot_id,
    jointIndices=joint_indices,
    controlMode=p.POSITION_CONTROL,
    targetPositions=target_positions,
    forces=[200] * len(joint_indices),
)
"""

VELOCITY = """
p.setJointMotorControl2(
    bodyUniqueId=robot_id,
    jointIndex=2,
    controlMode=p.VELOCITY_CONTROL,
    targetVelocity=1.0,
    force=100,
)
"""

TORQUE = """
p.setJointMotorControl2(
    bodyUniqueId=robot_id,
    jointIndex=2,
    controlMode=p.TORQUE_CONTROL,
    force=5.0,
)
"""

READ_JOINT = """
joint_state = p.getJointState(robot_id, 2)
joint_position = joint_state[0]
joint_velocity = joint_state[1]
joint_reaction_forces = joint_state[2]
joint_torque = joint_state[3]
"""

READ_LINK = """
link_state = p.getLinkState(
    robot_id,
    linkIndex=6,
)
end_effector_position = link_state[0]
end_effector_orientation = link_state[1]
"""

OBSERVATION = """
observation = [
    *joint_positions,
    *joint_velocities,
    *end_effector_position,
    *target_position,
]
"""

REACHING_SCENE = """
import pybullet as p
import pybullet_data
import numpy as np
p.connect(p.GUI)
p.setAdditionalSearchPath(
    pybullet_data.getDataPath()
)
p.setGravity(0, 0, -9.81)
plane_id = p.loadURDF("plane.urdf")
robot_id = p.loadURDF(
    "kuka_iiwa/model.urdf",
    basePosition=[0, 0, 0],
    useFixedBase=True,
)
target_position = np.array([
    0.45,
    0.10,
    0.55,
])
target_id = p.loadURDF(
    "sphere2.urdf",
    basePosition=target_position,
    globalScaling=0.05,
)
"""

REWARD = """
def compute_reward(
    end_effector_position,
    target_position,
):
    distance = np.linalg.norm(
        np.array(end_effector_position)
        - np.array(target_position)
    )
    return -distance
"""

BONUS = """
if distance < 0.05:
    reward += 10.0
"""

ENVIRONMENT = """
import gymnasium as gym
from gymnasium import spaces
import numpy as np
import pybullet as p
import pybullet_data
class PyBulletReachEnv(gym.Env):
    def __init__(self, render_mode=None):
        super().__init__()
        self.render_mode = render_mode
        self.action_space = spaces.Box(
            low=-1.0,
            high=1.0,
            shape=(7,),
            dtype=np.float32,
        )
        self.observation_space = spaces.Box(
            low=-np.inf,
            high=np.inf,
            shape=(20,),
            dtype=np.float32,
        )
        connection_mode = (
            p.GUI
            if render_mode == "human"
            else p.DIRECT
        )
        self.client_id = p.connect(connection_mode)
        p.setAdditionalSearchPath(
            pybullet_data.getDataPath(),
            physicsClientId=self.client_id,
        )
        self.max_steps = 200
        self.step_count = 0
    def reset(self, seed=None, options=None):
        super().reset(seed=seed)
        p.resetSimulation(
            physicsClientId=self.client_id,
        )
        p.setGravity(
            0,
            0,
            -9.81,
            physicsClientId=self.client_id,
        )
        p.loadURDF(
            "plane.urdf",
            physicsClientId=self.client_id,
        )
        self.robot_id = p.loadURDF(
            "kuka_iiwa/model.urdf",
            useFixedBase=True,
            physicsClientId=self.client_id,
        )
        self.target_position = self.np_random.uniform(
            low=[0.3, -0.3, 0.3],
            high=[0.7, 0.3, 0.8],
        )
        self.target_id = p.loadURDF(
            "sphere2.urdf",
            basePosition=self.target_position,
            globalScaling=0.05,
            physicsClientId=self.client_id,
        )
        self.step_count = 0
        return self._get_observation(), {}
    def step(self, action):
        target_positions = np.asarray(
            action,
            dtype=np.float32,
        )
        p.setJointMotorControlArray(
            bodyUniqueId=self.robot_id,
            jointIndices=list(range(7)),
            controlMode=p.POSITION_CONTROL,
            targetPositions=target_positions,
            forces=[200] * 7,
            physicsClientId=self.client_id,
        )
        for _ in range(8):
            p.stepSimulation(
                physicsClientId=self.client_id,
            )
        self.step_count += 1
        observation = self._get_observation()
        distance = observation[-1]
        reward = -distance
        terminated = distance < 0.05
        truncated = self.step_count >= self.max_steps
        if terminated:
            reward += 10.0
        info = {"distance_to_target": float(distance)}
        return (
            observation,
            reward,
            terminated,
            truncated,
            info,
        )
    def _get_observation(self):
        joint_states = [
            p.getJointState(
                self.robot_id,
                joint,
                physicsClientId=self.client_id,
            )
            for joint in range(7)
        ]
        joint_positions = [
            state[0] for state in joint_states
        ]
        joint_velocities = [
            state[1] for state in joint_states
        ]
        link_state = p.getLinkState(
            self.robot_id,
            6,
            physicsClientId=self.client_id,
        )
        end_effector_position = np.array(link_state[0])
        distance = np.linalg.norm(
            end_effector_position
            - self.target_position
        )
        return np.array(
            [
                *joint_positions,
                *joint_velocities,
                *end_effector_position,
                *self.target_position,
                distance,
            ],
            dtype=np.float32,
        )
    def close(self):
        p.disconnect(
            physicsClientId=self.client_id,
        )
"""

CAMERA = """
view_matrix = p.computeViewMatrixFromYawPitchRoll(
    cameraTargetPosition=[0.4, 0, 0.4],
    distance=1.2,
    yaw=45,
    pitch=-30,
    roll=0,
    upAxisIndex=2,
)
projection_matrix = p.computeProjectionMatrixFOV(
    fov=60,
    aspect=1.0,
    nearVal=0.1,
    farVal=3.0,
)
width, height, rgba, depth, segmentation = (
    p.getCameraImage(
        width=128,
        height=128,
        viewMatrix=view_matrix,
        projectionMatrix=projection_matrix,
    )
)
"""

RANDOMIZE = """
p.changeDynamics(
    object_id,
    linkIndex=-1,
    lateralFriction=float(
        self.np_random.uniform(0.3, 1.2)
    ),
)
"""


def test_the_first_scene(page: dict[str, Any]) -> None:
    run(page, IMPORTS, FIRST_SCENE, "p.connect(p.DIRECT)")


def test_the_loop_goes_round(page: dict[str, Any]) -> None:
    class Enough(Exception): ...

    rounds: list[int] = []

    def calculate_reward() -> float:
        rounds.append(1)
        if len(rounds) == 20:
            raise Enough
        return 0.0

    page |= {
        "get_observation": lambda: None,
        "choose_action": lambda observation: None,
        "apply_action": lambda action: None,
        "calculate_reward": calculate_reward,
        "episode_finished": lambda: len(rounds) % 5 == 0,
        "reset_world": lambda: page["p"].resetSimulation(),
    }
    with pytest.raises(Enough):
        run(page, IMPORTS, "p.connect(p.DIRECT)", LOOP)


def test_an_arm_is_inspected_driven_and_read(page: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    run(page, IMPORTS, "p.connect(p.DIRECT)\np.setAdditionalSearchPath(pybullet_data.getDataPath())", LOAD, INSPECT)
    assert len(capsys.readouterr().out.splitlines()) == 7
    settle = "for _ in range(240): p.stepSimulation()"
    run(page, POSITION, settle, READ_JOINT)
    assert page["joint_position"] == pytest.approx(0.5, abs=1e-3)
    run(page, POSITIONS, settle, READ_JOINT, READ_LINK)
    assert page["joint_position"] == pytest.approx(0, abs=1e-3)
    run(page, VELOCITY, "for _ in range(24): p.stepSimulation()", READ_JOINT)
    assert page["joint_velocity"] == pytest.approx(1, abs=1e-3)
    run(page, TORQUE, "p.stepSimulation()", READ_JOINT, READ_LINK)
    page |= {"joint_positions": [0.0] * 7, "joint_velocities": [0.0] * 7, "target_position": [0.4, 0, 0.5]}
    run(page, OBSERVATION)
    assert len(page["observation"]) == 20
    assert len(page["joint_reaction_forces"]) == 6 and len(page["end_effector_orientation"]) == 4


def test_the_reaching_scene_and_its_picture(page: dict[str, Any]) -> None:
    run(page, REACHING_SCENE, REWARD, READ_LINK, CAMERA)
    assert page["compute_reward"](page["end_effector_position"], page["target_position"]) < 0
    page |= {"distance": 0.04, "reward": 0.0}
    run(page, BONUS)
    assert page["reward"] == 10
    assert page["rgba"].shape == (128, 128, 4) and page["robot_id"] in page["segmentation"]
    page |= {"self": types.SimpleNamespace(np_random=np.random.default_rng(0)), "object_id": page["target_id"]}
    run(page, RANDOMIZE)
    assert 0.3 <= page["p"].getDynamicsInfo(page["target_id"], -1)[1] <= 1.2


def test_the_environment_runs_as_written_and_its_slip_is_found(page: dict[str, Any]) -> None:
    from gymnasium.utils.env_checker import check_env

    run(page, ENVIRONMENT)
    env = page["PyBulletReachEnv"]()
    observation, _ = env.reset(seed=0)
    assert observation.shape == (21,), "it declares 20"
    for _ in range(20):
        observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
    assert info["distance_to_target"] == pytest.approx(float(observation[-1]))
    env.close()
    wrong = page["PyBulletReachEnv"]()
    with pytest.raises(AssertionError):
        check_env(wrong)
    wrong.close()
    run(page, ENVIRONMENT.replace("shape=(20,)", "shape=(21,)"))
    right = page["PyBulletReachEnv"]()
    check_env(right, skip_render_check=True)
    right.close()
