"""The recorded scenes, as they are and without what leads them."""

import warnings
import xml.etree.ElementTree as ET
from pathlib import Path

import manyhands as mh
from benchmarks.mujoco_map import Compliance, Scene, mujoco


def scene_of(path: Path, compliance: Compliance = "stated") -> Scene:
    """As a user loads it; what gives way with us is up to `compliance`."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mh.LoadWarning)
        world = mh.World.from_file(path, compliance=compliance)
    assert world.report is not None
    return Scene(mujoco.MjModel.from_xml_path(str(path)), world.model, world.report)


def led_scene(path: Path, compliance: Compliance = "stated") -> Scene:
    """Without the welds to mocap bodies: the forces of a `Servo` take their place."""
    tree = ET.parse(path)
    mocap = {body.get("name") for body in tree.iter("body") if body.get("mocap") == "true"}
    for equality in tree.iter("equality"):
        for weld in equality.findall("weld"):
            if mocap & {weld.get("body1"), weld.get("body2")}:
                equality.remove(weld)
    beside = path.with_name("led.xml")
    tree.write(beside)
    return scene_of(beside, compliance)


def harden(scene: Scene, substeps: int) -> None:
    """Makes MuJoCo's limits and contacts as hard as they stay stable, at a step that is so many times shorter."""
    model = scene.mujoco
    model.opt.timestep /= substeps
    for reference, impedance in ((model.jnt_solref, model.jnt_solimp), (model.geom_solref, model.geom_solimp)):
        reference[:] = 2 * model.opt.timestep, 1
        impedance[:, :2] = 0.99, 0.999
