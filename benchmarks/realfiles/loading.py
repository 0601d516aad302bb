"""A file loaded by both programs."""

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import manyhands as mh
from benchmarks.mujoco_map import MjModel, Scene, mujoco
from benchmarks.realfiles.wording import alike

DISABLED = {int(bit): bit.name[7:].lower() for bit in mujoco.mjtDisableBit.__members__.values() if int(bit) > 0}
EQUALITY_KINDS = ("connect", "weld", "joint", "tendon", "flex", "flexvert", "distance", "flexstrain")


def load_theirs(path: Path) -> tuple[MjModel | None, str]:
    """MuJoCo's model, or None and why not."""
    try:
        return mujoco.MjModel.from_xml_path(str(path)), ""
    except (ValueError, mujoco.FatalError) as why:
        return None, first_line(why)


@dataclass
class Ours:
    """What we make of a file. `refused`: what a user meets who loads it as it stands; empty if it loads."""

    model: mh.Model | None = None
    report: mh.LoadReport | None = None
    refused: str = ""
    warned: bool = False


def load_ours(path: Path) -> Ours:
    """The file as a user loads it; if that is refused, once more with every door open, so that the rest is seen."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            world = mh.World.from_file(path)
            return Ours(world.model, world.report, "", bool(caught))
        except Exception as why:
            refused = f"{type(why).__name__}: {first_line(why)}"
        try:
            return Ours(*mh.load_mjcf(path, allow_outside_package=True), refused, bool(caught))
        except Exception:
            return Ours(None, None, refused, bool(caught))


def first_line(why: Exception) -> str:
    """Of its message."""
    return (str(why).strip() or "no reason given").splitlines()[0][:300]


def scene_of(theirs: MjModel, ours: Ours) -> Scene | None:
    """Both, if we have it."""
    if ours.model is None or ours.report is None:
        return None
    return Scene(theirs, ours.model, ours.report)


def serious(report: mh.LoadReport) -> list[str]:
    """What is missing or moves otherwise than the file asks for, by our own word."""
    return sorted({alike(f"{note.element.split(' ')[0]}: {note.message}") for note in report.notes if note.serious})


def features(model: MjModel) -> list[str]:
    """What the file asks of motion, in MuJoCo's words."""
    option = model.opt
    hinge_like = np.isin(model.jnt_type, [int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)])
    asked = {
        "mocap bodies": model.nmocap > 0,
        "joint springs": bool(np.any(model.jnt_stiffness)),
        "tendons": model.ntendon > 0,
        "tendon limits": bool(np.any(model.tendon_limited)),
        "tendon springs": bool(np.any(model.tendon_stiffness) or np.any(model.tendon_damping)),
        "tendon friction": bool(np.any(model.tendon_frictionloss)),
        "fluid": bool(option.density or option.viscosity),
        "gravcomp": bool(np.any(model.body_gravcomp)),
        "activations": model.na > 0,
        "ball limits": bool(np.any(model.jnt_limited[~hinge_like])),
        "flex or skin": model.nflex > 0,
        "margin": bool(np.any(model.geom_margin)),
        "height field": model.nhfield > 0,
        "plugins": model.nplugin > 0,
    }
    found = [name for name, present in asked.items() if present]
    found += [f"actuator on {kind}" for kind in sorted(transmissions(model))]
    found += [f"equality {kind}" for kind in sorted({EQUALITY_KINDS[i] for i in model.eq_type})]
    found += [f"no {name}" for bit, name in DISABLED.items() if option.disableflags & bit]
    if option.integrator:
        found.append(mujoco.mjtIntegrator(option.integrator).name[6:].lower())
    return found


def transmissions(model: MjModel) -> set[str]:
    """What actuators act on, joints apart."""
    joint = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    return {mujoco.mjtTrn(kind).name[6:].lower() for kind in model.actuator_trntype if kind not in joint}


def overlap(model: MjModel) -> float:
    """How deep geoms lie in each other at the start, in MuJoCo [m]; tiny if they only touch, 0 if they do not."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    touching = [contact.dist for contact in data.contact if contact.dist <= contact.includemargin]
    return max(-min(touching), 1e-12) if touching else 0.0
