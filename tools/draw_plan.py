#!/usr/bin/env python3
"""Render docs/images/plan.png: the plan of docs/planning.md, from where it begins over a post to where it ends.

python tools/draw_plan.py
"""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import manyhands as mh
from manyhands import kinematics as kin
from manyhands import planning

Array = NDArray[np.float64]
OUT = Path(__file__).resolve().parent.parent / "docs/images/plan.png"
WIDTH, HEIGHT, ANGLE = 1100, 760, math.radians(34)
FRAME = "panda_grasptarget"
DOWN = (1, 0, 0, 0)
GHOSTS = (0.28, 0.5, 0.72)  # of the way, at which the arm is drawn through between its ends
BEADS = 60  # along the way of the hand
START, GOAL = (0.12, 0.42, 0.85), (0.95, 0.45, 0.1)  # colours
GLASS = 0.3  # opacity of arms on the way


def scene() -> mh.World:
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.q = [0, -0.785, 0, -2.356, 0, 1.571, 0.785, 0.03, 0.03]
    world.add_box("table", (0.3, 0.5, 0.02), position=(0.55, 0, 0.1), fixed=True, colour=(0.62, 0.6, 0.56))
    world.add_cylinder("post", 0.04, 0.25, position=(0.5, 0, 0.37), fixed=True, colour=(0.75, 0.12, 0.12))
    world.add_box("cube", (0.02, 0.02, 0.02), position=(0.5, 0.3, 0.14), colour=START)
    return world


def add_arm(world: mh.World, name: str) -> list[int]:
    """One more arm; where its joints are in q, in the order of the planned ones."""
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"))
    world.add(model, name=name)
    return [j.iq for j in world.model.joints if j.nv == 1 and j.name.startswith(f"{name}/panda_joint")]


def place(world: mh.World, where: list[int], posture: Array) -> None:
    q = np.array(world.q)
    q[where] = posture
    world.q = q


def render(world: mh.World, camera: mh.Camera, marks: list[mh.Mark]) -> Array:
    look = mh.Look(antialiasing=3, shadow_rays=16)
    return world.render(camera, look=look, marks=marks).colour.astype(np.float64)


def beads(points: Array) -> list[mh.Mark]:
    shares = np.linspace(0, 1, len(points))[:, None]
    colours = (1 - shares) * np.array(START) + shares * np.array(GOAL)
    return [
        mh.Mark("sphere", [0.007], point, rgba=[*colour, 1.0]) for point, colour in zip(points, colours, strict=True)
    ]


def main() -> None:
    world = scene()
    planner = planning.Planner(world, FRAME)
    above = planner.plan(position=(0.5, 0.3, 0.25), quaternion=DOWN)
    across = planner.plan(position=(0.5, -0.3, 0.25), quaternion=DOWN, start=above.waypoints[-1], seed=1)
    motion = across.trajectory(acceleration=5.0)
    way = planner.configuration(motion.sample(np.linspace(0, motion.duration, BEADS)).q)
    marks = [mh.Mark("cylinder", [0.04, 0.0005], [0.5, -0.3, 0.121], rgba=[*GOAL, 1.0])]
    marks += beads(kin.forward(planner.model, way, FRAME)[0])
    start, *between, goal = motion.sample(motion.duration * np.array([0, *GHOSTS, 1])).q
    world.add_plane("floor")
    world.q = planner.configuration(start)
    place(world, add_arm(world, "goal"), goal)
    camera = mh.Camera.perspective(WIDTH, HEIGHT, ANGLE).orbit([0.3, 0, 0.4], 1.95, math.radians(80), math.radians(-18))
    solid = render(world, camera, marks)
    ghost, seen = add_arm(world, "ghost"), solid.copy()
    for posture in between:
        place(world, ghost, posture)
        seen += GLASS * (render(world, camera, marks) - solid)
    Image.fromarray(seen.clip(0, 255).astype(np.uint8)).save(OUT, optimize=True)
    print(across, f"{motion.duration:.2f} s")


if __name__ == "__main__":
    main()
