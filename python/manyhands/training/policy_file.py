"""Policies as ONNX files."""

from pathlib import Path
from typing import Any

import numpy as np
import onnx
from numpy.typing import ArrayLike
from onnx import TensorProto, helper, numpy_helper

from manyhands._core.learn import Policy
from manyhands.files import replacing
from manyhands.training.cloning import ClonedPolicy

_OPSET, _IR_VERSION = 17, 8  # old enough for every onnxruntime since 1.12


def to_onnx(policy: Policy | ClonedPolicy, env_id: str) -> onnx.ModelProto:
    """The policy as a graph.

    Inputs, float32: observation (batch, observation_dim), achieved_goal and desired_goal (batch, goal_dim), raw as the
    environment gives them. Output: action (batch, action_dim) in [-1, 1], or (batch, chunk, action_dim), the next ones,
    of a policy that was cloned in chunks.
    """
    chunk = policy.chunk if isinstance(policy, ClonedPolicy) else 1
    constants: list[onnx.TensorProto] = []
    nodes: list[onnx.NodeProto] = []

    def constant(name: str, value: ArrayLike) -> str:
        constants.append(numpy_helper.from_array(np.asarray(value, np.float32), name))
        return name

    def apply(operation: str, inputs: list[str], output: str, **attributes: Any) -> str:
        nodes.append(helper.make_node(operation, inputs, [output], **attributes))
        return output

    to_goal = apply("Sub", ["desired_goal", "achieved_goal"], "to_goal")
    parts = ["observation", "desired_goal", to_goal]
    if policy.differences:
        parts.append(apply("MatMul", ["observation", constant("pairs", _pairs(policy))], "differences"))
    x = apply("Concat", parts, "features", axis=1)
    x = apply("Sub", [x, constant("mean", policy.mean)], "centred")
    x = apply("Mul", [x, constant("scale", policy.scale)], "scaled")
    limits = [constant(name, value) for name, value in (("low", -policy.clip), ("high", policy.clip))]
    x = apply("Clip", [x, *limits], "normalised")
    for i, (weight, bias) in enumerate(policy.layers):
        last = i == len(policy.layers) - 1
        parameters = [constant(f"weight_{i}", weight), constant(f"bias_{i}", bias)]
        x = apply("Gemm", [x, *parameters], f"linear_{i}", transB=1)
        output = "action" if chunk == 1 else "actions_in_a_row"
        x = apply("Tanh" if last else "Relu", [x], output if last else f"hidden_{i}")
    if chunk > 1:
        shape = numpy_helper.from_array(np.array([-1, chunk, policy.action_dim], np.int64), "shape")
        constants.append(shape)
        apply("Reshape", [x, shape.name], "action")

    def rows(name: str, *sizes: int) -> onnx.ValueInfoProto:
        return helper.make_tensor_value_info(name, TensorProto.FLOAT, ["batch", *sizes])

    graph = helper.make_graph(
        nodes,
        "policy",
        [
            rows("observation", policy.observation_dim),
            rows("achieved_goal", policy.goal_dim),
            rows("desired_goal", policy.goal_dim),
        ],
        [rows("action", policy.action_dim) if chunk == 1 else rows("action", chunk, policy.action_dim)],
        constants,
    )
    model = helper.make_model(
        graph,
        producer_name="manyhands",
        ir_version=_IR_VERSION,
        opset_imports=[helper.make_opsetid("", _OPSET)],
    )
    helper.set_model_props(model, {"env_id": env_id})
    onnx.checker.check_model(model, full_check=True)
    return model


def _pairs(policy: Policy | ClonedPolicy) -> np.ndarray:
    """The matrix (observation_dim, 3 pairs) that takes the policy's differences from observations."""
    columns = np.eye(policy.observation_dim)
    pairs = zip(policy.differences[::2], policy.differences[1::2], strict=True)
    return np.hstack([columns[:, i : i + 3] - columns[:, k : k + 3] for i, k in pairs])


def save_policy(policy: Policy | ClonedPolicy, env_id: str, path: Path) -> None:
    """Writes the policy as an ONNX file."""
    with replacing(path) as temporary:
        onnx.save(to_onnx(policy, env_id), temporary)
