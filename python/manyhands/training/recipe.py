"""Recipes: the settings with which an environment is known to be learned."""

import difflib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from manyhands._core.envs import make_env_batch
from manyhands.arguments import as_whole
from manyhands.env_names import resolve_env_id
from manyhands.envs.cameras import eyes
from manyhands.simple_yaml import Entry, read_yaml
from manyhands.training.settings import KINDS, TrainSettings, require_setting

_FOLDER = Path(__file__).parent / "recipes"

_T = TypeVar("_T")


@dataclass(frozen=True)
class Measured:
    """What a recipe did: over several seeds, the least success and the longest training."""

    machine: str
    seeds: int
    success: float  # at the end of 1000 fresh episodes
    seconds: float
    env_steps: int


@dataclass(frozen=True)
class Recipe:
    """One file of recipes/, or a user's own."""

    path: Path
    env_id: str
    num_envs: int
    max_env_steps: int
    trainer: dict[str, Any]  # settings that differ from the trainer's defaults
    beyond: dict[str, str]  # what it uses beyond the task's own reward: a name, and what it does
    cameras: dict[str, Any]  # through which the policy sees, none if it knows the state
    measured: Measured | None

    def settings(self, **changes: Any) -> TrainSettings:
        """The settings of a run, with `changes`; those in `overrides` are added to the recipe's own."""
        own = {"num_envs": self.num_envs, "max_env_steps": self.max_env_steps, "cameras": self.cameras}
        given: dict[str, Any] = own | changes
        given["overrides"] = self.trainer | given.get("overrides", {})
        return TrainSettings(self.env_id, **given)

    def is_of(self, settings: TrainSettings) -> bool:
        """Whether a run has these settings, so that what was measured is to be expected of it."""
        own = (self.env_id, self.num_envs, self.trainer, self.cameras)
        its = (settings.env_id, settings.num_envs, settings.overrides, settings.cameras)
        return own == its and not settings.randomize and settings.workers is None


def recipe_ids() -> list[str]:
    """The environments that have a recipe."""
    return sorted(path.stem for path in _FOLDER.glob("*.yaml"))


def find_recipe(env_id: str, kind: str = "") -> Recipe | None:
    """The recipe that is shipped for an environment, None if there is none; `kind` is "pixels" for one that sees."""
    path = _FOLDER / kind / f"{env_id}.yaml"
    return load_recipe(path) if path.is_file() else None


def expected(settings: TrainSettings) -> Measured | None:
    """What the shipped recipe did that a run goes by; None if it goes by another, or nothing was measured."""
    recipe = find_recipe(settings.env_id, "pixels" if settings.cameras else "")
    return recipe.measured if recipe is not None and recipe.is_of(settings) else None


def named_recipe(name: Path, env_id: str) -> Recipe:
    """The recipe in a file, or of a kind that is shipped, such as "pixels". Raises ValueError if there is none of the
    kind for the environment, or its recipe is for another; OSError if the file cannot be read."""
    if (_FOLDER / name).is_dir() and not name.exists():
        recipe = find_recipe(env_id, str(name))
        if recipe is None:
            known = ", ".join(sorted(path.stem for path in (_FOLDER / name).glob("*.yaml")))
            raise ValueError(f"no recipe {name} is shipped for {env_id}; there are {known}")
    elif name.is_dir():
        raise ValueError(f"{name} is a folder; expected a recipe's file")
    elif not name.is_file():
        raise ValueError(f"there is no file {name} with a recipe, nor a kind of that name; pixels is one")
    else:
        recipe = load_recipe(name)
    if recipe.env_id != env_id:
        raise ValueError(f"{recipe.path} is a recipe for {recipe.env_id}, not for {env_id}")
    return recipe


def load_recipe(path: Path) -> Recipe:
    """The recipe in a file. Raises ValueError that names the line of what is wrong, OSError if it cannot be read."""
    top = _Block(path, Entry(1, entries=read_yaml(path)))
    env_id = _id(top, "environment")
    base = _base(top, path)
    trainer, beyond = top.block("trainer"), top.block("beyond")
    own_trainer = {name: entry.value for name, entry in trainer.entry.entries.items()}
    own_beyond = {name: beyond.take(name, str) for name in list(beyond.entry.entries)}
    recipe = Recipe(
        path=path,
        env_id=env_id,
        num_envs=top.take("num_envs", int, None if base is None else base.num_envs),
        max_env_steps=top.take("max_env_steps", int, None if base is None else base.max_env_steps),
        trainer=own_trainer if base is None else base.trainer | own_trainer,
        beyond=own_beyond if base is None else base.beyond | own_beyond,
        cameras=_cameras(top, env_id) or ({} if base is None else base.cameras),
        measured=_measured(top.block("measured")),
    )
    top.finish()
    _check_settings(recipe, top, trainer)
    return recipe


def _id(top: "_Block", name: str) -> str:
    """An environment's, with or without its version."""
    given = top.take(name, str)
    try:
        return resolve_env_id(given)
    except ValueError as reason:
        raise top.error(name, str(reason)) from None


def _base(top: "_Block", path: Path) -> Recipe | None:
    """The shipped recipe that this one is like, but for what it says itself."""
    if "like" not in top.entry.entries:
        return None
    shipped = _FOLDER / f"{_id(top, 'like')}.yaml"
    if not shipped.is_file():
        raise top.error("like", f"no recipe is shipped for {shipped.stem!r}; there are {', '.join(recipe_ids())}")
    if path.resolve() == shipped.resolve():
        raise top.error("like", "a recipe cannot be like itself")
    return load_recipe(shipped)


def _cameras(top: "_Block", env_id: str) -> dict[str, Any]:
    """Names of cameras, with what varies in their pictures."""
    looks = {name: entry.value for name, entry in top.block("looks").entry.entries.items()}
    names = top.take("cameras", list, [])
    if looks and not names:
        raise top.error("looks", "there are no cameras whose looks could vary")
    cameras: dict[str, Any] = {str(name): {"vary": dict(looks)} for name in names}
    if not cameras:
        return {}
    try:
        eyes(make_env_batch(env_id, 1), cameras)
    except (KeyError, ValueError) as reason:
        raise top.error("looks" if "vari" in reason.args[0] else "cameras", reason.args[0]) from reason
    return cameras


def _measured(block: "_Block") -> Measured | None:
    if not block.entry.entries:
        return None
    measured = Measured(
        machine=block.take("machine", str),
        seeds=block.take("seeds", int),
        success=block.take("success", float),
        seconds=block.take("seconds", float),
        env_steps=block.take("env_steps", int),
    )
    block.finish()
    return measured


def _check_settings(recipe: Recipe, top: "_Block", trainer: "_Block") -> None:
    """Raises ValueError, with the line of the setting that it is about, unless a run can have these settings."""
    for name in trainer.entry.entries:
        _check_name(name, trainer)
    try:
        recipe.settings().trainer_config()
    except ValueError as reason:
        for block in (trainer, top):
            for name in block.entry.entries:
                if name in str(reason):
                    raise block.error(name, str(reason)) from reason
        raise ValueError(f"{recipe.path}: {reason}") from reason


def _check_name(name: str, trainer: "_Block") -> None:
    try:
        require_setting(name)
    except ValueError as reason:
        raise trainer.error(name, str(reason)) from None


class _Block:
    """Entries of a file, taken one by one."""

    def __init__(self, path: Path, entry: Entry) -> None:
        self._path = path
        self.entry = entry
        self._left = dict(entry.entries)
        self._known: list[str] = []  # names that were asked for

    def error(self, name: str, complaint: str) -> ValueError:
        return ValueError(f"{self._path}:{self.entry.entries[name].line}: {complaint}")

    def take(self, name: str, kind: type[_T], default: _T | None = None) -> _T:
        """A value that must be there, unless there is a default."""
        self._known.append(name)
        if name not in self._left:
            if default is not None:
                return default
            raise self._missing(name)
        value = self._left.pop(name).value
        if kind is float and type(value) is int:
            value = float(value)
        if kind is int:
            value = as_whole(value)  # 1e4
        if type(value) is not kind:
            raise self.error(name, f"{name} is {value!r}, expected {KINDS[kind]}")
        return value

    def _missing(self, name: str) -> ValueError:
        for near in difflib.get_close_matches(name, self._left, cutoff=0.8):
            return self.error(near, f"there is no {near!r}; did you mean {name}?")
        return ValueError(f"{self._path}:{self.entry.line}: {name} is missing here")

    def block(self, name: str) -> "_Block":
        """Entries below a name, none if it is not there."""
        self._known.append(name)
        entry = self._left.pop(name, Entry(self.entry.line))
        if entry.value is not None:
            raise self.error(name, f"{name} is {entry.value!r}, expected indented lines 'name: value' below it")
        return _Block(self._path, entry)

    def finish(self) -> None:
        """Raises ValueError if something is left."""
        for name in self._left:
            near = difflib.get_close_matches(name, self._known)
            hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(self._known)}"
            raise self.error(name, f"a recipe has no {name!r} here; {hint}")
