"""Shows how a sweep goes on: a table on a terminal, a line for each run that ends elsewhere."""

from collections import Counter
from collections.abc import Sequence
from types import TracebackType

from rich import box
from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from manyhands.training.sweep import SweepRun

_STYLES = {"training": "cyan", "done": "green", "failed": "red", "stopped": "yellow", "waiting": "dim"}
_LINES_AROUND = 8  # of the terminal, that are not runs


class SweepProgress:
    """Context manager; `update` after each look at the runs."""

    def __init__(self, console: Console, runs: Sequence[SweepRun]) -> None:
        self._console = console
        self._runs = runs
        self._told = {run.name for run in runs if run.state == "done"}
        self._live = Live(console=console, auto_refresh=False) if console.is_terminal else None

    def update(self) -> None:
        """Shows where the runs stand."""
        if self._live is not None:
            self._live.update(self._table(), refresh=True)
            return
        for run in self._runs:
            if run.state in ("done", "failed", "stopped") and run.name not in self._told:
                self._told.add(run.name)
                text = f"{run.name}: {run.state}{': ' * bool(run.error)}{run.error}"
                self._console.print(text, highlight=False, markup=False, soft_wrap=True)

    def _table(self) -> Table:
        states = Counter(run.state for run in self._runs)
        title = ", ".join(f"{states[state]} {state}" for state in _STYLES if states[state])
        table = Table("run", "state", title=f"{len(self._runs)} runs: {title}", title_justify="left", box=box.SIMPLE)
        for name in ("steps", "success", "seconds"):
            table.add_column(name, justify="right")
        shown: Sequence[SweepRun] = self._runs
        if len(shown) > self._console.height - _LINES_AROUND:
            shown = [run for run in shown if run.state in ("training", "failed")]
        for run in shown:
            table.add_row(run.name, Text(run.state, _STYLES[run.state]), *figures(run))
        return table

    def __enter__(self) -> "SweepProgress":
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._live is not None:
            self._live.stop()


def figures(run: SweepRun) -> tuple[str, str, str]:
    """Steps and, while it trains, their share of the most; success; seconds."""
    if run.row is None:
        return "", "", ""
    share = "" if run.state == "done" else f" ({run.row.env_steps / run.settings.max_env_steps:.0%})"
    success = f"{run.row.evaluation_success_rate:.1%}" if run.row.evaluations else ""
    return f"{run.row.env_steps:,}{share}", success, f"{run.row.seconds:.1f}"
