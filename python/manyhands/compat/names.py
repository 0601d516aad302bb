"""Names of other packages that stand for modules of this one."""

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_loader
from types import ModuleType

NAMES = {
    "pybullet": "manyhands.pybullet",
    "pybullet_data": "manyhands.pybullet_data",
    "pybullet_utils": "manyhands.pybullet_utils",
    "panda_gym": "manyhands.panda_gym",
    "gym": "manyhands.gym",
    "ManipulaPy": "manyhands.manipulapy",
}
"""What `install_as` knows, and the modules that they then stand for."""

_INSIDE = {"gym.error": "gymnasium.error", "gym.spaces": "gymnasium.spaces"}
"""Modules below a name that are not where it stands."""


def install_as(*names: str) -> None:
    """From now on `import pybullet`, for example, gives this package's module, in all of the program; what lies below a
    name, as pybullet_utils.bullet_client, does too. Call it before anything imports these names.

    names: of "pybullet", "pybullet_data", "pybullet_utils", "panda_gym", "gym" and "ManipulaPy"; all six if none is
    given. Nothing is imported yet. Raises ValueError on another name, and ImportError if one has been imported from
    elsewhere.
    """
    names = names or tuple(NAMES)
    for name in names:
        if name not in NAMES:
            raise ValueError(f"{name!r} is no name that manyhands can stand in for; there are {', '.join(NAMES)}")
    for name in names:
        _require_free(name)
    redirect(*names)


def redirect(*names: str) -> None:
    """The same of names that are known to be free."""
    _FINDER.names.update(names)
    if _FINDER not in sys.meta_path:
        sys.meta_path.insert(0, _FINDER)


def _require_free(name: str) -> None:
    imported = [key for key in sys.modules if key == name or key.startswith(f"{name}.")]
    if all(sys.modules[key].__name__ == _target(key) for key in imported):
        return
    place = getattr(sys.modules[imported[0]], "__file__", None) or "another package"
    raise ImportError(
        f"{name!r} has been imported already, from {place}: call manyhands.install_as({name!r}) before the first "
        f"import of {name!r}, at the top of the program, or run the program by `python -m manyhands.compat`",
        name=name,
    )


def _target(name: str) -> str:
    """What a name, or one below it, stands for: "manyhands.gym.wrappers" of "gym.wrappers"."""
    for start in (*_INSIDE, *NAMES):
        if name == start or name.startswith(f"{start}."):
            return {**_INSIDE, **NAMES}[start] + name.removeprefix(start)
    raise KeyError(name)


class _Finder(MetaPathFinder):
    """Finds our modules under the names that were given away."""

    def __init__(self) -> None:
        self.names: set[str] = set()

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname.partition(".")[0] not in self.names:
            return None
        ours = _target(fullname)
        try:
            module = import_module(ours)
        except ModuleNotFoundError as missing:
            if missing.name == ours and "." in fullname:
                return None  # left to those after us, who look along the package's __path__
            raise
        is_package = hasattr(module, "__path__")
        return spec_from_loader(fullname, _Loader(module), origin=module.__file__, is_package=is_package)


class _Loader(Loader):
    """Gives a module that is there already, as it was."""

    def __init__(self, module: ModuleType) -> None:
        self._module, self._spec = module, module.__spec__

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return self._module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self._spec  # the import has put its own there


_FINDER = _Finder()
