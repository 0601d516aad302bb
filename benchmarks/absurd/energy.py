"""The energy that a scene can have at most, reckoned from outside.

What a scene has is the kinetic energy, and what its potentials (gravity, springs, drives towards a position) have
gained since the start. What it can have is the energy of the start, what the potentials have lost, the work of motors,
and what corrections bring: surfaces that overlap part at 0.1 m/s, open constraints close and joints beyond their limits
return at 1 m/s or rad/s, against weights, springs and drives. The ratio of the two is 1 or less where nothing errs.
Explicit steps make errors of their own, which grow with the angle by which a thing turns in one.
"""

import numpy as np

import manyhands as mh
from benchmarks.absurd.setting import Setting

PARTING, CLOSING = 0.1, 1.0  # [m/s], [m/s or rad/s]
# A correction yields by a part of the mobility: what it moves weighs so many times as much at most.
PARTING_WEIGHS, CLOSING_WEIGHS = 10.0, 100.0
ROUNDING = 1e-9  # of the largest of the terms that cancel


class Ledger:
    """Of one world, from its start on. `ratio`: the largest so far."""

    def __init__(self, setting: Setting, world: mh.World) -> None:
        model = world.model
        self.model, self.h = model, world.time_step
        pulls = bool(
            setting.jumps or model.equalities or any(np.isfinite([j.lower, j.upper]).any() for j in model.joints)
        )
        pulls |= any(np.isfinite([t.lower, t.upper]).any() for t in model.tendons)
        self.speed, self.weighs = (CLOSING, CLOSING_WEIGHS) if pulls else (PARTING, PARTING_WEIGHS)
        self.motors = setting.motors
        self.weight = float(np.linalg.norm(world.gravity)) * sum(link.mass for link in model.links)
        self.inertia = self.lifting = 0.0
        self.ctrl = world.ctrl
        kinetic, potential = world.energy()
        self.kinetic = kinetic
        self.potential = potential + self.drives(world)
        self.size = abs(potential)
        self.work = 0.0
        self.steps = 0
        self.ratio = 0.0
        self.last = ""

    def drives(self, world: mh.World) -> float:
        """The potential of drives towards a position [J]."""
        total = 0.0
        for actuator, ctrl in zip(self.model.actuators, self.ctrl, strict=True):
            if actuator.type != "position":
                continue
            stretch = abs(
                actuator.ctrl_scale * ctrl + actuator.ctrl_offset - actuator.gear * self.place(world, actuator)
            )
            bend = actuator.max_force / actuator.kp if actuator.kp > 0 else np.inf
            near = min(stretch, bend)
            total += 0.5 * actuator.kp * near**2 + (actuator.max_force * (stretch - near) if stretch > near else 0.0)
        return total

    def pull(self, world: mh.World) -> float:
        """The forces of springs and drives now [N m or N]: corrections move joints against them."""
        total = 0.0
        for joint in self.model.joints:
            if joint.stiffness > 0 and joint.nv == 1:
                rest = joint.spring_reference[0] if len(joint.spring_reference) else 0.0
                total += joint.stiffness * abs(world.q[joint.iq] - rest)
        for tendon, length in zip(self.model.tendons, world.tendon_lengths, strict=True):
            total += tendon.stiffness * max(0.0, length - tendon.spring_upper, tendon.spring_lower - length)
        for actuator, ctrl in zip(self.model.actuators, self.ctrl, strict=True):
            if actuator.type == "position":
                stretch = (
                    actuator.ctrl_scale * ctrl + actuator.ctrl_offset - actuator.gear * self.place(world, actuator)
                )
                total += abs(actuator.gear) * min(actuator.kp * abs(stretch), actuator.max_force)
        return total

    def place(self, world: mh.World, actuator: mh.Actuator) -> float:
        """What a drive acts on: q, or a tendon's length."""
        if actuator.joint < 0:
            return float(world.tendon_lengths[actuator.tendon])
        return float(world.q[self.model.joints[actuator.joint].iq])

    def rate(self, world: mh.World, actuator: mh.Actuator) -> float:
        """Its rate."""
        if actuator.joint < 0:
            return float(world.tendon_velocities[actuator.tendon])
        return float(world.v[self.model.joints[actuator.joint].iv])

    def add_work(self, world: mh.World) -> None:
        """Of motors and drives in the step that has been [J]."""
        if self.motors > 0:
            self.work += self.motors * float(np.sum(np.abs(world.v))) * self.h
        for actuator, ctrl in zip(self.model.actuators, self.ctrl, strict=True):
            rate = actuator.gear * self.rate(world, actuator)
            target = actuator.ctrl_scale * ctrl + actuator.ctrl_offset
            if actuator.type == "force":
                self.work += abs(target * rate) * self.h
            elif actuator.type == "velocity":
                force = np.clip(actuator.kd * (target - rate), -actuator.max_force, actuator.max_force)
                self.work += max(0.0, float(force) * rate) * self.h

    def see(self, world: mh.World) -> None:
        """After a step."""
        self.steps += 1
        self.add_work(world)
        if self.steps % 10 == 1 and self.model.nv:
            self.inertia = max(self.inertia, float(np.trace(mh.dynamics.crba(self.model, np.array(world.q)))))
        kinetic, potential = world.energy()
        self.size = max(self.size, abs(potential))
        gained = potential + self.drives(world) - self.potential
        self.lifting += (self.weight + self.pull(world)) * self.speed * self.h
        corrections = self.weighs * 0.5 * self.inertia * self.speed**2 + self.lifting
        supply = self.kinetic + self.work + corrections + max(0.0, -gained) + ROUNDING * self.size + 1e-300
        ratio = (kinetic + max(0.0, gained)) / supply
        if ratio > self.ratio:
            self.ratio = ratio
            self.last = (
                f"step {self.steps}: kinetic {kinetic:.2g} J, potentials gained {gained:.2g} J; "
                f"start {self.kinetic:.2g} J, motors {self.work:.2g} J, corrections {corrections:.2g} J"
            )
