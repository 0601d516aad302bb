#!/usr/bin/env python3
"""Film docs/images/clear.gif: examples/pick_and_place.py clears a floor; four times as fast as it is.

PYTHONPATH=. python tools/draw_pick_and_place.py
"""

import math
from pathlib import Path
from typing import Any

import manyhands as mh
from benchmarks.pick_and_place.scenes import in_bin, scene
from examples.pick_and_place import clear
from manyhands.video import write_video

OUT = Path(__file__).resolve().parent.parent / "docs/images/clear.gif"
RATE = 12  # pictures a second
FASTER = 4


class Filmed:
    """A world of which every so many steps a picture is taken."""

    def __init__(self, world: mh.World) -> None:
        self._world, self._next = world, 0.0
        self.pictures: list[Any] = []
        self._camera = mh.Camera.perspective(480, 300, math.radians(42)).orbit(
            [0.3, 0.15, 0.2], 1.55, math.radians(60), math.radians(-32)
        )

    def __getattr__(self, name: str) -> Any:
        return getattr(self._world, name)

    def step(self, n: int = 1) -> None:
        for _ in range(n):
            self._world.step()
            if self._world.time >= self._next:
                self.pictures.append(self._world.render(self._camera, look=mh.Look(antialiasing=2)).colour)
                self._next += FASTER / RATE


def main() -> None:
    world, names = scene(0)
    filmed = Filmed(world)
    clear(filmed)  # type: ignore[arg-type]
    filmed.step(500)
    write_video(filmed.pictures, OUT, fps=RATE)
    print(f"{len(in_bin(world, names))} of {len(names)}, {len(filmed.pictures)} pictures, {OUT.stat().st_size} bytes")


if __name__ == "__main__":
    main()
