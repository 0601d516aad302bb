"""Convex parts of concave meshes, by CoACD (Wei et al., Approximate Convex Decomposition for 3D Meshes with
Collision-Aware Concavity and Tree Search, SIGGRAPH 2022), kept in the user's cache folder."""

import hashlib
import os
import warnings
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model, ModelBuilder, with_convex_parts
from manyhands.extras import needs
from manyhands.files import replacing, write_text

Part = tuple[NDArray[np.float32], NDArray[np.int32]]  # vertices (n, 3) [m], triangles (m, 3)

# A tree search that is a fifth of CoACD's own: parts of the same quality on handles and holes, in seconds.
_SEARCH: dict[str, Any] = {
    "mcts_iterations": 60, "mcts_nodes": 10, "mcts_max_depth": 2, "resolution": 1000, "preprocess_resolution": 30,
    "seed": 0,
}  # fmt: skip


def decompose(mesh: str | PathLike[str] | tuple[ArrayLike, ArrayLike], *, threshold: float = 0.05) -> list[Part]:
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


def decompose_model(model: Model, *, threshold: float = 0.05) -> Model:
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


def parts_or_none(vertices: ArrayLike, triangles: ArrayLike) -> list[Part]:
    """The parts of `decompose`; none, with a warning, without CoACD, and none where the mesh is convex as it is."""
    try:
        parts = decompose((vertices, triangles))
    except ModuleNotFoundError as error:
        warnings.warn(f"{error}; until then its convex hull stands for a concave mesh that moves", stacklevel=2)
        return []
    return parts if len(parts) > 1 else []


def write_parts(mesh: str | PathLike[str], target: str | PathLike[str], log: str | PathLike[str]) -> None:
    """Writes the parts of a mesh file as objects of an OBJ file, and a line on each to the log."""
    parts = decompose(mesh)
    lines = [f"{len(parts)} convex parts of {mesh}"]
    objects: list[str] = []
    first = 1
    for index, (vertices, triangles) in enumerate(parts):
        objects.append(f"o part_{index}")
        objects += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
        objects += [f"f {a + first} {b + first} {c + first}" for a, b, c in triangles]
        first += len(vertices)
        lines.append(f"part_{index}: {len(vertices)} vertices, {len(triangles)} triangles")
    write_text(Path(target), "\n".join(objects) + "\n")
    write_text(Path(log), "\n".join(lines) + "\n")


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
            arrays = [file[f"arr_{i}"] for i in range(len(file.files))]
    except Exception:  # NumPy raises errors of many kinds on damaged files, and then the work is done again
        return None
    return list(zip(arrays[0::2], arrays[1::2], strict=True))


def _write(path: Path, parts: list[Part]) -> None:
    """Whole or not at all; a folder that cannot be written only costs time."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as temporary:
            np.savez(temporary, *(array for part in parts for array in part))
    except OSError:
        return
