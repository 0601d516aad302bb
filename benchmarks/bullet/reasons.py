"""Why files of pybullet_data are not loaded as Bullet loads them."""

REASONS: dict[str, str] = {}
