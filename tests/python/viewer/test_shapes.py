"""How the viewer draws shapes."""

import numpy as np
import pytest
from viewed import panda

from manyhands.viewer import shapes


def volume(surface: shapes.Surface) -> float:
    a, b, c = (surface.vertices[surface.triangles[:, k]].astype(np.float64) for k in range(3))
    return float((np.cross(a, b) * c).sum() / 6)


@pytest.mark.parametrize(
    ("shape", "size", "expected"),
    [
        ("box", [0.1, 0.2, 0.3], 8 * 0.1 * 0.2 * 0.3),
        ("sphere", [0.3, 0, 0], 4 / 3 * np.pi * 0.3**3),
        ("cylinder", [0.2, 0.5, 0], np.pi * 0.2**2 * 1.0),
        ("capsule", [0.2, 0.5, 0], np.pi * 0.2**2 * 1.0 + 4 / 3 * np.pi * 0.2**3),
    ],
)
def test_shapes_enclose_their_volume(shape: str, size: list[float], expected: float) -> None:
    assert volume(shapes.primitive(shape, np.array(size))) == pytest.approx(expected, rel=0.01)


def test_light_passes_smoothly_over_flat_edges_only() -> None:
    # Each corner of a box belongs to three sides; a sphere's points are shared by all triangles about them.
    assert len(shapes.primitive("box", np.ones(3)).vertices) == 24
    sphere = shapes.primitive("sphere", np.array([1.0, 0, 0]))
    assert len(np.unique(sphere.vertices.round(5), axis=0)) == len(sphere.vertices)
    cylinder = shapes.primitive("cylinder", np.array([0.5, 1.0, 0]))
    rim = cylinder.vertices[np.isclose(cylinder.vertices[:, 2], 1.0) & (np.hypot(*cylinder.vertices.T[:2]) > 0.4)]
    assert len(rim) == 2 * len(np.unique(rim.round(5), axis=0))  # once for the cap, once for the side


def test_meshes_keep_their_triangles() -> None:
    world = panda()
    for mesh in world.model.meshes[:6]:
        surface = shapes.creased(mesh.vertices, mesh.triangles)
        before, after = mesh.vertices[mesh.triangles], surface.vertices[surface.triangles]
        assert len(after) <= len(before)
        assert volume(surface) == pytest.approx(volume(shapes.Surface(mesh.vertices, mesh.triangles)), rel=1e-5)
