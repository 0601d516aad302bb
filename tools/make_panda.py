#!/usr/bin/env python3
"""Write the project's own Franka-Panda-like arm: URDF, visual shells and collision hulls.

    python tools/make_panda.py            # writes assets/panda
    python tools/make_panda.py --out DIR

Needs numpy only. The same input gives the same bytes.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from panda import shells, urdf

DEFAULT = Path(__file__).resolve().parent.parent / "assets" / "panda"


def write(out: Path) -> dict[str, int]:
    """Write every file under `out`; returns the number of triangles of each mesh file."""
    for folder in ("visual", "collision"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    triangles: dict[str, int] = {}
    parts: dict[str, list[str]] = {}
    for link, make in shells.LINKS.items():
        meshes = make()
        parts[link] = list(meshes)
        for material, mesh in meshes.items():
            name = f"visual/{link}_{material}.obj"
            (out / name).write_text(mesh.to_obj(), newline="\n")
            triangles[name] = len(mesh.faces)
    for hull in urdf.hulls().values():
        mesh = hull.mesh()
        name = f"collision/{hull.name}.obj"
        (out / name).write_text(mesh.to_obj(), newline="\n")
        triangles[name] = len(mesh.faces)
    (out / "panda.urdf").write_text(urdf.urdf_text(parts), newline="\n")
    return triangles


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=DEFAULT, help="folder to write to (default: assets/panda)")
    out = parser.parse_args().out
    triangles = write(out)
    size = sum(f.stat().st_size for f in out.rglob("*") if f.is_file())
    print(f"{out}: {len(triangles)} meshes, {sum(triangles.values())} triangles, {size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
