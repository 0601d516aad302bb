"""Things in pictures: by segmentation, and by a network that is brought along as an ONNX file."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.arguments import instance, rate, real_array, whole_number
from manyhands.extras import needs

Array = NDArray[np.float32]

Decode: TypeAlias = Callable[[Sequence[NDArray[Any]]], tuple[ArrayLike, ArrayLike, ArrayLike]]
"""From a network's outputs to boxes (n, 4) [pixels of its input], scores (n,) and classes (n,)."""


class Detections(NamedTuple):
    """What was found, the surest first."""

    boxes: Array
    """(n, 4) left, upper, right and lower edge [pixels of the picture]"""
    scores: Array
    """(n,), 0 to 1"""
    classes: NDArray[np.intp]
    """(n,) what each is, by number"""


def things(segmentation: ArrayLike) -> dict[int, tuple[int, int, int, int]]:
    """The box of pixels (left, upper, right, lower, the last two excluded) of every number of 0 or more in a picture
    (height, width), such as `Picture.segmentation` or `Picture.bodies`."""
    numbers = real_array("segmentation", segmentation)
    if numbers.ndim != 2 or numbers.dtype.kind not in "iu":
        raise ValueError(f"segmentation is {numbers.dtype} of shape {numbers.shape}; expected integers (height, width)")
    found: dict[int, tuple[int, int, int, int]] = {}
    for number in np.unique(numbers[numbers >= 0]).tolist():
        rows, columns = np.nonzero(numbers == number)
        found[number] = (int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1)
    return found


class Detector:
    """A network with one picture (1, 3, height, width) of numbers from 0 to 1 as its input, into which pictures are
    scaled, grey where their shape differs.

    network: an ONNX file or its bytes. size: width and height of its input, where the file leaves them open. decode:
    what its outputs mean; by default those of YOLO 8 and later, one output (1, 4 + classes, n) or (1, n, 4 + classes)
    of centres, sizes and scores, or those of torchvision: boxes (n, 4), classes (n,) and scores (n,) in any order.
    threshold: of scores. overlap: of two boxes of one class, intersection over union, above which only the surer stays.
    """

    def __init__(
        self,
        network: str | Path | bytes,
        *,
        size: tuple[int, int] | None = None,
        decode: Decode | None = None,
        threshold: float = 0.25,
        overlap: float = 0.45,
    ) -> None:
        with needs("vision", "detection by a network"):
            import onnxruntime
        self.threshold, self.overlap = rate("threshold", threshold), rate("overlap", overlap)
        given = instance("network", network, str, Path, bytes)
        if not isinstance(given, bytes) and not Path(given).is_file():
            raise FileNotFoundError(f"there is no file {str(given)!r} with a network; export one as ONNX")
        try:
            self._session: Any = onnxruntime.InferenceSession(
                given if isinstance(given, bytes) else str(given), providers=["CPUExecutionProvider"]
            )
        except Exception as error:  # onnxruntime's have no common base
            what = "the network" if isinstance(given, bytes) else repr(str(given))
            raise ValueError(f"{what} is no ONNX model that onnxruntime reads: {error}") from error
        inputs = self._session.get_inputs()
        shape = inputs[0].shape
        if len(inputs) != 1 or len(shape) != 4 or shape[1] != 3 or inputs[0].type != "tensor(float)":
            given = ", ".join(f"{each.name} {each.type} {each.shape}" for each in inputs)
            raise ValueError(f"the network takes {given}; expected one picture (1, 3, height, width) of float32")
        fixed = [length if isinstance(length, int) else None for length in (shape[3], shape[2])]
        if size is None and None in fixed:
            raise ValueError("the network leaves its input's size open; give size=(width, height)")
        width, height = fixed if size is None else size
        self.size = whole_number("width", width, 1), whole_number("height", height, 1)
        if any(length not in (None, mine) for length, mine in zip(fixed, self.size, strict=True)):
            raise ValueError(f"size is {self.size}; the network's input is fixed at {tuple(fixed)}")
        if decode is not None and not callable(decode):
            raise TypeError(f"decode is {decode!r}; expected a function of the network's outputs")
        self._input, self._decode = inputs[0].name, decode or _decode

    def detect(self, picture: ArrayLike) -> Detections:
        """What a picture (height, width, 3) of uint8 shows."""
        given = real_array("picture", picture)
        if given.dtype != np.uint8 or given.ndim != 3 or given.shape[2] < 3 or 0 in given.shape:
            raise ValueError(
                f"the picture is {given.dtype} of shape {given.shape}; expected uint8 of (height, width, 3)"
            )
        scaled, scale, shift = _letterbox(given[..., :3], *self.size)
        outputs = self._session.run(None, {self._input: scaled.transpose(2, 0, 1)[None]})
        boxes, scores, classes = (np.asarray(part) for part in self._decode(outputs))
        n = len(scores)
        if boxes.shape != (n, 4) or scores.shape != (n,) or classes.shape != (n,):
            raise ValueError(
                f"decode gave shapes {boxes.shape}, {scores.shape}, {classes.shape}; expected (n, 4), (n,), (n,)"
            )
        height, width = given.shape[:2]
        edges = np.clip((boxes - np.tile(shift, 2)) / scale, 0, [width, height, width, height])
        return _surest(edges.astype(np.float32), scores, classes, self.threshold, self.overlap)


def _letterbox(picture: NDArray[np.uint8], width: int, height: int) -> tuple[Array, float, Array]:
    """The picture as large as fits, its pixels between those of the original, grey around; its scale, and where its
    corner is."""
    rows, columns = picture.shape[:2]
    scale = min(width / columns, height / rows)
    w, h = round(columns * scale), round(rows * scale)
    left, top = (width - w) // 2, (height - h) // 2
    framed = np.full((height, width, 3), 114 / 255, np.float32)
    framed[top : top + h, left : left + w] = _resized(picture, w, h) / 255
    return framed, scale, np.array([left, top], np.float32)


def _resized(picture: NDArray[np.uint8], width: int, height: int) -> Array:
    """Linear between the centres of pixels."""
    for axis, length in ((0, height), (1, width)):
        n = picture.shape[axis]
        at = np.clip((np.arange(length) + 0.5) * n / length - 0.5, 0, n - 1)
        low = np.minimum(at.astype(np.intp), max(n - 2, 0))
        share = (at - low).astype(np.float32).reshape([-1 if k == axis else 1 for k in range(3)])
        near, far = picture.take(low, axis), picture.take(np.minimum(low + 1, n - 1), axis)
        picture = near * (1 - share) + far * share
    return picture.astype(np.float32)


def _decode(outputs: Sequence[NDArray[Any]]) -> tuple[ArrayLike, ArrayLike, ArrayLike]:
    if len(outputs) == 1 and outputs[0].ndim == 3 and outputs[0].shape[0] == 1 and min(outputs[0].shape[1:]) > 4:
        table = outputs[0][0]
        if table.shape[0] < table.shape[1]:  # there are more places than classes
            table = table.T
        half = table[:, 2:4] / 2
        classes = table[:, 4:].argmax(1)
        scores = table[np.arange(len(table)), 4 + classes]
        return np.concatenate([table[:, :2] - half, table[:, :2] + half], axis=1), scores, classes
    boxes = [each for each in outputs if each.ndim == 2 and each.shape[1] == 4]
    flat = [each for each in outputs if each.ndim == 1]
    classes = [each for each in flat if each.dtype.kind in "iu"]
    scores = [each for each in flat if each.dtype.kind == "f"]
    if len(boxes) == len(classes) == len(scores) == 1:
        return boxes[0], scores[0], classes[0]
    shapes = ", ".join(f"{each.dtype}{list(each.shape)}" for each in outputs)
    raise ValueError(f"what the network's outputs {shapes} mean is not known; give decode")


def _surest(boxes: Array, scores: NDArray[Any], classes: NDArray[Any], threshold: float, overlap: float) -> Detections:
    """Of each class, without those that a surer one covers."""
    kept: list[int] = []
    for i in np.argsort(-scores, kind="stable").tolist():
        if not scores[i] >= threshold:
            break
        rivals = [k for k in kept if classes[k] == classes[i]]
        if not rivals or (_shared(boxes[i], boxes[rivals]) <= overlap).all():
            kept.append(i)
    return Detections(boxes[kept], scores[kept].astype(np.float32), classes[kept].astype(np.intp))


def _shared(box: Array, others: Array) -> Array:
    """Intersection over union (n,)."""
    sides = np.minimum(box[2:], others[:, 2:]) - np.maximum(box[:2], others[:, :2])
    both = sides.clip(0).prod(1)
    areas = (others[:, 2:] - others[:, :2]).prod(1) + (box[2:] - box[:2]).prod()
    return both / np.maximum(areas - both, 1e-9)
