#!/usr/bin/env python3
"""Take docs/images/tasks.jpg: the six tasks, each while its expert is at work, as `render` shows them.

python tools/make_gallery.py [--out FILE]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from manyhands.envs import ArmEnv, Expert

ROOT = Path(__file__).resolve().parent.parent
SIZE = (400, 300)
GAP = 6
TASKS = {
    "Reach": (43, 1),
    "Push": (43, 9),
    "Slide": (1, 12),
    "PickAndPlace": (44, 8),
    "Stack": (5, 24),
    "Flip": (4, 12),
}
"""The seeds, and how many steps the experts have gone."""


def picture(task: str, seed: int, steps: int) -> Image.Image:
    env = ArmEnv(
        f"Panda{task}", render_mode="rgb_array", render_width=SIZE[0], render_height=SIZE[1],
        render_target_position=[-0.08, 0.0, 0.16], render_distance=0.92, render_yaw=55, render_pitch=-22,
    )  # fmt: skip
    expert = Expert(f"Panda{task}-v3")
    observation, _ = env.reset(seed=seed)
    for _ in range(steps):
        observation, *_ = env.step(np.asarray(expert(observation)))
    frame = env.render()
    assert frame is not None
    shown = Image.fromarray(frame)
    ImageDraw.Draw(shown).text((10, SIZE[1] - 30), task, fill=(235, 240, 245), font=ImageFont.load_default(20))
    return shown


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "docs/images/tasks.jpg")
    out = parser.parse_args().out
    width, height = SIZE[0] + GAP, SIZE[1] + GAP
    sheet = Image.new("RGB", (3 * width - GAP, 2 * height - GAP), "white")
    for k, (task, (seed, steps)) in enumerate(TASKS.items()):
        sheet.paste(picture(task, seed, steps), (k % 3 * width, k // 3 * height))
    sheet.save(out, quality=88)
    print(f"{out}: {out.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
