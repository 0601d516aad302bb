"""What a training takes of memory, so that one that does not fit is refused before it is begun."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from manyhands._core.envs import EnvSpec, make_env_batch
from manyhands._core.learn import TrainerConfig
from manyhands.envs.cameras import picture_bytes
from manyhands.training.settings import TrainSettings

_FEW = 2000  # worlds, of some 10 kB each: no more are not worth measuring, and so many are measured
_FLOAT = 4
_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")  # of a container, v2 and v1


def require_memory(settings: TrainSettings, runs: int = 1) -> float:
    """About how many bytes the worlds and the experience of a run take. Raises ValueError, with the number that fits,
    unless there is room for so many runs at a time."""
    config = settings.trainer_config()
    spec = make_env_batch(settings.env_id, 1, randomize=settings.ranges).spec
    free = available = free_memory() / runs
    if config.algorithm != "PPO" and not config.replay_folder:
        each = _bytes_of_transition(spec, config, settings.cameras)
        hint = "; a file holds more: --set replay_folder=FOLDER"
        free -= _require("replay_capacity", config.replay_capacity, each, free, runs, hint)
    counts = {"evaluation_episodes": config.evaluation_episodes}
    if settings.workers is None:  # else they are elsewhere
        counts["num_envs"] = settings.num_envs
    each = _bytes_of_steps(spec, config)
    if max(counts.values()) > _FEW:
        each += _bytes_of_world(settings.env_id)
    for name, count in counts.items():
        free -= _require(name, count, each, free, runs)
    return available - free


def require_replay(name: str, transitions: int, spec: EnvSpec, hint: str) -> None:
    """Raises ValueError, with the number that fits and `hint`, unless a replay of so many has room in memory."""
    _require(name, transitions, _bytes_of_transition(spec, TrainerConfig(), {}), free_memory(), 1, hint)


def require_rollout(name: str, steps: int, spec: EnvSpec, worlds: int) -> None:
    """Raises ValueError, with the number that fits, unless so many steps of so many worlds have room in memory."""
    _require(name, steps, worlds * _FLOAT * _numbers_of_step(spec), free_memory(), 1)


def _require(name: str, count: int, each: float, free: float, runs: int, hint: str = "") -> float:
    """The bytes that `count` of them take. Raises ValueError if these are more than are free."""
    if count * each > free:
        fits = str(max(0, int(free / each)))
        of_run = "" if runs == 1 else f" for each of {runs} runs at a time"
        raise ValueError(
            f"{name} is {count:,}, which takes about {in_gigabytes(count * each)} of memory, and {in_gigabytes(free)} "
            f"are free{of_run}: at most {int(fits[:2].ljust(len(fits), '0')):,} fit{hint}"
        )
    return count * each


def in_gigabytes(size: float) -> str:
    """For example "11 GB" and "0.4 GB"."""
    return f"{size / 1e9:,.{0 if size >= 1e10 else 1}f} GB"


def free_memory() -> float:
    """Bytes that processes may still take, as far as the system tells."""
    known = [float(line) for path in _LIMITS for line in _lines(path) if line.isdigit()]
    return min([_kilobytes("/proc/meminfo", "MemAvailable"), *known])


@cache
def _bytes_of_world(env_id: str) -> float:
    """Of its simulation. Measured, for what tasks keep differs; well in a process that has not freed much before."""
    before = _kilobytes("/proc/self/status", "VmRSS")
    envs = make_env_batch(env_id, _FEW, num_threads=1)
    return max(0.0, _kilobytes("/proc/self/status", "VmRSS") - before) / envs.num_envs


def _bytes_of_steps(spec: EnvSpec, config: TrainerConfig) -> float:
    """Of a world's episode so far, and of what PPO learns from."""
    steps = spec.max_episode_steps + (config.rollout_steps if config.algorithm == "PPO" else 0)
    return _FLOAT * _numbers_of_step(spec) * steps


def _numbers_of_step(spec: EnvSpec) -> int:
    return spec.observation_dim + 2 * spec.goal_dim + 2 * spec.action_dim + 2


def _bytes_of_transition(spec: EnvSpec, config: TrainerConfig, cameras: Mapping[str, Any]) -> float:
    """Of the replay: pictures, or the state before a step and after it."""
    if cameras:
        return picture_bytes(cameras)
    numbers = 2 * spec.observation_dim + 3 * spec.goal_dim + spec.action_dim + 1
    advised = spec.action_dim if config.wants_expert else 0
    drawn = len(spec.randomized) if config.privileged_critic else 0
    return _FLOAT * (numbers + advised + drawn + 1) + 1


def _kilobytes(path: str, name: str) -> float:
    """A line such as "VmRSS:  1234 kB", in bytes; infinity if the system has none."""
    for line in _lines(path):
        if line.startswith(f"{name}:"):
            return 1024 * float(line.split()[1])
    return float("inf")


def _lines(path: str) -> list[str]:
    try:
        return Path(path).read_text().splitlines()
    except OSError:
        return []
