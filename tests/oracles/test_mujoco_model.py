"""Scenes loaded from MJCF equal MuJoCo's: masses, poses, mass matrices, limits, actuators, geoms and filters."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from mujoco_scenes import ALL, FROM_MESHES, OWN, SCENES  # noqa: E402
from PIL import Image  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

import manyhands as mh  # noqa: E402
from benchmarks.mujoco_map import XYZW, Array, Scene, rotation  # noqa: E402

# Files as they are in the wild: some ask for parts that cannot be.
pytestmark = [
    pytest.mark.filterwarnings("ignore:.*; print the report:UserWarning"),
    pytest.mark.usefixtures("folder_of_its_own"),
]
TOLERANCE = 1e-9
EQUALITIES = ("point", "fixed", "joint")  # by MuJoCo's number
MESH_TOLERANCE = 1e-6  # vertices are float32


def scene_of(source: str | Path) -> Scene:
    if isinstance(source, str):
        return Scene.of_string(SCENES[source])
    try:
        mujoco.MjModel.from_xml_path(str(source))
    except ValueError as error:
        pytest.skip(f"MuJoCo: {error}")
    return Scene.of_file(source)


every_scene = pytest.mark.parametrize("source", ALL, ids=[s if isinstance(s, str) else s.name for s in ALL])


def assert_close(ours: Array | float, theirs: Array | float, what: str, tolerance: float = TOLERANCE) -> None:
    scale = max(float(np.max(np.abs(theirs), initial=0.0)), 1.0)
    away = float(np.max(np.abs(np.asarray(ours) - theirs), initial=0.0))
    assert away <= tolerance * scale, f"{what}: {away} away from {theirs}"


def tolerance_of(scene: Scene) -> float:
    return MESH_TOLERANCE if scene.mujoco.nmesh else TOLERANCE


@every_scene
def test_masses(source: str | Path) -> None:
    scene = scene_of(source)
    model, tolerance = scene.mujoco, tolerance_of(scene)
    for i, name in enumerate(scene.names("body", model.nbody)):
        link = scene.ours.link(name)
        assert_close(link.mass, model.body_mass[i], f"{name}: mass", tolerance)
        if i > 0 and link.mass > 0:
            assert_close(link.com, model.body_ipos[i], f"{name}: com", tolerance)
        largest = max(float(np.max(model.body_inertia[i])), 1e-12)
        assert_close(link.inertia / largest, scene.body_inertia(i) / largest, f"{name}: inertia", tolerance)


@every_scene
def test_poses_and_mass_matrices(source: str | Path) -> None:
    scene = scene_of(source)
    model, data, tolerance = scene.mujoco, scene.data, tolerance_of(scene)
    assert scene.ours.nq == model.nq
    assert scene.ours.nv == model.nv
    rng = np.random.default_rng(0)
    bodies, sites = scene.names("body", model.nbody), scene.names("site", model.nsite)
    for _ in range(5):
        data.qpos = scene.random_qpos(rng)
        data.qvel = 0
        mujoco.mj_forward(model, data)
        q, G = scene.configuration(data.qpos), scene.velocity_map(data.qpos)
        for name, position, quaternion in zip(bodies, data.xpos, data.xquat, strict=True):
            ours = mh.dynamics.frame_pose(scene.ours, q, name)
            assert_close(ours[0], position, f"{name}: position")
            assert_close(Rotation.from_quat(ours[1]).as_matrix(), rotation(quaternion), f"{name}: rotation")
        for name, position, matrix in zip(sites, data.site_xpos, data.site_xmat, strict=True):
            name = name + "_site" if name in bodies else name
            ours = mh.dynamics.frame_pose(scene.ours, q, name)
            assert_close(ours[0], position, f"{name}: position")
            assert_close(Rotation.from_quat(ours[1]).as_matrix(), matrix.reshape(3, 3), f"{name}: rotation")
        if model.nv == 0:
            continue
        M = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        assert_close(G.T @ mh.dynamics.crba(scene.ours, q) @ G, M, "mass matrix", tolerance)
        zero = np.zeros(model.nv)
        assert_close(G.T @ mh.dynamics.rnea(scene.ours, q, zero, zero), data.qfrc_bias, "gravity", tolerance)


@every_scene
def test_joints(source: str | Path) -> None:
    scene = scene_of(source)
    model = scene.mujoco
    for i, name in enumerate(scene.names("joint", model.njnt)):
        joint = scene.ours.joint(name)
        assert (joint.iq, joint.iv) == (model.jnt_qposadr[i], model.jnt_dofadr[i])
        if joint.nq == 1:
            expected = model.jnt_range[i] if model.jnt_limited[i] else [-np.inf, np.inf]
            assert np.allclose([joint.lower, joint.upper], expected, rtol=0, atol=1e-12), name
        effort = model.jnt_actfrcrange[i, 1] if model.jnt_actfrclimited[i] else np.inf
        assert joint.effort == effort
        assert joint.damping == model.dof_damping[joint.iv]
        assert joint.armature == model.dof_armature[joint.iv]
        assert joint.friction == model.dof_frictionloss[joint.iv]
    assert_close(scene.ours.initial_configuration(), scene.configuration(model.qpos0), "qpos0")
    off = model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
    assert_close(scene.ours.gravity, np.zeros(3) if off else model.opt.gravity, "gravity")
    assert scene.ours.time_step == model.opt.timestep


@every_scene
def test_actuators(source: str | Path) -> None:
    scene = scene_of(source)
    model = scene.mujoco
    ours = {actuator.name: actuator for actuator in scene.ours.actuators}
    for i, name in enumerate(scene.names("actuator", model.nu)):
        if name not in ours:
            assert any(f"actuator '{name}'" == note.element and note.action == "ignored" for note in scene.report.notes)
            continue
        a = ours[name]
        on = model.actuator_trnid[i, 0]
        if a.joint >= 0:
            assert scene.names("joint", model.njnt)[on] == scene.ours.joints[a.joint].name
        elif a.tendon >= 0:
            assert scene.names("tendon", model.ntendon)[on] == scene.ours.tendons[a.tendon].name
        else:
            ball = model.jnt_type[on] == mujoco.mjtJoint.mjJNT_BALL
            assert model.actuator_trntype[i] == mujoco.mjtTrn.mjTRN_SITE or ball, name
        gear = 1.0 if a.link >= 0 else model.actuator_gear[i, 0]
        gain, bias = model.actuator_gainprm[i, 0], model.actuator_biasprm[i, :3]
        if a.type == "affine":
            assert_close(np.array(a.gain), model.actuator_gainprm[i, :3], name)
            assert_close(np.array(a.bias), bias, name)
            continue
        k = {"force": 1, "position": a.kp, "velocity": a.kd}[a.type]
        kp, kd = (a.kp if a.type == "position" else 0), (a.kd if a.type != "force" else 0)
        found = [a.gear * k * a.ctrl_scale, a.gear * k * a.ctrl_offset, -(a.gear**2) * kp, -(a.gear**2) * kd]
        expected = [gear * gain, gear * bias[0], gear**2 * bias[1], gear**2 * bias[2]]
        assert_close(np.array(found), np.array(expected), name)
        limits = model.actuator_ctrlrange[i] if model.actuator_ctrllimited[i] else [-np.inf, np.inf]
        assert np.allclose([a.min_ctrl, a.max_ctrl], limits, rtol=0, atol=1e-12), name
        force = model.actuator_forcerange[i] if model.actuator_forcelimited[i] else np.array([-np.inf, np.inf])
        if on >= 0 and a.joint >= 0 and model.jnt_actfrclimited[on]:  # of all actuators of the joint
            force = np.clip(force, *(np.sort(model.jnt_actfrcrange[on] / gear)))
        assert [a.min_force, a.max_force] == pytest.approx(sorted(gear * force)), name


def pose_of_geom(scene: Scene, q: Array, geom: mh.Geom) -> tuple[Array, Array]:
    position, quaternion = mh.dynamics.frame_pose(scene.ours, q, scene.ours.links[geom.link].name)
    R = Rotation.from_quat(quaternion).as_matrix()
    return position + R @ geom.position, R @ Rotation.from_quat(geom.quaternion).as_matrix()


@every_scene
def test_geoms(source: str | Path) -> None:
    scene = scene_of(source)
    model, data = scene.mujoco, scene.data
    data.qpos = scene.random_qpos(np.random.default_rng(1))
    mujoco.mj_kinematics(model, data)
    q = scene.configuration(data.qpos)
    ours = {geom.name: geom for geom in scene.ours.geoms}
    for i, name in enumerate(scene.names("geom", model.ngeom)):
        geom = ours.pop(name)
        position, R = pose_of_geom(scene, q, geom)
        material = model.geom_matid[i]
        own = material < 0 or not np.array_equal(model.geom_rgba[i], np.float32([0.5, 0.5, 0.5, 1]))
        rgba = model.geom_rgba[i] if own else model.mat_rgba[material]
        assert_close(geom.rgba, rgba, f"{name}: rgba", 1e-6)
        if model.geom_type[i] == mujoco.mjtGeom.mjGEOM_MESH:  # MuJoCo turns meshes to their principal axes
            mesh = model.geom_dataid[i]
            start, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
            theirs = data.geom_xpos[i] + model.mesh_vert[start : start + count] @ data.geom_xmat[i].reshape(3, 3).T
            vertices = position + scene.ours.meshes[geom.mesh].vertices @ R.T
            away = np.linalg.norm(vertices[:, None] - theirs[None], axis=2)
            assert away.min(axis=0).max() < 1e-5, name
            assert away.min(axis=1).max() < 1e-5, name
            continue
        assert_close(position, data.geom_xpos[i], f"{name}: position")
        assert_close(R, data.geom_xmat[i].reshape(3, 3), f"{name}: rotation")
        size = model.geom_size[i]
        if model.geom_type[i] == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            unit = scene.ours.meshes[geom.mesh].vertices / size
            assert np.allclose(np.linalg.norm(unit, axis=1), 1, atol=1e-6), name
        else:
            used = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3}.get(geom.shape, 0)
            assert_close(geom.size[:used], size[:used], f"{name}: size")
        friction = [geom.friction, geom.spinning_friction, geom.rolling_friction]
        known = np.array([3, 4, 6]) <= model.geom_condim[i]
        assert_close(np.array(friction), model.geom_friction[i] * known, f"{name}: friction")
    assert not ours


@every_scene
def test_filters(source: str | Path) -> None:
    scene = scene_of(source)
    model = scene.mujoco
    ours = {geom.name: geom for geom in scene.ours.geoms}
    for (i, a), (k, b) in combinations(enumerate(scene.names("geom", model.ngeom)), 2):
        contype, conaffinity = model.geom_contype, model.geom_conaffinity
        theirs = bool((contype[i] & conaffinity[k]) | (contype[k] & conaffinity[i]))
        ga, gb = ours[a], ours[b]
        assert bool(ga.group & gb.mask and gb.group & ga.mask) == theirs, f"{a} and {b}"
    for i, name in enumerate(scene.names("geom", model.ngeom)):
        paired = i in {*model.pair_geom1, *model.pair_geom2}
        assert ours[name].is_visual == (not paired and not model.geom_contype[i] and not model.geom_conaffinity[i])


@every_scene
def test_frictions(source: str | Path) -> None:
    """Every pair that MuJoCo finds in contact has MuJoCo's friction, and moves of no base are lost."""
    scene = scene_of(source)
    model, data = scene.mujoco, scene.data
    if model.nmesh or model.nhfield:
        pytest.skip("its geoms are numbered alike, but their surfaces are not ours")
    model.geom_margin[:] = 100  # all in contact
    mujoco.mj_forward(model, data)
    ours = {geom.name: (i, geom) for i, geom in enumerate(scene.ours.geoms)}
    names = scene.names("geom", model.ngeom)
    pairs = {frozenset((pair.geom_a, pair.geom_b)): pair.friction for pair in scene.ours.contact_pairs}
    for contact in data.contact:
        (i, a), (k, b) = (ours[names[geom]] for geom in contact.geom)
        surfaces = [(geom.friction, geom.spinning_friction, geom.rolling_friction) for geom in (a, b)]
        found = pairs.get(frozenset((i, k))) or tuple(np.max(surfaces, axis=0))
        known = np.array([3, 4, 6]) <= contact.dim
        assert_close(np.array(found), contact.friction[[0, 2, 3]] * known, f"{a.name} and {b.name}: friction")


@pytest.mark.parametrize("name", FROM_MESHES)
def test_shapes_and_frames_that_follow_from_meshes(name: str) -> None:
    scene = Scene.of_string(FROM_MESHES[name])
    model, data = scene.mujoco, scene.data
    mujoco.mj_forward(model, data)
    q = scene.ours.initial_configuration()
    assert_close(q, scene.configuration(model.qpos0), "qpos0", MESH_TOLERANCE)
    for i, body in enumerate(scene.names("body", model.nbody)):
        assert_close(scene.ours.link(body).mass, model.body_mass[i], f"{body}: mass", MESH_TOLERANCE)
        assert_close(scene.ours.link(body).com, model.body_ipos[i], f"{body}: com", MESH_TOLERANCE)
        assert_close(scene.ours.link(body).inertia, scene.body_inertia(i), f"{body}: inertia", MESH_TOLERANCE)
    for i, site in enumerate(scene.names("site", model.nsite)):
        assert_close(mh.dynamics.frame_pose(scene.ours, q, site)[0], data.site_xpos[i], site, MESH_TOLERANCE)
    ours = {geom.name: geom for geom in scene.ours.geoms}
    for i, geom in enumerate(scene.names("geom", model.ngeom)):
        if model.geom_type[i] == mujoco.mjtGeom.mjGEOM_MESH:
            continue
        position, R = pose_of_geom(scene, q, ours[geom])
        assert_close(position, data.geom_xpos[i], f"{geom}: position", MESH_TOLERANCE)
        if model.geom_type[i] == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            reach = np.max(np.abs(scene.ours.meshes[ours[geom].mesh].vertices), axis=0)
            assert_close(reach, model.geom_size[i], f"{geom}: size", 0.03)  # a hull of points on it
        else:
            used = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3}[ours[geom].shape]
            assert_close(ours[geom].size[:used], model.geom_size[i, :used], f"{geom}: size", MESH_TOLERANCE)
        assert_close(R, data.geom_xmat[i].reshape(3, 3), f"{geom}: rotation", MESH_TOLERANCE)


def test_equalities_hold_at_the_start() -> None:
    scene = Scene.of_string(SCENES["equalities"])
    model, data = scene.mujoco, scene.data
    mujoco.mj_forward(model, data)
    q = scene.ours.initial_configuration()
    assert [equality.type for equality in scene.ours.equalities] == [
        "point",
        "point",
        "fixed",
        "fixed",
        "fixed",
        "joint",
        "point",
    ]
    for equality in scene.ours.equalities:
        if equality.type == "joint":
            ratio, offset = equality.ratio, equality.offset
            for x in (-1.0, 0.0, 2.0):  # MuJoCo's own residual of the driver at x
                iq = [scene.ours.joints[i].iq for i in (equality.joint_a, equality.joint_b)]
                data.qpos = model.qpos0
                data.qpos[iq[0]], data.qpos[iq[1]] = x, ratio * x + offset
                mujoco.mj_forward(model, data)
                rows = data.efc_pos[np.flatnonzero(data.efc_id == model.equality("e6").id)[: data.ne]]
                assert np.allclose(rows[:1], 0, atol=1e-12)
            continue
        ends = []
        for link, p, r in (
            (equality.link_a, equality.position_a, equality.quaternion_a),
            (equality.link_b, equality.position_b, equality.quaternion_b),
        ):
            position, quaternion = mh.dynamics.frame_pose(scene.ours, q, scene.ours.links[link].name)
            R = Rotation.from_quat(quaternion)
            ends.append((position + R.apply(p), (R * Rotation.from_quat(r)).as_matrix()))
        if equality.name != "e7":  # between sites, which lie apart
            assert_close(ends[0][0], ends[1][0], f"{equality.name}: position")
        if equality.type == "fixed":
            assert_close(ends[0][1], ends[1][1], f"{equality.name}: rotation")


def test_what_acts_on_attached_parts_comes_along() -> None:
    scene = Scene.of_file(OWN[0])
    model = scene.mujoco
    given = [(model.equality(i).name, EQUALITIES[model.eq_type[i]]) for i in range(model.neq)]
    assert [
        (e.name if name else "", e.type) for e, (name, _) in zip(scene.ours.equalities, given, strict=True)
    ] == given
    for equality, i in zip(scene.ours.equalities, range(model.neq), strict=True):
        if equality.type == "joint":
            names = [model.joint(k).name for k in (model.eq_obj1id[i], model.eq_obj2id[i])]
            assert [scene.ours.joints[j].name for j in (equality.joint_b, equality.joint_a)] == names
        else:
            names = [model.body(k).name for k in (model.eq_obj1id[i], model.eq_obj2id[i])]
            assert [scene.ours.links[k].name for k in (equality.link_a, equality.link_b)] == names
    assert [a.name or "" for a in scene.ours.actuators if not a.name.startswith("actuator_")] == [
        model.actuator(i).name for i in range(model.nu) if model.actuator(i).name
    ]
    assert [t.name for t in scene.ours.tendons] == [model.tendon(i).name for i in range(model.ntendon)]
    geoms = {geom.name: i for i, geom in enumerate(scene.ours.geoms)}
    theirs = {frozenset(geoms[model.geom(g[i]).name] for g in (model.pair_geom1, model.pair_geom2)) for i in range(2)}
    ours = {frozenset((p.geom_a, p.geom_b)): p.friction for p in scene.ours.contact_pairs}
    assert all(ours[pair][0] == 0.3 for pair in theirs)


def test_nkey_makes_keyframes_of_the_initial_state() -> None:
    text = SCENES["free"].replace("<worldbody>", '<size nkey="3"/><worldbody>', 1)
    scene = Scene.of_string(text)
    assert len(scene.ours.keyframes) == scene.mujoco.nkey == 3
    for key in scene.ours.keyframes[1:]:
        assert_close(key.q, scene.ours.initial_configuration(), "q")


@pytest.mark.parametrize("name", ["arm", "free"])
def test_keyframes(name: str) -> None:
    scene = Scene.of_string(SCENES[name])
    model, data = scene.mujoco, scene.data
    (key,) = scene.ours.keyframes
    mujoco.mj_resetDataKeyframe(model, data, 0)
    assert_close(key.q, scene.configuration(data.qpos), "q")
    assert_close(key.v, scene.velocity_map(data.qpos) @ data.qvel, "v")
    assert_close(key.ctrl, data.ctrl, "ctrl")
    assert key.time == data.time


def test_height_fields() -> None:
    scene = Scene.of_string(SCENES["height field"])
    (field,) = scene.ours.height_fields
    theirs = scene.mujoco.hfield_data.reshape(3, 2) * 0.5
    assert_close(field.heights, theirs, "heights", 1e-7)
    assert (field.dx, field.dy) == (2.0, 2.0)


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "LA", "P", "1", "I;16"])
def test_png_height_fields(mode: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    if mode == "I;16":
        picture = Image.fromarray(rng.integers(0, 65536, (17, 23), dtype=np.uint16))
    else:
        picture = Image.fromarray(rng.integers(0, 256, (17, 23, 3), dtype=np.uint8)).convert(mode)
    picture.save(tmp_path / "ground.png")
    scene = tmp_path / "scene.xml"
    scene.write_text("""<mujoco><asset><hfield name="h" file="ground.png" size="2 3 0.5 0.1"/></asset>
      <worldbody><geom type="hfield" hfield="h"/></worldbody></mujoco>""")
    loaded = Scene.of_file(scene)
    (field,) = loaded.ours.height_fields
    assert_close(field.heights, loaded.mujoco.hfield_data.reshape(17, 23) * 0.5, "heights", 1e-7)
    assert (field.dx, field.dy) == (4 / 22, 6 / 16)


def test_quaternion_order() -> None:
    assert XYZW == [1, 2, 3, 0]
    assert np.allclose(rotation(np.array([0.0, 1.0, 0.0, 0.0])), np.diag([1.0, -1.0, -1.0]))
