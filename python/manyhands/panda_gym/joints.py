"""Where the joints of a world have their numbers, and the motors that drive them."""

from collections.abc import Iterable, Sequence

import numpy as np

from manyhands._core import World
from manyhands.rotations import Array

# What Bullet gives every joint that is not commanded: no velocity, by at most 1 N m s in a step of 2 ms.
_HOLDING_FORCE = 500.0
_GAIN = 0.1


class Joints:
    """Joints of one degree of freedom, by their names in the world. Bullet's motors hold all that are not driven."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._places: dict[str, tuple[int, int]] = {}
        self._is_current = False
        # One number for each dof (nv): targets [rad or m], gains, greatest forces [N m or N].
        self._motors = np.zeros((3, 0))

    def world_has_changed(self) -> None:
        """To be called when parts of the world came, went or were put elsewhere."""
        self._is_current = False

    def places(self) -> dict[str, tuple[int, int]]:
        """Where each joint is in q and in v."""
        if not self._is_current:
            self._find()
        return self._places

    def drive(self, names: Iterable[str], angles: Sequence[float], forces: Sequence[float]) -> None:
        """Motors that take a tenth of the way to the angle in each step, with at most the force."""
        places = self.places()
        for name, angle, force in zip(names, angles, forces, strict=True):
            self._motors[:, places[name][1]] = angle, _GAIN, force
        self._send()

    def hold(self) -> None:
        """Holds all joints where they are."""
        for _, iv in self.places().values():
            self._motors[:, iv] = 0.0, 0.0, _HOLDING_FORCE
        self._send()

    @property
    def commands(self) -> Array:
        """Of the motors (3, nv), to be given back later."""
        self.places()
        return self._motors.copy()

    @commands.setter
    def commands(self, commands: Array) -> None:
        self._motors = commands.copy()
        self._send()

    def _find(self) -> None:
        model, before, old = self._world.model, self._places, self._motors
        self._places = {joint.name: (joint.iq, joint.iv) for joint in model.joints if joint.nv == 1}
        self._motors = np.zeros((3, model.nv))
        for name, (_, iv) in self._places.items():
            self._motors[:, iv] = old[:, before[name][1]] if name in before else (0.0, 0.0, _HOLDING_FORCE)
        self._is_current = True
        self._send()

    def _send(self) -> None:
        target, gain, force = self._motors
        self._world.set_motors(target_q=target, kp=gain, max_force=force)
