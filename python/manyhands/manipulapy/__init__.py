"""ManipulaPy's package over this engine: `from manyhands.manipulapy.sim import Simulation` in place of ManipulaPy.

Modules are imported when they are first asked for. docs/coming_from_manipulapy.md says what is here and what differs.
"""

from importlib import import_module
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as _version
from importlib.util import find_spec
from typing import Any

__version__ = "1.4.1"
"""The version of ManipulaPy whose functions these are."""

_MODULES = (
    "backend", "control", "cuda_kernels", "dynamics", "ik_helpers", "kinematics", "path_planning", "perception",
    "planning", "potential_field", "sim", "singularity", "trac_ik", "urdf", "urdf_processor", "utils", "vision",
    "ManipulaPy_data",
)  # fmt: skip
_NAMES = {
    "SerialManipulator": "kinematics",
    "TracIKSolver": "kinematics",
    "ManipulatorDynamics": "dynamics",
    "ManipulatorController": "control",
    "Vision": "vision",
    "set_backend": "backend",
    "get_backend": "backend",
    "use_backend": "backend",
}
_FEATURES = {
    "core": "manyhands",
    "simulation": "manyhands",
    "vision": "manyhands",
    "plots": "matplotlib",
    "gui": "viser",
}


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return import_module(f"{__name__}.{name}")
    if name in _NAMES:
        return getattr(import_module(f"{__name__}.{_NAMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_MODULES, *_NAMES})


def get_version() -> str:
    """Of ManipulaPy's functions."""
    return __version__


def get_available_features() -> list[str]:
    """What works with what is installed."""
    return [name for name, module in _FEATURES.items() if find_spec(module) is not None]


def get_missing_features() -> list[str]:
    """What needs more."""
    return [name for name in _FEATURES if name not in get_available_features()]


def check_dependencies(verbose: bool = True) -> dict[str, bool]:
    """Features, and whether they work."""
    found = {name: name in get_available_features() for name in _FEATURES}
    if verbose:
        for name, works in found.items():
            print(f"{name}: {'works' if works else get_installation_command(name)}")
    return found


def get_installation_command(feature: str) -> str:
    """What to type for a feature."""
    extras = {"plots": "[plots]", "gui": "[viewer]"}
    return f'pip install "manyhands{extras.get(feature, "")}"'


def require_feature(feature: str) -> None:
    """Raises ImportError, which says what to install, unless it works."""
    if feature not in get_available_features():
        raise ImportError(f"{feature} is not available: {get_installation_command(feature)}")


def test_installation() -> bool:
    """Whether the package underneath is installed."""
    try:
        return bool(_version("manyhands"))
    except PackageNotFoundError:
        return False
