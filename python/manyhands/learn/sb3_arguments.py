"""Arguments of Stable-Baselines3's constructors that there are none of here: taken where they ask for what is done
anyway, and else refused in a line that says what to write instead."""

import difflib
import inspect
from collections.abc import Mapping
from typing import Any

import numpy as np

_ANY_ALGORITHM = {
    "device": (("auto", "cpu"), "networks run on the processor; leave it out"),
    "stats_window_size": ((100,), "means are of the last 100 episodes; leave it out"),
    "use_sde": ((False,), "noise does not depend on the state; leave it out"),
    "sde_sample_freq": ((-1,), "noise does not depend on the state; leave it out"),
    "_init_setup_model": ((True,), "a model is always set up; leave it out"),
}
_PPO = {
    "clip_range_vf": ((None,), "values are not clipped; leave it out"),
    "normalize_advantage": ((True,), "advantages are always normalised; leave it out"),
    "target_kl": ((None,), "updates are not cut short; set n_epochs or learning_rate lower instead"),
    "rollout_buffer_class": ((None,), "there is one buffer for all; leave it out"),
    "rollout_buffer_kwargs": ((None, {}), "there is one buffer for all; leave it out"),
}
_OFF_POLICY = {
    "action_noise": ((None,), "actions are drawn from the policy, which sets its own noise; leave it out"),
    "target_update_interval": ((1,), "targets follow each gradient step; set tau lower instead"),
    "optimize_memory_usage": ((False,), "states are stored in full; replay_folder keeps the replay in a file"),
    "use_sde_at_warmup": ((False,), "noise does not depend on the state; leave it out"),
}


def named_arguments(name: str, value: Any) -> dict[str, Any]:
    """What a dict of arguments holds; None holds nothing. Raises TypeError on anything else."""
    if value is not None and not isinstance(value, Mapping):
        raise TypeError(f"{name} is {value!r}, expected a dict")
    return dict(value or {})


def check_others(algorithm: type, others: Mapping[str, Any]) -> None:
    """Raises TypeError on what is no argument there either, ValueError on a value that is not done here."""
    known = _ANY_ALGORITHM | (_PPO if algorithm.__name__ == "PPO" else _OFF_POLICY)
    for name, value in others.items():
        if name not in known:
            own = [parameter for parameter in inspect.signature(algorithm).parameters if parameter != "others"]
            near = difflib.get_close_matches(name, own, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise TypeError(f"{algorithm.__name__} has no argument {name}{hint}")
        taken, instead = known[name]
        given = str(value) if name == "device" else value
        if not any(given is one or given == one for one in taken):
            expected = " or ".join(map(repr, taken))
            raise ValueError(f"{name} is {value!r}, expected {expected}: {instead}")


def updates_per_step(gradient_steps: int, train_freq: int | tuple[int, str]) -> int:
    """Gradient steps after each step of all worlds; -1: as many as there are worlds. Raises ValueError."""
    steps, unit = train_freq if isinstance(train_freq, tuple) and len(train_freq) == 2 else (train_freq, "step")
    if gradient_steps == -1:
        return -1
    if unit == "step" and isinstance(steps, int) and steps > 0 and gradient_steps % steps == 0:
        return gradient_steps // steps
    raise ValueError(
        f"train_freq is {train_freq!r} and gradient_steps {gradient_steps}: training follows every step here, so "
        "gradient_steps must be -1, which is as many as transitions, or a multiple of a train_freq in steps"
    )


def hindsight(
    replay_buffer_class: Any,
    replay_buffer_kwargs: Mapping[str, Any] | None,
    hindsight_fraction: float,
    env: str,
    has_goals: bool,
) -> float:
    """The share of transitions with a new goal: none without goals, else what it is here, unless a replay buffer says
    otherwise.

    Raises ValueError on a buffer, or an argument of one, that there is none of or that needs goals.
    """
    name = getattr(replay_buffer_class, "__name__", replay_buffer_class)
    if name not in (None, "HerReplayBuffer", "ReplayBuffer", "DictReplayBuffer"):
        raise ValueError(f"replay_buffer_class is {name!r}, expected 'HerReplayBuffer', 'ReplayBuffer' or None")
    if name == "HerReplayBuffer" and not has_goals:
        raise ValueError(f"replay_buffer_class is {name!r}, but {env} has no goals: leave it out")
    given = named_arguments("replay_buffer_kwargs", replay_buffer_kwargs)
    given.pop("copy_info_dict", None)  # infos are not stored
    strategy = given.pop("goal_selection_strategy", "future")
    if str(getattr(strategy, "name", strategy)).lower() != "future":
        raise ValueError(f"goal_selection_strategy is {strategy!r}, expected 'future': goals are reached later on")
    if "n_sampled_goal" in given:
        goals = given.pop("n_sampled_goal")
        if not isinstance(goals, int | np.integer) or goals < 0:
            raise ValueError(f"n_sampled_goal is {goals!r}, expected a whole number of 0 or more")
        hindsight_fraction = 1 - 1 / (goals + 1)
    if given:
        names = ", ".join(map(repr, given))
        raise ValueError(f"replay_buffer_kwargs has no {names}, only 'n_sampled_goal' and 'goal_selection_strategy'")
    return hindsight_fraction if has_goals and name not in ("ReplayBuffer", "DictReplayBuffer") else 0.0


def deviation(action_noise: Any) -> float:
    """The standard deviation of noise on actions, of a number, of a NormalActionNoise, or of None, which is no noise.

    Raises ValueError on other noise.
    """
    if action_noise is None:
        return 0.0
    if type(action_noise).__name__ == "NormalActionNoise":
        mean, sigma = np.unique(action_noise._mu), np.unique(action_noise._sigma)
        if mean.tolist() == [0.0] and len(sigma) == 1:
            return float(sigma[0])
        raise ValueError(f"action_noise is {action_noise}, expected a mean of 0 and one deviation for all actions")
    if isinstance(action_noise, int | float | np.number):
        return float(action_noise)
    raise ValueError(
        f"action_noise is {action_noise!r}, expected the standard deviation of normal noise, in [-1, 1], or None"
    )


METHODS = {
    "get_env": "worlds are the trainer's own: act in an environment of yours, as gymnasium.make gives it",
    "get_vec_normalize_env": "observations are always normalised, and predict takes them as they are",
    "get_parameters": "`policy.layers` holds the weights",
    "set_parameters": "`load` reads what `save` wrote",
    "set_logger": "give `tensorboard_log` to the constructor",
    "logger": "`metrics` says where training stands",
    "save_replay_buffer": "write `save(path, include_replay=True)`",
    "load_replay_buffer": "`load` reads the replay that `save(path, include_replay=True)` wrote",
    "replay_buffer": "the replay lies in C++; `save(path, include_replay=True)` writes it",
    "set_random_seed": "give `seed` to the constructor",
    "collect_rollouts": "`learn` collects and trains",
    "train": "`learn` collects and trains",
}
"""What models have there and not here, and what to do instead."""

_CALLBACKS = "a callback is a function that takes the model: learn(steps, callback=function)"
_CHOICES = "PPO learns choices"
_MANY = "give the environment's id and n_envs to the algorithm"
NAMES = {
    "A2C": "use PPO",
    "BaseCallback": _CALLBACKS,
    "CheckpointCallback": _CALLBACKS,
    "DictReplayBuffer": "write replay_buffer_class='ReplayBuffer', which turns hindsight off",
    "DQN": _CHOICES,
    "DummyVecEnv": _MANY,
    "EvalCallback": _CALLBACKS,
    "HerReplayBuffer": "where there are goals it is the default; replay_buffer_class takes its name as a text",
    "NormalActionNoise": "action_noise takes the standard deviation",
    "ReplayBuffer": "write replay_buffer_class='ReplayBuffer', which turns hindsight off",
    "SubprocVecEnv": _MANY,
    "VecNormalize": "observations are always normalised, and PPO's rewards",
    "make_vec_env": _MANY,
}
"""What modules have there and `manyhands.learn` has not, and what to do instead."""
