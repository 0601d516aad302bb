"""Pinocchio's dynamics on our Panda, called from Python: the call itself is part of its figures."""

import time
from typing import Any

import numpy as np

from benchmarks.rows import Contender, Row, measure_in_turns
from manyhands import asset_path

STATES = 64  # different ones, in a circle


def run_pinocchio(rounds: int, seconds: float) -> list[Row]:
    """Nanoseconds per arm of each algorithm; rows that say so where Pinocchio is not installed."""
    names = ("forward kinematics", "RNEA", "ABA", "CRBA")
    rows = [Row(name, "Pinocchio", "double", 1, None, "ns/arm", note="Python call included") for name in names]
    try:
        import pinocchio  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        for row in rows:
            row.note = f"not installed: {error.name}"
        return rows
    pin: Any = pinocchio  # its types are made at run time
    model = pin.buildModelFromUrdf(str(asset_path("panda/panda.urdf")))
    data = model.createData()
    random = np.random.default_rng(0)
    q = [pin.randomConfiguration(model) for _ in range(STATES)]
    v = random.uniform(-1, 1, (STATES, model.nv))
    a = random.uniform(-5, 5, (STATES, model.nv))
    calls = (
        lambda i: pin.forwardKinematics(model, data, q[i]),
        lambda i: pin.rnea(model, data, q[i], v[i], a[i]),
        lambda i: pin.aba(model, data, q[i], v[i], a[i]),
        lambda i: pin.crba(model, data, q[i]),
    )

    def repeated(call: Any) -> Any:
        def run(n: int) -> None:
            for i in range(n):
                call(i % STATES)

        return run

    contenders = [Contender(row, repeated(call), clock=time.thread_time) for row, call in zip(rows, calls, strict=True)]
    measure_in_turns(contenders, rounds, seconds)
    for row in rows:
        row.engine = f"Pinocchio {pin.__version__}"
        row.value = 1e9 / row.value if row.value else None
    return rows
