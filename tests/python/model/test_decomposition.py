"""Concave things that move: a cup holds a ball, a peg enters a hole."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import manyhands as mh

pytest.importorskip("coacd")

Array = NDArray[np.float64]
HALF, HOLE, HEIGHT = 0.04, 0.0105, 0.04  # [m]


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "manyhands" / "convex"


def block_with_a_hole() -> tuple[Array, NDArray[np.int32]]:
    """A square block with a square hole all through it."""
    ring = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    vertices = [(*(size * corner), z) for z in (0, HEIGHT) for size in (HALF, HOLE) for corner in ring]
    faces: list[tuple[int, int, int]] = []
    for k in range(4):
        n = (k + 1) % 4
        for a, b, c, d in (
            (k, n, 8 + n, 8 + k), (4 + n, 4 + k, 12 + k, 12 + n), (8 + k, 8 + n, 12 + n, 12 + k), (n, k, 4 + k, 4 + n),
        ):  # fmt: skip
            faces += [(a, b, c), (a, c, d)]
    return np.array(vertices), np.array(faces, np.int32)


def cup(sides: int = 16) -> tuple[Array, NDArray[np.int32]]:
    """Turned about z: outside, rim, inside, each a ring; the middles of the bottoms last."""
    rings = [(0.04, 0.0), (0.04, 0.1), (0.034, 0.1), (0.034, 0.006)]
    angles = np.arange(sides) * 2 * np.pi / sides
    vertices = [(r * np.cos(a), r * np.sin(a), z) for r, z in rings for a in angles]
    vertices += [(0, 0, 0.0), (0, 0, 0.006)]
    faces: list[tuple[int, int, int]] = []
    for k in range(sides):
        n = (k + 1) % sides
        for ring in range(3):
            a, b = ring * sides + k, ring * sides + n
            faces += [(a, b, b + sides), (a, b + sides, a + sides)]
        faces += [(4 * sides, n, k), (4 * sides + 1, 3 * sides + k, 3 * sides + n)]
    return np.array(vertices), np.array(faces, np.int32)


def body_of(mesh: tuple[Array, NDArray[np.int32]]) -> mh.Model:
    builder = mh.ModelBuilder("thing")
    builder.add_link("thing", mass=0.5, inertia=np.diag([1e-3, 1e-3, 1e-3]))
    builder.add_joint("free", "floating", "world", "thing")
    builder.add_geom("thing", "mesh", mesh=builder.add_mesh_arrays(mesh[0].astype(np.float32), mesh[1]))
    return mh.decompose_model(builder.build())


def test_a_cup_that_moves_holds_a_ball() -> None:
    world = mh.World(time_step=0.002)
    world.add_plane("ground")
    world.add(body_of(cup()), name="cup")
    world.add_sphere("ball", radius=0.02, mass=0.05, position=(0, 0, 0.06))
    world.step(1000)
    ball, thing = world.body_pose("ball")[0], world.body_pose("cup/thing")[0]
    assert ball[2] - thing[2] == pytest.approx(0.026, abs=2e-3)  # on the bottom, 6 mm thick
    assert np.hypot(*(ball - thing)[:2]) < 0.016


def test_a_peg_enters_a_hole_with_half_a_millimetre_of_clearance() -> None:
    world = mh.World(time_step=0.001)
    world.add_plane("ground")
    world.add(body_of(block_with_a_hole()), name="block")
    world.add_box("peg", size=(0.01, 0.01, 0.03), mass=0.1, position=(0, 0, 0.08))
    world.step(1500)
    assert world.body_pose("peg")[0][2] == pytest.approx(0.03, abs=1e-3)  # it stands on the ground


def test_results_are_kept_and_mended(cache: Path) -> None:
    mesh = block_with_a_hole()
    first = mh.decompose(mesh)
    (kept,) = cache.iterdir()
    kept.write_bytes(b"damaged")
    again = mh.decompose(mesh)
    assert len(first) == len(again) > 3
    assert kept.stat().st_size > 100
    for (v, t), (w, u) in zip(again, mh.decompose(mesh), strict=True):
        assert np.array_equal(v, w)
        assert np.array_equal(t, u)


def test_what_cannot_be_decomposed() -> None:
    with pytest.raises(ValueError, match="threshold is 0"):
        mh.decompose(block_with_a_hole(), threshold=0)
    with pytest.raises(RuntimeError, match="no such file"):
        mh.decompose("none.stl")
