"""ONNX graphs of policies, node by node."""

from typing import Any

import numpy as np
import onnx
from numpy.typing import ArrayLike
from onnx import TensorProto, helper, numpy_helper

_OPSET, _IR_VERSION = 17, 8  # old enough for every onnxruntime since 1.12
INPUTS = ("observation", "achieved_goal", "desired_goal")


class PolicyGraph:
    """Values are known by their names; a graph begins with INPUTS, or without goals with the first of them."""

    def __init__(self, has_goals: bool = True) -> None:
        self._inputs = INPUTS if has_goals else INPUTS[:1]
        self._constants: list[onnx.TensorProto] = []
        self._nodes: list[onnx.NodeProto] = []

    def constant(self, name: str, value: ArrayLike, half: bool = False) -> str:
        """A float32 array; with `half` it is held in 16 bits."""
        kind, held = (np.float16, f"{name}_half") if half else (np.float32, name)
        self._constants.append(numpy_helper.from_array(np.asarray(value, kind), held))
        return self.apply("Cast", [held], name, to=TensorProto.FLOAT) if half else name

    def apply(self, operation: str, inputs: list[str], output: str, **attributes: Any) -> str:
        """What an operation makes of values."""
        self._nodes.append(helper.make_node(operation, inputs, [output], **attributes))
        return output

    def normalised(self, x: str, mean: ArrayLike, scale: ArrayLike, clip: float, of: str = "") -> str:
        """clip((x - mean) * scale); `of` ends the names, if there are several."""
        x = self.apply("Sub", [x, self.constant(f"mean{of}", mean)], f"centred{of}")
        x = self.apply("Mul", [x, self.constant(f"scale{of}", scale)], f"scaled{of}")
        return self.clipped(x, clip, f"normalised{of}")

    def clipped(self, x: str, limit: float, output: str) -> str:
        """Between -limit and limit."""
        limits = [self.constant(f"{side}_{output}", value) for side, value in (("low", -limit), ("high", limit))]
        return self.apply("Clip", [x, *limits], output)

    def goal_features(self, pairs: ArrayLike, mean: ArrayLike, scale: ArrayLike, clip: float) -> str:
        """What our networks see: observation, where there are goals the goal and the way to it, and differences within
        the observation, normalised.

        pairs: the matrix (observation_dim, n) that takes the differences, none with n = 0.
        """
        parts = ["observation"]
        if len(self._inputs) > 1:
            parts += ["desired_goal", self.apply("Sub", ["desired_goal", "achieved_goal"], "to_goal")]
        if np.size(pairs):
            parts.append(self.apply("MatMul", ["observation", self.constant("pairs", pairs)], "differences"))
        return self.normalised(self.apply("Concat", parts, "features", axis=1), mean, scale, clip)

    def linear(self, x: str, weight: ArrayLike, bias: ArrayLike, number: int, half: bool = False) -> str:
        """weight (outputs, inputs) x + bias."""
        given = {f"weight_{number}": weight, f"bias_{number}": bias}
        parameters = [self.constant(name, value, half) for name, value in given.items()]
        return self.apply("Gemm", [x, *parameters], f"linear_{number}", transB=1)

    def reshaped(self, x: str, shape: tuple[int, ...], output: str) -> str:
        """The same numbers in another shape; -1 is what is left."""
        self._constants.append(numpy_helper.from_array(np.array(shape, np.int64), f"shape_of_{output}"))
        return self.apply("Reshape", [x, f"shape_of_{output}"], output)

    def model(self, observation_dim: int, goal_dim: int, action_shape: tuple[int, ...], env_id: str) -> onnx.ModelProto:
        """The checked graph; the value "action" is its output, (batch, *action_shape)."""

        def rows(name: str, *sizes: int) -> onnx.ValueInfoProto:
            return helper.make_tensor_value_info(name, TensorProto.FLOAT, ["batch", *sizes])

        sizes = (observation_dim, goal_dim, goal_dim)
        inputs = [rows(name, size) for name, size in zip(self._inputs, sizes, strict=False)]
        graph = helper.make_graph(self._nodes, "policy", inputs, [rows("action", *action_shape)], self._constants)
        model = helper.make_model(
            graph,
            producer_name="manyhands",
            ir_version=_IR_VERSION,
            opset_imports=[helper.make_opsetid("", _OPSET)],
        )
        helper.set_model_props(model, {"env_id": env_id})
        onnx.checker.check_model(model, full_check=True)
        return model
