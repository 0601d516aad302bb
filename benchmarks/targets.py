"""What the figures ought to be, and whether they are."""

from benchmarks.rows import Row
from benchmarks.tasks import POLICIES, TASKS, WORLDS

TIMES_PANDA_GYM = {f"{task} random": 120.0 for task in TASKS} | {"Reach random": 300.0, "Stack random": 100.0}
TIMES_WITH_EXPERT = 100.0
TIMES_ONE_THREAD = 1.9
NS_PER_ARM = 100.0
FRAMES = {  # a second
    ("84 x 84 colour, depth, segmentation", 1): 1000.0,
    ("640 x 480 with shadows", 1): 40.0,
    ("128 x 128 of 256 worlds", 2): 1500.0,
}
LANES = ("lanes4", "lanes8", "lanes16")


def compare_with_peers(rows: list[Row]) -> None:
    """Fills the ratios of our dynamics to Pinocchio's, and of two threads to one."""
    tiny = {row.benchmark: row.value for row in rows if row.engine == "PyBullet TinyRenderer"}
    pinocchio = {row.benchmark: row.value for row in rows if row.engine.startswith("Pinocchio")}
    one_thread = {row.benchmark: row.value for row in rows if row.threads == 1 and row.engine == "manyhands"}
    for row in rows:
        if row.engine != "manyhands" or not row.value or row.ratio:
            continue
        peer, one = pinocchio.get(row.benchmark), one_thread.get(row.benchmark)
        if peer:
            row.ratio, row.ratio_to = peer / row.value, "Pinocchio"
        elif tiny.get(row.benchmark):
            row.ratio, row.ratio_to = row.value / (tiny[row.benchmark] or 1.0), "PyBullet"
        elif row.threads > 1 and one:
            row.ratio, row.ratio_to = row.value / one, "1 thread"


def judge(rows: list[Row]) -> None:
    """Fills target and verdict of the rows that have one."""
    names = {f"{task} {policy}, make_vec of {WORLDS}": f"{task} {policy}" for task in TASKS for policy in POLICIES}
    for row in rows:
        if row.benchmark in names:
            times = TIMES_PANDA_GYM.get(names[row.benchmark], TIMES_WITH_EXPERT)
            least = times if row.threads == 1 else TIMES_ONE_THREAD
            row.target = f">= {least:g}x {row.ratio_to or 'the peer'}"
            set_verdict(row, row.ratio, row.ratio is not None and row.ratio >= least)
        frames = FRAMES.get((row.benchmark, row.threads)) if row.engine == "manyhands" else None
        if frames:
            row.target = f">= {frames:g} frames/s"
            set_verdict(row, row.value, (row.value or 0.0) >= frames)
    for benchmark in ("RNEA", "ABA"):
        lanes = [row for row in rows if row.benchmark == benchmark and row.number_type in LANES and row.value]
        if lanes:
            best = min(lanes, key=lambda row: row.value or 0.0)
            best.target = f"<= {NS_PER_ARM:g} ns/arm"
            set_verdict(best, best.value, (best.value or 0.0) <= NS_PER_ARM)


def set_verdict(row: Row, figure: float | None, reached: bool) -> None:
    """Leaves the verdict open where there is no figure."""
    if figure is not None:
        row.verdict = "pass" if reached else "short"
