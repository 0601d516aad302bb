"""Hands and feet that do the tasks of `manyhands.world_envs` by rule: what proves that each can be done."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands import dynamics
from manyhands.world_envs import DrawerOpen, KukaReach, Quadrotors, QuadrupedWalk
from manyhands.world_envs.kuka_reach import HAND

Array = NDArray[np.float64]


def reach(env: KukaReach, seen: Array) -> Array:
    """Moves the joints along the shortest way that brings the flange nearer: damped least squares."""
    q, hand, target = seen[:7], seen[14:17], seen[17:20]
    J = dynamics.jacobian(env.model, q, HAND)[3:]
    move = J.T @ np.linalg.solve(J @ J.T + 0.01 * np.eye(3), target - hand) / env.REACH
    return move / max(1.0, float(np.abs(move).max()))


class OpenDrawer:
    """Before the handle, over it, shut the hand, and pull."""

    def __init__(self) -> None:
        self.phase, self.since = 0, 0

    def __call__(self, env: DrawerOpen, seen: Array) -> Array:
        hand, handle = seen[:3], seen[7:10] + np.array([0.008, 0, 0])  # a little beyond the bar
        ways = [handle - [0.08, 0, 0] - hand, handle - hand, np.zeros(3), np.array([-0.03, 0, 0])]
        self.since += 1
        if self.phase < 3 and (self.since > 8 if self.phase == 2 else np.abs(ways[self.phase]).max() < 0.008):
            self.phase, self.since = self.phase + 1, 0
        return np.append(0.6 * ways[self.phase] / env.STRIDE, 1 if self.phase < 2 else -1)


def hover(env: Quadrotors, seen: Array) -> Array:
    """Each leans towards its place by a PD law, and turns about as another one says."""
    commands = []
    for row in seen.reshape(env.drones, -1):
        way, axes, velocity, omega = row[:3], row[3:12].reshape(3, 3).T, row[12:15], row[15:18]
        pull = 4 * way - 3.2 * velocity + [0, 0, 9.81]
        upward = axes[:, 2]
        lean = np.cross(upward, pull / np.linalg.norm(pull))
        yaw = math.atan2(axes[1, 0], axes[0, 0])
        turn = axes.T @ (lean - [0, 0, 0.2 * yaw] - 0.16 * omega)  # in its own axes
        thrust = pull @ upward / 9.81
        x, y, z = turn * [1.6, 1.6, 2.0]
        commands += [thrust - y + z, thrust + x - z, thrust + y + z, thrust - x - z]
    return np.array(commands) - 1


def trot(env: QuadrupedWalk, step: int, speed: float, period: float = 0.4, lift: float = 0.06) -> Array:
    """Two legs across swing ahead while the other two push back."""
    phase = step * env.dt / period
    joints = []
    for leg in range(4):
        share = (phase + (0.5 if leg in (1, 2) else 0.0)) % 1.0
        half = speed * period / 4
        if share < 0.5:  # on the ground
            x, z = half * (1 - 4 * share), 0.0
        else:
            x, z = half * (4 * share - 3), lift * math.sin(2 * math.pi * (share - 0.5))
        joints += [0.0, *_leg(x, 0.27 - z)]
    return (np.array(joints) - env.STANDING) / env.STRIDE


def _leg(x: float, depth: float) -> tuple[float, float]:
    """Angles that bring the foot to x ahead of the hip, and so far below it; upper and lower leg are 0.2 m long."""
    bend = math.acos(min(math.hypot(x, depth) / 0.4, 1.0))
    return bend - math.atan2(x, depth), -2 * bend


def run(env: Any, seed: int, choose: Any, steps: int) -> tuple[Array, float, bool, dict[str, Any]]:
    """An episode of at most so many steps: what is seen last, the sum of rewards, whether it is over, and `info`."""
    seen, info = env.reset(seed=seed)
    total = 0.0
    for step in range(steps):
        seen, reward, terminated, _, info = env.step(choose(env, seen.astype(np.float64), step))
        total += reward
        if terminated:
            return seen, total, True, info
    return seen, total, False, info
