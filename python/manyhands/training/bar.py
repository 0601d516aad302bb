"""The bar of a training on a terminal, drawn by rich."""

from typing import Any

from rich.progress import BarColumn, Progress, ProgressColumn, SpinnerColumn, Task, TextColumn
from rich.text import Text


class _Figures(ProgressColumn):
    def render(self, task: Task) -> Text:
        return Text(task.fields["figures"], no_wrap=True)


class Bar:
    """A spinner, a name, a bar and figures."""

    def __init__(self, console: Any, name: str, total: int) -> None:
        """console: rich's."""
        columns = (SpinnerColumn(), TextColumn("[bold]{task.description}"), BarColumn(12), _Figures())
        self._progress = Progress(*columns, console=console)
        self._task = self._progress.add_task(name, total=total, figures="starting")

    def show(self, completed: int, total: int, figures: str) -> None:
        """How much of the total is done, and what stands beside it."""
        self._progress.update(self._task, completed=completed, total=total, figures=figures)

    def start(self) -> None:
        self._progress.start()

    def stop(self) -> None:
        self._progress.stop()
