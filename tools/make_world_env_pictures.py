#!/usr/bin/env python3
"""Take docs/images/world_envs.jpg: the environments of `manyhands.world_envs`, each while it is solved by rule.

python tools/make_world_env_pictures.py [--out FILE]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests/python/shared"))

import controllers  # noqa: E402  # pyright: ignore[reportMissingImports]

from manyhands.world_envs import DrawerOpen, KukaReach, Quadrotors, QuadrupedWalk, WorldEnv  # noqa: E402

SIZE = 400, 267
PULL = controllers.OpenDrawer()
REACH: Callable[..., Any] = lambda env, seen, _: controllers.reach(env, seen)  # noqa: E731
HOVER: Callable[..., Any] = lambda env, seen, _: controllers.hover(env, seen)  # noqa: E731
DUSK = {"camera": -0.5, "light": 0.3}

SHOTS: list[tuple[WorldEnv, int, Callable[..., Any], int]] = [  # seed, who acts, and for how many steps
    (KukaReach(render_mode="rgb_array"), 2, REACH, 3),
    (DrawerOpen(render_mode="rgb_array"), 1, lambda env, seen, _: PULL(env, seen), 30),
    (QuadrupedWalk(render_mode="rgb_array"), 1, lambda env, _, step: controllers.trot(env, step, 0.4), 27),
    (Quadrotors(render_mode="rgb_array"), 1, HOVER, 8),
    (Quadrotors(3, render_mode="rgb_array"), 2, HOVER, 8),
    (KukaReach(render_mode="rgb_array", randomize=DUSK), 2, REACH, 3),
]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "docs/images/world_envs.jpg")
    tiles = []
    for env, seed, choose, steps in SHOTS:
        controllers.run(env, seed, choose, steps)
        tiles.append(np.asarray(Image.fromarray(env.render()).resize(SIZE, Image.Resampling.LANCZOS)))  # pyright: ignore[reportArgumentType]
    rows = [np.concatenate(tiles[k : k + 3], axis=1) for k in (0, 3)]
    Image.fromarray(np.concatenate(rows)).save(parser.parse_args().out, quality=88)


if __name__ == "__main__":
    main()
