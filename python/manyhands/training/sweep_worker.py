"""One training of a sweep: `python -m manyhands.training.sweep_worker RUN_DIR`.

It goes on from the folder's checkpoint, if there is one. Its input says that the sweep lives: when that ends, the run
saves a checkpoint and ends, too.
"""

import os
import signal
import sys
import threading
import traceback
from pathlib import Path

from rich.console import Console

from manyhands.interrupts import INTERRUPTED
from manyhands.training.lock import locked
from manyhands.training.run import TrainingRun
from manyhands.training.run_folder import RunFolder
from manyhands.training.sweep import ERROR


def _end_with_the_sweep() -> None:
    os.read(0, 1)
    os.kill(os.getpid(), signal.SIGTERM)


def main(path: Path) -> int:
    """Trains and evaluates. Returns the exit code; what goes wrong is told in a line that begins with ERROR."""
    try:
        return _train(path)
    except Exception as error:
        traceback.print_exc()
        print(ERROR, " ".join(f"{error}".split()) or type(error).__name__, file=sys.stderr, flush=True)
        return 1


def _train(path: Path) -> int:
    threading.Thread(target=_end_with_the_sweep, daemon=True).start()
    folder = RunFolder(path)
    with locked(path):
        run = TrainingRun(folder.read_settings(), folder.checkpoint if folder.checkpoint.is_file() else None)
        outcome = run.train(folder, Console())
    return INTERRUPTED if outcome.evaluation is None else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
