"""Times ManipulaPy's functions here and there, in turns: `python -m benchmarks.beside_manipulapy --python PATH`.

PATH is the Python of an environment in which ManipulaPy is installed; both sides read the same robot file, this
project's xArm6. Each side is a process of its own that runs what it is told, so that neither disturbs the other;
processor time, the least of several rounds.
"""

import argparse
import json
import logging
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import IO, Any

OURS = "manyhands.manipulapy"
ROUNDS = 7


def functions(package: str, urdf: str) -> dict[str, tuple[Callable[[Any], object], int]]:
    """What is timed, of arguments q (6,), and how often in a round."""
    import numpy as np

    def module(name: str) -> Any:
        return import_module(f"{package}.{name}")

    arm = module("urdf_processor").URDFToSerialManipulator(urdf)
    robot, dynamics = arm.serial_manipulator, arm.dynamics
    planner = module("path_planning").TrajectoryPlanning(robot, urdf, dynamics, [(-6.0, 6.0)] * 6)
    field, rng = module("potential_field").PotentialField(), np.random.default_rng(0)
    v, a, g, none = rng.normal(size=6), rng.normal(size=6), np.array([0.0, 0.0, -9.81]), np.zeros(6)
    obstacles = rng.uniform(-1, 1, (100, 3))
    goal = np.array([0.3, -0.4, -0.9, 0.2, 0.8, 0.1])
    pose, start = robot.forward_kinematics(goal), goal + 0.1
    return {
        "forward_kinematics": (robot.forward_kinematics, 200),
        "jacobian": (robot.jacobian, 200),
        "mass_matrix": (dynamics.mass_matrix, 50),
        "inverse_dynamics": (lambda q: dynamics.inverse_dynamics(q, v, a, g, none), 5),
        "forward_dynamics": (lambda q: dynamics.forward_dynamics(q, v, a, g, none), 5),
        "iterative_inverse_kinematics": (lambda q: robot.iterative_inverse_kinematics(pose, start + 0.1 * q), 10),
        "joint_trajectory, 1000 points": (lambda q: planner.joint_trajectory(none, q, 2.0, 1000, 5), 3),
        "compute_gradient, 100 obstacles": (lambda q: field.compute_gradient(q[:3], q[3:], obstacles), 50),
    }


def work(package: str, urdf: str) -> None:
    """A side: reads names, answers with microseconds of processor time for each call."""
    import numpy as np

    logging.disable(logging.CRITICAL)
    answers, sys.stdout = sys.stdout, sys.stderr  # what a package prints is no answer
    timed, rng = functions(package, urdf), np.random.default_rng(1)
    for line in sys.stdin:
        name = json.loads(line)
        call, times = timed[name]
        states = 0.5 * rng.normal(size=(times, 6))  # never the same twice: nobody may remember
        call(states[0])
        begin = time.process_time()
        for state in states:
            call(state)
        answers.write(json.dumps((time.process_time() - begin) / times * 1e6) + "\n")
        answers.flush()


class Side:
    """A process that works for one package."""

    def __init__(self, python: str, package: str, urdf: str) -> None:
        command = [python, str(Path(__file__).resolve()), "--work", package, urdf]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)

    def time(self, name: str) -> float:
        send: IO[str] = self._process.stdin  # type: ignore[assignment]
        answers: IO[str] = self._process.stdout  # type: ignore[assignment]
        send.write(json.dumps(name) + "\n")
        send.flush()
        answer = answers.readline()
        if not answer:
            raise RuntimeError("a side has ended; what it said stands above")
        return json.loads(answer)


def main() -> int:
    """Prints a table; returns 0 where everything is at least 100 times as fast here."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", required=True, help="of an environment with ManipulaPy")
    options = parser.parse_args()
    from manyhands.manipulapy.ManipulaPy_data import get_robot_urdf

    urdf = get_robot_urdf("xarm6")
    ours, theirs = Side(sys.executable, OURS, urdf), Side(options.python, "ManipulaPy", urdf)
    slowest = float("inf")
    print("| call | here [us] | ManipulaPy [us] | |\n| --- | --- | --- | --- |")
    for name in functions(OURS, urdf):
        pairs = [(ours.time(name), theirs.time(name)) for _ in range(ROUNDS)]
        here, there = min(pair[0] for pair in pairs), min(pair[1] for pair in pairs)
        slowest = min(slowest, there / here)
        print(f"| `{name}` | {here:.3g} | {there:.4g} | x{there / here:.0f} |", flush=True)
    return 0 if slowest >= 100 else 1


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "--work":
        work(*sys.argv[2:])
    else:
        sys.exit(main())
