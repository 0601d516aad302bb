"""Seconds of motion in both programs, side by side: what explodes, what rests, and what a step costs."""

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

import manyhands as mh
from benchmarks.mujoco_map import Array, Scene, mujoco
from benchmarks.realfiles.accelerations import activations, commands, random_ctrl
from benchmarks.realfiles.statics import Difference

CHUNK = 0.1  # [s] simulated by one program, then by the other
REST = 1e-3  # [m]
SAME = 1e-2  # [m] within which both have settled in one place: what stood on its tip may have fallen otherwise
SLOW = 1e-3  # [rad/s or m/s] that no dof exceeds at rest: what rolls, or begins to fall off its tip, does not rest
LAST = 0.2  # the part of a run, at its end, in which what has settled rests
# What counts as an explosion: a speed, or a kinetic energy, that MuJoCo's stays below by so much.
TIMES_SPEED, TIMES_ENERGY = 100.0, 1000.0
LEAST_SPEED = 10.0  # [rad/s or m/s], and the energy of all bodies falling for a second


@dataclass
class Run:
    """What happened. Speeds are the largest of any dof, times are the processor's for all steps."""

    start: str
    seconds: float = 0.0  # simulated
    exploded: str = ""  # how
    unstable: bool = False  # MuJoCo warned, or had to reset
    out_of_time: bool = False
    speed: float = 0.0
    their_speed: float = 0.0
    their_last_speed: float = 0.0  # of MuJoCo, at the end
    energy: float = 0.0  # [J] kinetic
    their_energy: float = 0.0
    moved: float = 0.0  # [m] farthest of any body from its start
    they_moved: float = 0.0
    drifted: float = 0.0  # [m] in the last part
    they_drifted: float = 0.0
    apart: float = 0.0  # [m] of any body from MuJoCo's, where the last part begins
    where: str = ""  # what moved farthest
    cost: float = 0.0  # [s] a step
    their_cost: float = 0.0
    contacts: float = 0.0  # MuJoCo's, on average

    @property
    def verdict(self) -> str:
        """For the column: empty if nothing is wrong."""
        return self.exploded if not self.unstable else ""

    @property
    def rests(self) -> bool:
        """Whether MuJoCo's scene rests, from the start, or at the end where ours has settled too."""
        whole = not (self.exploded or self.unstable or self.out_of_time)
        return (
            whole
            and self.their_last_speed <= SLOW
            and (self.they_moved <= REST or (self.they_drifted <= REST and self.apart <= SAME))
        )

    @property
    def restless(self) -> str:
        """Where it rests and ours moves."""
        if self.rests and self.they_moved <= REST < self.moved:
            return f"{self.where} moves {self.moved * 1e3:.3g} mm"
        if self.rests and self.apart <= SAME and self.they_drifted <= REST < self.drifted:
            return f"{self.where} drifts {self.drifted * 1e3:.3g} mm at the end"
        return ""

    def words(self) -> dict[str, Any]:
        """All that is known, and what follows from it."""
        return asdict(self) | {"verdict": self.verdict, "rests": self.rests, "restless": self.restless}


class Pair:
    """The scene in both programs at one start."""

    def __init__(self, scene: Scene, key: int | None) -> None:
        self.scene, self.data = scene, mujoco.MjData(scene.mujoco)
        self.world = mh.World(scene.ours)
        self.command = commands(scene)
        model = scene.mujoco
        if key is not None:
            mujoco.mj_resetDataKeyframe(model, self.data, key)
        mujoco.mj_forward(model, self.data)
        self.world.q = scene.configuration(self.data.qpos)
        self.world.v = scene.velocity_map(self.data.qpos) @ self.data.qvel
        self.world.ctrl = self.data.ctrl[self.command]
        self.world.act = self.data.act[activations(scene)]
        self.names = scene.names("body", model.nbody)[1:]
        self.mass = float(np.sum(model.body_mass[1:]))

    def set_ctrl(self, ctrl: Array) -> None:
        """The same commands for both."""
        self.data.ctrl = ctrl
        self.world.ctrl = ctrl[self.command]

    def step(self, run: Run, steps: int) -> None:
        """Both by as many steps, MuJoCo first, and what each took of the processor."""
        before = time.thread_time()
        mujoco.mj_step(self.scene.mujoco, self.data, steps)
        between = time.thread_time()
        try:
            self.world.step(steps)
        except mh.SimulationError as why:
            run.exploded = f"SimulationError: {why}".splitlines()[0][:300]
            return
        run.cost += time.thread_time() - between
        run.their_cost += between - before

    def look(self, run: Run) -> None:
        """Speeds, energies and warnings now."""
        v, theirs = self.world.v, self.scene.velocity_map(self.data.qpos) @ self.data.qvel
        run.speed = max(run.speed, float(np.max(np.abs(v), initial=0.0)))
        run.their_last_speed = float(np.max(np.abs(theirs), initial=0.0))
        run.their_speed = max(run.their_speed, run.their_last_speed)
        run.energy = max(run.energy, self.world.energy()[0])
        mujoco.mj_energyVel(self.scene.mujoco, self.data)
        run.their_energy = max(run.their_energy, float(self.data.energy[1]))
        bad = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
        run.unstable |= any(self.data.warning[int(kind)].number for kind in bad)
        if run.speed > TIMES_SPEED * max(run.their_speed, LEAST_SPEED):
            run.exploded = f"{run.speed:.1e} rad/s or m/s beside MuJoCo's {run.their_speed:.1e}"
        elif run.energy > TIMES_ENERGY * max(run.their_energy, 50.0 * self.mass, 1.0):
            run.exploded = f"{run.energy:.1e} J of motion beside MuJoCo's {run.their_energy:.1e}"

    def positions(self) -> tuple[Array, Array]:
        """Of all bodies (n, 3) each: ours, MuJoCo's."""
        mujoco.mj_kinematics(self.scene.mujoco, self.data)
        return np.array([self.world.body_pose(name)[0] for name in self.names]), self.data.xpos[1:].copy()


def run_pair(pair: Pair, start: str, seconds: float, budget: float, command: Callable[[], Array] | None) -> Run:
    """Both for `seconds`, or until one explodes, or `budget` seconds of the processor have gone by."""
    run, steps, ended = Run(start), 0, time.thread_time() + budget
    chunk = max(1, round(CHUNK / pair.scene.mujoco.opt.timestep))
    first = pair.positions()
    far, at_end = (Difference(), Difference()), (Difference(), Difference())
    before_end: tuple[Array, Array] | None = None
    while steps * pair.scene.mujoco.opt.timestep < seconds - 1e-9 and not run.exploded and not run.unstable:
        if time.thread_time() > ended:
            run.out_of_time = True
            break
        if command is not None:
            pair.set_ctrl(command())
        pair.step(run, chunk)
        if run.exploded:
            break
        steps += chunk
        run.seconds = steps * pair.scene.mujoco.opt.timestep
        pair.look(run)
        run.contacts += pair.data.ncon
        now = pair.positions()
        spread(far, now, first, pair.names)
        if run.seconds >= (1 - LAST) * seconds:
            if before_end is None:
                before_end = now
                run.apart = float(np.max(np.linalg.norm(now[0] - now[1], axis=1), initial=0.0))
            spread(at_end, now, before_end, pair.names)
    run.moved, run.they_moved = far[0].away, far[1].away
    run.drifted, run.they_drifted = at_end[0].away, at_end[1].away
    run.where = far[0].where
    run.cost, run.their_cost = run.cost / max(steps, 1), run.their_cost / max(steps, 1)
    run.contacts /= max(steps // chunk, 1)
    return run


def spread(
    farthest: tuple[Difference, Difference], now: tuple[Array, Array], before: tuple[Array, Array], names: list[str]
) -> None:
    """Keeps how far bodies are from where they were, in each program."""
    for most, here, there in zip(farthest, now, before, strict=True):
        if len(names):
            away = np.linalg.norm(here - there, axis=1)
            most.note(float(np.max(away)), names[int(np.argmax(away))])


def compare(scene: Scene, seconds: float, budget: float, done: Callable[[dict[str, Any]], None]) -> None:
    """From the file's state, from each keyframe, and under random controls; `done` gets each run as it ends."""
    starts = [("file", None, False)]
    starts += [(f"keyframe {k}", k, False) for k in range(scene.mujoco.nkey)]
    if scene.mujoco.nu:
        starts.append(("random controls", None, True))
    rng = np.random.default_rng(0)
    for name, key, driven in starts:
        command = (lambda: random_ctrl(scene.mujoco, rng)) if driven else None
        try:
            run = run_pair(Pair(scene, key), name, seconds, budget, command)
        except (ValueError, RuntimeError, KeyError) as why:
            run = Run(name, exploded=f"{type(why).__name__}: {why}".splitlines()[0][:300])
        done(run.words())
