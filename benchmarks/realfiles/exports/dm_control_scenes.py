"""Writes the scenes of dm_control's manipulation and locomotion tasks below the folder that is its argument."""

import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from absl import flags  # pyright: ignore[reportMissingImports]
from dm_control import manipulation, mjcf  # pyright: ignore[reportMissingImports]
from dm_control.locomotion.examples import (  # pyright: ignore[reportMissingImports]
    basic_cmu_2019,
    basic_rodent_2020,
)

flags.FLAGS(sys.argv[:1])


def scenes() -> dict[str, Callable[[], Any]]:
    """What makes each environment."""
    found: dict[str, Callable[[], Any]] = {
        name: (lambda name=name: manipulation.load(name, seed=0))
        for name in manipulation.ALL
        if name.endswith("_features")
    }
    for module in (basic_cmu_2019, basic_rodent_2020):
        for name, make in vars(module).items():
            if name.startswith(("cmu_", "rodent_")) and callable(make):
                found[name] = lambda make=make: make(random_state=0)
    return found


def main() -> None:
    """All that this version can make."""
    for name, make in scenes().items():
        folder = Path(sys.argv[1]) / name
        if (folder / "scene.xml").is_file():
            continue
        try:
            environment = make()
            environment.reset()
            root = environment.task.root_entity.mjcf_model.root
            mjcf.export_with_assets(root, str(folder), out_file_name="scene.xml")
        except Exception:
            print(f"dm_control makes no {name}:")
            traceback.print_exc()


if __name__ == "__main__":
    main()
