"""Detection by networks that the tests make: what they find is known by hand."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import manyhands as mh
from manyhands import vision

onnx = pytest.importorskip("onnx")
helper, FLOAT, INT64 = onnx.helper, onnx.TensorProto.FLOAT, onnx.TensorProto.INT64


def network(nodes: list[Any], outputs: list[tuple[str, int]], constants: dict[str, np.ndarray], size: Any) -> bytes:
    picture = helper.make_tensor_value_info("picture", FLOAT, [1, 3, *size])
    graph = helper.make_graph(
        nodes, "detector", [picture],
        [helper.make_tensor_value_info(name, kind, None) for name, kind in outputs],
        [onnx.numpy_helper.from_array(array, name) for name, array in constants.items()],
    )  # fmt: skip
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    return model.SerializeToString()


def cells(size: Any = (64, 96)) -> bytes:
    """A detector of colours in the manner of YOLO: the means of red, green and blue over cells of 16 x 16 pixels are
    the scores of three classes, and every cell's box is itself."""
    rows, columns = 4, 6
    y, x = np.mgrid[0:rows, 0:columns] * 16 + 8
    boxes = np.stack([x, y, np.full_like(x, 16), np.full_like(x, 16)]).reshape(1, 4, -1).astype(np.float32)
    nodes = [
        helper.make_node("AveragePool", ["picture"], ["means"], kernel_shape=[16, 16], strides=[16, 16]),
        helper.make_node("Reshape", ["means", "flat"], ["scores"]),
        helper.make_node("Concat", ["boxes", "scores"], ["found"], axis=1),
    ]
    return network(nodes, [("found", FLOAT)], {"boxes": boxes, "flat": np.array([1, 3, -1], np.int64)}, size)


def test_boxes_are_those_of_the_picture_and_not_of_the_networks_frame() -> None:
    """A picture of 48 x 48 is made 64 x 64 of the input's 96 x 64, 16 pixels from its left: cells are 12 pixels."""
    picture = np.zeros((48, 48, 3), np.uint8)
    picture[12:24, 24:36] = (255, 0, 0)
    picture[36:48, 0:12] = (0, 0, 200)
    found = vision.Detector(cells(), threshold=0.6).detect(picture)
    np.testing.assert_allclose(found.boxes, [[24, 12, 36, 24], [0, 36, 12, 48]], atol=1e-4)
    assert found.classes.tolist() == [0, 2]
    assert found.scores[0] > 0.9 > found.scores[1] > 0.7


def test_a_network_sees_what_our_camera_sees() -> None:
    world = mh.World()
    world.add_box("red", [0.2, 0.2, 0.01], position=[0.25, 0.0, 0.0], colour=[1, 0, 0])
    view = mh.Camera.orthographic(96, 64, 1.0).look_at([0, 0, 1], [0, 0, 0], up=[0, 1, 0])
    picture = world.render(view, look=mh.Look(shadows=False, sun=0, ambient=1, horizon=[0, 0, 0], zenith=[0, 0, 0]))
    found = vision.Detector(cells(), threshold=0.3).detect(picture.colour)
    link = [link.name for link in world.model.links].index("red")
    left, upper, right, lower = vision.things(picture.segmentation)[link]
    assert set(found.classes.tolist()) == {0}
    middles = (found.boxes[:, :2] + found.boxes[:, 2:]) / 2
    assert ((middles > [left - 8, upper - 8]) & (middles < [right + 8, lower + 8])).all()


def test_of_boxes_that_share_most_of_their_place_the_surest_stays() -> None:
    boxes = np.array([[0, 0, 10, 10], [1, 0, 11, 10], [0, 0, 10, 10], [30, 30, 40, 40], [0, 0, 5, 10]], np.float32)
    scores = np.array([0.8, 0.9, 0.7, 0.5, 0.1], np.float32)
    classes = np.array([0, 0, 1, 0, 0], np.int64)
    parts = {"boxes": (boxes, FLOAT), "scores": (scores, FLOAT), "labels": (classes, INT64)}
    nodes = [helper.make_node("Identity", [f"{name}_"], [name]) for name in parts]
    made = network(
        nodes, [(name, kind) for name, (_, kind) in parts.items()],
        {f"{name}_": array for name, (array, _) in parts.items()}, ("height", "width"),
    )  # fmt: skip
    picture = np.zeros((50, 50, 3), np.uint8)
    found = vision.Detector(made, size=(50, 50)).detect(picture)
    np.testing.assert_array_equal(found.boxes, boxes[[1, 2, 3]])
    assert found.classes.tolist() == [0, 1, 0]
    assert len(vision.Detector(made, size=(50, 50), overlap=1.0, threshold=0.0).detect(picture).scores) == 5
    own = vision.Detector(made, size=(50, 50), decode=lambda outputs: (outputs[0][:1], outputs[1][:1], [7]))
    assert own.detect(picture).classes.tolist() == [7]
    with pytest.raises(ValueError, match="size open"):
        vision.Detector(made)


def test_what_is_no_such_network_or_picture_is_refused() -> None:
    one = helper.make_node("ReduceMean", ["picture"], ["mean"], keepdims=0)
    strange = vision.Detector(network([one], [("mean", FLOAT)], {}, (8, 8)))
    with pytest.raises(ValueError, match=r"float32\[\] mean is not known; give decode"):
        strange.detect(np.zeros((8, 8, 3), np.uint8))
    for picture in (np.zeros((8, 8, 3)), np.zeros((8, 8), np.uint8), np.zeros((0, 8, 3), np.uint8)):
        with pytest.raises(ValueError, match="the picture is"):
            strange.detect(picture)
    short = vision.Detector(cells(), decode=lambda outputs: (np.zeros((2, 4)), np.zeros(3), np.zeros(3)))
    with pytest.raises(ValueError, match="decode gave"):
        short.detect(np.zeros((8, 8, 3), np.uint8))
    with pytest.raises(ValueError, match="threshold"):
        vision.Detector(cells(), threshold=25)


def test_things_are_boxes_of_numbers() -> None:
    seen = np.full((6, 8), -1)
    seen[1:3, 2:5] = 4
    seen[5, 7] = 0
    assert vision.things(seen) == {0: (7, 5, 8, 6), 4: (2, 1, 5, 3)}
    assert vision.things(np.zeros((0, 5), int)) == {}
    with pytest.raises(ValueError, match="segmentation is float64"):
        vision.things(np.zeros((2, 2)))


def test_files_that_are_no_networks_are_told(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"there is no file '.*nowhere.onnx' with a network"):
        vision.Detector(tmp_path / "nowhere.onnx")
    (tmp_path / "text.onnx").write_text("no network")
    with pytest.raises(ValueError, match=r"text.onnx' is no ONNX model"):
        vision.Detector(tmp_path / "text.onnx")
    with pytest.raises(ValueError, match=r"size is \(64, 64\); the network's input is fixed at \(96, 64\)"):
        vision.Detector(cells(), size=(64, 64))
