"""Convex parts of concave meshes, by CoACD (Wei et al., Approximate Convex Decomposition for 3D Meshes with
Collision-Aware Concavity and Tree Search, SIGGRAPH 2022), kept in the user's cache folder."""

import hashlib
import os
import tempfile
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model, ModelBuilder, with_convex_parts
from manyhands.extras import needs

Part = tuple[NDArray[np.float32], NDArray[np.int32]]  # vertices (n, 3) [m], triangles (m, 3)

# A tree search that is a fifth of CoACD's own: parts of the same quality on handles and holes, in seconds.
_SEARCH = {"mcts_iterations": 60, "mcts_nodes": 10, "mcts_max_depth": 2, "resolution": 1000, "seed": 0}


def decompose(mesh: str | PathLike[str] | tuple[ArrayLike, ArrayLike], *, threshold: float = 0.02) -> list[Part]:
    """Convex parts of a mesh: a file, or vertices (n, 3) [m] and triangles (m, 3) that face outwards.

    threshold: how far parts may reach beyond the mesh, relative to its size, 0.01 to 1; smaller gives more parts.
    Raises ModuleNotFoundError without CoACD, ValueError on a threshold out of range or arrays of other shapes, and what
    `ModelBuilder.add_mesh` raises.
    """
    if not 0.01 <= threshold <= 1:
        raise ValueError(f"threshold is {threshold}; expected 0.01 to 1")
    vertices, triangles = _arrays(mesh)
    cached = _cache_folder() / f"{_key(vertices, triangles, threshold)}.npz"
    parts = _read(cached)
    if parts is None:
        parts = _decomposed(vertices, triangles, threshold)
        _write(cached, parts)
    return parts


def decompose_model(model: Model, *, threshold: float = 0.02) -> Model:
    """The model with convex parts in place of the meshes that collide on bodies which move, as `decompose` makes them.
    Meshes that one part can stand for stay as they are."""
    meshes = {geom.mesh for geom in model.geoms if geom.shape == "mesh" and not geom.is_visual}
    parts = {}
    for index in sorted(index for index in meshes if index is not None and index >= 0):
        mesh = model.meshes[index]
        found = decompose((mesh.vertices, mesh.triangles), threshold=threshold)
        if len(found) > 1:
            parts[index] = found
    return with_convex_parts(model, parts)


def _arrays(mesh: str | PathLike[str] | tuple[ArrayLike, ArrayLike]) -> Part:
    builder = ModelBuilder("mesh")
    if isinstance(mesh, tuple):
        vertices, triangles = mesh
        builder.add_mesh_arrays(np.ascontiguousarray(vertices, np.float32), np.ascontiguousarray(triangles, np.int32))
    else:
        builder.add_mesh(mesh)
    checked = builder.build().meshes[0]
    return checked.vertices, checked.triangles


def _decomposed(vertices: NDArray[np.float32], triangles: NDArray[np.int32], threshold: float) -> list[Part]:
    with needs("convex", "convex decomposition"):
        import coacd  # pyright: ignore[reportMissingImports]
    coacd.set_log_level("error")
    found = coacd.run_coacd(coacd.Mesh(vertices.astype(np.float64), triangles), threshold=threshold, **_SEARCH)
    return [(np.ascontiguousarray(v, np.float32), np.ascontiguousarray(t, np.int32)) for v, t in found]


def _cache_folder() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "manyhands" / "convex"


def _key(vertices: NDArray[np.float32], triangles: NDArray[np.int32], threshold: float) -> str:
    said = f"1 {threshold!r} {sorted(_SEARCH.items())} {vertices.shape} {triangles.shape}"
    return hashlib.sha256(said.encode() + vertices.tobytes() + triangles.tobytes()).hexdigest()[:32]


def _read(path: Path) -> list[Part] | None:
    """Nothing where the file is missing or damaged."""
    try:
        with np.load(path) as file:
            return [(file[f"v{i}"], file[f"t{i}"]) for i in range(len(file.files) // 2)]
    except Exception:  # NumPy raises errors of many kinds on damaged files, and then the work is done again
        return None


def _write(path: Path, parts: list[Part]) -> None:
    """Whole or not at all; a folder that cannot be written only costs time."""
    arrays = {f"v{i}": v for i, (v, _) in enumerate(parts)} | {f"t{i}": t for i, (_, t) in enumerate(parts)}
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".npz", delete=False) as file:
            np.savez(file, **arrays)
        os.replace(file.name, path)
    except OSError:
        return
