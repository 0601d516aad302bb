"""`python -m benchmarks.bullet COMMAND`: each command is a module of its own."""

import sys
from importlib import import_module

COMMANDS = {
    "speed": "times frequent calls on both sides",
    "examples": "runs the example programs and environments of the wheel on both sides",
    "calls": "writes docs/pybullet_coverage.md: what is compared with the real PyBullet, call by call",
    "files": "writes docs/pybullet_files.md: every file of pybullet_data beside the real PyBullet",
}


def main() -> int:
    """Runs the command; returns the exit status."""
    if len(sys.argv) < 2 or sys.argv[1] not in COMMANDS:
        print(
            "usage: python -m benchmarks.bullet COMMAND\n",
            *(f"  {n}: {what}" for n, what in COMMANDS.items()),
            sep="\n",
        )
        return 2
    return import_module(f"benchmarks.bullet.{sys.argv[1]}").main(sys.argv[2:])


if __name__ == "__main__":
    sys.exit(main())
