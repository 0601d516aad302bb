"""Substeps per second of a Panda in contact, ours in lanes beside MuJoCo's and PyBullet's, in turns."""

import json
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from benchmarks.contact_peers import Peer, Scene, mujoco_peer, pybullet_peer, pybullet_robot
from benchmarks.rows import Contender, Row, measure_in_turns
from benchmarks.targets import set_verdict

UNIT = "substeps/s"
CHECKED, BESIDE_PEERS = "contact step, ", "contact beside peers, "
TIMES_MUJOCO = 25.0
TIMES_PYBULLET = 80.0
PEERS: tuple[tuple[str, Callable[[Scene], Peer], float], ...] = (
    ("MuJoCo {}", mujoco_peer, TIMES_MUJOCO),
    ("MuJoCo {} (PyBullet's arm)", lambda scene: mujoco_peer(scene, pybullet_robot), TIMES_MUJOCO),
    ("PyBullet {}", pybullet_peer, TIMES_PYBULLET),
)


class Program:
    """The C++ program, which steps its scenes when told to and says what that cost its thread."""

    def __init__(self, path: Path) -> None:
        self._process = subprocess.Popen([str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.scenes: list[Scene] = []
        self.seconds = 0.0  # of its thread, in all steps so far
        while "worlds" not in (line := json.loads(self._answer())):
            self.scenes.append(Scene(**line))
        self.worlds: int = line["worlds"]
        self.number_type: str = line["number_type"]

    def step(self, scene: int, steps: int) -> None:
        """All worlds of a scene, so many substeps."""
        assert self._process.stdin is not None
        print(scene, steps, file=self._process.stdin, flush=True)
        self.seconds += float(self._answer())

    def close(self) -> None:
        """Ends the program."""
        self._process.communicate()

    def _answer(self) -> str:
        assert self._process.stdout is not None
        answer = self._process.stdout.readline()
        if not answer:
            raise RuntimeError(f"the program that steps scenes in contact ended with status {self._process.wait()}")
        return answer


def run_contact(folder: Path, rounds: int, seconds: float, checked: Sequence[Row] = ()) -> list[Row]:
    """All scenes, each with ours and the peers in turns of about `seconds`; processor time of each one's own thread.

    `checked` holds the rows of `contact_stages`: where a scene's is wrong, its speed beside the peers is none either.
    """
    path = folder / "contact_server"
    if not path.is_file():
        return [Row("contact beside peers", "manyhands", "", 1, None, "", note=f"not built: {path}; run `make bench`")]
    program = Program(path)
    rows: list[Row] = []
    for index, scene in enumerate(program.scenes):
        rows += run_scene(program, index, scene, rounds, seconds)
    program.close()
    wrong = {(row.benchmark.removeprefix(CHECKED), row.number_type): row.note for row in checked if row.wrong}
    for row in rows:
        why = wrong.get((row.benchmark.removeprefix(BESIDE_PEERS), row.number_type))
        if row.engine == "manyhands" and why is not None:
            row.refuse(why.removeprefix("REFUSED: "))
            row.verdict = ""
    return rows


def run_scene(program: Program, index: int, scene: Scene, rounds: int, seconds: float) -> list[Row]:
    """The peers' rows of one scene, and ours once for each peer that it is compared with."""
    name = BESIDE_PEERS + scene.name
    ours = Contender(
        Row(name, "manyhands", program.number_type, 1, None, UNIT),
        lambda steps: program.step(index, steps),
        units=program.worlds,
        clock=lambda: program.seconds,
    )
    rows: list[Row] = []
    measured: list[tuple[Contender, Peer, float]] = []
    for label, make, times in PEERS:
        row = Row(name, label.format("").strip(), "double", 1, None, UNIT)
        rows.append(row)
        try:
            peer = make(scene)
        except ImportError as error:
            row.note = f"not installed: {error.name}"
            continue
        row.engine = label.format(peer.version)
        measured.append((Contender(row, peer.run, clock=peer.clock), peer, times))
    measure_in_turns([ours, *(contender for contender, _, _ in measured)], rounds, seconds)
    for contender, peer, times in measured:
        contender.row.note = peer.note(scene)
        if ours.row.value and contender.row.value:
            ratio = ours.row.value / contender.row.value
            row = replace(ours.row, ratio=ratio, ratio_to=contender.row.engine, target=f">= {times:g}x")
            set_verdict(row, ratio, ratio >= times)
            rows.append(row)
    return rows if measured else [*rows, ours.row]
