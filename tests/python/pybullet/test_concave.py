"""Concave meshes that move collide by convex parts."""

from collections.abc import Iterator
from pathlib import Path

import pytest

import manyhands.pybullet as p

pytest.importorskip("coacd")


@pytest.fixture(autouse=True)
def client(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    identity = p.connect(p.DIRECT)
    p.setGravity(0, 0, -9.81)
    yield identity
    p.disconnect()


def channel(path: Path) -> Path:
    """A gutter along x: a floor of 20 mm and two walls of 50 mm, 60 mm apart, as one mesh."""
    outline = [
        (-0.05, 0),
        (0.05, 0),
        (0.05, 0.07),
        (0.03, 0.07),
        (0.03, 0.02),
        (-0.03, 0.02),
        (-0.03, 0.07),
        (-0.05, 0.07),
    ]
    lines = [f"v {x} {y} {z}" for x in (-0.1, 0.1) for y, z in outline]
    n = len(outline)
    for i in range(n):
        k = (i + 1) % n
        a, b, c, d = i + 1, k + 1, n + k + 1, n + i + 1
        lines += [f"f {a} {d} {c}", f"f {a} {c} {b}"]
    for a, b, c, d in ((0, 1, 4, 5), (1, 2, 3, 4), (5, 6, 7, 0)):
        near = [a + 1, b + 1, c + 1, d + 1]
        far = [n + i for i in near]
        lines += [f"f {near[0]} {near[1]} {near[2]}", f"f {near[0]} {near[2]} {near[3]}"]
        lines += [f"f {far[0]} {far[2]} {far[1]}", f"f {far[0]} {far[3]} {far[2]}"]
    path.write_text("\n".join(lines) + "\n")
    return path


def ball_in(gutter: int) -> float:
    """How high a ball of 20 mm comes to rest above the origin of the gutter, into which it falls."""
    sphere = p.createMultiBody(0.05, p.createCollisionShape(p.GEOM_SPHERE, radius=0.02), basePosition=[0, 0, 0.12])
    for _ in range(480):
        p.stepSimulation()
    ball, base = p.getBasePositionAndOrientation(sphere)[0], p.getBasePositionAndOrientation(gutter)[0]
    return ball[2] - base[2]


@pytest.mark.parametrize("concave", [True, False])
def test_a_gutter_that_moves_holds_a_ball_where_its_hull_does_not(tmp_path: Path, concave: bool) -> None:
    p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE))
    shape = p.createCollisionShape(
        p.GEOM_MESH, fileName=str(channel(tmp_path / "gutter.obj")),
        flags=p.GEOM_FORCE_CONCAVE_TRIMESH if concave else 0,
    )  # fmt: skip
    height = ball_in(p.createMultiBody(1.0, shape))
    assert height == pytest.approx(0.04 if concave else 0.09, abs=1e-3)
    (record,) = p.getCollisionShapeData(1, -1)
    assert record[2] == p.GEOM_MESH


def test_a_concave_mesh_of_a_file_is_split_too(tmp_path: Path) -> None:
    channel(tmp_path / "gutter.obj")
    (tmp_path / "gutter.urdf").write_text("""<robot name="gutter"><link name="gutter">
      <inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision concave="yes"><geometry><mesh filename="gutter.obj"/></geometry></collision>
    </link></robot>""")
    p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE))
    assert ball_in(p.loadURDF(str(tmp_path / "gutter.urdf"))) == pytest.approx(0.04, abs=1e-3)


def test_vhacd_writes_the_parts(tmp_path: Path) -> None:
    source = channel(tmp_path / "gutter.obj")
    p.vhacd(str(source), str(tmp_path / "parts.obj"), str(tmp_path / "log.txt"), resolution=1000)
    text = (tmp_path / "parts.obj").read_text()
    assert text.count("\no part_") + text.startswith("o part_") >= 3
    assert "convex parts" in (tmp_path / "log.txt").read_text()
    with pytest.raises(Exception, match="no such file"):
        p.vhacd("none.obj", str(tmp_path / "parts.obj"), "log.txt")
