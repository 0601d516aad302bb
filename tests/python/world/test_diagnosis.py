"""`World.diagnose` tells common mistakes in plain words, and leaves scenes alone that are right."""

from collections.abc import Callable

import numpy as np
import pytest

import manyhands as mh
import manyhands.pybullet as p
from manyhands import pybullet_data

HOME = [0.0, 0.4, 0.0, -1.2, 0.0, 2.0, 0.7, 0.02, 0.02]


def kinds(world: mh.World) -> list[str]:
    return [finding.kind for finding in world.diagnose()]


def cube(height: float = 1.0, ground: bool = True) -> mh.World:
    world = mh.World()
    if ground:
        world.add_plane("floor")
    world.add_box("cube", [0.1, 0.1, 0.1], position=[0, 0, height])
    return world


def arm(max_force: float = 87.0) -> mh.World:
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.q = HOME
    world.set_motors(target_q=HOME, max_force=max_force)
    return world


@pytest.mark.parametrize("height", [0.1, 1.0, 3.0, None])
def test_nothing_is_found_where_nothing_is_wrong(height: float | None) -> None:
    world = arm() if height is None else cube(height)
    for _ in range(60):
        world.step(10)
        assert world.diagnose() == []


def test_a_world_without_a_plane() -> None:
    world = cube(ground=False)
    world.add_sphere("ball", 0.1, position=[2, 0, 1])
    world.step(100)
    (finding,) = world.diagnose()
    assert finding.kind == "no_ground" and finding.parts == ["cube", "ball"]
    assert finding.text == (
        "'cube', 'ball': it falls, and nothing lies below; add a plane, or look whether it began under it"
    )
    world.add_plane("floor", position=[0, 0, -50])
    assert kinds(world) == []


def test_many_parts_are_counted_in_the_text() -> None:
    world = mh.World()
    for k in range(10):
        world.add_sphere(f"ball{k}", 0.1, position=[k, 0, 1])
    world.step(100)
    (finding,) = world.diagnose()
    assert len(finding.parts) == 10 and finding.text.startswith("'ball0', 'ball1', 'ball2' and 7 more: ")


def test_a_robot_beneath_the_edge_of_its_table_falls() -> None:
    world = mh.World()
    world.add_box("table", [0.3, 0.3, 0.01], fixed=True)
    world.add_box("cube", [0.05, 0.05, 0.05], position=[0, 0, 0.2])
    world.add_box("beside", [0.05, 0.05, 0.05], position=[0.5, 0, 0.2])
    world.step(80)
    (finding,) = world.diagnose()
    assert finding.parts == ["beside"]


def test_a_body_without_a_shape() -> None:
    builder = mh.ModelBuilder("ghost")
    builder.add_link("ghost", mass=1, inertia=np.eye(3))
    builder.add_joint("flight", "floating", "world", "ghost")
    builder.add_geom("ghost", "sphere", 0.1, visual=True)
    world = cube()
    world.add(builder)
    world.step()
    (finding,) = world.diagnose()
    assert finding.kind == "no_shape" and finding.parts == ["ghost"]


def test_no_gravity() -> None:
    world = cube()
    world.gravity = [0, 0, 0]
    world.step()
    assert kinds(world) == ["gravity"]
    fixed = arm()
    fixed.gravity = [0, 0, 0]
    fixed.step()
    assert kinds(fixed) == []  # an arm may well be without


def test_no_step() -> None:
    world = cube()
    assert kinds(world) == ["no_step"]
    world.step()
    assert kinds(world) == []


def test_a_motor_that_is_too_weak_to_hold_its_arm() -> None:
    """To hold still takes what inverse dynamics says."""
    world = arm(max_force=10)
    world.step(2)
    (finding,) = world.diagnose()
    assert finding.kind == "weak_motor" and finding.parts == ["panda_joint2"]
    needed = mh.dynamics.rnea(world.model, world.q, np.zeros(9), np.zeros(9))[1]
    assert "gives all that it may, 10 N m; to hold still takes" in finding.text
    assert f"takes {abs(needed):.3g} N m" in finding.text
    strong = arm(max_force=1.2 * abs(needed))
    strong.step(2)
    assert kinds(strong) == []


def test_a_motor_that_works_hard_is_not_too_weak() -> None:
    """It may be at its limit on its way, as long as it could stand still."""
    world = arm()
    world.set_motors(target_q=[1.0, *HOME[1:]], max_force=87)
    world.step(2)
    assert kinds(world) == []


def test_a_target_beyond_a_limit() -> None:
    world = arm()
    world.step()
    world.set_motors(target_q=[0, 3, *HOME[2:]], max_force=87)
    (finding,) = world.diagnose()
    assert finding.kind == "target_beyond_limit" and finding.parts == ["panda_joint2"]
    assert finding.text == ("'panda_joint2': its motor is to go to 3, and the joint goes from -1.83 to 1.83")
    world.set_motors(target_v=1.0, kp=0.0, max_force=87)  # a velocity has no target
    assert kinds(world) == []


def test_looking_changes_nothing() -> None:
    world = cube(0.1)
    world.step(10)
    before = world.state_hash()
    contacts = len(world.contacts())
    world.diagnose()
    assert world.state_hash() == before and len(world.contacts()) == contacts > 0


# ---- the same in PyBullet's words ----------------------------------------------------------------------------------


def test_a_client_of_pybullet_is_diagnosed() -> None:
    client = p.connect(p.DIRECT)
    p.setAdditionalSearchPath(pybullet_data.getDataPath(), physicsClientId=client)
    p.loadURDF("r2d2.urdf", [0, 0, 1], physicsClientId=client)
    assert [each.kind for each in p._diagnose(client)] == ["no_step", "gravity"]
    p.setGravity(0, 0, -9.81, physicsClientId=client)
    for _ in range(50):
        p.stepSimulation(physicsClientId=client)
    assert [each.kind for each in p._diagnose(client)] == ["no_ground"]
    p.disconnect(client)


def test_a_wrong_index_is_an_error_that_lists_the_joints() -> None:
    client = p.connect(p.DIRECT)
    p.setAdditionalSearchPath(pybullet_data.getDataPath(), physicsClientId=client)
    arm = p.loadURDF("kuka_iiwa/model.urdf", useFixedBase=True, physicsClientId=client)
    calls: list[tuple[str, Callable[[], object]]] = [
        ("Joint index out-of-range", lambda: p.setJointMotorControl2(arm, 9, p.POSITION_CONTROL)),
        ("Joint index out-of-range", lambda: p.getJointStates(arm, [0, 9])),
        ("Joint index out-of-range", lambda: p.resetJointState(arm, 9, 0)),
        ("getJointState failed", lambda: p.getJointState(arm, 9)),
        ("GetJointInfo failed", lambda: p.getJointInfo(arm, 9)),
    ]
    for start, call in calls:
        with pytest.raises(p.error) as caught:
            call()
        text = str(caught.value)
        assert text.startswith(start) and "there is no joint 9; body 0 has 0 'lbr_iiwa_joint_1', 1 'lbr_" in text, text
        assert text.endswith("6 'lbr_iiwa_joint_7'") and "\n" not in text
    with pytest.raises(p.error, match="Joint index out-of-range: there is no such body"):
        p.setJointMotorControl2(7, 0, p.POSITION_CONTROL)
    p.disconnect(client)
