#!/usr/bin/env python3
"""Take docs/images/robots.jpg, all of assets/robots at home, and print the table of docs/robots.md.

python tools/make_robot_pictures.py [--out FILE]
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import gymnasium
import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

import manyhands as mh
from manyhands.envs import Expert

ROOT = Path(__file__).resolve().parent.parent
SIZE, GAP, COLUMNS = (300, 250), 4, 4
AT_WORK = ("six_axis+two_finger", "six_axis_compact+parallel", "six_axis_slim+two_finger", "seven_axis+three_finger")
"""The last row: arms with grippers on, which carry a cube."""
SIDE, FRONT = -0.9, math.pi + 0.7  # yaw of the camera: on arms and grippers, on what faces -x


def corners(world: mh.World) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Of the box that holds what is seen from both sides."""
    seen = []
    for yaw in (0.7, 0.7 + math.pi):
        camera = mh.Camera.orthographic(200, 200, 3.6).orbit([0.0, 0.0, 0.4], 5.0, yaw, -0.3)
        seen.append(world.render(camera, colour=False).point_cloud())
    cloud = np.concatenate(seen)
    return cloud.min(axis=0), cloud.max(axis=0)


def picture(label: str, model: mh.Model, yaw: float) -> Image.Image:
    world = mh.World(model)
    low, high = corners(world)
    world.add_plane("ground", position=[0.0, 0.0, float(low[2]) - 1e-3])
    reach = float(np.linalg.norm(high - low))
    lens = mh.Camera.perspective(2 * SIZE[0], 2 * SIZE[1], math.radians(30))
    camera = lens.orbit([float(c) for c in (low + high) / 2], 2.0 * reach, yaw, -0.42)
    return labelled(world.render(camera, look=mh.Look(antialiasing=2)).colour, label)


def at_work(robot: str) -> Image.Image:
    """The Panda's expert lifts a cube with another arm."""
    env = gymnasium.make(
        "PandaPickAndPlace-v3",
        robot=robot,
        render_mode="rgb_array",
        render_width=2 * SIZE[0],
        render_height=2 * SIZE[1],
        render_target_position=[-0.2, 0.0, 0.29],
        render_distance=1.05,
        render_yaw=40,
        render_pitch=-15,
    )
    expert = Expert("PandaPickAndPlace-v3")
    observation, _ = env.reset(seed=3)
    for _ in range(14):
        observation, *_ = env.step(expert(observation))
    return labelled(np.asarray(env.render()), robot)


def labelled(pixels: npt.NDArray[np.uint8], label: str) -> Image.Image:
    """Scaled down, its name in the corner."""
    shown = Image.fromarray(pixels).resize(SIZE, Image.Resampling.LANCZOS)
    ImageDraw.Draw(shown).text((8, 6), label, fill=(40, 48, 58), font=ImageFont.load_default(13))
    return shown


def reach(model: mh.Model, frame: str) -> float:
    """The largest distance of a frame from the axis of the base, over random postures [m]."""
    joints = [joint for joint in model.joints if joint.type != "fixed"]
    lower, upper = (np.array([getattr(joint, key) for joint in joints]) for key in ("lower", "upper"))
    q = np.random.default_rng(0).uniform(lower, upper, (200_000, model.nq))
    position, _ = mh.dynamics.frame_pose(model, q, frame)
    return float(np.hypot(position[:, 0], position[:, 1]).max())


def row(name: str) -> str:
    robot, model = mh.robots.describe(name), mh.robots.load(name)
    mass = sum(link.mass for link in model.links)
    end = robot.flange or robot.tool
    cells = [f"`{name}`", robot.about, str(len(robot.home))]
    cells += [f"{reach(model, end):.2f} m" if robot.kind == "arm" else "", f"{mass:.3g} kg"]
    return "| " + " | ".join([*cells, f"{robot.payload:g} kg" if robot.payload else ""]) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "docs/images/robots.jpg")
    out: Path = parser.parse_args().out
    shots = []
    for name in mh.robots.names():
        shots.append(
            picture(name, mh.robots.load(name), FRONT if mh.robots.describe(name).kind == "furniture" else SIDE)
        )
        print(row(name))
    shots += [at_work(robot) for robot in AT_WORK]
    width, height = SIZE[0] + GAP, SIZE[1] + GAP
    rows = math.ceil(len(shots) / COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * width - GAP, rows * height - GAP), "white")
    for k, shot in enumerate(shots):
        sheet.paste(shot, (k % COLUMNS * width, k // COLUMNS * height))
    sheet.save(out, quality=86)
    print(f"{out}: {len(shots)} pictures, {out.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
