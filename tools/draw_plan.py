#!/usr/bin/env python3
"""Render docs/images/plan.png: the plan of docs/planning.md as arms along its motion, around a post.

python tools/draw_plan.py
"""

import math
from pathlib import Path

import numpy as np
from PIL import Image

import manyhands as mh
from manyhands import planning

OUT = Path(__file__).resolve().parent.parent / "docs/images/plan.png"
FRAME = "panda_grasptarget"
DOWN = (1, 0, 0, 0)
ARMS = 6


def scene() -> mh.World:
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.q = [0, -0.785, 0, -2.356, 0, 1.571, 0.785, 0.03, 0.03]
    world.add_box("table", (0.3, 0.5, 0.02), position=(0.55, 0, 0.1), fixed=True)
    world.add_cylinder("post", 0.04, 0.25, position=(0.5, 0, 0.37), fixed=True)
    world.add_box("cube", (0.02, 0.02, 0.02), position=(0.5, 0.3, 0.14))
    return world


def main() -> None:
    world = scene()
    planner = planning.Planner(world, FRAME)
    above = planner.plan(position=(0.5, 0.3, 0.25), quaternion=DOWN)
    across = planner.plan(position=(0.5, -0.3, 0.25), quaternion=DOWN, start=above.waypoints[-1], seed=1)
    motion = across.trajectory(acceleration=5.0)
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"))
    postures = motion.sample(np.linspace(0, motion.duration, ARMS)).q
    world.q = planner.configuration(postures[0])
    for k in range(1, ARMS):
        world.add(model, name=f"arm{k}")
        joints = {joint.name: joint for joint in world.model.joints}
        q = np.array(world.q)
        for name, value in zip(planner.joints, postures[k], strict=True):
            q[joints[f"arm{k}/{name}"].iq] = value
        world.q = q
    world.add_plane("floor")
    camera = mh.Camera.perspective(960, 640, math.radians(42)).orbit(
        [0.3, 0, 0.42], 2.1, math.radians(35), math.radians(-25)
    )
    picture = world.render(camera, look=mh.Look(antialiasing=3, shadow_rays=16))
    Image.fromarray(picture.colour).save(OUT, optimize=True)
    print(across, f"{motion.duration:.2f} s")


if __name__ == "__main__":
    main()
