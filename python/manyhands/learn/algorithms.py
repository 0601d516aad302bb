"""PPO, SAC, TQC, TD3 and DDPG, by the arguments and defaults of Stable-Baselines3.

What differs: observations are always normalised by their running mean and deviation, PPO's rewards by the deviation of
the return, and in goal environments hindsight replay is on (`hindsight_fraction`).
"""

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from manyhands.arguments import whole
from manyhands.learn.course import Schedule
from manyhands.learn.model import Model
from manyhands.learn.sb3_arguments import check_others, deviation, hindsight, named_arguments, updates_per_step
from manyhands.learn.worlds import AnyEnv, Worlds, make_worlds
from manyhands.training.memory import require_replay, require_rollout

PolicyArguments = Mapping[str, Any] | None

_PPO_WORLDS, _OFF_POLICY_WORLDS = 64, 8  # where they are stepped in C++ and nothing is said
_ROLLOUT = 2048  # transitions between PPO's updates, if nothing is said
_GOAL_TEMPERATURE = 0.1  # of SAC at first, where a step costs 1 and nothing else counts: entropy must not outweigh that


def network(
    policy: str, policy_kwargs: PolicyArguments, layers: list[int], activation: str, **more: str
) -> dict[str, Any]:
    """The settings of a network. `more`: what else policy_kwargs may have, and the settings that it sets.

    Raises ValueError on a policy or a shape that there is none of.
    """
    if policy not in ("MlpPolicy", "MultiInputPolicy"):
        raise ValueError(f"policy is {policy!r}, expected 'MlpPolicy' or 'MultiInputPolicy', which here are the same")
    given = named_arguments("policy_kwargs", policy_kwargs)
    settings = {setting: given.pop(name) for name, setting in more.items() if name in given}
    shape = given.pop("net_arch", layers)
    if isinstance(shape, Mapping):
        shapes = list(shape.values())
        if not shapes or any(one != shapes[0] for one in shapes):
            raise ValueError(f"net_arch is {shape!r}, but policy and critics have layers of the same sizes here")
        shape = shapes[0]
    if not isinstance(shape, list | tuple) or not shape or not all(isinstance(n, int | np.integer) for n in shape):
        raise ValueError(f"net_arch is {shape!r}, expected the units of each layer, for example [256, 256]")
    chosen = given.pop("activation_fn", activation)
    name = (chosen if isinstance(chosen, str) else getattr(chosen, "__name__", str(chosen))).lower()
    if name not in ("relu", "tanh"):
        raise ValueError(f"activation_fn is {chosen!r}, expected 'relu' or 'tanh'")
    if given:
        known = ", ".join(map(repr, ["net_arch", "activation_fn", *more]))
        raise ValueError(f"policy_kwargs has no {', '.join(map(repr, given))}, only {known}")
    return {"hidden_layers": [int(units) for units in shape], "activation": name, **settings}


def _number(name: str, value: Any) -> float:
    if callable(value):
        raise TypeError(f"{name} is a schedule; give a number")
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is {value!r}, expected a number") from error


def _off_policy(
    worlds: Worlds,
    gradient_steps: int,
    train_freq: int | tuple[int, str],
    buffer_size: int,
    learning_starts: int,
    batch_size: int,
    tau: float,
    gamma: float,
    n_steps: int,
    hindsight_fraction: float,
    replay_buffer_class: Any,
    replay_buffer_kwargs: Mapping[str, Any] | None,
    replay_folder: str | Path,
) -> dict[str, Any]:
    """Settings that off-policy algorithms share."""
    updates = updates_per_step(whole("gradient_steps", gradient_steps, -1), train_freq)
    share = hindsight(replay_buffer_class, replay_buffer_kwargs, hindsight_fraction, worlds.name, worlds.has_goals)
    spec = worlds.batch.spec
    capacity = max(whole("buffer_size", buffer_size, 1), spec.max_episode_steps)  # the replay keeps episodes whole
    if not replay_folder:
        require_replay("buffer_size", capacity, spec, "; a file holds more: give replay_folder")
    return {
        "replay_capacity": capacity,
        "warmup_transitions": max(whole("learning_starts", learning_starts, 0), 1),
        "batch_size": batch_size,
        "target_rate": tau,
        "gamma": gamma,
        "updates_per_iteration": worlds.batch.num_envs if updates == -1 else updates,
        "return_steps": n_steps,
        "hindsight_fraction": share,
        "replay_folder": os.fspath(replay_folder),
        "random_action_rate": 0.0,
    }


class PPO(Model):
    """Proximal policy optimisation (Schulman et al., 2017), for actions in a box and for choices."""

    def __init__(
        self,
        policy: str,
        env: AnyEnv,
        learning_rate: float | Schedule = 3e-4,
        n_steps: int | None = None,
        batch_size: int = 64,
        n_epochs: int = 10,
        gamma: float = 0.99,
        gae_lambda: float = 0.95,
        clip_range: float = 0.2,
        *,
        ent_coef: float = 0.0,
        vf_coef: float = 0.5,
        max_grad_norm: float = 0.5,
        scale_rewards: bool = True,
        policy_kwargs: PolicyArguments = None,
        n_envs: int | None = None,
        num_threads: int | None = None,
        seed: int | None = 0,
        tensorboard_log: str | Path | None = None,
        verbose: int = 0,
        **others: Any,
    ) -> None:
        """n_steps: of each world between updates; None makes 2048 transitions of all worlds together.

        n_envs: worlds; None is one, or 64 where they run in C++. seed: None draws one. others: arguments that
        Stable-Baselines3 has beside these, where they ask for what is done anyway.
        """
        check_others(type(self), others)
        worlds = make_worlds(env, n_envs, num_threads, _PPO_WORLDS)
        if n_steps is None:
            n_steps = max(_ROLLOUT // worlds.batch.num_envs, 1)
        n_steps = whole("n_steps", n_steps, 1)
        require_rollout("n_steps", n_steps, worlds.batch.spec, worlds.batch.num_envs)
        settings = {
            "algorithm": "PPO",
            "rollout_steps": n_steps,
            "batch_size": batch_size,
            "epochs": n_epochs,
            "gamma": gamma,
            "gae_lambda": gae_lambda,
            "clip_range": _number("clip_range", clip_range),
            "entropy_weight": ent_coef,
            "value_weight": vf_coef,
            "max_gradient_norm": max_grad_norm,
            "scale_rewards": scale_rewards,
            **network(policy, policy_kwargs, [64, 64], "tanh", log_std_init="initial_std"),
        }
        if policy_kwargs and "log_std_init" in policy_kwargs:
            settings["initial_std"] = math.exp(_number("log_std_init", settings["initial_std"]))
        super().__init__(worlds, settings, num_threads, seed, verbose, learning_rate, tensorboard_log)


class SAC(Model):
    """Soft actor-critic (Haarnoja et al., 2018)."""

    _POLICY_KWARGS: ClassVar = {"n_critics": "num_critics"}

    def __init__(
        self,
        policy: str,
        env: AnyEnv,
        learning_rate: float | Schedule = 3e-4,
        buffer_size: int = 1_000_000,
        learning_starts: int = 100,
        batch_size: int = 256,
        tau: float = 0.005,
        gamma: float = 0.99,
        train_freq: int | tuple[int, str] = 1,
        gradient_steps: int = 1,
        *,
        ent_coef: float | str = "auto",
        target_entropy: float | str = "auto",
        n_steps: int = 1,
        hindsight_fraction: float = 0.8,
        replay_buffer_class: Any = None,
        replay_buffer_kwargs: Mapping[str, Any] | None = None,
        replay_folder: str | Path = "",
        policy_kwargs: PolicyArguments = None,
        n_envs: int | None = None,
        num_threads: int | None = None,
        seed: int | None = 0,
        tensorboard_log: str | Path | None = None,
        verbose: int = 0,
        **more: Any,
    ) -> None:
        """ent_coef: the weight of the entropy; "auto" learns it, from 1 on or, where there are goals, 0.1; "auto_0.5"
        from 0.5 on.

        gradient_steps: after each step of all worlds, -1: as many as there are worlds. n_steps: rewards that are summed
        before the critics tell the rest. hindsight_fraction: of a mini-batch gets a goal that was reached later, where
        there are goals. replay_folder: where the replay lies in a file rather than in memory, unless it is empty.
        n_envs: worlds; None is one, or 8 where they run in C++. seed: None draws one. more: arguments that
        Stable-Baselines3 has beside these, where they ask for what is done anyway.
        """
        own = self._own_settings(**more)
        worlds = make_worlds(env, n_envs, num_threads, _OFF_POLICY_WORLDS)
        shared = _off_policy(
            worlds,
            gradient_steps,
            train_freq,
            buffer_size,
            learning_starts,
            batch_size,
            tau,
            gamma,
            n_steps,
            hindsight_fraction,
            replay_buffer_class,
            replay_buffer_kwargs,
            replay_folder,
        )
        settings = {
            "algorithm": "SAC",
            "num_critics": 2,
            "exploration_noise": 0.0,
            **_temperature(ent_coef, _GOAL_TEMPERATURE if worlds.has_goals else 1.0),
            "target_entropy": _target_entropy(target_entropy),
            **shared,
            **own,
            **network(policy, policy_kwargs, [256, 256], "relu", **self._POLICY_KWARGS),
        }
        super().__init__(worlds, settings, num_threads, seed, verbose, learning_rate, tensorboard_log)

    def _own_settings(self, **more: Any) -> dict[str, Any]:
        """Settings of a kin of SAC. Raises TypeError or ValueError on arguments that are not taken."""
        check_others(type(self), more)
        return {}


def _target_entropy(target_entropy: float | str) -> float:
    try:
        return 0.0 if target_entropy == "auto" else float(target_entropy)
    except (TypeError, ValueError) as error:
        raise ValueError(f"target_entropy is {target_entropy!r}, expected a number or 'auto'") from error


def _temperature(ent_coef: float | str, usual: float) -> dict[str, Any]:
    """usual: where an entropy weight that is learned begins."""
    if not isinstance(ent_coef, str):
        return {"temperature": _number("ent_coef", ent_coef), "learned_temperature": False}
    first = ent_coef.removeprefix("auto").removeprefix("_")
    try:
        return {"temperature": float(first) if first else usual, "learned_temperature": True}
    except ValueError as error:
        raise ValueError(f"ent_coef is {ent_coef!r}, expected a number, 'auto' or for example 'auto_0.1'") from error


class TQC(SAC):
    """SAC whose critics give quantiles, of which the largest are left out (Kuznetsov et al., 2020). Beside SAC's
    arguments: top_quantiles_to_drop_per_net, n_quantiles, n_critics."""

    _POLICY_KWARGS: ClassVar = {"n_critics": "num_critics", "n_quantiles": "num_quantiles"}

    def _own_settings(
        self, top_quantiles_to_drop_per_net: int = 2, n_quantiles: int = 25, n_critics: int = 2, **more: Any
    ) -> dict[str, Any]:
        return super()._own_settings(**more) | {
            "num_critics": n_critics,
            "num_quantiles": n_quantiles,
            "dropped_quantiles": top_quantiles_to_drop_per_net,
        }


class TD3(Model):
    """Twin delayed deep deterministic policy gradient (Fujimoto et al., 2018)."""

    def __init__(
        self,
        policy: str,
        env: AnyEnv,
        learning_rate: float | Schedule = 1e-3,
        buffer_size: int = 1_000_000,
        learning_starts: int = 100,
        batch_size: int = 256,
        tau: float = 0.005,
        gamma: float = 0.99,
        train_freq: int | tuple[int, str] = 1,
        gradient_steps: int = 1,
        action_noise: Any = 0.1,
        policy_delay: int = 2,
        target_policy_noise: float = 0.2,
        target_noise_clip: float = 0.5,
        *,
        n_critics: int = 2,
        n_steps: int = 1,
        hindsight_fraction: float = 0.8,
        replay_buffer_class: Any = None,
        replay_buffer_kwargs: Mapping[str, Any] | None = None,
        replay_folder: str | Path = "",
        policy_kwargs: PolicyArguments = None,
        n_envs: int | None = None,
        num_threads: int | None = None,
        seed: int | None = 0,
        tensorboard_log: str | Path | None = None,
        verbose: int = 0,
        **others: Any,
    ) -> None:
        """action_noise: the standard deviation of normal noise on actions of [-1, 1], or a NormalActionNoise.

        Others as SAC's.
        """
        check_others(type(self), others)
        worlds = make_worlds(env, n_envs, num_threads, _OFF_POLICY_WORLDS)
        shared = _off_policy(
            worlds,
            gradient_steps,
            train_freq,
            buffer_size,
            learning_starts,
            batch_size,
            tau,
            gamma,
            n_steps,
            hindsight_fraction,
            replay_buffer_class,
            replay_buffer_kwargs,
            replay_folder,
        )
        settings = {
            "algorithm": "TD3",
            "num_critics": n_critics,
            "exploration_noise": deviation(action_noise),
            "policy_delay": policy_delay,
            "target_noise": target_policy_noise,
            "target_noise_clip": target_noise_clip,
            **shared,
            **network(policy, policy_kwargs, [400, 300], "relu", n_critics="num_critics"),
        }
        super().__init__(worlds, settings, num_threads, seed, verbose, learning_rate, tensorboard_log)


class DDPG(TD3):
    """Deep deterministic policy gradient (Lillicrap et al., 2016): TD3 without its three additions."""

    def __init__(self, policy: str, env: AnyEnv, learning_rate: float | Schedule = 1e-3, **more: Any) -> None:
        """Arguments as TD3's, but for those of its additions."""
        plain = {"policy_delay": 1, "target_policy_noise": 0.0, "n_critics": 1}
        for name in plain.keys() & more.keys():
            raise TypeError(f"DDPG has no {name}; TD3 has")
        super().__init__(policy, env, learning_rate, **plain, **more)
