"""manyhands.collision: its answers where they are plain, its shapes and rows, and what it says to nonsense.
tests/oracles/test_coal.py proves the numbers."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from manyhands import collision as c

HERE = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])
CUBE = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])


def at(x: float, y: float, z: float) -> c.Pose:
    return [x, y, z], [0.0, 0.0, 0.0, 1.0]


def every_shape() -> list[c.Shape]:
    return [
        c.Sphere(0.1),
        c.Capsule(0.1, 0.2),
        c.Cylinder(0.1, 0.2),
        c.Box((0.1, 0.2, 0.3)),
        c.Convex(CUBE),
        c.Plane(),
        c.Mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]]),
        c.HeightField(np.zeros((3, 4)), 1.0, 1.0),
    ]


SOLIDS, GROUNDS = range(5), range(5, 8)  # of every_shape


def test_shapes_say_what_they_are() -> None:
    types = [shape.type for shape in every_shape()]
    assert types == ["sphere", "capsule", "cylinder", "box", "convex", "plane", "mesh", "height_field"]
    np.testing.assert_array_equal(c.Capsule(0.1, 0.2).size, [0.1, 0.2, 0.0])
    assert repr(c.Box((1, 2, 3))) == "<collision shape: box>"
    assert all(isinstance(shape, c.Shape) for shape in every_shape())


def test_distance_of_two_spheres() -> None:
    d = c.signed_distance(c.Sphere(0.1), HERE, c.Sphere(0.2), at(0.5, 0.0, 0.0))
    assert d.phi == pytest.approx(0.2, abs=1e-15)
    np.testing.assert_allclose(d.point_a, [0.1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(d.point_b, [0.3, 0, 0], atol=1e-15)
    np.testing.assert_allclose(d.normal, [1, 0, 0], atol=1e-15)


def test_a_turned_box_reaches_its_edge() -> None:
    eighth = [0.0, 0.0, np.sin(np.pi / 8), np.cos(np.pi / 8)]
    d = c.signed_distance(c.Box((0.1, 0.1, 0.1)), ([0, 0, 0], eighth), c.Sphere(0.05), at(0.5, 0.0, 0.0))
    assert d.phi == pytest.approx(0.5 - 0.05 - 0.1 * np.sqrt(2), abs=1e-14)


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("solid", SOLIDS)
def test_every_solid_knows_its_height_above_every_ground(solid: int, ground: int) -> None:
    require_height(every_shape()[solid], every_shape()[ground])


def require_height(solid: c.Shape, ground: c.Shape) -> None:
    below = {"sphere": 0.1, "capsule": 0.3, "cylinder": 0.2, "box": 0.3, "convex": 0.1}[solid.type]
    gap = 0.01
    d = c.signed_distance(solid, at(0, 0, below + gap), ground, HERE)
    assert d.phi == pytest.approx(gap, abs=1e-9)
    np.testing.assert_allclose(d.normal, [0, 0, -1], atol=1e-9)
    for dtype in (np.float64, np.float32):
        found = c.contact_points(solid, at(0, 0, below + gap), ground, HERE, 0.02, dtype=dtype)
        mirror = c.contact_points(ground, HERE, solid, at(0, 0, below + gap), 0.02, dtype=dtype)
        assert found.points.dtype == found.distances.dtype == found.normal.dtype == dtype
        assert 1 <= len(found.points) <= 4
        np.testing.assert_allclose(found.normal, np.tile([0, 0, -1], (len(found.points), 1)), atol=1e-6)
        np.testing.assert_allclose(found.points[:, 2], gap / 2, atol=1e-6)
        np.testing.assert_allclose(found.distances, gap, atol=1e-6)
        np.testing.assert_allclose(mirror.normal, -found.normal, atol=1e-6)
        assert len(c.contact_points(solid, at(0, 0, below + gap), ground, HERE, 0.009, dtype=dtype).points) == 0


def test_a_cube_stands_on_its_four_corners() -> None:
    for cube in (c.Box((0.1, 0.1, 0.1)), c.Convex(CUBE)):
        found = c.contact_points(cube, at(0, 0, 0.099), c.Plane(), HERE)
        corners = sorted(map(tuple, np.sign(found.points[:, :2]).astype(int).tolist()))
        assert corners == [(-1, -1), (-1, 1), (1, -1), (1, 1)]
        np.testing.assert_allclose(np.abs(found.points[:, :2]), 0.1, atol=1e-12)
        np.testing.assert_allclose(found.distances, -0.001, atol=1e-12)


@pytest.mark.parametrize("second", range(8))
@pytest.mark.parametrize("first", range(8))
def test_rows_are_single_calls(first: int, second: int) -> None:
    a, b = every_shape()[first], every_shape()[second]
    rng = np.random.default_rng(0)
    p, q = rng.normal(size=(7, 3)), rng.normal(size=(7, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    many = c.signed_distance(a, (p, q), b, HERE)
    assert many.phi.shape == (7,) and many.point_a.shape == many.point_b.shape == many.normal.shape == (7, 3)
    alike = c.signed_distance([a] * 7, (p, q), [b], HERE)
    for i in range(7):
        single = c.signed_distance(a, (p[i], q[i]), b, HERE)
        assert np.shape(single.phi) == () and single.normal.shape == (3,)
        for rows, other, one in zip(many, alike, single, strict=True):
            np.testing.assert_array_equal(rows[i], one)
            np.testing.assert_array_equal(other[i], one)


def test_no_rows_give_no_rows() -> None:
    d = c.signed_distance([], (np.zeros((0, 3)), np.zeros((0, 4))), c.Sphere(1.0), HERE)
    assert d.phi.shape == (0,) and d.normal.shape == (0, 3)


@pytest.mark.parametrize("which", range(8))
def test_a_ray_from_above(which: int) -> None:
    shape = every_shape()[which]
    top = {"sphere": 0.1, "capsule": 0.3, "cylinder": 0.2, "box": 0.3, "convex": 0.1}.get(shape.type, 0.0)
    hit = c.ray_cast(shape, HERE, [0.01, 0.02, 2.0], [0, 0, -3])
    on_top = top - (0.1 - np.sqrt(0.01 - 0.0005) if shape.type in ("sphere", "capsule") else 0)
    assert hit.distance == pytest.approx(2.0 - on_top, abs=1e-12)
    np.testing.assert_allclose(hit.point, [0.01, 0.02, on_top], atol=1e-12)
    assert hit.normal[2] > 0.9
    short = c.ray_cast(shape, HERE, [[0.01, 0.02, 2.0], [0.01, 0.02, 2.0]], [[0, 0, -1], [0, 0, 1]], 1.0)
    assert np.isinf(short.distance).all() and np.isnan(short.point).all() and np.isnan(short.normal).all()


def test_a_ray_from_within_meets_at_once() -> None:
    hit = c.ray_cast(c.Sphere(1.0), HERE, [0.1, 0, 0], [0, 2, 0])
    assert hit.distance == 0
    np.testing.assert_array_equal(hit.normal, [0, -1, 0])


NONSENSE: dict[str, tuple[Callable[[], Any], str]] = {
    "radius": (lambda: c.Sphere(0.0), "sphere's radius is 0.*expected a finite length above 0"),
    "NaN": (lambda: c.Capsule(0.1, np.nan), "capsule's half length is nan"),
    "infinite": (lambda: c.Cylinder(np.inf, 0.1), "cylinder's radius is inf"),
    "two extents": (lambda: c.Box([1, 2]), r"half_extents have shape \(2,\); expected \(3,\)"),
    "flat box": (lambda: c.Box([1, 2, 0]), "half extent"),
    "words": (lambda: c.Box("box"), "not an array of real numbers"),
    "one point": (lambda: c.Convex([[0, 0, 0]]), "one point"),
    "no hull": (lambda: c.Convex(np.zeros((0, 3))), "convex hull"),
    "columns": (lambda: c.Convex(np.zeros((5, 2))), r"vertices has shape \(5, 2\)"),
    "index": (lambda: c.Mesh(CUBE, [[0, 1, 8]]), "names vertex 8 of 8"),
    "negative": (lambda: c.Mesh(CUBE, [[0, 1, -1]]), "names no vertex"),
    "corners": (lambda: c.Mesh(CUBE, [[0, 1]]), "2 corners"),
    "floats": (lambda: c.Mesh(CUBE, [[0.0, 1.0, 2.0]]), "whole numbers"),
    "no triangle": (lambda: c.Mesh(CUBE, [[0, 0, 1]]), "no triangle has an area"),
    "one row": (lambda: c.HeightField([[0.0, 1.0]], 1.0, 1.0), "2 x 2 or more"),
    "spacing": (lambda: c.HeightField(np.zeros((2, 2)), 0.0, 1.0), "spacings above 0"),
    "heights": (lambda: c.HeightField([[0, np.nan], [0, 0]], 1.0, 1.0), "finite"),
    "pose": (lambda: c.signed_distance(c.Plane(), None, c.Plane(), HERE), "pose_a must be a pair"),  # type: ignore
    "position": (lambda: c.signed_distance(c.Plane(), ([0, 0], HERE[1]), c.Plane(), HERE), "pose_a's position has"),
    "quaternion": (lambda: c.signed_distance(c.Plane(), HERE, c.Plane(), ([0, 0, 0], [0, 0, 0, 2])), "has length 2"),
    "rows": (
        lambda: c.signed_distance([c.Sphere(1)] * 3, (np.zeros((2, 3)), [[0, 0, 0, 1]] * 2), c.Plane(), HERE),
        "pose_a has 2 rows, others 3",
    ),
    "shape": (lambda: c.signed_distance([1.0], HERE, c.Plane(), HERE), "a holds 1.0"),  # type: ignore
    "grounds": (lambda: c.contact_points(c.Plane(), HERE, c.Plane(), HERE), "make one of them a solid"),
    "margin": (lambda: c.contact_points(c.Sphere(1), HERE, c.Plane(), HERE, -1.0), "margin is -1"),
    "dtype": (lambda: c.contact_points(c.Sphere(1), HERE, c.Plane(), HERE, dtype=int), "dtype is int64"),
    "many": (
        lambda: c.contact_points(c.Sphere(1), (np.zeros((2, 3)), [[0, 0, 0, 1]] * 2), c.Plane(), HERE),
        "call it for each row",
    ),
    "direction": (lambda: c.ray_cast(c.Plane(), HERE, [0, 0, 1], [0, 0, 0]), "direction has a length of 0"),
    "distance": (lambda: c.ray_cast(c.Plane(), HERE, [0, 0, 1], [0, 0, 1], np.nan), "max_distance is nan"),
}


@pytest.mark.parametrize("name", NONSENSE)
def test_nonsense_is_refused_with_reasons(name: str) -> None:
    call, message = NONSENSE[name]
    with pytest.raises(ValueError, match=message):
        call()


numbers = st.floats(width=64) | st.floats(-2, 2)
vectors = st.lists(numbers, max_size=5)


@settings(max_examples=300, deadline=None)
@given(
    kind=st.sampled_from(["sphere", "capsule", "cylinder", "box"]),
    x=numbers,
    y=numbers,
    z=numbers,
    p=vectors,
    q=vectors,
)
def test_any_numbers_give_an_answer_or_a_reason(kind: str, x: float, y: float, z: float, p: list, q: list) -> None:
    make = {
        "sphere": lambda: c.Sphere(x),
        "capsule": lambda: c.Capsule(x, y),
        "cylinder": lambda: c.Cylinder(x, y),
        "box": lambda: c.Box((x, y, z)),
    }
    if len(q) == 4 and 1e-9 < max(map(abs, q)) < 1e9:
        q = (np.array(q) / np.linalg.norm(q)).tolist()
    pose = (p, q)
    try:
        shape = make[kind]()
        d = c.signed_distance(shape, pose, c.Box((0.1, 0.2, 0.3)), HERE)
        c.contact_points(shape, pose, c.Box((0.1, 0.2, 0.3)), HERE, 0.01, dtype=np.float32)
        c.ray_cast(shape, pose, p, p)
    except ValueError as error:
        assert len(str(error)) > 10
        return
    assert not np.isnan(d.phi)
