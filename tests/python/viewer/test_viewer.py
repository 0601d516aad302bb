"""The viewer and its command, without a browser."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from viewed import falling_ball, panda, until

import manyhands as mh
from manyhands.plots import plot
from manyhands.recording import Recorder
from manyhands.viewer import Viewer


def test_what_cannot_be_shown_is_refused() -> None:
    with pytest.raises(TypeError, match="expected a World or an environment"):
        Viewer(object(), announce=False)
    with pytest.raises(ValueError, match="fps"):
        Viewer(falling_ball(), fps=0, announce=False)
    for port in ("x", -1, 2**16):
        with pytest.raises(ValueError, match="port is"):
            Viewer(falling_ball(), port=port, announce=False)  # pyright: ignore[reportArgumentType]


def test_a_stretched_robot_is_seen_to_its_end() -> None:
    """Its last link is long, and only its shape tells."""
    box = '<geom type="box" size="0.25 0.03 0.03" pos="0.25 0 0"/>'
    link = f'<body pos="0.5 0 0"><joint axis="0 1 0"/>{box}</body>'
    scene = f'<mujoco><worldbody><body pos="0 0 0.3"><joint/>{box}{link}</body></worldbody></mujoco>'
    world = mh.World(mh.load_mjcf_string(scene)[0])
    with Viewer(world, port=18450, announce=False) as viewer:
        eye, look_at = viewer.stage.camera()
        forward = (look_at - eye) / np.linalg.norm(look_at - eye)
        for end in ([0.0, 0.0, 0.3], [1.0, 0.0, 0.3]):
            to = np.array(end) - eye
            assert np.degrees(np.arccos(to @ forward / np.linalg.norm(to))) < 38 / 2


def test_a_port_that_is_taken_is_told(here: Viewer, capsys: pytest.CaptureFixture[str]) -> None:
    taken = here.server.get_port()
    with Viewer(falling_ball(), port=taken) as other:
        assert other.server.get_port() != taken
        assert f"{other.url} (port {taken} is taken)" in capsys.readouterr().out


@pytest.mark.parametrize("package", ["viser", "matplotlib"])
def test_a_missing_package_is_installed_by_what_is_said(
    package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For the Python that runs, and with the packages by their own names: nothing needs to be found by this one's."""
    recording = Recorder(panda())
    recording.add()
    run = recording.recording()
    for name in [*sys.modules]:
        if name.split(".")[0] == package or name.startswith("manyhands.viewer."):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ModuleNotFoundError) as raised:
        if package == "viser":
            mh.view(falling_ball(), announce=False)
        else:
            plot(run, tmp_path / "run.png")
    what, _, command = str(raised.value).partition(": ")
    assert what.endswith(f"needs {package}")
    python, *words, first, second = shlex.split(command)
    assert (python, *words) == (sys.executable, "-m", "pip", "install")
    assert re.match(f"{package}[=>]=", first) and re.match(r"(pillow|plotly)>=", second)


def test_a_recording_is_one_file_with_all_that_moved(here: Viewer, tmp_path: Path) -> None:
    here.speed = 2.0
    here.play()
    until(lambda: here.source.time > 0.5)
    here.pause()
    path = here.save_html(tmp_path / "run.html", seconds=0.4)
    text = path.read_text()
    assert text.startswith("<!") and "__VISER_EMBED_DATA__" in text
    assert "http-equiv" not in text.lower() and 'src="http' not in text


def test_axes_trails_and_plots_are_chosen(here: Viewer) -> None:
    view, graphs, body = here.panel.view, here.panel.graphs, here.stage.index["ball"]
    for name, shown in (("ball", [body]), ("all links", [*here.stage.index.values()]), ("none", [])):
        view._frames.value = name
        until(lambda shown=shown: [k for k, each in enumerate(here.stage._bodies) if each.show_axes] == shown)
    view._trail.value = "ball"
    until(lambda: here.overlays.trails == ["ball"])
    here.plot("height", lambda: here.source.poses()[0][body][2])
    for quantity in ("height", "Energy", "Contact force"):
        graphs._choice.value = quantity
        until(lambda quantity=quantity: list(here.player.watched) == [quantity])
        here.play()
        until(lambda: graphs._plot is not None and len(graphs._rows) > 3)
        here.pause()
    graphs._choice.value = "none"
    view._trail.value = "none"
    until(lambda: not here.player.watched and not here.overlays.trails)
    assert not here.player.problem


def test_cameras_see_the_scene_while_somebody_has_the_page_open(here: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    cameras = here.panel.cameras
    assert cameras is not None
    cameras._choice.value = "front"
    cameras.refresh(None)  # pyright: ignore[reportArgumentType]
    assert here.player.do(lambda: None, wait=5.0)
    assert cameras._image.image.std() == 0
    monkeypatch.setattr(here.server, "get_clients", lambda: {0: object()})
    until(lambda: cameras._image.image.std() > 5, 20.0)
    assert cameras._image.image.shape == (240, 320, 3)
    cameras._choice.value = "none"


def test_parts_may_come_and_go_while_they_are_seen(here: Viewer) -> None:
    world = here.source.world
    assert world is not None
    here.player.do(lambda: world.add_box("box", [0.1, 0.1, 0.1], mass=1.0, position=[0.5, 0, 0.1]), wait=2.0)
    until(lambda: "box" in here.stage.index)
    here.player.do(lambda: world.remove("box"), wait=2.0)
    until(lambda: "box" not in here.stage.index)
    assert not here.player.problem


@pytest.mark.parametrize("target", ["panda", "seven_axis", "scara+vacuum", "table", "PandaReach", "scene.xml"])
def test_the_command_shows_robots_scenes_and_environments(
    target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from manyhands import cli

    if target == "scene.xml":
        path = tmp_path / target
        path.write_text('<mujoco><worldbody><geom type="plane" size="1 1 1"/></worldbody></mujoco>')
        target = str(path)
    seen: list[Viewer] = []
    monkeypatch.setattr(Viewer, "wait", lambda viewer: seen.append(viewer))
    assert cli.main(["view", target, "--port", "18440"]) == 0
    assert len(seen) == 1
    assert "http://localhost:18" in capsys.readouterr().out


def test_the_command_says_what_it_does_not_know(capsys: pytest.CaptureFixture[str]) -> None:
    from manyhands import cli

    assert cli.main(["view", "PandaRaech"]) == 2
    assert "PandaReach" in capsys.readouterr().err
    assert cli.main(["view", "seven_axi"]) == 2
    assert "no robot or environment 'seven_axi'; did you mean seven_axis" in capsys.readouterr().err
    assert cli.main(["view", "nowhere.urdf"]) == 2
    assert "nowhere.urdf" in capsys.readouterr().err
    assert cli.main(["view", __file__]) == 2
    assert f"{__file__} is no URDF, MJCF or SDF" in capsys.readouterr().err


def test_the_page_leaves_gymnasiums_environments_as_they_are() -> None:
    """Importing the drop-in changes them, in all of a program."""
    code = "import sys, manyhands.viewer.viewer; sys.exit('manyhands.panda_gym' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
