"""Where commands print: rich's console, or plain lines where rich is missing."""

from typing import Any, Protocol


class Console(Protocol):
    """What is used of rich's."""

    @property
    def is_terminal(self) -> bool: ...

    def print(
        self, *objects: Any, markup: bool | None = ..., highlight: bool | None = ..., soft_wrap: bool | None = ...
    ) -> None: ...


class PlainConsole:
    """Prints lines as they are."""

    is_terminal = False

    def print(self, *objects: Any, **_: Any) -> None:
        """rich's options are for its terminals."""
        print(*objects, flush=True)


def counted(number: int, thing: str) -> str:
    """For example "1 episode", "1,000 episodes"."""
    return f"{number:,} {thing}{'' if number == 1 else 's'}"


def clock(seconds: float) -> str:
    """For example "2:05"."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def make_console() -> Console:
    """rich's where it is installed."""
    try:
        from rich.console import Console as RichConsole
    except ModuleNotFoundError:
        return PlainConsole()
    return RichConsole()
