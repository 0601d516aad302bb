"""What the package says, by Gymnasium's logger."""

from gymnasium import logger as _logger
from gymnasium.logger import deprecation, error, warn

DEBUG, INFO, WARN, ERROR, DISABLED = 10, 20, 30, 40, 50

__all__ = ["DEBUG", "DISABLED", "ERROR", "INFO", "WARN", "deprecation", "error", "set_level", "warn"]


def set_level(level: int) -> None:
    """What is less than this is not said: WARN from the start."""
    _logger.min_level = level


def info(message: str, *values: object) -> None:
    """Says something."""
    if _logger.min_level <= INFO:
        print(f"INFO: {message % values if values else message}")
