"""What the real PyBullet makes of the files in its data folder. Each file is loaded in a process of its own, for some
end it."""

import faulthandler
import os
import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__import__("pybullet_data").getDataPath())
MOVING = ("revolute", "prismatic", "spherical", "planar")


@dataclass
class BulletBody:
    """One body; lists run over the base and then the links, joints over the links alone."""

    base: str
    joints: list[Any]  # getJointInfo's tuples
    masses: list[float]  # [kg]
    links: list[Any]  # getLinkState's tuples
    shapes: list[list[tuple[str, tuple[float, ...]]]]  # what touches, but for meshes, and its sizes [m]


def files(kind: str) -> list[str]:
    """Paths in the data folder; of the thousand random objects every fiftieth."""
    found = sorted(str(path.relative_to(ROOT)) for path in ROOT.rglob(f"*.{kind}"))
    if kind == "xml":
        found = [path for path in found if path.startswith("mjcf/")]
    return [path for path in found if not path.startswith("random_urdfs") or path[13:15] in ("00", "05", "50")]


def bullet_bodies(path: str) -> list[BulletBody] | str:
    """The bodies in a file, or how PyBullet fails."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        _report(path, writing)
    os.close(writing)
    with os.fdopen(reading, "rb") as stream:
        data = stream.read()
    os.waitpid(child, 0)
    return pickle.loads(data) if data else "crash"


def _report(path: str, writing: int) -> None:
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    faulthandler.disable()  # PyBullet crashes on some files, and that is part of the answer
    import pybullet as pb

    pb.connect(pb.DIRECT)
    try:
        result: list[BulletBody] | str = [_body(pb, body, path) for body in _load(pb, str(ROOT / path))]
    except pb.error as error:
        result = str(error)
    with os.fdopen(writing, "wb") as stream:
        stream.write(pickle.dumps(result))
    os._exit(0)


def _load(pb: Any, path: str) -> tuple[int, ...]:
    if path.endswith(".urdf"):
        return (pb.loadURDF(path, flags=pb.URDF_USE_INERTIA_FROM_FILE | pb.URDF_USE_IMPLICIT_CYLINDER),)
    return pb.loadSDF(path) if path.endswith(".sdf") else pb.loadMJCF(path)


def _body(pb: Any, body: int, path: str) -> BulletBody:
    links = range(pb.getNumJoints(body))
    return BulletBody(
        base=pb.getBodyInfo(body)[0].decode(),
        joints=[pb.getJointInfo(body, i) for i in links],
        masses=[pb.getDynamicsInfo(body, i)[0] for i in range(-1, len(links))],
        links=[pb.getLinkState(body, i, computeForwardKinematics=1) for i in links],
        shapes=[]
        if path.endswith(".xml")
        else [_shapes(pb, body, i) for i in range(-1, len(links))],  # it crashes there
    )


def _shapes(pb: Any, body: int, link: int) -> list[tuple[str, tuple[float, ...]]]:
    found = []
    for shape in pb.getCollisionShapeData(body, link):
        kind, sizes = shape[2], shape[3]
        if kind == pb.GEOM_BOX:
            found.append(("box", tuple(x / 2 for x in sizes)))
        elif kind == pb.GEOM_SPHERE:
            found.append(("sphere", (sizes[0],)))
        elif kind in (pb.GEOM_CYLINDER, pb.GEOM_CAPSULE):
            found.append(("cylinder" if kind == pb.GEOM_CYLINDER else "capsule", (sizes[1], sizes[0] / 2)))
        elif kind == pb.GEOM_PLANE:
            found.append(("plane", ()))
    return found
