"""Makes the environments known to gymnasium."""

import gymnasium

_LENGTHS = {
    "DrawerOpen": 100,
    "KukaReach": 100,
    "QuadrotorHover": 250,
    "QuadrotorTeam": 250,
    "QuadrupedWalk": 500,
}
_MAKERS = {"QuadrotorHover": "Quadrotors", "QuadrotorTeam": "Quadrotors"}
_OPTIONS = {"QuadrotorTeam": {"drones": 3}}


def register() -> None:
    """Registers "KukaReach-v0" and the like."""
    for name, length in _LENGTHS.items():
        gymnasium.register(
            id=f"{name}-v0",
            entry_point=f"manyhands.world_envs:{_MAKERS.get(name, name)}",
            max_episode_steps=length,
            kwargs=_OPTIONS.get(name, {}),
        )
