"""Joints by hand: sliders, and what they mean to a world."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from manyhands._core import Model, World
from manyhands.kinematics import inverse_kinematics

Array = NDArray[np.float64]
Send = Callable[[list[str], list[float], list[float]], None]

_GAIN = 0.05  # of the way to its target that a motor takes in a step
_FORCE = 100.0  # [N m or N] where the model names no limit
_TURN, _SLIDE = np.pi, 1.0  # reach of a slider whose joint has no limits
_FINGERS = ("finger", "gripper", "jaw")


class Knob(NamedTuple):
    """A joint of one degree of freedom that a slider moves."""

    name: str
    iq: int
    iv: int
    lower: float
    upper: float
    force: float
    """What its motor may use [N m or N]."""
    actuator: int
    """The position actuator that drives it; -1: a motor of the page's."""
    gear: float
    is_finger: bool
    follows: str
    """The joint that it mimics, which alone has a slider; empty if none."""


class JointDrive:
    """Targets for the joints of a world.

    Nothing is driven until a target is set; then every joint is, and those that nobody moved hold still. Position
    actuators are told by `World.ctrl`, other joints have PyBullet-style motors. Joints that a loop couples move
    together.
    """

    def __init__(self, world: World, send: Send | None = None) -> None:
        """send: drives joints of the given names to targets with forces, where motors belong to somebody else."""
        self._world, self._send_to = world, send
        self._parts: tuple[str, ...] = ()
        self._knobs: dict[str, Knob] = {}
        self._targets: dict[str, float] = {}

    @property
    def knobs(self) -> list[Knob]:
        """All joints that a slider may move, in the model's order."""
        self._refresh()
        return list(self._knobs.values())

    def value(self, knob: Knob) -> float:
        """Where the joint is [rad or m]."""
        return float(self._world.q[knob.iq])

    def target(self, name: str) -> float:
        """Where it is driven to, or where it is if nothing is driven."""
        self._refresh()
        return self._targets.get(name, self.value(self._knobs[name]))

    def move(self, targets: dict[str, float], *, place: bool = False) -> None:
        """Drives joints to targets [rad or m]; `place` puts them there at once, at rest. Raises KeyError on an unknown
        name."""
        self.hold()
        wanted = self._coupled(targets)
        for name, value in wanted.items():
            knob = self._knobs[name]
            self._targets[name] = float(np.clip(value, knob.lower, knob.upper))
        if place:
            q, v = self._world.q.copy(), self._world.v.copy()
            for name in wanted:
                q[self._knobs[name].iq], v[self._knobs[name].iv] = self._targets[name], 0.0
            self._world.q, self._world.v = q, v
        self._send()

    def reach(self, frame: str, position: Array, quaternion: Array, *, place: bool = False) -> bool:
        """Drives the joints that move a frame so that it comes to a pose (3), (4), or as near as there is a way without
        a jump. Gives whether it reaches it."""
        self._refresh()
        q = self._world.q.copy()
        for name, target in self._targets.items():
            q[self._knobs[name].iq] = target
        try:
            found = inverse_kinematics(self._world.model, frame, position, quaternion, start=q, restarts=0)
        except ValueError:  # a floating base, or a frame that no joint moves
            return False
        moved = {k.name: float(found.q[k.iq]) for k in self.knobs if found.q[k.iq] != q[k.iq]}
        if moved and found.position_error < 0.05:
            self.move(moved, place=place)
        return bool(found.success)

    def grip(self, opening: float, *, place: bool = False) -> None:
        """Opens the fingers as far as they go with 1, closes them with 0."""
        fingers = [knob for knob in self.knobs if knob.is_finger]
        if fingers:
            part = float(np.clip(opening, 0, 1))
            self.move({k.name: k.lower + (k.upper - k.lower) * part for k in fingers}, place=place)

    @property
    def opening(self) -> float | None:
        """Where the fingers are driven to, from 0 to 1; None without fingers."""
        fingers = [knob for knob in self.knobs if knob.is_finger]
        if not fingers:
            return None
        return float(np.mean([(self.target(k.name) - k.lower) / (k.upper - k.lower) for k in fingers]))

    def hold(self) -> None:
        """Drives all joints to where they are, unless they are driven already."""
        self._refresh()
        if not self._targets:
            self._targets = {knob.name: self.value(knob) for knob in self._knobs.values()}

    def start_holding(self) -> None:
        """Holds all joints where they are now."""
        self._targets = {}
        self.hold()
        self._send()

    def release(self) -> None:
        """After the world was put elsewhere: what was driven holds where it is now."""
        if self._targets:
            self.start_holding()

    def forget(self) -> None:
        """Drives nothing from now on; what motors were told they keep."""
        self._targets = {}

    def save(self) -> dict[str, float]:
        return dict(self._targets)

    def restore(self, targets: dict[str, float]) -> None:
        """Targets that `save` gave; the world itself remembers its motors."""
        self._targets = dict(targets)

    def _coupled(self, targets: dict[str, float]) -> dict[str, float]:
        """With those of the joints that mimic them, or that they mimic, and so on."""
        wanted, known, couplings = dict(targets), dict(targets), _couplings(self._world.model)
        while known:
            name, value = known.popitem()
            for leader, follower, ratio, offset in couplings:
                if name == leader and follower in self._knobs and follower not in wanted:
                    wanted[follower] = known[follower] = ratio * value + offset
                elif name == follower and leader in self._knobs and leader not in wanted:
                    wanted[leader] = known[leader] = (value - offset) / ratio
        return wanted

    def _send(self) -> None:
        known = [knob for knob in self._knobs.values() if knob.name in self._targets]
        motors = [knob for knob in known if knob.actuator < 0]
        if self._send_to is not None:
            self._send_to([k.name for k in motors], [self._targets[k.name] for k in motors], [k.force for k in motors])
        elif motors:
            target, force = np.zeros((2, self._world.model.nv))
            for knob in motors:
                target[knob.iv], force[knob.iv] = self._targets[knob.name], knob.force
            self._world.set_motors(target_q=target, kp=_GAIN, max_force=force)
        ctrl = self._world.ctrl.copy()
        for knob in known:
            if knob.actuator >= 0:
                ctrl[knob.actuator] = knob.gear * self._targets[knob.name]
        if len(ctrl):
            self._world.ctrl = ctrl

    def _refresh(self) -> None:
        """Reads the joints anew if parts came or went."""
        parts = tuple(self._world.names)
        if self._knobs and parts == self._parts:
            return
        self._parts = parts
        self._knobs = {knob.name: knob for knob in _knobs(self._world.model)}
        self._targets = {name: target for name, target in self._targets.items() if name in self._knobs}


def _couplings(model: Model) -> list[tuple[str, str, float, float]]:
    """Joints a, and b that mimic them: b = ratio a + offset."""
    joints = model.joints
    return [
        (joints[equality.joint_a].name, joints[equality.joint_b].name, equality.ratio, equality.offset)
        for equality in model.equalities
        if equality.type == "joint" and equality.ratio != 0
    ]


def _knobs(model: Model) -> list[Knob]:
    drives: dict[int, Any] = {}
    for index, actuator in enumerate(model.actuators):
        drives.setdefault(actuator.joint, (index, actuator))
    knobs = []
    leaders = {follower: leader for leader, follower, _, _ in _couplings(model)}
    for index, joint in enumerate(model.joints):
        if joint.nv != 1:
            continue
        number, drive = drives.get(index, (-1, None))
        if drive is not None and drive.type != "position":
            continue
        reach = _SLIDE if joint.type == "prismatic" else _TURN
        lower, upper = max(joint.lower, -reach * 2), min(joint.upper, reach * 2)
        if not np.isfinite([joint.lower, joint.upper]).all():
            lower, upper = max(joint.lower, -reach), min(joint.upper, reach)
        if not upper > lower:
            continue
        force = joint.effort if 0 < joint.effort < np.inf else _FORCE
        gear = 1.0 if drive is None else drive.gear
        names = (joint.name, model.links[joint.child].name)
        is_finger = any(word in name.lower() for word in _FINGERS for name in names)
        knobs.append(
            Knob(
                joint.name,
                joint.iq,
                joint.iv,
                lower,
                upper,
                force,
                number,
                gear,
                is_finger,
                leaders.get(joint.name, ""),
            )
        )
    return knobs
