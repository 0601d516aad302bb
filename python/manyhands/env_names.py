"""Names of environments, and what they stand for."""

import difflib
import re
from typing import Any

import gymnasium

from manyhands._core.envs import control_types, env_ids

VERSION = "-v3"  # of all ids
_ID = re.compile(r"(Panda\w+?)(Joints)?(Dense)?" + VERSION)


def versioned(name: str) -> str:
    """A name with its version: "PandaReach-v3" of "PandaReach" too. Raises TypeError on what is no name."""
    if not isinstance(name, str):
        raise TypeError(f"the environment is {name!r}, expected a name, for example 'PandaReach' or 'PandaReach-v3'")
    return name if name.endswith(VERSION) else name + VERSION


def env_id(task: str, reward_type: str, control_type: str) -> str:
    """The id of a variant, for example "PandaReachJointsDense-v3", of a task with or without its version.

    Controls that panda-gym does not have are variants of none: they get the id of "ee". Raises ValueError on an unknown
    type or a task that names one, TypeError on a task that is no name.
    """
    task = versioned(task).removesuffix(VERSION)
    if task.endswith(("Joints", "Dense")):
        raise ValueError(
            f"task is {task!r}, which names a variant: name the task alone, for example 'PandaReach', and give "
            "reward_type='dense' or control_type='joints'"
        )
    if reward_type not in ("sparse", "dense"):
        raise ValueError(f"reward_type is {reward_type!r}, expected 'sparse' or 'dense'")
    if control_type not in control_types():
        raise ValueError(f"control_type is {control_type!r}, expected one of {control_types()}")
    return f"{task}{'Joints' * (control_type == 'joints')}{'Dense' * (reward_type == 'dense')}{VERSION}"


def variant_of(name: str) -> dict[str, Any]:
    """What an id stands for, as arguments of `ArmEnv`. Raises ValueError on an id of another form."""
    match = _ID.fullmatch(name)
    if match is None:
        raise ValueError(f"{name!r} is not of the form Panda<Task>[Joints][Dense]-v3")
    task, joints, dense = match.groups()
    return {
        "task": task,
        "reward_type": "dense" if dense else "sparse",
        "control_type": "joints" if joints else "ee",
    }


def resolve_env_id(name: str) -> str:
    """The id that `name` means, with or without its version: "PandaReach" is "PandaReach-v3".

    Raises ValueError on an unknown name, with the nearest ones, TypeError on what is no name.
    """
    versioned(name)
    ids = env_ids()
    for candidate in (name, name + VERSION):
        if candidate in ids:
            return candidate
    if name in gymnasium.registry:
        raise ValueError(
            f"{name!r} is stepped in Python, and this takes the ids that manyhands envs lists; "
            f"manyhands.learn trains in any environment: learn.PPO('MlpPolicy', {name!r}).learn(100_000)"
        )
    near = difflib.get_close_matches(name, ids, cutoff=0.4)
    hint = f"did you mean {', '.join(near)}?" if near else "manyhands envs lists them"
    raise ValueError(f"there is no environment {name!r}; {hint}")
