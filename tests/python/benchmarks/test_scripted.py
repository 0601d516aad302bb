"""`python -m benchmarks.scripted`: recording and replay on scenes of our own; no package is fetched."""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[3]))

pytest.importorskip("mujoco")

from benchmarks.mujoco_map import mujoco
from benchmarks.scripted import compare as comparing
from benchmarks.scripted.compare import HARD, LED_OURS, LED_THEIRS, RECORDED, THEIRS, Compared
from benchmarks.scripted.recorders.recorder import Recorder
from benchmarks.scripted.tasks import Task, joint

DRAWER = """
  <body name="drawer" pos="0.3 0 0.1"><joint name="slide" type="slide" axis="1 0 0" damping="20" {limit}/>
    <geom type="box" size="0.05 0.1 0.05" mass="1" group="2"/></body>"""
# The ball has no mass: only geoms of group 2 have, which MuJoCo forgets when it writes a scene.
LED_HAND = """
<mujoco><option timestep="0.002"/><compiler inertiagrouprange="2 2"/><worldbody>
  <body name="target" mocap="true" pos="0 0 0.1"/>
  <body name="hand" pos="0 0 0.1"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
    <joint type="slide" axis="0 0 1"/><geom type="box" size="0.03 0.03 0.03" mass="2" group="2"/>
    <geom type="sphere" size="0.01" mass="5" group="0" contype="0" conaffinity="0"/></body>{drawer}</worldbody>
  <equality><weld body1="target" body2="hand"/></equality></mujoco>"""
DRIVEN_HAND = """
<mujoco><option timestep="0.002"/><worldbody>
  <body pos="0 0 0.1"><joint name="reach" type="slide" axis="1 0 0" damping="5"/>
    <geom type="box" size="0.03 0.03 0.03" mass="1"/></body>{drawer}</worldbody>
  <actuator><motor joint="reach"/></actuator></mujoco>"""
PUSHED = Task("own", "drawer", "way of the drawer", "m", joint("slide"), (0, 0, 0), 1, 0)


def compared(folder: Path, text: str, limit: str = "", **commands: Any) -> Compared:
    """A second of it, recorded and replayed. commands: of each name in MuJoCo's data, by time."""
    model = mujoco.MjModel.from_xml_string(text.format(drawer=DRAWER.format(limit=limit)))
    recorder = Recorder(model, mujoco.MjData(model))
    for k in range(500):
        for name, command in commands.items():
            setattr(recorder.data, name, command(k * model.opt.timestep))
        recorder.step()
    recorder.write(folder / "drawer", Path())
    return comparing.compare(PUSHED, folder / "drawer")


def towards(place: float) -> Any:
    """Of a mocap body that moves along x for a second."""
    return lambda time: [[place * (1 - math.cos(math.pi * time)) / 2, 0, 0.1]]


def test_what_a_mocap_body_leads(tmp_path: Path) -> None:
    found = compared(tmp_path, LED_HAND, mocap_pos=towards(0.4))
    assert not found.failed
    assert np.array_equal(found.paths[THEIRS], found.paths[RECORDED])  # the written scene is the recorded one
    np.testing.assert_allclose(found.paths[LED_THEIRS], found.paths[RECORDED], atol=1e-3)
    assert (found.outcome(RECORDED) or 0) > 0.1
    assert found.verdict == "same"
    assert abs(found.difference(RECORDED)) < 0.02


def test_what_motors_drive(tmp_path: Path) -> None:
    found = compared(tmp_path, DRIVEN_HAND, ctrl=lambda time: 8 * math.sin(6 * time))
    assert np.array_equal(found.paths[LED_THEIRS], found.paths[RECORDED])  # its servo has nothing to do
    assert (found.outcome(RECORDED) or 0) > 0.05
    assert found.verdict == "same"


def test_what_passes_soft_limits(tmp_path: Path) -> None:
    found = compared(tmp_path, LED_HAND, 'range="0 0.05" limited="true"', mocap_pos=towards(0.5))
    assert (found.outcome(RECORDED) or 0) > 0.06
    assert found.outcome(LED_OURS) == pytest.approx(0.05, abs=1e-3)
    assert found.outcome(HARD) == pytest.approx(0.05, abs=1e-3)
    assert found.verdict == "as MuJoCo's when hard"
    assert found.figures()["verdict"] == found.verdict


def test_what_differs_is_said(tmp_path: Path) -> None:
    found = compared(tmp_path, LED_HAND, mocap_pos=towards(0.4))
    found.paths[LED_OURS] = found.paths[LED_OURS][:1]
    assert found.verdict == "differs"
    del found.paths[LED_OURS]
    assert found.verdict == "differs"
