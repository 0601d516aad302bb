"""The bar of a training on a terminal, drawn by rich."""

from collections.abc import Sequence
from typing import Any

from rich.progress import BarColumn, Progress, ProgressColumn, SpinnerColumn, Task, TextColumn
from rich.text import Text

_BAR = 12  # columns
_BESIDE = 1 + 1 + 1 + _BAR + 1  # of the terminal, beside name and figures: spinner, bar and the gaps


class _Figures(ProgressColumn):
    """The longest text that fits the terminal."""

    def __init__(self, console: Any) -> None:
        super().__init__()
        self._console = console

    def render(self, task: Task) -> Text:
        room = self._console.width - _BESIDE - len(task.description)
        texts: Sequence[str] = task.fields["figures"]
        return Text(next((text for text in texts if len(text) <= room), texts[-1]), no_wrap=True)


class Bar:
    """A spinner, a name, a bar and figures."""

    def __init__(self, console: Any, name: str, total: int) -> None:
        """console: rich's."""
        columns = (SpinnerColumn(), TextColumn("[bold]{task.description}"), BarColumn(_BAR), _Figures(console))
        self._progress = Progress(*columns, console=console)
        self._task = self._progress.add_task(name, total=total, figures=["starting"])

    def show(self, completed: int, total: int, figures: Sequence[str]) -> None:
        """How much of the total is done, and what stands beside it: the first of the texts that fits, or the last."""
        self._progress.update(self._task, completed=completed, total=total, figures=figures)

    def start(self) -> None:
        self._progress.start()

    def stop(self) -> None:
        self._progress.stop()
