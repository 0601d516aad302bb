"""ONNX graphs of policies, node by node."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import onnx
from numpy.typing import ArrayLike
from onnx import TensorProto, helper, numpy_helper

_OPSET, _IR_VERSION = 17, 8  # old enough for every onnxruntime since 1.12
INPUTS = ("observation", "achieved_goal", "desired_goal")


class PolicyGraph:
    """Values are known by their names; a graph begins with INPUTS, or without goals with the first of them, and with
    what cameras show."""

    def __init__(self, has_goals: bool = True) -> None:
        self._inputs = INPUTS if has_goals else INPUTS[:1]
        self._pictures: list[onnx.ValueInfoProto] = []
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

    def goal_features(
        self, pairs: ArrayLike, mean: ArrayLike, scale: ArrayLike, clip: float, rotation: Sequence[str] = ()
    ) -> str:
        """What our networks see: observation, where there are goals the goal and the way to it, a cube's rotation, and
        differences within the observation, normalised.

        pairs: the matrix (observation_dim, n) that takes the differences, none with n = 0; rotation: values.
        """
        parts = ["observation"]
        if len(self._inputs) > 1:
            parts += ["desired_goal", self.apply("Sub", ["desired_goal", "achieved_goal"], "to_goal"), *rotation]
        if np.size(pairs):
            parts.append(self.apply("MatMul", ["observation", self.constant("pairs", pairs)], "differences"))
        return self.normalised(self.apply("Concat", parts, "features", axis=1), mean, scale, clip)

    def eye(self, name: str, pictures: tuple[int, int, int], layers: Sequence[tuple[Any, Any, int]]) -> str:
        """Features (batch, n) of a camera's input (batch, stack, height, width, 3), uint8, the newest picture first.

        pictures: stack, height and width; layers: as in `Policy.eyes`.
        """
        stack, height, width = pictures
        shape = ["batch", stack, height, width, 3]
        self._pictures.append(helper.make_tensor_value_info(name, TensorProto.UINT8, shape))
        x = self.apply("Cast", [name], f"{name}_numbers", to=TensorProto.FLOAT)
        x = self.apply("Mul", [x, self.constant(f"{name}_scale", 1 / 255)], f"{name}_scaled")
        x = self.apply("Sub", [x, self.constant(f"{name}_mean", 0.5)], f"{name}_centred")
        x = self.apply("Transpose", [x], f"{name}_planes", perm=[0, 1, 4, 2, 3])
        x = self.reshaped(x, (-1, 3 * stack, height, width), f"{name}_stack")
        for i, (weight, bias, stride) in enumerate(layers):
            channels, planes, kernel, _, below = weight.shape
            turned = weight.transpose(0, 1, 4, 2, 3).reshape(channels, planes * below, kernel, kernel)
            parameters = [self.constant(f"{name}_weight_{i}", turned), self.constant(f"{name}_bias_{i}", bias)]
            x = self.apply("Conv", [x, *parameters], f"{name}_convolved_{i}", strides=[stride, stride])
            x = self.apply("Relu", [x], f"{name}_seen_{i}")
        x = self.apply("Transpose", [x], f"{name}_places", perm=[0, 2, 3, 1])
        return self.apply("Flatten", [x], f"{name}_features", axis=1)

    def linear(self, x: str, weight: ArrayLike, bias: ArrayLike, number: int, half: bool = False) -> str:
        """weight (outputs, inputs) x + bias."""
        given = {f"weight_{number}": weight, f"bias_{number}": bias}
        parameters = [self.constant(name, value, half) for name, value in given.items()]
        return self.apply("Gemm", [x, *parameters], f"linear_{number}", transB=1)

    def reshaped(self, x: str, shape: tuple[int, ...], output: str) -> str:
        """The same numbers in another shape; -1 is what is left."""
        self._constants.append(numpy_helper.from_array(np.array(shape, np.int64), f"shape_of_{output}"))
        return self.apply("Reshape", [x, f"shape_of_{output}"], output)

    def model(
        self,
        observation_dim: int,
        goal_dim: int,
        action_shape: tuple[int, ...],
        env_id: str,
        cameras: Mapping[str, Any] | None = None,
    ) -> onnx.ModelProto:
        """The checked graph; the value "action" is its output, (batch, *action_shape). `cameras`: those through which
        it sees, as environments take them."""

        def rows(name: str, *sizes: int) -> onnx.ValueInfoProto:
            return helper.make_tensor_value_info(name, TensorProto.FLOAT, ["batch", *sizes])

        sizes = (observation_dim, goal_dim, goal_dim)
        inputs = [rows(name, size) for name, size in zip(self._inputs, sizes, strict=False)] + self._pictures
        graph = helper.make_graph(self._nodes, "policy", inputs, [rows("action", *action_shape)], self._constants)
        model = helper.make_model(
            graph,
            producer_name="manyhands",
            ir_version=_IR_VERSION,
            opset_imports=[helper.make_opsetid("", _OPSET)],
        )
        properties = {"env_id": env_id}
        if cameras:
            properties["cameras"] = json.dumps(cameras)
        helper.set_model_props(model, properties)
        onnx.checker.check_model(model, full_check=True)
        return model
