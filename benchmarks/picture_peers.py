"""Pictures by the program people use today: PyBullet's TinyRenderer, of the same scene from the same place."""

import time

from benchmarks.rows import Contender, Row, measure_in_turns

SIZE = 84


def run_picture_peers(rounds: int, seconds: float) -> list[Row]:
    """The rate of `getCameraImage`; a row that says why where PyBullet is not installed."""
    row = Row("84 x 84 colour, depth, segmentation", "PyBullet TinyRenderer", "", 1, None, "frames/s")
    try:
        import pybullet
        import pybullet_data
    except ImportError:
        row.note = "not installed"
        return [row]
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.loadURDF(f"{pybullet_data.getDataPath()}/franka_panda/panda.urdf", [-0.6, 0, 0], useFixedBase=True)
    for half, height in (((3, 3, 0.01), -0.41), ((0.55, 0.35, 0.2), -0.2), ((0.02, 0.02, 0.02), 0.02)):
        shape = pybullet.createVisualShape(pybullet.GEOM_BOX, halfExtents=half)
        pybullet.createMultiBody(0, -1, shape, [-0.3 if half[0] == 0.55 else 0, 0, height])
    view = pybullet.computeViewMatrixFromYawPitchRoll([0, 0, 0], 1.4, 45, -30, 0, 2)
    projection = pybullet.computeProjectionMatrixFOV(60, 1, 0.1, 100)

    def run(n: int) -> None:
        for _ in range(n):
            pybullet.getCameraImage(SIZE, SIZE, view, projection, renderer=pybullet.ER_TINY_RENDERER)

    measure_in_turns([Contender(row, run, clock=time.thread_time)], rounds, seconds)
    pybullet.disconnect(client)
    return [row]
