"""PyBullet's flags for loading robots: what they mean here."""

import warnings

from manyhands.panda_gym.simulation import error

# The file's inertia, true cylinders, shapes kept in memory: so it is here. 16 adds nothing where links do not touch.
_AS_IT_IS = 2 | 16 | 32 | 128 | 1024
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
    8: "URDF_USE_SELF_COLLISION",
    8192: "URDF_USE_SELF_COLLISION_INCLUDE_PARENT",
    131072: "URDF_MAINTAIN_LINK_ORDER",
    524288: "URDF_MERGE_FIXED_LINKS",
    1048576: "URDF_IGNORE_VISUAL_SHAPES",
    2097152: "URDF_IGNORE_COLLISION_SHAPES",
}


def require_honoured(flags: int) -> None:
    """Warns of flags that change nothing here. Raises error on those that would have to, and on unknown ones."""
    for flag, name in _REFUSED.items():
        if flags & flag:
            raise error(f"loadURDF cannot honour the flag {name} ({flag}) here: load without it, or change the file")
    if unknown := flags & ~(_AS_IT_IS | sum(_WITHOUT_EFFECT)):
        raise error(f"loadURDF knows no flags {unknown}")
    for flag, name in _WITHOUT_EFFECT.items():
        if flags & flag:
            warnings.warn(f"the flag {name} ({flag}) has no effect here", UserWarning, 3)
