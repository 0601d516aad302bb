"""Models built and loaded in Python: every kind of part, and errors that name it."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import manyhands as mh

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.int32)


def two_hinges() -> mh.ModelBuilder:
    builder = mh.ModelBuilder("two hinges")
    for name, parent in (("a", "world"), ("b", "a")):
        builder.add_link(name, mass=1.0, inertia=np.eye(3))
        builder.add_joint(f"hinge_{name}", "revolute", parent, name, lower=-1, upper=1, initial=[0.25])
    return builder


def test_geoms_read_back_as_given() -> None:
    builder = two_hinges()
    index = builder.add_geom(
        "b",
        "capsule",
        (0.1, 0.3),
        name="c",
        position=(1, 2, 3),
        quaternion=(0, 0, 1, 0),
        friction=0.9,
        restitution=0.2,
        rolling_friction=0.01,
        spinning_friction=0.02,
        group=2,
        mask=5,
        margin=0.001,
        rgba=(1, 0, 0, 0.5),
    )
    assert index == 0
    builder.add_geom("a", "sphere", 0.2, visual=True)
    builder.add_geom("a", "box", np.array([0.1, 0.2, 0.3]))
    builder.add_geom("world", "plane")
    capsule, sphere, box, plane = builder.build().geoms
    assert (capsule.name, capsule.shape, capsule.link, capsule.is_visual) == ("c", "capsule", 2, False)
    assert np.array_equal(capsule.size, [0.1, 0.3, 0])
    assert np.array_equal(capsule.position, [1, 2, 3])
    assert np.array_equal(capsule.quaternion, [0, 0, 1, 0])
    surface = (capsule.friction, capsule.restitution, capsule.rolling_friction, capsule.spinning_friction)
    assert surface == (0.9, 0.2, 0.01, 0.02)
    assert (capsule.group, capsule.mask, capsule.margin) == (2, 5, 0.001)
    assert np.allclose(capsule.rgba, [1, 0, 0, 0.5])
    assert sphere.is_visual
    assert sphere.size[0] == 0.2
    assert np.array_equal(box.size, [0.1, 0.2, 0.3])
    assert (box.group, box.mask) == (1, 0xFFFFFFFF)
    assert plane.link == 0


def test_meshes_and_height_fields_read_back(tmp_path: Path) -> None:
    builder = two_hinges()
    lines = [f"v {x} {y} {z}" for x, y, z in TETRAHEDRON] + [f"f {a} {b} {c}" for a, b, c in FACES + 1]
    (tmp_path / "t.obj").write_text("\n".join(lines))
    from_file = builder.add_mesh(tmp_path / "t.obj", scale=(2, 2, 2))
    from_arrays = builder.add_mesh_arrays(TETRAHEDRON, FACES)
    heights = np.arange(6.0).reshape(2, 3)
    field = builder.add_height_field(heights, dx=0.5, dy=0.25)
    builder.add_geom("a", "convex", mesh=from_file)
    builder.add_geom("world", "mesh", mesh=from_arrays)
    builder.add_geom("world", "height_field", height_field=field)
    model = builder.build()
    assert [geom.mesh for geom in model.geoms] == [0, 1, -1]
    assert np.array_equal(model.meshes[0].vertices, 2 * TETRAHEDRON)
    assert np.array_equal(model.meshes[1].triangles, FACES)
    assert np.array_equal(model.height_fields[0].heights, heights)
    assert (model.height_fields[0].dx, model.height_fields[0].dy) == (0.5, 0.25)


def test_couplings_read_back() -> None:
    builder = two_hinges()
    builder.add_equality("pin", "point", "b", "world", position_a=(0, 0, 1), position_b=(1, 0, 0), max_force=9.0)
    builder.add_equality("ratio", "gear", "hinge_a", "hinge_b", ratio=-2.0)
    builder.add_actuator("servo", "position", "hinge_b", kp=30, kd=2, gear=3, ctrl_range=(-1, 2), max_force=5)
    builder.exclude_contact("a", "world")
    builder.set_contact_rules(friction="maximum", self_collision=False)
    builder.set_time_step(0.01)
    builder.add_keyframe("here")
    builder.add_keyframe("there", q=[0.5, 0.6], ctrl=[1.0], time=2.0)
    model = builder.build()
    pin, ratio = model.equalities
    assert (pin.type, pin.link_a, pin.link_b, pin.joint_a, pin.max_force) == ("point", 2, 0, -1, 9.0)
    assert np.array_equal(pin.position_b, [1, 0, 0])
    assert (ratio.type, ratio.joint_a, ratio.joint_b, ratio.ratio) == ("gear", 0, 1, -2.0)
    (servo,) = model.actuators
    assert (servo.type, servo.joint, servo.kp, servo.kd, servo.gear) == ("position", 1, 30, 2, 3)
    assert (servo.min_ctrl, servo.max_ctrl, servo.max_force, model.nu) == (-1, 2, 5, 1)
    assert model.time_step == 0.01
    here, there = model.keyframes
    assert np.array_equal(here.q, model.initial_configuration())
    assert np.array_equal(here.q, [0.25, 0.25])
    assert (there.time, there.ctrl[0], there.v[1]) == (2.0, 1.0, 0.0)


def test_compliances_read_back() -> None:
    soft = mh.Compliance(0.05, 0.7, impedance=(0.2, 0.6), width=0.01, midpoint=0.4, power=3, share=2)
    direct = mh.Compliance(stiffness=400.0, damping=3.0)
    builder = two_hinges()
    builder.add_link("c", mass=1.0, inertia=((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    builder.add_joint("slide", "prismatic", "b", "c", lower=0.0, compliance=direct)
    builder.add_geom("c", "sphere", 0.1, compliance=soft)
    builder.add_tendon("rope", joints={"slide": 1}, limits=(0.0, 1.0), compliance=direct)
    builder.add_equality("weld", "fixed", "c", "world", compliance=soft, torque_scale=0.5)
    model = builder.build()
    (weld,) = model.equalities
    assert (weld.compliance, weld.torque_scale) == (soft, 0.5)
    assert [joint.compliance for joint in model.joints] == [None, None, direct]
    assert model.geoms[-1].compliance == soft
    assert model.tendons[0].compliance == direct
    assert (direct.stiffness, direct.damping, direct.impedance, direct.width) == (400, 3, (0.9, 0.95), 0.001)
    assert (soft.stiffness, soft.damping) == pytest.approx((1 / (0.05 * 0.7) ** 2, 2 / 0.05))
    assert (soft.impedance, soft.midpoint, soft.power, soft.share) == ((0.2, 0.6), 0.4, 3, 2)
    assert soft != direct


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda b: mh.Compliance(impedance=(0, 1)), "between 0 and 1"),
        (lambda b: mh.Compliance(0.0), "finite"),
        (
            lambda b: b.add_equality("l", "fixed", "a", "b", max_force=1.0, compliance=mh.Compliance()),
            "no max_force; expected one of the two",
        ),
        (lambda b: b.add_geom("a", "cone", 1.0), "there is no shape 'cone'; there are 'sphere'"),
        (lambda b: b.add_geom("a", "box", 1.0), "shape 'box' has a size of 3 numbers, not 1"),
        (lambda b: b.add_geom("a", "sphere", -1.0, name="g"), "geom 'g': a size is -1"),
        (lambda b: b.add_geom("a", "sphere", 1.0, quaternion=(0, 0, 0, 2)), "must have length 1"),
        (lambda b: b.add_geom("a", "convex"), "needs a mesh added before"),
        (lambda b: b.add_mesh_arrays(TETRAHEDRON, FACES + 1), "a triangle names vertex 4 of 4"),
        (lambda b: b.add_height_field(np.zeros((1, 3)), dx=1.0, dy=1.0), "2 x 2 or more"),
        (lambda b: b.add_equality("l", "rope", "a", "b"), "there is no equality type 'rope'"),
        (lambda b: b.add_equality("l", "fixed", "a", "a"), "equality 'l' joins a link to itself"),
        (lambda b: b.add_actuator("m", "force", "hinge_a", gear=0.0), "actuator 'm': gear"),
        (lambda b: b.set_contact_rules(friction="mean"), "there is no rule 'mean'"),
        (lambda b: b.add_contact_pair(0, 1), "a contact pair needs two geoms"),
    ],
)
def test_errors_name_the_part(call, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call(two_hinges())


@pytest.mark.parametrize("call", [lambda b: b.add_geom("c", "plane"), lambda b: b.add_actuator("m", "force", "c")])
def test_unknown_names_are_key_errors(call) -> None:
    with pytest.raises(KeyError, match="'c' has not been added"):
        call(two_hinges())


SCENE = """<mujoco model="s"><option timestep="0.005"/><worldbody><geom type="plane" size="1 1 1"/>
<body name="b" pos="0 0 1"><freejoint/><geom size="0.1"/><light/></body></worldbody></mujoco>"""


def test_scenes_load_with_their_report(tmp_path: Path) -> None:
    (tmp_path / "s.xml").write_text(SCENE)
    for model, report in (mh.load_mjcf_string(SCENE), mh.load_mjcf(tmp_path / "s.xml")):
        assert (model.name, model.time_step, model.nq) == ("s", 0.005, 7)
        assert np.array_equal(model.initial_configuration(), [0, 0, 1, 0, 0, 0, 1])
        (note,) = report.notes
        assert (note.action, note.line, note.element) == ("ignored", 2, "body 'b'")
        assert "<light> in <body> is not used" in str(report)


def test_scenes_that_cannot_be_loaded(tmp_path: Path) -> None:
    with pytest.raises(mh.MjcfError, match=r"mjcf:1: mujoco: the root element is <robot>"):
        mh.load_mjcf_string("<robot/>")
    assert issubclass(mh.MjcfError, ValueError)
    with pytest.raises(FileNotFoundError):
        mh.load_mjcf(tmp_path / "none.xml")


def test_an_asset_that_is_not_there_is_answered_by_those_that_are() -> None:
    with pytest.raises(
        FileNotFoundError,
        match=r"'foo/bar.urdf' is not in .* there are 'arm6/arm6.urdf', \d+ models in 'bullet', 'panda/",
    ):
        mh.asset_path("foo/bar.urdf")


BROKEN = """
<robot name="broken">
  <link name="base"/>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/></joint>
  <link name="arm">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="no_such.stl"/></geometry></visual>
    <collision><geometry><mesh filename="no_such.stl"/></geometry></collision>
  </link>
</robot>
"""


def test_a_part_that_a_file_loses_is_warned_of_once(tmp_path: Path) -> None:
    file = tmp_path / "broken.urdf"
    file.write_text(BROKEN)
    world = mh.World()
    for load, where in (
        (lambda: mh.World.from_file(file), "the world's `report`"),
        (lambda: world.add(file), "the world's `report`"),
        (lambda: mh.load_urdf(file), "the report, which comes with the model"),
    ):
        with pytest.warns(mh.LoadWarning, match=f"broken.urdf: .*no_such.stl.* first of 2 .*print {where}") as warned:
            load()
        assert len(warned) == 1
        assert warned[0].filename == __file__
    assert [note.serious for note in world.report.notes].count(True) == 2
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(UserWarning):
            mh.load_urdf(file)
        mh.load_urdf(file, load_meshes=False)
        world.add(mh.ModelBuilder("nothing").build())


@pytest.mark.parametrize("mass", ["-1", "1"])
def test_a_negative_mass_is_warned_of_and_a_missing_axis_is_not(mass: str, tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(BROKEN.replace('mass value="1"', f'mass value="{mass}"').replace("no_such.stl", "box.obj"))
    (tmp_path / "box.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n")
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        _, report = mh.load_urdf(file)
    assert len(report) > 0
    assert [("negative" in str(each.message)) for each in warned] == ([True] if mass == "-1" else [])


@pytest.mark.parametrize("robot", ["panda/panda.urdf", "arm6/arm6.urdf"])
def test_robots_that_ship_load_without_a_warning(robot: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mh.World.from_file(mh.asset_path(robot))


SDF = """<sdf version="1.7"><world name="w"><gravity>0 0 -1.6</gravity><model name="box"><pose>0 0 1 0 0 0</pose>
<link name="l"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link></model>
<model name="floor"><static>1</static><link name="l"><collision name="c"><geometry><plane/></geometry></collision>
</link></model></world></sdf>"""


def test_sdf_worlds_load_model_by_model_and_as_one(tmp_path: Path) -> None:
    path = tmp_path / "w.sdf"
    path.write_text(SDF)
    (box, report), (floor, _) = mh.load_sdf(path)
    assert (box.name, box.nq, floor.nq) == ("box", 7, 0)
    assert "no <inertial>" in str(report)
    world = mh.World.from_file(path)
    assert world.gravity[2] == -1.6
    assert set(world.names) == {"box", "floor"}
    world.step(2000)
    assert world.body_pose("box/l")[0][2] == pytest.approx(0.5, abs=1e-3)
    world.add(path, name="again")
    assert world.body_pose("again/box/l")[0][2] == 1


def test_sdf_that_cannot_be_loaded(tmp_path: Path) -> None:
    path = tmp_path / "w.sdf"
    path.write_text("<sdf/>")
    with pytest.raises(mh.SdfError, match=r"w.sdf:1: sdf: there is no model in it"):
        mh.load_sdf(path)
    with pytest.raises(FileNotFoundError):
        mh.load_sdf(tmp_path / "none.sdf")


def test_bullets_rules_and_scale(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    path.write_text('<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="fixed">'
                    '<origin xyz="1 0 0"/><parent link="a"/><child link="b"/></joint></robot>')  # fmt: skip
    model, _ = mh.load_urdf(path, bullet=True, scale=2.0)
    assert model.links[1].mass == 1
    assert mh.World(model).body_pose("b")[0][0] == 2
    with pytest.raises(mh.UrdfError, match="scale is not above 0"):
        mh.load_urdf(path, scale=float("nan"))
