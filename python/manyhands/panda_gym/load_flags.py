"""PyBullet's flags for loading robots: what they mean here."""

import warnings

from manyhands.panda_gym.simulation import SelfCollision, error

_USE_SELF_COLLISION, _EXCLUDE_ALL_PARENTS = 8, 32

_AS_IT_IS = 2 | 16 | 128 | 1024
"""The file's inertia, self-collision as it is with 8 alone, true cylinders, shapes kept in memory: so is it here."""

_WITHOUT_EFFECT = {
    256: "URDF_GLOBAL_VELOCITIES_MB",
    2048: "URDF_ENABLE_SLEEPING",
    4096: "URDF_INITIALIZE_SAT_FEATURES",
    32768: "URDF_USE_MATERIAL_COLORS_FROM_MTL",
    65536: "URDF_USE_MATERIAL_TRANSPARANCY_FROM_MTL",
    262144: "URDF_ENABLE_WAKEUP",
    4194304: "URDF_PRINT_URDF_INFO",
    8388608: "URDF_GOOGLEY_UNDEFINED_COLORS",
}
_REFUSED = {
    8192: "URDF_USE_SELF_COLLISION_INCLUDE_PARENT",
    131072: "URDF_MAINTAIN_LINK_ORDER",
    524288: "URDF_MERGE_FIXED_LINKS",
    1048576: "URDF_IGNORE_VISUAL_SHAPES",
    2097152: "URDF_IGNORE_COLLISION_SHAPES",
}


def self_collision_of(flags: int) -> SelfCollision | None:
    """Which links of a robot touch each other by its flags; None: none of them. Warns of flags that change nothing
    here. Raises error on those that would have to change something, and on unknown ones."""
    for flag, name in _REFUSED.items():
        if flags & flag:
            raise error(f"loadURDF cannot honour the flag {name} ({flag}) here: change the file, or load without it")
    for flag, name in _WITHOUT_EFFECT.items():
        if flags & flag:
            warnings.warn(f"the flag {name} ({flag}) has no effect here", UserWarning, 3)
    known = _USE_SELF_COLLISION | _EXCLUDE_ALL_PARENTS | _AS_IT_IS | sum(_WITHOUT_EFFECT)
    if unknown := flags & ~known:
        raise error(f"loadURDF knows no flags {unknown}")
    if not flags & _USE_SELF_COLLISION:
        return None

    def touch(a: int, b: int, parents: list[int]) -> bool:
        above, below = sorted((a, b))
        if parents[below] == above:
            return False
        return not flags & _EXCLUDE_ALL_PARENTS or above not in _ancestors(below, parents)

    return touch


def _ancestors(link: int, parents: list[int]) -> set[int]:
    found: set[int] = set()
    while (link := parents[link]) >= 0:
        found.add(link)
    return found
