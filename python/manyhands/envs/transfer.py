"""What differs from episode to episode where a policy is to work on a robot: one set of ranges for all tasks."""

from manyhands.env_names import variant_of

_OF_OBJECTS = ("object_mass", "object_size", "object_friction", "table_friction", "finger_friction")

TRANSFER: dict[str, tuple[float, float] | tuple[float, float, str]] = {
    "object_mass": (0.5, 2.0, "log"),
    "object_size": (0.95, 1.05),
    "object_friction": (0.7, 1.3),
    "table_friction": (0.7, 1.3),
    "finger_friction": (0.7, 1.3),
    "joint_damping": (0.0, 2.0),
    "motor_gain": (0.75, 1.5, "log"),
    "action_latency": (0, 1),
    "action_noise": (0.0, 0.05),
    "observation_noise": (0.0, 0.002),
}
"""As `randomize` takes them. Sizes, masses, frictions and gains differ as much as in OpenAI et al., "Learning dexterous
in-hand manipulation", 2018; damping, delay and noise as much as on an arm of the Panda's kind."""


def transfer_ranges(env_id: str) -> dict[str, tuple[float, float] | tuple[float, float, str]]:
    """Those of TRANSFER that make a difference in an environment. Raises ValueError on another form of id."""
    touches_nothing = variant_of(env_id)["task"] == "PandaReach"
    return {name: given for name, given in TRANSFER.items() if not (touches_nothing and name in _OF_OBJECTS)}
