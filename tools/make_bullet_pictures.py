#!/usr/bin/env python3
"""Take docs/images/bullet_data.jpg: every model of assets/bullet, as our cameras see it.

python tools/make_bullet_pictures.py [--out FILE] [--columns N] [NAME ...]
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

import manyhands as mh

ROOT = Path(__file__).resolve().parent.parent
BULLET = ROOT / "assets" / "bullet"
SIZE = (200, 166)
GAP = 4
UPRIGHT = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
Y_UP = ("duck_vhacd", "teddy", "humanoid/", "laikago/laikago.urdf", "laikago/laikago_toes.urdf")
GROUNDS = ("plane", "samurai", "mjcf/ground")
LEFT_OUT = (
    "sphere2_rolling_friction.urdf",
    "sphere_with_restitution.urdf",
    "plane100.urdf",
    "plane_implicit.urdf",
    "cube_collisionfilter.urdf",
    "cube_no_rotation.urdf",
    "cube_rotate.urdf",
    "teddy_large.urdf",
    "urdf/mug.urdf",
    "kuka_iiwa/model_vr_limits.urdf",
    "kuka_iiwa/model_free_base.urdf",
    "laikago/laikago.urdf",
    "laikago/laikago_toes.urdf",
    "TwoJointRobot_wo_fixedJoints.urdf",
    "mjcf/humanoid_symmetric_no_ground.xml",
    "mjcf/ground_plane.xml",
)
"""Models that look as others do."""
POSES = {
    "franka_panda/panda.urdf": [0.3, 0.1, 0.0, -1.9, 0.0, 2.0, 0.8, 0.03, 0.03],
    "kuka_iiwa/model.urdf": [0.3, 0.6, 0.2, -1.3, 0.4, 1.0, 0.0],
    "universal/ur5e.urdf": [0.3, -1.2, 1.5, -1.9, -1.57, 0.0],
    "xarm/xarm6_robot.urdf": [0.3, -0.3, -0.8, 0.0, 1.1, 0.0],
    "r2d2.urdf": [0.0, 0.0, 0.0, 0.0, 0.0, 0.2, 0.2, 0.0],
    "cartpole.urdf": [0.3, 0.25],
    "door.urdf": [1.2, 0.4],
    "cabinet/cabinet.urdf": [0.15, 0.05, 0.6],
    "drawer/drawer.urdf": [0.12],
    "pendulum5.urdf": [-0.9, 0.5, -0.4, 0.3, -0.3],
    "a1/a1.urdf": [0.0, 0.7, -1.4] * 4,
    "mini_cheetah/mini_cheetah.urdf": [0.0, -0.7, 1.4] * 4,
    "pr2_gripper.urdf": [0.3, 0.3],
    "mjcf/hopper.xml": [0.0, 0.0, 0.0, -0.5, -1.0, 0.6],
    "mjcf/walker2d.xml": [0.0, 0.0, 0.0, -0.7, -0.9, 0.2, -0.1, -0.3, 0.2],
    "mjcf/reacher.xml": [0.5, 0.8, 0.1, 0.1],
}
BOXES = {
    "sphere_transparent.urdf": ((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)),
    "cartpole.urdf": ((-0.6, -0.3, -0.12), (0.9, 0.3, 1.0)),
    "mjcf/humanoid.xml": ((-0.2, -0.4, 0.0), (0.4, 0.4, 1.68)),
    "mjcf/inverted_double_pendulum.xml": ((-1.0, -0.1, -0.1), (1.0, 0.1, 1.2)),
    "mjcf/reacher.xml": ((-0.3, -0.3, 0.0), (0.3, 0.3, 0.05)),
    "mjcf/pusher.xml": ((-0.2, -0.8, -0.33), (1.0, 0.1, 0.3)),
    "mjcf/striker.xml": ((-0.2, -0.8, -0.33), (1.0, 0.1, 0.3)),
    "mjcf/thrower.xml": ((-0.2, -0.9, -0.33), (0.8, 0.5, 0.6)),
    "mjcf/swimmer.xml": ((-1.5, -0.1, -0.1), (1.5, 0.1, 0.1)),
}
"""What is shown of models that have a floor, or that depth pictures do not see."""
Points = npt.NDArray[np.floating]


def world_with(name: str) -> mh.World:
    load = mh.load_mjcf if name.endswith(".xml") else mh.load_urdf
    model, _ = load(BULLET / name)
    q = np.array(model.neutral_configuration(), dtype=float)
    given = POSES.get(name, [])
    q[: len(given)] = given
    world = mh.World()
    world.add(model, quaternion=UPRIGHT if name.startswith(Y_UP) else (0.0, 0.0, 0.0, 1.0))
    world.q = q
    return world


def bounds(world: mh.World) -> tuple[Points, Points]:
    """Corners of the box that holds what two cameras see within 20 m."""
    seen = []
    for yaw, pitch in ((0.7, -0.5), (0.7 + math.pi, 0.4)):
        for reach in (60.0, 6.0, 0.6):
            camera = mh.Camera.orthographic(160, 160, reach).orbit([0.0, 0.0, 0.0], 2 * reach, yaw, pitch)
            points = world.render(camera, colour=False).point_cloud()
            points = np.asarray(points).reshape(-1, 3)
            seen.append(points[np.isfinite(points).all(axis=1)])
    cloud = np.concatenate(seen)
    cloud = cloud[(np.abs(cloud) < 20).all(axis=1)]
    return cloud.min(axis=0), cloud.max(axis=0)


def picture(name: str) -> Image.Image:
    world = world_with(name)
    fov = 50 if name.startswith("samurai") else 30
    lens = mh.Camera.perspective(2 * SIZE[0], 2 * SIZE[1], math.radians(fov))
    if name.startswith(GROUNDS):
        distance, yaw = (85.0, 0.9) if name.startswith("samurai") else (2.5, 0.7)
        camera = lens.orbit([0.0, 0.0, 0.0], distance, yaw, -0.4)
    else:
        low, high = (np.array(corner) for corner in BOXES.get(name) or bounds(world))
        world.add_plane("ground", position=[0.0, 0.0, float(low[2])])
        reach = float(np.linalg.norm(high - low))
        camera = lens.orbit([float(c) for c in (low + high) / 2], 1.95 * reach, 0.75, -0.38)
    colour = world.render(camera, look=mh.Look(antialiasing=2)).colour
    shown = Image.fromarray(np.asarray(colour)).resize(SIZE, Image.Resampling.LANCZOS)
    label = name.rsplit(".", 1)[0]
    ImageDraw.Draw(shown).text((6, SIZE[1] - 17), label, fill=(40, 48, 58), font=ImageFont.load_default(10))
    return shown


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "docs/images/bullet_data.jpg")
    parser.add_argument("--columns", type=int, default=10)
    parser.add_argument("names", nargs="*", help="models by their paths in assets/bullet; all that differ in looks")
    options = parser.parse_args()
    files = sorted(p.relative_to(BULLET).as_posix() for p in BULLET.rglob("*") if p.suffix in (".urdf", ".xml"))
    shown = [name for name in files if name not in LEFT_OUT and not name.startswith("random")]
    names = options.names or shown + [f"random_urdfs/{k:03d}/{k:03d}.urdf" for k in (2, 5, 18)]
    width, height = SIZE[0] + GAP, SIZE[1] + GAP
    rows = math.ceil(len(names) / options.columns)
    sheet = Image.new("RGB", (options.columns * width - GAP, rows * height - GAP), "white")
    for k, name in enumerate(names):
        sheet.paste(picture(name), (k % options.columns * width, k // options.columns * height))
    sheet.save(options.out, quality=86)
    print(f"{options.out}: {len(names)} models, {options.out.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
