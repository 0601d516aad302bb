"""Evaluates policy files on fresh episodes."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode

from manyhands._core.envs import EnvSpec, env_ids, make_env_batch
from manyhands.envs.registration import make_vector_env
from manyhands.envs.spaces import Observation
from manyhands.policies import Policy
from manyhands.training.run_folder import RunFolder


@dataclass(frozen=True)
class Evaluation:
    """Means over episodes; episode k started from seed first_seed + k."""

    env_id: str
    episodes: int
    first_seed: int
    success_rate: float  # success at the last step of the episode
    mean_return: float  # undiscounted
    mean_length: float  # environment steps


class PolicyFile:
    """An ONNX policy, ready to act. Of one that gives a chunk of actions, the first is done and all are given anew."""

    def __init__(self, path: Path) -> None:
        """path: a file, or the folder of a training run. Raises ValueError if it is no policy of ours."""
        folder, path = path, RunFolder(path).policy if path.is_dir() else path
        if not path.is_file():
            runs = sorted(folder.glob(f"*/{path.name}"), key=lambda found: found.stat().st_mtime)
            held = f"; {folder} holds runs, name one of them: {runs[-1].parent}" if runs else ""
            raise ValueError(f"there is no file {path}{held}")
        import onnxruntime

        if has_loop(path):
            raise ValueError(f"{path} has a Loop, which need not end; a policy is a function without any")
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1  # the networks are small, and the worlds have the cores
        try:
            self._session = onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])
        except Exception as error:  # onnxruntime's errors have no common base but this
            raise ValueError(f"{path} cannot be read as ONNX: {error}") from error
        properties = self._session.get_modelmeta().custom_metadata_map
        self.env_id: str | None = properties.get("env_id")
        self.cameras: dict[str, Any] = json.loads(properties.get("cameras", "{}"))
        """Through which it sees, as environments take them."""
        shapes = {one.name: one.shape for one in self._session.get_inputs()}
        self.inputs = list(shapes)
        own = sorted(shapes.keys() - self.cameras.keys())
        if own != (["observation"] if self.cameras else ["achieved_goal", "desired_goal", "observation"]):
            raise ValueError(f"{path} is no goal policy: its inputs are {self.inputs}")
        rows = [*self._session.get_inputs(), *self._session.get_outputs()]
        if odd := [one.name for one in rows if not one.shape or len(one.shape) < 2]:
            raise ValueError(f"{path} is no goal policy: {', '.join(odd)} should have a row for each world")
        self._stacks = FrameStacks({name: shapes[name][1] for name in self.cameras})
        self._sizes = {one.name: one.shape[-1] for one in rows if one.name not in self.cameras}

    def require_fit(self, spec: EnvSpec) -> None:
        """Raises ValueError unless rows and actions are as long as the environment's."""
        goal = spec.goal_dim
        expected = {
            "observation": spec.observation_dim,
            "achieved_goal": goal,
            "desired_goal": goal,
            "action": spec.action_dim,
        }
        if self.cameras:
            expected = {"observation": spec.robot_dim, "action": spec.action_dim}
        if self._sizes != expected:
            raise ValueError(f"the policy does not fit {spec.id}: its sizes are {self._sizes}, expected {expected}")

    def __call__(self, observation: Observation) -> np.ndarray:
        """Actions (n, action_dim) for observations with rows (n, ...), or (action_dim) for those of one environment.

        A policy that sees remembers the last pictures of each world until its goal is another, in a new episode. Raises
        ValueError if its cameras are not in the observation.
        """
        if np.asarray(observation["observation"]).ndim == 1:
            return self({name: np.asarray(each)[None] for name, each in observation.items()})[0]
        if missing := [name for name in self.cameras if name not in observation]:
            raise ValueError(
                f"the policy sees through cameras, and {', '.join(missing)} is not in the observation; make the "
                f"environment with cameras={self.cameras}"
            )
        given: dict[str, Any] = {} if not self.cameras else self._stacks(observation)
        for name in self.inputs:
            if name not in given:
                given[name] = np.asarray(observation[name], np.float32)[:, : self._sizes[name]]
        actions = np.asarray(self._session.run(None, given)[0])
        return actions if actions.ndim == 2 else actions[:, 0]


def has_loop(path: Path) -> bool:
    """Whether an ONNX file may go on for ever; nothing but the end of the program would stop it. False of a file that
    is no ONNX."""
    import onnx

    try:
        model = onnx.load(path, load_external_data=False)
    except Exception:  # protobuf's errors have no common base but this
        return False

    def loops(nodes: Iterable[onnx.NodeProto]) -> bool:
        return any(node.op_type == "Loop" or any(loops(one.g.node) for one in node.attribute) for node in nodes)

    return loops(model.graph.node) or any(loops(function.node) for function in model.functions)


class FrameStacks:
    """The last pictures of each camera, the newest first, in worlds that a policy acts in."""

    def __init__(self, lengths: dict[str, int]) -> None:
        """lengths: how many of each camera."""
        self._lengths = lengths
        self._stacks: dict[str, np.ndarray] = {}
        self._goal = np.zeros((0, 0), np.float32)

    def __call__(self, observation: Observation) -> dict[str, np.ndarray]:
        """Stacks (n, length, height, width, 3) that end with what is observed now; those of a world whose goal has
        changed, as with a new episode, show that alone."""
        goal = np.array(observation["desired_goal"])
        is_other = goal.shape != self._goal.shape
        begun = np.ones(len(goal), np.bool_) if is_other else (goal != self._goal).any(axis=1)
        self._goal = goal
        for name, length in self._lengths.items():
            now = np.asarray(observation[name])[:, None]
            before = now.repeat(length, axis=1) if is_other else self._stacks[name]
            stack = np.concatenate([now, before[:, : length - 1]], axis=1)
            stack[begun] = now[begun]
            self._stacks[name] = stack
        return dict(self._stacks)


def policy_for(path: Path, spec: EnvSpec) -> PolicyFile:
    """The policy of a file or of a training run's folder. Raises ValueError unless it fits an environment."""
    policy = PolicyFile(path)
    policy.require_fit(spec)
    return policy


def evaluate(
    policy: PolicyFile | Policy, env_id: str, episodes: int, first_seed: int, num_threads: int | None = None
) -> Evaluation:
    """Runs `episodes` episodes. Raises ValueError if the policy does not fit the environment."""
    if episodes < 1:
        raise ValueError(f"episodes is {episodes}, expected a positive number")
    if env_id not in env_ids():
        raise ValueError(f"there is no environment {env_id!r}")
    policy.require_fit(make_env_batch(env_id, 1).spec)
    if isinstance(policy, Policy):
        result = policy.evaluate(env_id, episodes, first_seed, num_threads)
        return Evaluation(env_id, episodes, first_seed, result.success_rate, result.mean_return, result.mean_length)
    env = make_vector_env(
        env_id, episodes, num_threads=num_threads, autoreset_mode=AutoresetMode.SAME_STEP, cameras=policy.cameras
    )
    obs, _ = env.reset(seed=first_seed)
    running = np.ones(episodes, np.bool_)
    success, total, length = np.zeros(episodes), np.zeros(episodes), np.zeros(episodes)
    while running.any():
        obs, reward, terminated, truncated, info = env.step(policy(obs))
        total += reward * running
        length += running
        ended = running & (terminated | truncated)
        if ended.any():
            success[ended] = info["final_info"]["is_success"][ended]
        running &= ~ended
    return Evaluation(env_id, episodes, first_seed, float(success.mean()), float(total.mean()), float(length.mean()))
