"""Policies as ONNX files."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, numpy_helper

from manyhands._core.learn import Policy
from manyhands.files import replacing
from manyhands.training.cloning import ClonedPolicy
from manyhands.training.policy_graph import PolicyGraph

Array = NDArray[np.float32]


def to_onnx(policy: Policy | ClonedPolicy, env_id: str, cameras: Mapping[str, Any] | None = None) -> onnx.ModelProto:
    """The policy as a graph.

    Inputs, float32: observation (batch, observation_dim), and where there are goals achieved_goal and desired_goal
    (batch, goal_dim), raw as the environment gives them. Output: action (batch, action_dim) in [-1, 1], or the index of
    a choice; of a policy that was cloned in chunks (batch, chunk, action_dim), the next ones.

    One that sees has the inputs of `PolicyGraph.eye` by the names of its cameras, and of the observation's numbers only
    those of the robot itself.
    """
    graph = PolicyGraph(has_goals=policy.goal_dim > 0)
    seen = cameras if cameras and isinstance(policy, Policy) else {}
    x = graph.goal_features(_pairs(policy), policy.mean, policy.scale, policy.clip)
    if isinstance(policy, Policy) and seen:
        features = [graph.eye(name, policy.pictures, eye) for name, eye in zip(seen, policy.eyes, strict=True)]
        x = graph.apply("Concat", [*features, x], "seen_and_known", axis=1)
    for i, (weight, bias) in enumerate(policy.layers):
        x = graph.linear(x, weight, bias, i)
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


def _pairs(policy: Policy | ClonedPolicy) -> Array:
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


@dataclass(frozen=True)
class PolicyArrays:
    """What a file of `save_policy` holds, of a policy that reaches goals and ends with tanh."""

    pairs: Array  # (observation_dim, n) takes differences from observations
    mean: Array  # (inputs)
    scale: Array  # (inputs)
    clip: float
    activation: str  # of hidden layers: "Relu" or "Tanh"
    layers: list[tuple[Array, Array]]  # weight (outputs, inputs), bias (outputs)
    observation_dim: int
    goal_dim: int


def read_policy(path: Path) -> PolicyArrays:
    """The arrays of a policy that was trained here. Raises ValueError on another graph, OSError if there is no file."""
    try:
        graph = onnx.load(path).graph
    except OSError:
        raise
    except Exception as error:  # protobuf's errors have no common base but this
        raise ValueError(f"{path} cannot be read as ONNX: {error}") from error
    constants = {one.name: numpy_helper.to_array(one) for one in graph.initializer}
    done = [node.op_type for node in graph.node]
    count = done.count("Gemm")
    differs = ["MatMul"] if "pairs" in constants else []
    activation = "Relu" if "Relu" in done else "Tanh"
    hidden = ["Gemm", activation] * (count - 1)
    if done != ["Sub", *differs, "Concat", "Sub", "Mul", "Clip", *hidden, "Gemm", "Tanh"]:
        raise ValueError(
            f"{path} is no policy that a trainer of ours made, reaches goals and ends with tanh: its operations are "
            f"{', '.join(done)}"
        )
    sizes = {one.name: one.type.tensor_type.shape.dim[-1].dim_value for one in graph.input}
    observation_dim = sizes["observation"]
    return PolicyArrays(
        pairs=constants.get("pairs", np.zeros((observation_dim, 0), np.float32)),
        mean=constants["mean"],
        scale=constants["scale"],
        clip=float(constants["high_normalised"]),
        activation=activation,
        layers=[(constants[f"weight_{i}"], constants[f"bias_{i}"]) for i in range(count)],
        observation_dim=observation_dim,
        goal_dim=sizes["desired_goal"],
    )
