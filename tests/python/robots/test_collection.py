"""The robots of assets/robots: as their generator writes them, in their physics, and with grippers on."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
import robot_files  # puts tools/ on the path
from robots.collection.all_files import all_entries, collection_files

import manyhands as mh

FOLDER = robot_files.ASSETS / "robots"
ENTRIES = {entry.robot.name: entry for entry in all_entries()}
ARMS, GRIPPERS, FURNITURE = (mh.robots.names(kind) for kind in ("arm", "gripper", "furniture"))
FINGERED = [name for name in GRIPPERS if mh.robots.describe(name).closed]
UP = np.array([0.0, 0.0, 1.0])
MAKERS = ("ur5", "xarm", "gen3", "iiwa", "panda", "so-101", "so101", "robotiq", "kuka", "kinova", "franka")


def test_generator_reproduces_the_committed_files() -> None:
    files = collection_files()
    assert {p.relative_to(FOLDER).as_posix() for p in FOLDER.rglob("*") if p.is_file()} == set(files)
    assert not [name for name, data in files.items() if (FOLDER / name).read_bytes() != data], (
        "run tools/make_robots.py"
    )
    assert sum(map(len, files.values())) < 400_000


def test_the_catalogue_lists_what_there_is() -> None:
    assert mh.robots.names() == list(ENTRIES)
    assert len(ARMS) == 7 and len(GRIPPERS) == 4 and len(FURNITURE) == 5
    assert not [name for name in ENTRIES for maker in MAKERS if maker in name]
    with pytest.raises(ValueError, match="six_axis"):
        mh.robots.load("sixaxis")
    with pytest.raises(ValueError, match="no flange"):
        mh.robots.load("desktop", gripper="parallel")


@pytest.mark.parametrize("name", mh.robots.OF_ENVIRONMENTS)
def test_the_arms_of_the_environments_load_at_home_too(name: str) -> None:
    model, robot = mh.robots.load(name), mh.robots.describe(name)
    assert mh.robots.path(name).stem == name and model.link(robot.tool).name.endswith("grasptarget")
    q = model.initial_configuration()
    np.testing.assert_allclose([q[model.joint(joint).iq] for joint in robot.home], list(robot.home.values()))
    position, quaternion = mh.kinematics.forward(model, q, robot.tool)
    np.testing.assert_allclose(position, [0.64, 0, 0.2], atol=0.01)  # above the table's middle, pointing down
    assert abs(quaternion[0]) > 0.99
    planner = mh.planning.Planner(model, robot.tool)
    assert planner.is_free(planner.start)
    with pytest.raises(ValueError, match="no flange"):
        mh.robots.load(name, gripper="parallel")


@pytest.mark.parametrize("name", ENTRIES)
def test_it_loads_with_nothing_repaired(name: str) -> None:
    model, report = mh.load_urdf(mh.robots.path(name))
    assert len(report) == 0, str(report)
    robot = mh.robots.describe(name)
    for link in (robot.flange, robot.tool):
        assert not link or model.link(link).mass == 0
    mimics = {joint.get("name") for joint in ET.parse(mh.robots.path(name)).getroot().findall("joint[mimic]")}
    assert set(robot.home) == {joint.name for joint in model.joints if joint.type != "fixed"} - mimics


@pytest.mark.parametrize("name", ENTRIES)
def test_masses_and_inertias_are_those_of_bodies(name: str) -> None:
    for link in ENTRIES[name].robot.links:
        if not link.shapes:
            continue
        (xx, yy, zz), (xy, xz, yz) = link.inertia, link.products
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        moments = np.linalg.eigvalsh(tensor)
        assert moments[0] > 0 and moments[2] < (moments[0] + moments[1]) * (1 + 1e-3), link.name
        # The mass fills a part of the box of the shapes, and no more of its length than there is.
        low, high = bounds(link.shapes)
        density = link.mass / np.prod(high - low)
        assert 5 < density < 8000, link.name
        spread = np.sqrt((np.trace(tensor) / 2 - np.diag(tensor)) / link.mass)
        assert (spread <= (high - low) / 2).all(), link.name
        assert (low <= link.com).all() and (link.com <= high).all(), link.name


def bounds(shapes) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the box around boxes, balls, and cylinders along axes."""
    corners = []
    for shape in shapes:
        if hasattr(shape, "radius"):
            low, high = (np.array(shape.centre) + side * shape.radius for side in (-1, 1))
            if hasattr(shape, "axis"):
                axis = "xyz".index(shape.axis)
                low[axis], high[axis] = shape.low, shape.high
        else:
            low, high = np.array(shape.low), np.array(shape.high)
        corners.append((low, high))
    return np.min([low for low, _ in corners], axis=0), np.max([high for _, high in corners], axis=0)


@pytest.mark.parametrize("name", ENTRIES)
def test_its_shapes_are_those_that_every_reader_of_urdf_knows(name: str) -> None:
    shapes = {element.tag for element in ET.parse(mh.robots.path(name)).getroot().findall("link/*/geometry/*")}
    assert shapes <= {"box", "cylinder", "sphere"}


@pytest.mark.parametrize("name", [name for name, entry in ENTRIES.items() if entry.home])
def test_its_mass_matrix_is_pinocchios(name: str) -> None:
    pin = pytest.importorskip("pinocchio")
    ours, _ = mh.load_urdf(mh.robots.path(name))
    theirs = pin.buildModelFromUrdf(str(mh.robots.path(name)))
    order = [ours.joint(joint).iv for joint in list(theirs.names)[1:]]
    for q in np.random.default_rng(4).uniform(-0.5, 0.5, (10, ours.nv)):
        upper = np.triu(pin.crba(theirs, theirs.createData(), q[order]))
        expected = upper + np.triu(upper, 1).T
        np.testing.assert_allclose(mh.dynamics.crba(ours, q)[np.ix_(order, order)], expected, atol=1e-12)


@pytest.mark.parametrize("name", ENTRIES)
def test_pybullet_reads_it_as_we_do(name: str) -> None:
    bullet = pytest.importorskip("pybullet")
    model, _ = mh.load_urdf(mh.robots.path(name))
    client = bullet.connect(bullet.DIRECT)
    try:
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        body = bullet.loadURDF(str(mh.robots.path(name)), useFixedBase=True, flags=flags, physicsClientId=client)
        joints = [
            bullet.getJointInfo(body, i, physicsClientId=client)
            for i in range(bullet.getNumJoints(body, physicsClientId=client))
        ]
        for index, joint in enumerate(joints):
            mass = bullet.getDynamicsInfo(body, index, physicsClientId=client)[0]
            assert mass == pytest.approx(model.link(joint[12].decode()).mass)
        world, q = mh.World(model), np.random.default_rng(5).uniform(-0.5, 0.5, model.nq)
        world.q = q
        for index, joint in enumerate(joints):
            if joint[2] != bullet.JOINT_FIXED:
                place = q[model.joint(joint[1].decode()).iq]
                bullet.resetJointState(body, index, place, physicsClientId=client)
        for index, joint in enumerate(joints):
            theirs = bullet.getLinkState(body, index, computeForwardKinematics=True, physicsClientId=client)[4]
            np.testing.assert_allclose(world.body_pose(joint[12].decode())[0], theirs, atol=1e-6)
    finally:
        bullet.disconnect(client)


@pytest.mark.parametrize("name", ENTRIES)
def test_mujocos_mass_matrix_is_ours(name: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    ours, theirs = mh.load_urdf(mh.robots.path(name))[0], mujoco.MjModel.from_xml_path(str(mh.robots.path(name)))
    assert theirs.nq == ours.nq
    order = [ours.joint(theirs.joint(i).name).iv for i in range(theirs.njnt)]
    data, dense = mujoco.MjData(theirs), np.zeros((theirs.nv, theirs.nv))
    for q in np.random.default_rng(6).uniform(-0.5, 0.5, (5, ours.nq)) if ours.nq else []:
        data.qpos[:] = q[order]
        mujoco.mj_forward(theirs, data)
        for unit, column in zip(np.eye(theirs.nv), dense, strict=True):
            mujoco.mj_mulM(theirs, data, column, unit)
        np.testing.assert_allclose(mh.dynamics.crba(ours, q)[np.ix_(order, order)], dense, atol=1e-9)


def test_a_link_of_two_materials_has_the_inertia_of_its_grains() -> None:
    """A tube with an off-centre drive, summed over a million points."""
    from robots.collection.common import DENSITIES, Part, link
    from robots.description import Box, Cylinder

    parts = [
        Part(Cylinder("z", 0.0, 0.3, 0.04), "tube", "shell"),
        Part(Box((0.05, -0.03, 0.1), (0.11, 0.05, 0.2)), "drive", "shell"),
    ]
    made = link("made", parts)
    rng = np.random.default_rng(0)
    n = 1_000_000
    turn, radius = rng.uniform(0, 2 * np.pi, n), 0.04 * np.sqrt(rng.uniform(0, 1, n))
    clouds = [
        np.stack([radius * np.cos(turn), radius * np.sin(turn), rng.uniform(0, 0.3, n)], 1),
        rng.uniform((0.05, -0.03, 0.1), (0.11, 0.05, 0.2), (n, 3)),
    ]
    masses = [DENSITIES["tube"] * np.pi * 0.04**2 * 0.3, DENSITIES["drive"] * 0.06 * 0.08 * 0.1]
    assert made.mass == pytest.approx(sum(masses), abs=1e-4)
    com = sum(m * cloud.mean(0) for m, cloud in zip(masses, clouds, strict=True)) / sum(masses)
    np.testing.assert_allclose(made.com, com, atol=2e-4)
    tensor = np.zeros((3, 3))
    for m, cloud in zip(masses, clouds, strict=True):
        r = cloud - com
        tensor += m * ((r**2).sum(1).mean() * np.eye(3) - r.T @ r / n)
    ours = [*made.inertia, *made.products]
    np.testing.assert_allclose(ours, tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]], atol=3e-3 * tensor.max())


@pytest.mark.parametrize("name", ARMS)
def test_an_arm_stands_still_at_home_and_touches_nothing(name: str) -> None:
    world = mh.World()
    world.add(mh.robots.load(name))
    home = mh.robots.describe(name).home
    assert not world.near_links(0.002)
    world.move(dict(home))
    world.step(1000)  # two seconds
    for joint, value in home.items():
        assert world.q[world.model.joint(joint).iq] == pytest.approx(value, abs=1e-6), joint
    assert not world.contacts()
    assert not [str(finding) for finding in world.diagnose()]


@pytest.mark.parametrize("name", ARMS)
def test_the_tool_points_down_at_home(name: str) -> None:
    world = mh.World(mh.robots.load(name))
    robot = mh.robots.describe(name)
    x, y, _, _ = world.body_pose(robot.flange or robot.tool)[1]
    assert 1 - 2 * (x * x + y * y) == pytest.approx(-1, abs=1e-4)  # z of the frame along the world's z


@pytest.mark.parametrize("name", ARMS)
def test_motors_hold_the_payload_in_any_posture(name: str) -> None:
    model, robot = mh.robots.load(name), mh.robots.describe(name)
    joints = [joint for joint in model.joints if joint.type != "fixed"]
    lower, upper, effort = (np.array([getattr(joint, key) for joint in joints]) for key in ("lower", "upper", "effort"))
    q = np.random.default_rng(3).uniform(lower, upper, (20_000, model.nq))
    rest = np.zeros((len(q), model.nv))
    arm = mh.dynamics.rnea(model, q, rest, rest)
    load = mh.dynamics.jacobian(model, q, robot.flange or robot.tool)[:, 5] * 9.81 * robot.payload
    assert robot.payload > 0 and (np.abs(arm + load) < effort).all()


@pytest.mark.parametrize("name", ["table", "scara", "claw"])
def test_what_is_no_gripper_goes_on_no_flange(name: str) -> None:
    for put_on in (
        lambda: mh.robots.load("six_axis", gripper=name),
        lambda: mh.robots.load(f"six_axis+{name}"),
        lambda: mh.robots.attach(mh.robots.load("six_axis"), name, "flange"),
    ):
        with pytest.raises(ValueError, match=f"no gripper '{name}'; there are {', '.join(GRIPPERS)}"):
            put_on()


def test_an_arm_is_named_with_its_gripper() -> None:
    expected = [link.name for link in mh.robots.load("six_axis", gripper="parallel").links]
    for name in ("six_axis+parallel", "six_axis + parallel"):
        assert [link.name for link in mh.robots.load(name).links] == expected
    with pytest.raises(ValueError, match="name one gripper"):
        mh.robots.load("six_axis+parallel", gripper="vacuum")
    with pytest.raises(ValueError, match="kind is 'hand'; expected 'arm', 'gripper' or 'furniture'"):
        mh.robots.names("hand")


@pytest.mark.parametrize("gripper", GRIPPERS)
@pytest.mark.parametrize("arm", [name for name in ARMS if mh.robots.describe(name).flange])
def test_a_gripper_goes_on_any_flange(arm: str, gripper: str) -> None:
    model = mh.robots.load(arm, gripper=gripper)
    alone, hand = mh.robots.load(arm), mh.robots.load(gripper)
    assert model.nv == alone.nv + hand.nv
    mass = [sum(link.mass for link in part.links) for part in (model, alone, hand)]
    assert mass[0] == pytest.approx(mass[1] + mass[2])
    world = mh.World(model)
    flange, tool = world.body_pose("flange"), world.body_pose("gripper/tool")
    length = mh.World(hand).body_pose("tool")[0][2]
    np.testing.assert_allclose(tool[0], flange[0] - [0, 0, length], atol=1e-5)
    world.move({**mh.robots.describe(arm).home, **{f"gripper/{j}": 0.0 for j in mh.robots.describe(gripper).home}})
    world.step(100)
    assert not world.contacts()


def test_a_gripper_goes_on_arms_of_others() -> None:
    ur, _ = mh.load_urdf(mh.asset_path("bullet/universal/ur5e.urdf"))
    model = mh.robots.attach(ur, "vacuum", "tool0", prefix="cup/")
    assert model.link("cup/palm").body == model.link("tool0").body
    with pytest.raises(ValueError, match=r"no link or frame 'nowhere'; there are: .*'tool0'"):
        mh.robots.attach(ur, "vacuum", "nowhere")
    with pytest.raises(ValueError, match="base_link"):
        mh.robots.attach(ur, ur, "tool0", prefix="")


def test_a_cup_must_be_there() -> None:
    world = mh.World(mh.robots.load("vacuum"))
    with pytest.raises(KeyError, match=r"no link 'cupp'; it has: .*'cup'"):
        mh.robots.Vacuum(world, "cupp")


def hanging(gripper: str, half: float, mass: float = 0.1) -> mh.World:
    """A gripper that points down, open about a cube that stands on a post."""
    world = mh.World()
    world.add(mh.robots.load(gripper), [0, 0, 0.5], [1, 0, 0, 0], name="hand")
    tip = float(world.body_pose("hand/tool")[0][2])
    top = tip + half if mh.robots.describe(gripper).closed else tip
    world.add_box("cube", [half] * 3, mass=mass, position=[0, 0, top - half], friction=0.8)
    world.add_box("post", [half / 2, half / 2, 0.05], position=[0, 0, top - 2 * half - 0.05], fixed=True)
    return world


@pytest.mark.parametrize("name", FINGERED)
@pytest.mark.parametrize("loaded", [False, True])
def test_fingers_close_hold_a_cube_and_let_it_go(name: str, loaded: bool) -> None:
    robot = mh.robots.describe(name)
    world = hanging(name, 0.02, robot.payload if loaded else 0.1)
    ((joint, closed),) = robot.closed.items()
    start = world.body_pose("cube")[0]
    assert not world.near_links(0.002, "hand/palm")
    world.move({f"hand/{joint}": closed})
    world.step(500)
    world.remove("post")
    world.step(250)
    held = world.body_pose("cube")[0]
    # Three pads cannot lie flat on a square: they turn the cube into a grip. Two do not move it.
    assert np.abs(held - start).max() < (8e-3 if name == "three_finger" else 1e-3)
    world.step(1000)
    assert np.abs(world.body_pose("cube")[0] - held).max() < 1e-5
    world.move({f"hand/{joint}": 0.0})
    world.step(250)
    assert world.body_pose("cube")[0][2] < held[2] - 0.05


@pytest.mark.parametrize("gripper", GRIPPERS)
def test_every_gripper_lifts_a_cube_and_holds_it_for_five_seconds(gripper: str) -> None:
    arm, hand, half = mh.robots.describe("six_axis"), mh.robots.describe(gripper), 0.02
    world = mh.World()
    world.add(mh.robots.load("six_axis", gripper=gripper), name="arm")
    place, turn = world.body_pose("arm/gripper/tool")
    middle = place - [0, 0, 0 if hand.closed else half]
    world.add_box("cube", [half] * 3, mass=0.2, position=middle, friction=0.8)
    world.add_box("post", [half / 2, half / 2, 0.02], position=middle - [0, 0, half + 0.02], fixed=True)
    world.move({f"arm/{joint}": angle for joint, angle in arm.home.items()})
    if hand.closed:
        world.move({f"arm/gripper/{joint}": closed for joint, closed in hand.closed.items()})
    else:
        assert mh.robots.Vacuum(world, "arm/gripper/cup").on() == "cube"
    world.step(250)
    for height in np.linspace(0, 0.1, 101)[1:]:
        goal = mh.inverse_kinematics(world.model, "arm/gripper/tool", place + height * UP, turn, start=world.q)
        assert goal.success
        world.move({f"arm/{joint}": goal.q[world.model.joint(f"arm/{joint}").iq] for joint in arm.home})
        world.step(5)
    world.step(250)
    lifted = world.body_pose("cube")[0]
    assert lifted[2] - middle[2] == pytest.approx(0.1, abs=0.01)
    world.step(2500)
    np.testing.assert_allclose(world.body_pose("cube")[0], lifted, atol=1e-4)


@pytest.mark.parametrize("name", FINGERED)
def test_its_width_is_that_between_its_pads_and_grows_evenly(name: str) -> None:
    robot = mh.robots.describe(name)
    ((joint, closed),) = robot.closed.items()
    narrow, wide = robot.width
    for share, tolerance in ((0.0, 1e-4), (0.3, 2.5e-3), (0.7, 2.5e-3)):
        world = mh.World(mh.robots.load(name))
        world.move({joint: share * closed})
        world.step(500)
        middle = world.body_pose("tool")[0]
        outwards = [1, 0, 0] if name == "three_finger" else [0, 1, 0]
        hit = world.ray_cast(middle, outwards)
        assert hit is not None and 2 * hit.distance == pytest.approx(wide + share * (narrow - wide), abs=tolerance)


@pytest.mark.parametrize("name", FINGERED)
def test_fingers_reach_their_ends_with_nothing_between(name: str) -> None:
    world = mh.World(mh.robots.load(name))
    ((joint, closed),) = mh.robots.describe(name).closed.items()
    for goal in (closed, 0.0):
        world.move({joint: goal})
        world.step(500)
        assert world.q[world.model.joint(joint).iq] == pytest.approx(goal, abs=2e-2 * closed)


def test_a_vacuum_holds_a_cube_until_it_is_off() -> None:
    world = hanging("vacuum", 0.02)
    cup = mh.robots.Vacuum(world, "hand/cup")
    assert cup.on() == "cube" and cup.holds
    assert cup.on() is None
    world.remove("post")
    before = world.body_pose("cube")[0]
    world.step(1000)
    assert np.abs(world.body_pose("cube")[0] - before).max() < 1e-6
    cup.off()
    cup.off()
    assert not cup.holds
    world.step(250)
    assert world.body_pose("cube")[0][2] < before[2] - 0.05
    assert cup.on() is None


def test_the_desktop_arm_holds_a_cube_in_its_jaw() -> None:
    world = mh.World()
    world.add(mh.robots.load("desktop"), name="arm")
    robot = mh.robots.describe("desktop")
    world.move({f"arm/{joint}": value for joint, value in robot.home.items()})
    tool, _ = world.body_pose("arm/tool")
    half = 0.0115  # the tool is 12 mm from the jaw that stays
    world.add_box("cube", [half] * 3, mass=0.03, position=tool, friction=0.8)
    world.add_box("post", [half / 2, half / 2, 0.02], position=tool - [0, 0, half + 0.02], fixed=True)
    world.move({f"arm/{joint}": value for joint, value in robot.closed.items()})
    world.step(500)
    world.remove("post")
    before = world.body_pose("cube")[0]
    world.step(1000)
    assert np.abs(world.body_pose("cube")[0] - before).max() < 1e-3


def test_a_cube_falls_into_the_bin_and_a_drawer_opens() -> None:
    world = mh.World()
    world.add(mh.robots.load("bin"), name="bin")
    world.add_box("cube", [0.02] * 3, mass=0.1, position=[0.05, 0.03, 0.3])
    world.add(mh.robots.load("drawer_cabinet"), [1, 0, 0], name="cabinet")
    world.move({"cabinet/drawer2_joint": 0.25})
    world.step(1000)
    assert world.body_pose("cube")[0][2] == pytest.approx(0.026, abs=1e-3)
    assert world.q[world.model.joint("cabinet/drawer2_joint").iq] == pytest.approx(0.25, abs=1e-3)


def test_furniture_stands_where_it_is_put() -> None:
    for name in FURNITURE:
        world = mh.World()
        world.add_plane("floor")
        world.add(mh.robots.load(name, fixed_base=False), name=name)
        world.step(500)
        position, turn = world.body_pose(f"{name}/base")
        assert np.abs(position).max() < 2e-3 and turn[3] == pytest.approx(1, abs=1e-4), name
