"""A picture of each task: the end in MuJoCo and here, and the outcome over time."""

import math
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

import manyhands as mh
from benchmarks.mujoco_map import Array, mujoco
from benchmarks.scripted.compare import HARD, LED_OURS, RECORDED, Compared
from benchmarks.scripted.tasks import Task

Pixels = NDArray[np.uint8]  # (height, width, 3)
SIZE = (300, 240)
SHOWN = {RECORDED: ("MuJoCo", "tab:orange"), LED_OURS: ("manyhands", "tab:blue"), HARD: ("MuJoCo, hard", "0.6")}


def write_picture(compared: Compared, path: Path) -> None:
    """MuJoCo's end drawn by MuJoCo (which needs OpenGL, see its MUJOCO_GL), ours by us, and curves."""
    parts = [
        ("MuJoCo", theirs(compared, compared.paths[RECORDED][-1])),
        ("manyhands", ours(compared)),
        ("", curves(compared)),
    ]
    sheet = Image.new("RGB", (len(parts) * SIZE[0], SIZE[1]), "white")
    for i, (title, part) in enumerate(parts):
        sheet.paste(Image.fromarray(part), (i * SIZE[0], 0))
        ImageDraw.Draw(sheet).text((i * SIZE[0] + 8, 6), title, fill="black", font=ImageFont.load_default(15))
    path.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(path, quality=80)


def theirs(compared: Compared, qpos: Array) -> Pixels:
    """MuJoCo's picture."""
    task, model = compared.task, compared.led.mujoco
    data, camera = mujoco.MjData(model), mujoco.MjvCamera()
    data.qpos = qpos
    mujoco.mj_forward(model, data)
    camera.lookat, camera.distance = task.target, task.distance
    camera.azimuth, camera.elevation = 90 + task.yaw, task.pitch
    options = mujoco.MjvOption()
    options.geomgroup[:] = [task.package != "robosuite", 1, 1, 0, 0, 0]  # its group 0 is what collides
    with mujoco.Renderer(model, SIZE[1], SIZE[0]) as renderer:
        renderer.update_scene(data, camera, options)
        return renderer.render()


def ours(compared: Compared) -> Pixels:
    """Our picture of ours."""
    task, world = compared.task, mh.World(compared.led.ours)
    world.q = compared.led.configuration(compared.paths[LED_OURS][-1])
    return world.render(camera(task, float(compared.led.mujoco.vis.global_.fovy)), look=mh.Look(antialiasing=3)).colour


def camera(task: Task, fov_y: float) -> mh.Camera:
    """Where MuJoCo's stands; fov_y in degrees."""
    lens = mh.Camera.perspective(*SIZE, math.radians(fov_y))
    return lens.orbit(task.target, task.distance, math.radians(task.yaw), math.radians(task.pitch))


def curves(compared: Compared) -> Pixels:
    """The outcome over time."""
    figure = Figure(figsize=(SIZE[0] / 100, SIZE[1] / 100), dpi=100, layout="constrained")
    axes = figure.subplots()
    for run, (label, colour) in SHOWN.items():
        if run in compared.paths:
            curve = compared.curve(run)
            axes.plot(np.arange(len(curve)) * compared.time_step, curve, color=colour, label=label, lw=1.2)
    axes.set_title(f"{compared.task.outcome} [{compared.task.unit}]", fontsize=8)
    axes.set_xlabel("s", fontsize=7)
    axes.tick_params(labelsize=7)
    axes.legend(fontsize=7)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.array(canvas.buffer_rgba())[:, :, :3]
