"""What a first-time user stumbled over: wrong arguments that were taken in silence, or refused without a reason."""

import os
import time
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import manyhands as mh


def test_options_that_reset_does_not_know_are_refused() -> None:
    env = gymnasium.make("PandaReach-v3")
    with pytest.raises(ValueError, match="there are no options"):
        env.reset(options={"goal": [0, 0, 0]})
    env.reset(options={})


def test_restitution_above_one_is_refused() -> None:
    """It would make energy: a ball that is let go at 1 m rose to more than 10 m."""
    world = mh.World()
    with pytest.raises(ValueError, match=r"restitution is 2.*expected 0 to 1"):
        world.add_sphere("ball", 0.1, restitution=2)
    world.add_sphere("ball", 0.1, restitution=1)
    builder = mh.ModelBuilder()
    builder.add_link("ball", mass=1.0, inertia=np.eye(3))
    geom = builder.add_geom("ball", "sphere", 0.1)
    batch = mh.Batch(world.model, 2)
    for call in (
        lambda: world.set_restitution("ball", 2),
        lambda: batch.set_restitution("ball", [0.5, 2]),
        lambda: builder.add_geom("ball", "sphere", 0.1, restitution=2),
        lambda: builder.add_contact_pair(geom, geom, friction=1.0, restitution=2),
    ):
        with pytest.raises(ValueError, match=r"restitution is 2.*expected 0 to 1"):
            call()
    assert world.restitution("ball") == 1


@pytest.mark.parametrize(
    ("name", "file"),
    [
        (
            "ball.urdf",
            """<robot name="ball"><link name="ball"><contact><restitution value="2"/></contact><inertial>
            <mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
            <collision name="ball"><geometry><sphere radius="0.1"/></geometry></collision></link></robot>""",
        ),
        (
            "ball.sdf",
            """<sdf version="1.7"><model name="ball"><link name="ball"><collision name="ball">
            <geometry><sphere><radius>0.1</radius></sphere></geometry><surface><bounce>
            <restitution_coefficient>2</restitution_coefficient></bounce></surface></collision></link></model></sdf>""",
        ),
    ],
)
def test_restitution_above_one_in_a_file_is_repaired(tmp_path: Path, name: str, file: str) -> None:
    (tmp_path / name).write_text(file)
    with pytest.warns(mh.LoadWarning, match=r"would make energy; 1 taken"):
        world = mh.World.from_file(tmp_path / name)
    assert world.restitution("ball") == 1


def test_a_pair_whose_numbers_would_not_count_is_refused() -> None:
    builder = mh.ModelBuilder()
    builder.add_link("ball", mass=1.0, inertia=np.eye(3))
    geom = builder.add_geom("ball", "sphere", 0.1)
    with pytest.raises(ValueError, match=r"only with friction"):
        builder.add_contact_pair(geom, geom, restitution=0.5)


def test_rows_that_do_not_fit_say_what_would() -> None:
    batch = mh.Batch(mh.load_urdf(mh.asset_path("panda/panda.urdf"))[0], 4)
    with pytest.raises(ValueError, match=r"shape \(3,\) cannot be broadcast to \(4,\)"):
        batch.set_mass("panda_hand", [1, 2, 3])


def test_a_mesh_that_is_not_there_is_a_file_that_is_not_found() -> None:
    with pytest.raises(FileNotFoundError, match=r"nope\.obj"):
        mh.World().add_mesh("m", "nope.obj")


def test_what_is_no_file_is_told_to_be_none(tmp_path: Path) -> None:
    """A pipe that nobody writes into would block for ever."""
    os.mkfifo(tmp_path / "pipe.urdf")
    for path in (tmp_path, tmp_path / "pipe.urdf"):
        with pytest.raises(ValueError, match="expected a URDF, MJCF or SDF file"):
            mh.World.from_file(path)


def test_worlds_and_models_count_the_same_links() -> None:
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"))
    count = f"{len(model.links)} links"
    assert count in repr(model) and count in repr(mh.World(model))


def test_the_package_lists_what_is_for_users() -> None:
    assert {"World", "load_urdf", "view"} <= set(dir(mh))
    assert not {"Path", "TYPE_CHECKING", "import_module"} & set(dir(mh))


def test_a_hollow_body_has_the_inertia_that_it_is_given() -> None:
    """A torque about each axis turns it as 1 / I says."""
    world = mh.World()
    world.gravity = [0, 0, 0]
    world.add_box("shell", [0.05, 0.05, 0.05])
    inertia = np.diag([1e-3, 2e-3, 2.5e-3])
    world.set_inertial("shell", mass=0.3, inertia=inertia)
    assert world.mass("shell") == 0.3
    start = world.snapshot()
    for axis in range(3):
        world.restore(start)
        world.apply_force("shell", [0, 0, 0], torque=np.eye(3)[axis])
        world.step()
        assert world.v[axis] == pytest.approx(world.time_step / inertia[axis, axis], rel=1e-9)
    for mass, matrix, message in ((0, inertia, "mass"), (1, -inertia, "semi-definite"), (1, np.tri(3), "symmetric")):
        with pytest.raises(ValueError, match=message):
            world.set_inertial("shell", mass=mass, inertia=matrix)
    with pytest.raises(KeyError, match="shel'"):
        world.set_inertial("shel", mass=1, inertia=inertia)


def test_many_replicas_are_read_in_time_that_grows_with_their_number() -> None:
    """All pairs of geoms were compared: 100,000 took 88 s, in which Ctrl-C did nothing."""

    def seconds(count: int) -> float:
        scene = f"""<mujoco><worldbody><replicate count="{count}" offset="1 0 0"><body><freejoint/><geom size="0.1"/>
        </body></replicate></worldbody></mujoco>"""
        begin = time.process_time()
        model, _ = mh.load_mjcf_string(scene)
        assert len(model.links) == count + 1
        return time.process_time() - begin

    seconds(100)
    few = min(seconds(1000) for _ in range(3))
    assert seconds(16_000) < 64 * few  # 16 times as many, and four times as long each at most


def test_pairs_without_number_are_refused() -> None:
    """Each would have a surface of its own."""
    kinds = [f'<geom size="0.1" priority="{k}" solref="0.{k + 1} 1"/>' for k in range(2)]
    bodies = "".join(f'<replicate count="1100"><body><freejoint/>{kind}</body></replicate>' for kind in kinds)
    with pytest.raises(mh.MjcfError, match="more than 1,000,000 pairs with a surface of their own"):
        mh.load_mjcf_string(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")


@pytest.mark.parametrize(
    "text",
    [
        b'<robot name="r\xe9"><link name="a"/></robot>',
        b'<robot name="r"><link name="a\xff"/></robot>',
        b'<robot name="r">\n<link name="a" \xc3="x"/></robot>',
    ],
)
def test_names_that_are_no_utf8_are_refused(tmp_path: Path, text: bytes) -> None:
    """They were read, and every later look at them was a UnicodeDecodeError."""
    path = tmp_path / "robot.urdf"
    path.write_bytes(text)
    with pytest.raises(mh.UrdfError, match=r"robot\.urdf:\d.*no UTF-8; save the file as UTF-8"):
        mh.load_urdf(path)
    path.write_bytes(b'<robot name="r\xc3\xa9"><!-- \xe9 --><link name="a"/></robot>')
    assert mh.load_urdf(path)[0].name == "r\xe9"  # a comment may be what it likes
