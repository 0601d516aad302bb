"""What was recorded in MuJoCo, read back."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.mujoco_map import Array


@dataclass(frozen=True)
class Recording:
    """Rows are the n steps; states have one more, the last. All in MuJoCo's coordinates."""

    ctrl: Array  # (n, nu)
    mocap_pos: Array  # (n, nmocap, 3) [m]
    mocap_quat: Array  # (n, nmocap, 4) wxyz, of any length
    qpos: Array  # (n + 1, nq)
    qvel: Array  # (n + 1, nv)

    @classmethod
    def read(cls, path: Path) -> "Recording":
        """Of a file that a recorder wrote."""
        with np.load(path) as rows:
            return cls(**{name: rows[name] for name in cls.__dataclass_fields__})
