"""The models in assets/bullet: as their generator writes them, read by our loaders, and beside PyBullet's."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import robot_files  # puts tools/ on the path
from robots.bullet_data.all_files import bullet_files

import manyhands as mh

BULLET = robot_files.ASSETS / "bullet"
MODELS = sorted(p.relative_to(BULLET).as_posix() for p in BULLET.rglob("*") if p.suffix in (".urdf", ".sdf", ".xml"))
MESHES = sorted(p.relative_to(BULLET).as_posix() for p in BULLET.rglob("*.obj"))
SHEETS = ("plane", "terrain", "roboschool", "cloth")  # meshes that are no solids


def test_generator_reproduces_the_committed_files() -> None:
    files = bullet_files()
    kept = {p.relative_to(BULLET).as_posix() for p in BULLET.rglob("*") if p.is_file()}
    assert kept == set(files)
    different = [name for name, data in files.items() if (BULLET / name).read_bytes() != data]
    assert not different, "run tools/make_bullet_data.py"
    assert sum(map(len, files.values())) < 1_500_000


@pytest.mark.parametrize("name", MODELS)
def test_our_loaders_read_it_without_serious_notes(name: str) -> None:
    world = mh.World.from_file(BULLET / name)
    assert not [str(note) for note in world.report.notes if note.serious]
    for _ in range(10):
        world.step()
    assert np.isfinite(world.q).all() and np.isfinite(world.v).all()


@pytest.mark.parametrize("name", [m for m in MODELS if m.endswith(".xml")])
def test_mujoco_reads_the_same_joints(name: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    theirs = mujoco.MjModel.from_xml_path(str(BULLET / name))
    ours, _ = mh.load_mjcf(BULLET / name)
    assert (ours.nq, ours.nv, ours.nu) == (theirs.nq, theirs.nv, theirs.nu)
    names = [mujoco.mj_id2name(theirs, mujoco.mjtObj.mjOBJ_JOINT, k) for k in range(theirs.njnt)]
    assert set(names) <= {joint.name for joint in ours.joints}


def test_a_mug_holds_a_ball_and_a_tray_a_cube() -> None:
    world = mh.World()
    world.add(BULLET / "objects" / "mug.urdf")
    world.add(BULLET / "tray" / "traybox.urdf", position=[1.0, 0.0, 0.0], name="tray")
    world.add_sphere("ball", 0.02, position=[0.005, 0.004, 0.15], mass=0.02)
    world.add_box("cube", [0.025, 0.025, 0.025], position=[1.1, 0.1, 0.15], mass=0.1)
    for _ in range(1000):
        world.step()
    ball, cube = (world.body_pose(name)[0] for name in ("ball", "cube"))
    assert ball[2] == pytest.approx(0.026, abs=2e-3) and np.hypot(ball[0], ball[1]) < 0.0225
    assert cube[2] == pytest.approx(0.040, abs=2e-3) and np.abs(cube[:2] - [1.0, 0.0]).max() < 0.2


@pytest.mark.parametrize("name", [m for m in MESHES if not m.startswith(SHEETS)])
def test_solids_are_closed_and_face_outwards(name: str) -> None:
    vertices, faces = robot_files.obj_arrays(BULLET / name)
    edges = Counter((int(f[i]), int(f[(i + 1) % 3])) for f in faces for i in range(3))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    assert (a * np.cross(b, c)).sum() / 6 > 0


@pytest.fixture(scope="module")
def bullet() -> Iterator[tuple]:
    """PyBullet, connected, and its data folder."""
    pybullet = pytest.importorskip("pybullet")
    data = pytest.importorskip("pybullet_data")
    client = pybullet.connect(pybullet.DIRECT)
    yield pybullet, Path(data.getDataPath())
    pybullet.disconnect(client)


def load_in_bullet(pybullet, path: Path) -> tuple[int, ...]:
    if path.suffix == ".sdf":
        return pybullet.loadSDF(str(path))
    if path.suffix == ".xml":
        return pybullet.loadMJCF(str(path))
    return (pybullet.loadURDF(str(path)),)


@pytest.mark.parametrize("name", MODELS)
def test_bullet_reads_it_as_its_own(bullet, name: str, capfd: pytest.CaptureFixture[str]) -> None:
    pybullet, data = bullet
    pybullet.resetSimulation()
    ours = load_in_bullet(pybullet, BULLET / name)
    assert ours
    if not (data / name).exists():
        return
    try:
        theirs = load_in_bullet(pybullet, data / name)
    except pybullet.error:
        pytest.skip("PyBullet cannot load its own")
    finally:
        capfd.readouterr()
    assert len(ours) == len(theirs)
    for a, b in zip(ours, theirs, strict=True):
        compare_bodies(pybullet, a, b)


def compare_bodies(pybullet, ours: int, theirs: int) -> None:
    """Names, joints, frames and masses of two bodies are the same."""
    assert pybullet.getBodyInfo(ours) == pybullet.getBodyInfo(theirs)
    assert pybullet.getNumJoints(ours) == pybullet.getNumJoints(theirs)
    place = [pybullet.getBasePositionAndOrientation(body) for body in (ours, theirs)]
    np.testing.assert_allclose(place[0][0], place[1][0], atol=1e-6)
    for i in range(-1, pybullet.getNumJoints(ours)):
        a, b = (pybullet.getDynamicsInfo(body, i) for body in (ours, theirs))
        # Mass, and the centre of mass, from which constraints measure.
        assert a[0] == pytest.approx(b[0]), i
        np.testing.assert_allclose(a[3], b[3], atol=1e-6, err_msg=str(i))
    for i in range(pybullet.getNumJoints(ours)):
        a, b = pybullet.getJointInfo(ours, i), pybullet.getJointInfo(theirs, i)
        # Index, name, type, q index, v index, flags; link name; parent.
        assert (a[0], plain(a[1]), *a[2:6], a[12], a[16]) == (b[0], plain(b[1]), *b[2:6], b[12], b[16])
        # Damping, friction, limits, effort, velocity.
        np.testing.assert_allclose(a[6:12], b[6:12], atol=2e-5, err_msg=a[1].decode())
        np.testing.assert_allclose(a[13], b[13], atol=1e-6)
        if a[12] == b"imu_link":
            continue  # the Husky's file leaves its place to a tool that PyBullet has not
        states = [pybullet.getLinkState(body, i, computeForwardKinematics=True) for body in (ours, theirs)]
        np.testing.assert_allclose(states[0][4], states[1][4], atol=2e-5, err_msg=a[12].decode())
        turns = [np.array(state[5]) / np.linalg.norm(state[5]) for state in states]
        assert abs(turns[0] @ turns[1]) == pytest.approx(1.0, abs=1e-9), a[12]


def plain(name: bytes) -> bytes:
    """A joint's name without the numbers that PyBullet counts through a process, of joints that it makes up."""
    return re.sub(rb"^(jointfix)_\d+_\d+$", rb"\1", name)


SOLIDS = [
    "plane.urdf",
    "table/table.urdf",
    "tray/traybox.urdf",
    "cube.urdf",
    "cube_small.urdf",
    "block.urdf",
    "sphere2.urdf",
    "sphere_small.urdf",
    "sphere_1cm.urdf",
    "soccerball.urdf",
    "lego/lego.urdf",
    "jenga/jenga.urdf",
    "domino/domino.urdf",
    "objects/mug.urdf",
    "duck_vhacd.urdf",
    "teddy_vhacd.urdf",
]


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_are_as_large_as_bullets(bullet, name: str) -> None:
    pybullet, data = bullet
    boxes = []
    for folder in (BULLET, data):
        pybullet.resetSimulation()
        boxes.append(np.array(pybullet.getAABB(pybullet.loadURDF(str(folder / name)))))
    size = np.diff(boxes[1], axis=0).max()
    np.testing.assert_allclose(boxes[0], boxes[1], atol=0.1 * size)
