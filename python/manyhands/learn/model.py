"""A policy in training: what PPO, SAC, TQC, TD3 and DDPG have in common."""

import io
import json
import math
import tempfile
import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import gymnasium
import numpy as np
from numpy.typing import NDArray

from manyhands._core.learn import Policy, Trainer, TrainerConfig, TrainMetrics
from manyhands.arguments import whole_number
from manyhands.extras import needs
from manyhands.files import replacing
from manyhands.interrupts import Interrupts
from manyhands.learn.course import Log, Schedule, first_rate, rate_at
from manyhands.learn.report import Report
from manyhands.learn.worlds import AnyEnv, make_worlds
from manyhands.training.settings import override

_SECONDS_PER_PIECE = 0.1
_ROLLOUT = 2048  # transitions between PPO's updates, if nothing is said
_FORMAT = 1  # of saved files

Callback = Callable[["Model"], bool | None]

_M = TypeVar("_M", bound="Model")


class Model:
    """Trains a policy on an environment, and acts by it."""

    def __init__(
        self,
        env: AnyEnv,
        settings: dict[str, Any],
        n_envs: int | None,
        num_threads: int | None,
        seed: int,
        verbose: int,
        learning_rate: float | Schedule,
        tensorboard_log: str | Path | None,
    ) -> None:
        """`settings` are the trainer's. Raises ValueError on those that make no sense."""
        rate = first_rate(learning_rate)
        settings = settings | {"actor_learning_rate": rate, "critic_learning_rate": rate}
        self._worlds = make_worlds(env, n_envs, num_threads)
        self._settings = settings
        self.learning_rate = learning_rate
        """A number, or a function of what is left of the training, from 1 down to 0. May be set between trainings."""
        self.present_rate = rate
        """What the learning rate is now."""
        self.tensorboard_log = None if tensorboard_log is None else Path(tensorboard_log)
        """The folder of TensorBoard's events, None for no such."""
        self.verbose = verbose
        self.seed = whole_number("seed", seed, 0, 2**63 - 1)
        batch = self._worlds.batch
        if settings["algorithm"] == "PPO" and "rollout_steps" not in settings:
            self._settings["rollout_steps"] = max(_ROLLOUT // batch.num_envs, 1)
        if not self.has_goals:
            self._settings["hindsight_fraction"] = 0.0
        if "replay_capacity" in settings:
            whole_number("buffer_size", settings["replay_capacity"], 1)
            self._settings["replay_capacity"] = max(settings["replay_capacity"], batch.spec.max_episode_steps)
        self._trainer = Trainer(batch, None, self._config(num_threads))

    def _config(self, num_threads: int | None) -> TrainerConfig:
        config = TrainerConfig()
        config.seed = self.seed
        if num_threads is not None:
            config.num_threads = num_threads
        for name, value in self._settings.items():
            override(config, name, value)
        config.validate()
        return config

    @property
    def n_envs(self) -> int:
        """Worlds that are stepped at a time."""
        return self._worlds.batch.num_envs

    @property
    def num_timesteps(self) -> int:
        """Steps of all worlds together so far."""
        return self.metrics.env_steps

    @property
    def has_goals(self) -> bool:
        """Whether the environment has goals."""
        return self._worlds.batch.spec.goal_dim > 0

    @property
    def has_success(self) -> bool:
        """Whether the environment says of an episode if it succeeded; one in Python says so first by its infos."""
        return self._worlds.host is None or self._worlds.host.has_success

    @property
    def metrics(self) -> TrainMetrics:
        """Where training stands."""
        return self._trainer.metrics()

    @property
    def policy(self) -> Policy:
        """The deterministic policy as arrays."""
        return self._trainer.policy()

    def learn(
        self: _M,
        total_timesteps: int,
        callback: Callback | None = None,
        progress_bar: bool = False,
        reset_num_timesteps: bool = False,
        tb_log_name: str | None = None,
    ) -> _M:
        """Trains for `total_timesteps` more steps of all worlds together, rounded up to whole steps of every world.

        callback: called with the model after each step of the worlds; False ends the training.
        reset_num_timesteps: must be False; steps are counted on, and of schedules what was trained before is done.
        tb_log_name: of this training in the folder `tensorboard_log`; None is the algorithm's.

        Ctrl-C ends it after the present step, and the model can be saved. Raises RuntimeError if networks diverge.
        """
        if reset_num_timesteps:
            raise ValueError("reset_num_timesteps is True: steps are always counted on; make a new model instead")
        left = math.ceil(whole_number("total_timesteps", total_timesteps, 0, 2**62) / self.n_envs)
        end = self.num_timesteps + left * self.n_envs
        piece = 1
        log = Log(self.tensorboard_log, tb_log_name or type(self).__name__)
        with Interrupts() as interrupts, log, Report(self, end, progress_bar, self.verbose > 0) as report:
            while left > 0:
                begin = time.perf_counter()
                self._set_rate(1 - self.num_timesteps / end)
                self._trainer.advance(min(piece, left))
                left -= min(piece, left)
                log.add(self, last=left == 0)
                if callback is not None and callback(self) is False:
                    break
                if callback is None and not callable(self.learning_rate):
                    elapsed = max(time.perf_counter() - begin, 1e-6)
                    piece = max(1, round(piece * min(_SECONDS_PER_PIECE / elapsed, 2.0)))
                report.show()
                if interrupts.requested:
                    raise KeyboardInterrupt
        return self

    def _set_rate(self, left: float) -> None:
        """Where so much of the training is left."""
        self.present_rate = rate_at(self.learning_rate, left)
        self._trainer.scale_rates(self.present_rate / self._settings["actor_learning_rate"])

    def predict(
        self,
        observation: Any,
        state: None = None,
        episode_start: NDArray[np.bool_] | None = None,
        deterministic: bool = False,
    ) -> tuple[Any, None]:
        """(action, None) for an observation, or (n actions, None) for n of them, as the environment gives them.

        deterministic: True acts best, False as in training, by chance (TD3 and DDPG have no chance in them). `state`
        and `episode_start` are of policies with a memory, which these are not. Raises ValueError on a wrong shape.
        """
        observations, several = self._worlds.observation.unbatch(observation)
        rows = self._trainer.predict(*self._worlds.observation.rows(observations), draw=not deterministic)
        actions = self._worlds.action.actions(rows)
        return (actions if several else actions[0]), None

    def save_onnx(self, path: str | Path) -> None:
        """Writes the deterministic policy as an ONNX file, which takes observations as the environment gives them, in
        a row, and gives actions in [-1, 1] or the index of a choice. Needs the extra `train`."""
        with needs("train", "an ONNX file"):
            from manyhands.training.policy_file import save_policy
        save_policy(self.policy, self._worlds.name, Path(path))

    def save(self, path: str | Path, include_replay: bool = False) -> None:
        """Writes a .zip file from which `load` goes on: networks, optimisers, statistics. With the replay training
        goes on exactly, where the environment gives the same bits again. Raises OSError, leaving the file as it was."""
        path = _zip_path(path)
        about = {
            "format": _FORMAT,
            "algorithm": type(self).__name__,
            "environment": self._worlds.name,
            "n_envs": self.n_envs,
            "seed": self.seed,
            "settings": self._settings,
        }
        with replacing(path) as temporary, tempfile.TemporaryDirectory() as folder:
            checkpoint = Path(folder) / "checkpoint"
            self._trainer.save(checkpoint, include_replay)
            with zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
                archive.writestr("about.json", json.dumps(about, indent=2))
                archive.write(checkpoint, "checkpoint")

    @classmethod
    def load(
        cls: type[_M],
        path: str | Path,
        env: AnyEnv | None = None,
        num_threads: int | None = None,
        verbose: int = 0,
        tensorboard_log: str | Path | None = None,
    ) -> _M:
        """A model that `save` wrote. `env`: None makes the one that it was trained on, by its id. A schedule is not
        saved: `learning_rate` is the number with which training began, until it is set.

        Raises FileNotFoundError, or ValueError if the file is damaged, of another algorithm, or does not fit `env`.
        """
        path = _zip_path(path)
        about, checkpoint = _read(path)
        if about["algorithm"] != cls.__name__:
            raise ValueError(f"{path} holds a {about['algorithm']}, not a {cls.__name__}: load it by that")
        model = cls.__new__(cls)
        Model.__init__(
            model,
            about["environment"] if env is None else env,
            about["settings"],
            about["n_envs"],
            num_threads,
            about["seed"],
            verbose,
            about["settings"]["actor_learning_rate"],
            tensorboard_log,
        )
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / path.name
            file.write_bytes(checkpoint)
            try:
                model._trainer.load(file)
            except RuntimeError as error:
                raise ValueError(f"{path} does not fit {model._worlds.name}: {error}") from error
        return model


def _zip_path(path: str | Path) -> Path:
    path = Path(path)
    return path if path.suffix == ".zip" else path.with_name(path.name + ".zip")


def _read(path: Path) -> tuple[dict[str, Any], bytes]:
    """What a saved model says of itself, and its checkpoint."""
    if not path.is_file():
        raise FileNotFoundError(f"there is no saved model {path}")
    try:
        with zipfile.ZipFile(io.BytesIO(path.read_bytes())) as archive:
            about, checkpoint = json.loads(archive.read("about.json")), archive.read("checkpoint")
        missing = {"format", "algorithm", "environment", "n_envs", "seed", "settings"} - about.keys()
    except (zipfile.BadZipFile, KeyError, ValueError, AttributeError) as error:
        raise ValueError(f"{path} is no saved model, or damaged: {error}") from error
    if missing or about["format"] != _FORMAT:
        raise ValueError(f"{path} is no saved model of this version")
    return about, checkpoint


def evaluate_policy(
    model: Model, env: Any, n_eval_episodes: int = 10, deterministic: bool = True, seed: int = 0
) -> tuple[float, float]:
    """Mean and standard deviation of the return over episodes of one Gymnasium environment, from seed `seed` on."""
    whole_number("n_eval_episodes", n_eval_episodes, 1, 2**31)
    if not isinstance(env, gymnasium.Env):
        raise TypeError(f"env is {env!r}, expected one Gymnasium environment, as gymnasium.make gives it")
    returns: list[float] = []
    for episode in range(n_eval_episodes):
        observation, _ = env.reset(seed=seed + episode)
        total, over = 0.0, False
        while not over:
            action, _ = model.predict(observation, deterministic=deterministic)
            observation, reward, terminated, truncated, _ = env.step(action)
            total += float(reward)
            over = bool(terminated or truncated)
        returns.append(total)
    return float(np.mean(returns)), float(np.std(returns))
