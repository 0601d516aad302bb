"""The command `manyhands convert`, and saving from Python."""

from pathlib import Path

import pytest

import manyhands as mh
from manyhands import cli

ARM = """<mujoco><worldbody><body name="arm"><joint name="j" type="{kind}"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>"""


@pytest.fixture
def hinge(tmp_path: Path) -> Path:
    path = tmp_path / "hinge.xml"
    path.write_text(ARM.format(kind="hinge"), encoding="utf-8")
    return path


@pytest.fixture
def ball(tmp_path: Path) -> Path:
    path = tmp_path / "ball.xml"
    path.write_text(ARM.format(kind="ball"), encoding="utf-8")
    return path


def test_to_urdf_and_back(hinge: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot, again = tmp_path / "hinge.urdf", tmp_path / "again.xml"
    assert cli.main(["convert", str(hinge), str(robot)]) == 0
    assert cli.main(["convert", str(robot), str(again)]) == 0
    assert "nq 1" in capsys.readouterr().out
    assert mh.load_mjcf(again)[0].link("arm").mass == 1


def test_a_robot_with_meshes(tmp_path: Path) -> None:
    scene = tmp_path / "panda.xml"
    assert cli.main(["convert", str(mh.asset_path("panda/panda.urdf")), str(scene), "--quiet"]) == 0
    assert mh.load_mjcf(scene)[0].nq == mh.load_urdf(mh.asset_path("panda/panda.urdf"))[0].nq
    assert list((tmp_path / "panda_assets").glob("*.obj"))


def test_what_is_lost_is_asked_for(ball: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot = tmp_path / "ball.urdf"
    assert cli.main(["convert", str(ball), str(robot)]) == 2
    assert "allow" in capsys.readouterr().err
    assert not robot.exists()
    assert cli.main(["convert", str(ball), str(robot), "--allow-loss"]) == 0
    assert "spherical" in capsys.readouterr().err


def test_requests_that_make_no_sense(hinge: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = hinge.read_text(encoding="utf-8")
    for target in (hinge, tmp_path / "robot.stl", tmp_path / "none" / "robot.urdf"):
        assert cli.main(["convert", str(hinge), str(target)]) == 2
    assert cli.main(["convert", str(tmp_path / "missing.xml"), str(tmp_path / "robot.urdf")]) == 2
    assert capsys.readouterr().err.count("manyhands convert: ") == 4
    assert hinge.read_text(encoding="utf-8") == before


def test_a_text_needs_no_files() -> None:
    model = mh.load_urdf(mh.asset_path("panda/panda.urdf"))[0]
    text, report = mh.save_mjcf_string(model)
    assert not any(note.serious for note in report.notes)
    again = mh.load_mjcf_string(text)[0]
    assert mh.load_mjcf_string(mh.save_mjcf_string(again)[0])[0].fingerprint == again.fingerprint
