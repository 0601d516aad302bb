"""Packages that scripts of the wheel want, in a folder of their own below build/: nothing goes into the environment.

NumPy is one of them: what env_bases.py gives a window's render is an empty array, which scripts compare with False, and
NumPy raises an error at that from 2.2 on. TensorFlow, baselines and stable_baselines3 are not: they are gigabytes, and
the scripts want versions of before 2020.
"""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

PACKAGES = ("numpy==2.1.3", "gin-config", "attrs", "mock", "mpi4py", "mpich")
WITHOUT_DEPENDENCIES = ("filterpy",)  # SciPy is there, and would bring a NumPy of its own


def install(folder: Path) -> None:
    """Installs them once. Raises CalledProcessError if the package index cannot be reached."""
    done = folder / "installed"
    wanted = "\n".join(PACKAGES + WITHOUT_DEPENDENCIES)
    if done.is_file() and done.read_text() == wanted:
        return
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--ignore-installed", "--prefix", str(folder)]
    subprocess.run([*pip, *PACKAGES], check=True)
    subprocess.run([*pip, "--no-deps", *WITHOUT_DEPENDENCIES], check=True)
    done.write_text(wanted)


def surroundings(folder: Path, root: Path) -> dict[str, str]:
    """Environment variables of a program that finds them, and the benchmarks below `root`."""
    packages = sysconfig.get_path("purelib", vars={"base": str(folder)})
    path = [os.environ.get("PYTHONPATH", ""), packages, str(root)]
    return dict(os.environ) | {
        "PYTHONPATH": os.pathsep.join(filter(None, path)),
        "MPI4PY_LIBMPI": str(folder / "lib" / "libmpi.so.12"),
        "PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION": "python",  # the wheel's messages are of an old protoc
        "MPLBACKEND": "Agg",
        "PYTHONUNBUFFERED": "1",
    }
