"""Records metaworld's own scripted policies: `metaworld_tasks.py FOLDER TASK...`."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from metaworld import policies  # pyright: ignore[reportMissingImports]
from metaworld.env_dict import (  # pyright: ignore[reportMissingImports]
    ALL_V3_ENVIRONMENTS_GOAL_OBSERVABLE as ENVIRONMENTS,
)

from benchmarks.scripted.recorders.recorder import Recorder

LONGEST = 300  # actions
AFTER = 20  # actions after success
POLICIES = {
    "assembly": policies.SawyerAssemblyV3Policy,
    "button-press": policies.SawyerButtonPressV3Policy,
    "door-open": policies.SawyerDoorOpenV3Policy,
    "drawer-open": policies.SawyerDrawerOpenV3Policy,
    "handle-press": policies.SawyerHandlePressV3Policy,
    "lever-pull": policies.SawyerLeverPullV3Policy,
    "peg-insert-side": policies.SawyerPegInsertionSideV3Policy,
    "pick-place": policies.SawyerPickPlaceV3Policy,
    "window-open": policies.SawyerWindowOpenV3Policy,
}


def record(task: str, folder: Path) -> None:
    """One task, from its reset until a moment after its success."""
    environment = ENVIRONMENTS[f"{task}-v3-goal-observable"](seed=0)
    policy = POLICIES[task]()
    observation, _ = environment.reset(seed=0)
    recorder = Recorder(environment.model, environment.data)

    def simulate(ctrl: Any, n_frames: int) -> None:
        environment.data.ctrl[:] = np.asarray(ctrl)
        for _ in range(n_frames):
            recorder.step()

    environment.do_simulation = simulate
    left = LONGEST
    while left > 0:
        observation, _, _, _, info = environment.step(policy.get_action(observation))
        left = min(left - 1, AFTER) if info["success"] else left - 1
    recorder.write(folder / task, Path(environment.model_name).parent)


if __name__ == "__main__":
    for name in sys.argv[2:]:
        record(name, Path(sys.argv[1]))
