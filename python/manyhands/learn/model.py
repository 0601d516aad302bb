"""A policy in training: what PPO, SAC, TQC, TD3 and DDPG have in common."""

import io
import json
import math
import re
import secrets
import tempfile
import time
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import gymnasium
import numpy as np
from numpy.typing import NDArray

from manyhands._core.learn import Policy, Trainer, TrainerConfig, TrainMetrics
from manyhands.arguments import whole
from manyhands.extras import needs
from manyhands.files import replacing
from manyhands.interrupts import Interrupts
from manyhands.learn.course import Log, Schedule, first_rate, rate_at
from manyhands.learn.report import Report
from manyhands.learn.sb3_arguments import METHODS, check_others
from manyhands.learn.worlds import AnyEnv, Worlds, make_worlds
from manyhands.training.settings import override

_SECONDS_PER_PIECE = 0.1
_FORMAT = 1  # of saved files

_ARGUMENTS = {
    "activation": "activation_fn",
    "actor_learning_rate": "learning_rate",
    "dropped_quantiles": "top_quantiles_to_drop_per_net",
    "entropy_weight": "ent_coef",
    "epochs": "n_epochs",
    "exploration_noise": "action_noise",
    "hidden_layers": "net_arch",
    "initial_std": "exp(log_std_init)",
    "max_gradient_norm": "max_grad_norm",
    "num_critics": "n_critics",
    "num_quantiles": "n_quantiles",
    "replay_capacity": "buffer_size",
    "return_steps": "n_steps",
    "rollout_steps": "n_steps",
    "target_noise": "target_policy_noise",
    "target_rate": "tau",
    "temperature": "ent_coef",
    "updates_per_iteration": "gradient_steps",
    "value_weight": "vf_coef",
    "warmup_transitions": "learning_starts",
}  # that set the trainer's settings
_OF_SETTINGS = "TrainerConfig: ", "the trainer setting "  # how errors about them begin

Callback = Callable[["Model"], bool | None]

_M = TypeVar("_M", bound="Model")


class Model:
    """Trains a policy on an environment, and acts by it."""

    def __init__(
        self,
        worlds: Worlds,
        settings: dict[str, Any],
        num_threads: int | None,
        seed: int | None,
        verbose: int,
        learning_rate: float | Schedule,
        tensorboard_log: str | Path | None,
    ) -> None:
        """`settings` are the trainer's. Raises ValueError on those that make no sense."""
        rate = first_rate(learning_rate)
        settings = settings | {"actor_learning_rate": rate, "critic_learning_rate": rate}
        self._settings = {name: _plain(value) for name, value in settings.items()}
        self._num_threads = num_threads
        self.learning_rate = learning_rate
        """A number, or a function of what is left of the training, from 1 down to 0. May be set between trainings."""
        self.present_rate = rate
        """What the learning rate is now."""
        self.tensorboard_log = None if tensorboard_log is None else Path(tensorboard_log)
        """The folder of TensorBoard's events, None for no such."""
        self.verbose = verbose
        self.seed = secrets.randbits(62) if seed is None else whole("seed", seed, 0, 2**63 - 1)
        self._worlds = worlds
        self._trainer = self._make_trainer(worlds)

    def _make_trainer(self, worlds: Worlds) -> Trainer:
        config = TrainerConfig()
        config.seed = self.seed
        if self._num_threads is not None:
            config.num_threads = self._num_threads
        try:
            for name, value in self._settings.items():
                override(config, name, value)
            config.validate()
            return Trainer(worlds.batch, None, config)
        except ValueError as error:
            if not str(error).startswith(_OF_SETTINGS):  # of the environment, whose first reset this was
                raise
            raise ValueError(_with_names_of_arguments(str(error))) from None

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
        return self._worlds.has_goals

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
        total_timesteps: float,
        callback: Callback | None = None,
        progress_bar: bool = False,
        reset_num_timesteps: bool = False,
        tb_log_name: str | None = None,
        log_interval: int | None = None,
    ) -> _M:
        """Trains for `total_timesteps` more steps of all worlds together, rounded up to whole steps of every world.

        callback: called with the model after each step of the worlds; False ends the training.
        reset_num_timesteps: must be False once there were steps, which are counted on, as schedules are.
        tb_log_name: of this training in the folder `tensorboard_log`; None is the algorithm's.
        log_interval: taken for programs that give it; lines and events come every few seconds, by the clock.

        Ctrl-C ends it after the present step, and the model can be saved. Raises RuntimeError if networks diverge.
        """
        del log_interval
        if reset_num_timesteps and self.num_timesteps > 0:
            raise ValueError("reset_num_timesteps is True: steps are always counted on; make a new model instead")
        if callback is not None and not callable(callback):
            raise TypeError(f"callback is a {type(callback).__name__}, expected a function that takes the model")
        left = math.ceil(whole("total_timesteps", total_timesteps, 0, 2**62) / self.n_envs)
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
        and `episode_start` are of policies with a memory, which these are not. Raises ValueError on a wrong shape and
        on numbers that are not finite.
        """
        if isinstance(observation, tuple) and observation and isinstance(observation[-1], Mapping):
            raise ValueError(
                f"the observation is a tuple of {len(observation)}: reset returns (observation, info), step "
                "(observation, reward, terminated, truncated, info), and predict takes the observation alone"
            )
        observations, several = self._worlds.observation.unbatch(observation)
        parts = self._worlds.observation.rows(observations)
        for name, part in zip(("observation", "achieved_goal", "desired_goal"), parts, strict=True):
            if not np.isfinite(part).all():
                raise ValueError(f"the {name} holds {part[~np.isfinite(part)][0]}, expected finite numbers")
        rows = self._trainer.predict(*parts, draw=not deterministic)
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
        device: Any = "auto",
    ) -> _M:
        """A model that `save` wrote. `env`: None makes the one that it was trained on, by its id. A schedule is not
        saved: `learning_rate` is the number with which training began, until it is set. `device`: "auto" or "cpu".

        Raises FileNotFoundError, or ValueError if the file is damaged, of another algorithm, or does not fit `env`.
        """
        check_others(cls, {"device": device})
        path = _zip_path(path)
        about, checkpoint = _read(path)
        if about["algorithm"] != cls.__name__:
            raise ValueError(f"{path} holds a {about['algorithm']}, not a {cls.__name__}: load it by that")
        model = cls.__new__(cls)
        Model.__init__(
            model,
            _worlds_of_saved(path, about, env, num_threads),
            about["settings"],
            num_threads,
            about["seed"],
            verbose,
            about["settings"]["actor_learning_rate"],
            tensorboard_log,
        )
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / path.name
            file.write_bytes(checkpoint)
            _load(model._trainer, file, f"{path} does not fit {model._worlds.name}")
        return model

    def set_env(self, env: AnyEnv) -> None:
        """From now on trains on `env`, which has as many worlds as the last one, its id, spaces and length of episodes.
        Raises ValueError if it does not, and changes nothing."""
        worlds = make_worlds(env, self.n_envs, self._num_threads, self.n_envs)
        trainer = self._make_trainer(worlds)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "checkpoint"
            self._trainer.save(file, True)
            _load(trainer, file, f"the model, of {self._worlds.name}, does not fit {worlds.name}")
        self._worlds, self._trainer = worlds, trainer

    if not TYPE_CHECKING:  # which would take every name for one that is there

        def __getattr__(self, name: str) -> Any:
            instead = f": {METHODS[name]}" if name in METHODS else ""
            raise AttributeError(f"{type(self).__name__} has no {name}{instead}")


def _load(trainer: Trainer, file: Path, misfit: str) -> None:
    """Raises ValueError, which begins with `misfit`."""
    try:
        trainer.load(file)
    except RuntimeError as error:
        reason = str(error).removeprefix(f"cannot load checkpoint {file}: ")
        raise ValueError(f"{misfit}: {reason}") from None


def _worlds_of_saved(path: Path, about: dict[str, Any], env: AnyEnv | None, num_threads: int | None) -> Worlds:
    """Those that a saved model is given, or was trained on. Raises ValueError if it must be given some."""
    count = about["n_envs"]
    if env is not None:
        return make_worlds(env, count, num_threads, count)
    name = about["environment"]
    try:
        return make_worlds(name, count, num_threads, count)
    except gymnasium.error.Error as error:
        raise ValueError(f"{path} was trained on {name}, which Gymnasium does not know: give it as env") from error


def _plain(value: Any) -> Any:
    """Numbers of numpy as Python's, which a saved model can hold."""
    return value.item() if isinstance(value, np.generic) else value


def _with_names_of_arguments(text: str) -> str:
    """What the trainer says of its settings, with the arguments that set them."""
    for prefix in _OF_SETTINGS:
        text = text.removeprefix(prefix)
    return re.sub(r"\w+", lambda word: _ARGUMENTS.get(word[0], word[0]), text)


def _zip_path(path: str | Path) -> Path:
    path = Path(path)
    if path.name in ("", ".."):
        raise ValueError(f"the path of the model is {str(path)!r}, a folder; name a file, for example 'model'")
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
