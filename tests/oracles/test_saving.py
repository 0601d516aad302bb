"""Files that are saved are read by MuJoCo, PyBullet and Pinocchio as the robots they were."""

import warnings
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from mujoco_scenes import ALL, SCENES  # noqa: E402

import manyhands as mh  # noqa: E402
from benchmarks.mujoco_map import Scene  # noqa: E402

pytestmark = [
    pytest.mark.filterwarnings("ignore:.*; print the report:UserWarning"),
    pytest.mark.usefixtures("folder_of_its_own"),
]
TOLERANCE = 1e-9
MESH_TOLERANCE = 1e-6  # vertices are float32


every_scene = pytest.mark.parametrize("source", ALL, ids=[s if isinstance(s, str) else s.name for s in ALL])


def loaded(source: str | Path) -> mh.Model:
    try:
        if isinstance(source, str):
            return mh.load_mjcf_string(SCENES[source])[0]
        return mh.load_mjcf(source, allow_outside_package=True)[0]
    except mh.MjcfError as error:
        pytest.skip(str(error))


@every_scene
def test_mjcf_is_read_back_to_the_bit(source: str | Path, tmp_path: Path) -> None:
    model = loaded(source)
    saved = tmp_path / "saved.xml"
    report = mh.save_mjcf(model, saved)
    again, read = mh.load_mjcf(saved)
    assert again.fingerprint == model.fingerprint, str(report)
    assert not any(note.serious for note in read.notes), str(read)
    np.testing.assert_array_equal(again.initial_configuration(), model.initial_configuration())
    assert again.time_step == model.time_step
    assert len(again.geoms) == len(model.geoms)
    for ours, theirs in zip(again.keyframes, model.keyframes, strict=True):
        np.testing.assert_array_equal(ours.q, theirs.q)
        np.testing.assert_array_equal(ours.ctrl, theirs.ctrl)
    assert mh.save_mjcf_string(again)[0] == mh.save_mjcf_string(model)[0]


@every_scene
def test_mujoco_reads_what_is_saved(source: str | Path, tmp_path: Path) -> None:
    model = loaded(source)
    saved = tmp_path / "saved.xml"
    mh.save_mjcf(model, saved)
    if not isinstance(source, str):
        try:
            mujoco.MjModel.from_xml_path(str(source))
        except ValueError as error:
            pytest.skip(f"MuJoCo refuses the original: {error}")
    scene = Scene.of_file(saved)
    theirs, data = scene.mujoco, scene.data
    tolerance = MESH_TOLERANCE if theirs.nmesh else TOLERANCE
    assert (theirs.nq, theirs.nv, theirs.nu) == (model.nq, model.nv, model.nu)
    np.testing.assert_allclose(theirs.opt.gravity, model.gravity, atol=TOLERANCE)
    for i, name in enumerate(scene.names("body", theirs.nbody)):
        np.testing.assert_allclose(theirs.body_mass[i], model.link(name).mass, rtol=TOLERANCE)
    for i, name in enumerate(scene.names("jnt", theirs.njnt)):
        joint = model.joint(name)
        if theirs.jnt_limited[i] and np.isfinite([joint.lower, joint.upper]).all():
            np.testing.assert_allclose(theirs.jnt_range[i], [joint.lower, joint.upper], atol=TOLERANCE)
    rng = np.random.default_rng(0)
    for _ in range(3):
        data.qpos = scene.random_qpos(rng)
        data.qvel = 0
        mujoco.mj_forward(theirs, data)
        q, G = scene.configuration(data.qpos), scene.velocity_map(data.qpos)
        for name, position in zip(scene.names("body", theirs.nbody), data.xpos, strict=True):
            ours = mh.dynamics.frame_pose(model, q, name)[0]
            np.testing.assert_allclose(ours, position, atol=tolerance * max(1, np.abs(position).max()))
        if not theirs.nv:
            continue
        mass = np.zeros((theirs.nv, theirs.nv))
        mujoco.mj_fullM(theirs, data, mass)
        ours = G.T @ mh.dynamics.crba(model, q) @ G
        np.testing.assert_allclose(ours, mass, atol=tolerance * max(1, np.abs(mass).max()))


@pytest.mark.parametrize("robot", ["panda/panda.urdf", "arm6/arm6.urdf"])
def test_robots_through_mjcf_and_urdf(robot: str, tmp_path: Path) -> None:
    model = mh.load_urdf(mh.asset_path(robot))[0]
    mh.save_mjcf(model, tmp_path / "robot.xml")
    mh.save_urdf(model, tmp_path / "robot.urdf")
    back = mh.load_urdf(tmp_path / "robot.urdf")[0]
    assert back.fingerprint == model.fingerprint
    theirs = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    assert (theirs.nq, theirs.nv) == (model.nq, model.nv)
    rng = np.random.default_rng(1)
    data = mujoco.MjData(theirs)
    for _ in range(5):
        data.qpos = q = rng.uniform(-1, 1, model.nq)
        mujoco.mj_kinematics(theirs, data)
        for i in range(1, theirs.nbody):
            name = theirs.body(i).name
            np.testing.assert_allclose(data.xpos[i], mh.dynamics.frame_pose(model, q, name)[0], atol=TOLERANCE)


@pytest.mark.parametrize("robot", ["panda/panda.urdf", "arm6/arm6.urdf"])
def test_pinocchio_and_pybullet_read_saved_urdf(robot: str, tmp_path: Path) -> None:
    pin = pytest.importorskip("pinocchio")
    pybullet = pytest.importorskip("pybullet")
    model = mh.load_urdf(mh.asset_path(robot))[0]
    saved = tmp_path / "robot.urdf"
    mh.save_urdf(model, saved)
    theirs = pin.buildModelFromUrdf(str(saved))
    data = theirs.createData()
    assert theirs.nq == model.nq
    q = np.random.default_rng(2).uniform(-0.02, 0.04, model.nq)
    pin.framesForwardKinematics(theirs, data, q)
    for link in model.links[1:]:
        pose = data.oMf[theirs.getFrameId(link.name)]
        np.testing.assert_allclose(pose.translation, mh.dynamics.frame_pose(model, q, link.name)[0], atol=TOLERANCE)
    ours = mh.dynamics.crba(model, q)
    crba = pin.crba(theirs, data, q)
    np.testing.assert_allclose(np.triu(crba), np.triu(ours), atol=TOLERANCE)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body = pybullet.loadURDF(str(saved), useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        by_name = {joint.name: joint for joint in model.joints}
        for i in range(pybullet.getNumJoints(body)):
            info = pybullet.getJointInfo(body, i)
            name, child = info[1].decode(), info[12].decode()
            mass = pybullet.getDynamicsInfo(body, i)[0]
            np.testing.assert_allclose(mass, model.link(child).mass, atol=TOLERANCE)
            if by_name[name].type in ("revolute", "prismatic"):
                np.testing.assert_allclose(info[8:10], [by_name[name].lower, by_name[name].upper], atol=TOLERANCE)
    finally:
        pybullet.disconnect(client)


def test_what_urdf_cannot_say_is_an_error(tmp_path: Path) -> None:
    model = mh.load_mjcf_string(SCENES["equalities"])[0]
    target = tmp_path / "robot.urdf"
    with pytest.raises(mh.SaveError, match="allow_loss"):
        mh.save_urdf(model, target)
    assert not target.exists()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        report = mh.save_urdf(model, target, allow_loss=True)
    assert any(note.serious for note in report.notes)
    assert mh.load_urdf(target)[0].nq == model.nq
