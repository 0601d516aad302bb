"""Write a robot: URDF, visual shells and collision hulls. The same input gives the same bytes."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

from robots import urdf
from robots.description import Robot
from robots.mesh import Mesh

ASSETS = Path(__file__).resolve().parents[2] / "assets"


def robot_files(robot: Robot) -> tuple[str, dict[str, Mesh]]:
    """The text of the URDF, and its meshes by their paths from the folder that `robot.meshes` names."""
    meshes = {}
    parts: dict[str, list[str]] = {}
    for link, make in robot.shells.items():
        made = make()
        parts[link] = list(made)
        meshes |= {f"visual/{link}_{material}.obj": mesh for material, mesh in made.items()}
    meshes |= {f"collision/{hull.name}.obj": hull.mesh() for hull in robot.hulls}
    return urdf.urdf_text(robot, parts), meshes


def write(robot: Robot, out: Path) -> dict[str, int]:
    """Write every file under `out`; returns the number of triangles of each mesh file."""
    text, meshes = robot_files(robot)
    out.mkdir(parents=True, exist_ok=True)
    for name, mesh in meshes.items():
        (out / name).parent.mkdir(exist_ok=True)
        (out / name).write_text(mesh.to_obj(robot.script), newline="\n")
    (out / f"{robot.name}.urdf").write_text(text, newline="\n")
    return {name: len(mesh.faces) for name, mesh in meshes.items()}


def main(robot: Robot, description: str | None) -> None:
    """The command line of a robot's script."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    default = ASSETS / robot.name
    parser.add_argument("--out", type=Path, default=default, help=f"folder to write to (default: assets/{robot.name})")
    out = parser.parse_args().out
    triangles = write(robot, out)
    size = sum(f.stat().st_size for f in out.rglob("*") if f.is_file())
    print(f"{out}: {len(triangles)} meshes, {sum(triangles.values())} triangles, {size / 1e6:.2f} MB")


def write_folder(files: Mapping[str, bytes], default: Path, description: str | None) -> None:
    """The command line of a script that writes a whole folder; what is there and not among the files goes."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=default, help="folder to write to")
    out: Path = parser.parse_args().out
    for path in [p for p in out.rglob("*") if p.is_file() and p.relative_to(out).as_posix() not in files]:
        path.unlink()
    for name, data in files.items():
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_bytes(data)
    print(f"{out}: {len(files)} files, {sum(map(len, files.values())) / 1e6:.2f} MB")
