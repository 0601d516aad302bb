"""What is known of a trained policy: how well it does, and where it comes from."""

from dataclasses import dataclass, fields
from pathlib import Path

from manyhands.files import write_text
from manyhands.simple_yaml import read_yaml


@dataclass(frozen=True)
class Card:
    """Success is that at the end of fresh episodes of the plain task, without exploration."""

    environment: str
    file: str
    """That holds the weights, beside the card. Environments in which training gives the same weights share one."""
    success: float
    """With the weights as they are in the file."""
    success_float32: float
    """Of the same episodes, with the weights as they were trained."""
    episodes: int
    first_seed: int
    """Of the episodes; the others count up."""
    mean_length: float
    """Environment steps of an episode."""
    weights: str
    """float16 or float32, as the file holds them; the networks compute in float32."""
    recipe: str
    """By which it was trained: a file of `manyhands/training/recipes`."""
    beyond: str
    """What that uses beyond the task's own reward, by name."""
    seed: int
    seeds: int
    """How many were trained; this one did best in other episodes than these."""
    training_seconds: float
    """On one thread, periodic evaluations included."""
    env_steps: int
    version: str
    """Of manyhands, by which it was trained."""

    def __str__(self) -> str:
        return "".join(f"{field.name}: {getattr(self, field.name)}\n" for field in fields(self))

    def save(self, path: Path) -> None:
        """Writes a file of YAML."""
        write_text(path, str(self))


def read_card(path: Path) -> Card:
    """The card in a file. Raises ValueError that names what is wrong, OSError if it cannot be read."""
    entries = {name: entry.value for name, entry in read_yaml(path).items()}
    known = {field.name: field.type for field in fields(Card)}
    if entries.keys() != known.keys():
        differ = ", ".join(sorted(entries.keys() ^ known.keys()))
        raise ValueError(f"{path} is no card of a policy: {differ} are there or missing")
    try:
        return Card(**{name: known[name](value) for name, value in entries.items()})  # pyright: ignore[reportCallIssue]
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path} is no card of a policy: {error}") from error
