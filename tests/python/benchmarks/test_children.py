"""Children: what they say, and how their parent learns that they crashed or hang."""

import os
import signal
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[3]))

from benchmarks import children


def work(say: children.Say, task: str) -> None:
    say(f"{task} begins")
    if task == "crashes":
        os.kill(os.getpid(), signal.SIGSEGV)
    if task == "hangs":
        time.sleep(1000)
    say(f"{task} ends")


def test_what_is_said_before_a_crash_or_a_hang_is_kept() -> None:
    ended: dict[str, children.Ended[str]] = {}
    tasks = ["works", "crashes", "hangs"]
    patience = {"works": 100.0, "crashes": 100.0, "hangs": 5.0}
    seen: list[list[str]] = []
    children.run_all(
        tasks,
        work,
        lambda task: patience[task],
        2,
        lambda one: ended.update({one.task: one}),
        lambda at_work: seen.append(list(at_work)),
    )
    assert (ended["works"].said, ended["works"].status) == (["works begins", "works ends"], 0)
    assert (ended["crashes"].said, ended["crashes"].status) == (["crashes begins"], -signal.SIGSEGV)
    assert ended["hangs"].status is None
    assert [len(at_work) <= 2 for at_work in seen] == [True] * 3
