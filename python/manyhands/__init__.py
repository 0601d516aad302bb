"""Robot manipulation: thousands of arms simulated at once on an ordinary CPU, and policies learned from them."""

import sys
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from manyhands_command import end_quietly

if sys.argv[:1] == ["-m"]:  # `python -m manyhands` is on its way to its main
    sys.excepthook = end_quietly

from manyhands.isa import VERSION, BuildInfo, build_info

# isort: split
# The build of the extension is chosen.
from manyhands import collision, control, dynamics, envs, kinematics, perception, planning, robots, world_envs
from manyhands._core import (
    Actuator,
    Batch,
    Compliance,
    Contact,
    ContactPair,
    ContactResiduals,
    ContactWrench,
    EqualityConstraint,
    Finding,
    Frame,
    Geom,
    HeightField,
    Joint,
    Keyframe,
    Link,
    LoadNote,
    LoadReport,
    LoadWarning,
    Mesh,
    MjcfError,
    Model,
    ModelBuilder,
    SaveError,
    SdfError,
    SimulationError,
    Tendon,
    UrdfError,
    World,
    asset_path,
    load_mjcf,
    load_mjcf_string,
    load_sdf,
    load_urdf,
    save_mjcf,
    save_mjcf_string,
    save_urdf,
    save_urdf_string,
    set_asset_root,
)
from manyhands._core.render import Camera, Look, Mark, Picture, Renderer, Texture
from manyhands.compat import install_as
from manyhands.decomposition import decompose, decompose_model
from manyhands.ik import IkResult, inverse_kinematics
from manyhands.notebook import show_in_notebooks
from manyhands.policies import policy
from manyhands.textures import load_texture
from manyhands.viewer import view

if TYPE_CHECKING:
    from types import ModuleType

    from manyhands import plots, recording, video

__version__ = VERSION

_assets = Path(__file__).parent / "assets"
if _assets.is_dir():
    set_asset_root(_assets)

show_in_notebooks()
envs.register()
world_envs.register()

if not TYPE_CHECKING:  # a type checker knows all names as it is

    def __getattr__(name: str) -> "ModuleType":
        """Modules that few programs need are imported when they are first asked for."""
        if name in ("plots", "recording", "video"):
            return import_module(f"manyhands.{name}")
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """What users find here, without what this file needs itself."""
    return sorted([*__all__, "__doc__", "__file__", "__name__", "__path__"])


__all__ = [
    "Actuator",
    "Batch",
    "BuildInfo",
    "Camera",
    "Compliance",
    "Contact",
    "ContactPair",
    "ContactResiduals",
    "ContactWrench",
    "EqualityConstraint",
    "Finding",
    "Frame",
    "Geom",
    "HeightField",
    "IkResult",
    "Joint",
    "Keyframe",
    "Link",
    "LoadNote",
    "LoadReport",
    "LoadWarning",
    "Look",
    "Mark",
    "Mesh",
    "MjcfError",
    "Model",
    "ModelBuilder",
    "Picture",
    "Renderer",
    "SaveError",
    "SdfError",
    "SimulationError",
    "Tendon",
    "Texture",
    "UrdfError",
    "World",
    "__version__",
    "asset_path",
    "build_info",
    "collision",
    "control",
    "decompose",
    "decompose_model",
    "dynamics",
    "envs",
    "install_as",
    "inverse_kinematics",
    "kinematics",
    "load_mjcf",
    "load_mjcf_string",
    "load_sdf",
    "load_texture",
    "load_urdf",
    "perception",
    "planning",
    "plots",
    "policy",
    "recording",
    "robots",
    "save_mjcf",
    "save_mjcf_string",
    "save_urdf",
    "save_urdf_string",
    "video",
    "view",
    "world_envs",
]
