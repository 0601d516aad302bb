"""Policies as ONNX files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto

from manyhands._core.learn import Policy
from manyhands.files import replacing
from manyhands.training.cloning import ClonedPolicy
from manyhands.training.policy_graph import PolicyGraph
from manyhands.training.rotation_graph import add_cube_rotation

Array = NDArray[np.float32]


def to_onnx(
    policy: Policy | ClonedPolicy, env_id: str, cameras: Mapping[str, Any] | None = None, half: bool = False
) -> onnx.ModelProto:
    """The policy as a graph; with `half` it holds its weights in 16 bits, and computes in 32 as ever.

    Inputs, float32: observation (batch, observation_dim), and where there are goals achieved_goal and desired_goal
    (batch, goal_dim), raw as the environment gives them. Output: action (batch, action_dim) in [-1, 1], or the index of
    a choice; of a policy that was cloned in chunks (batch, chunk, action_dim), the next ones.

    One that sees has the inputs of `PolicyGraph.eye` by the names of its cameras, and of the observation's numbers only
    those of the robot itself.
    """
    graph = PolicyGraph(has_goals=policy.goal_dim > 0)
    seen = cameras if cameras and isinstance(policy, Policy) else {}
    rotation = _rotation(graph, policy)
    x = graph.goal_features(differences(policy), policy.mean, policy.scale, policy.clip, rotation)
    if isinstance(policy, Policy) and seen:
        features = [graph.eye(name, policy.pictures, eye) for name, eye in zip(seen, policy.eyes, strict=True)]
        x = graph.apply("Concat", [*features, x], "seen_and_known", axis=1)
    for i, (weight, bias) in enumerate(policy.layers):
        x = graph.linear(x, weight, bias, i, half)
        if i < len(policy.layers) - 1:
            x = graph.apply("Relu" if policy.activation == "relu" else "Tanh", [x], f"hidden_{i}")
    if isinstance(policy, ClonedPolicy) and policy.chunk > 1:
        graph.reshaped(graph.apply("Tanh", [x], "actions_in_a_row"), (-1, policy.chunk, policy.action_dim), "action")
        return graph.model(policy.observation_dim, policy.goal_dim, (policy.chunk, policy.action_dim), env_id)
    if policy.output == "tanh":
        graph.apply("Tanh", [x], "action")
    elif policy.output == "clip":
        graph.clipped(x, 1, "action")
    else:
        choice = graph.apply("ArgMax", [x], "choice", axis=1, keepdims=1)
        graph.apply("Cast", [choice], "action", to=TensorProto.FLOAT)
    return graph.model(policy.observation_dim, policy.goal_dim, (policy.action_dim,), env_id, seen)


def _rotation(graph: PolicyGraph, policy: Policy | ClonedPolicy) -> list[str]:
    if isinstance(policy, ClonedPolicy) or policy.cube_rotation < 0:
        return []
    return add_cube_rotation(graph, policy.observation_dim, policy.cube_rotation)


def differences(policy: Policy | ClonedPolicy) -> Array:
    """The matrix (observation_dim, 3 pairs) that takes the policy's differences from observations."""
    columns = np.eye(policy.observation_dim, dtype=np.float32)
    pairs = zip(policy.differences[::2], policy.differences[1::2], strict=True)
    return np.hstack([columns[:, :0], *(columns[:, i : i + 3] - columns[:, k : k + 3] for i, k in pairs)])


def save_policy(
    policy: Policy | ClonedPolicy, env_id: str, path: Path, cameras: Mapping[str, Any] | None = None
) -> None:
    """Writes the policy as an ONNX file."""
    save_model(to_onnx(policy, env_id, cameras), path)


def save_model(model: onnx.ModelProto, path: Path) -> None:
    """Writes a graph to a file, whole or not at all. Raises OSError if it cannot be written."""
    with replacing(path) as temporary:
        onnx.save(model, temporary)
