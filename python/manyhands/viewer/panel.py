"""The control panel: time, and tabs for all else."""

import math
import time
from typing import Any

import viser

from manyhands.viewer.batches import BatchSource
from manyhands.viewer.camera_panel import CameraPanel
from manyhands.viewer.controls import SharedSlider
from manyhands.viewer.environments import EnvSource
from manyhands.viewer.graph_panel import GraphPanel
from manyhands.viewer.host import Host
from manyhands.viewer.player import Frame
from manyhands.viewer.record_panel import RecordPanel
from manyhands.viewer.robot_panel import RobotPanel
from manyhands.viewer.teleop_panel import TeleopPanel
from manyhands.viewer.view_panel import ViewPanel
from manyhands.viewer.worlds_panel import WorldsPanel

_SPEEDS = {
    "1/10": 0.1,
    "1/4": 0.25,
    "1/2": 0.5,
    "real time": 1.0,
    "2 x": 2.0,
    "5 x": 5.0,
    "as fast as it goes": math.inf,
}
_REFRESH = 0.2  # [s] between two updates of numbers on the page


class Panel:
    """All controls. What they ask for is done between two steps of the simulation."""

    def __init__(self, viewer: Host) -> None:
        self._viewer, self._player = viewer, viewer.player
        self._last_refresh = -math.inf
        self._shown_playing: bool | None = None
        gui = viewer.server.gui
        self._status = gui.add_markdown("")
        if not viewer.source.only_watched:
            self._make_time(gui)
        tabs = gui.add_tab_group()
        source = viewer.source
        self.teleop = TeleopPanel(viewer, tabs) if isinstance(source, EnvSource) else None
        self.worlds = WorldsPanel(viewer, tabs) if isinstance(source, BatchSource) else None
        self.robot = (
            RobotPanel(viewer, tabs, self.teleop) if source.joints is not None and source.joints.knobs else None
        )
        self.view = ViewPanel(viewer, tabs)
        self.graphs = GraphPanel(viewer, tabs)
        self.cameras = None if source.only_watched else CameraPanel(viewer, tabs)
        self.recorder = RecordPanel(viewer, tabs)
        if not source.only_watched:
            self._make_keys(gui)

    def _make_time(self, gui: viser.GuiApi) -> None:
        self._play = gui.add_button("Play", icon=viser.Icon.PLAYER_PLAY, hint="Lets time pass (key P)")
        self._play.on_click(lambda _: self.toggle())
        buttons = gui.add_button_group("Time", ("Step", "Reset"), hint="One step (key N); begin anew (key R)")
        buttons.on_click(lambda event: self._viewer.step() if event.target.value == "Step" else self._viewer.reset())
        self._speed = gui.add_dropdown("Speed", tuple(_SPEEDS), initial_value="real time")
        self._speed.on_update(lambda _: setattr(self._viewer, "speed", _SPEEDS[self._speed.value]))
        rewind = gui.add_slider(
            "Rewind [s]", min=-1.0, max=0.0, step=0.05, initial_value=0.0, hint="Back through the last three minutes"
        )
        self._rewind = SharedSlider(rewind, self._go_back)
        self._rewound_from: float | None = None

    def _make_keys(self, gui: viser.GuiApi) -> None:
        for key, label, act in (
            ("P", "Play or pause", self.toggle),
            ("N", "Next step", self._viewer.step),
            ("R", "Reset", self._viewer.reset),
        ):
            command = gui.add_command(label, hotkey=key)  # pyright: ignore[reportArgumentType]
            command.on_trigger(lambda _, act=act: act())

    def toggle(self) -> None:
        """Plays what pauses, pauses what plays."""
        if self._player.playing:
            self._viewer.pause()
        else:
            self._rewound_from = None
            self._viewer.play()

    def close(self) -> None:
        """Ends what waits."""
        self.recorder.close()

    def rebuild(self) -> None:
        """After bodies came or went."""
        if self.robot is not None:
            self.robot.rebuild()
        self.view.rebuild()

    def update(self, frame: Frame) -> None:
        """With every frame; numbers on the page follow a few times a second."""
        self.graphs.add_frame(frame)
        self.recorder.add_frame(frame)
        if self.robot is not None:
            self.robot.follow(frame)
        now = time.perf_counter()
        if now - self._last_refresh < _REFRESH:
            return
        self._last_refresh = now
        self._show_time(frame)
        parts: tuple[Any, ...] = (self.robot, self.teleop, self.worlds, self.graphs, self.cameras)
        for part in parts:
            if part is not None:
                part.refresh(frame)

    def _show_time(self, frame: Frame) -> None:
        player, watched = self._player, self._viewer.source.only_watched
        if player.problem:
            text = f"**Stopped:** {player.problem}"
        else:
            pace = f"{player.rate:.2g} x real time" if player.playing or watched else "paused"
            text = f"**{frame.time:.2f} s** &nbsp; {pace}"
        if self._status.content != text:
            self._status.content = text
        if not watched:
            self._show_play()
            self._show_rewind()

    def _show_play(self) -> None:
        playing = self._player.playing
        if playing != self._shown_playing:
            self._shown_playing = playing
            self._play.label = "Pause" if playing else "Play"
            self._play.icon = viser.Icon.PLAYER_PAUSE if playing else viser.Icon.PLAYER_PLAY

    def _show_rewind(self) -> None:
        first, last = self._player.history.span
        if self._rewound_from is None or self._player.playing:
            self._rewound_from = None
            reach = -max(1.0, round(last - first, 1))
            if self._rewind.handle.min != reach:
                self._rewind.handle.min = reach
            self._rewind.show(0.0)

    def _go_back(self, seconds: float) -> None:
        if self._rewound_from is None:
            self._rewound_from = self._player.history.span[1]
        self._player.rewind(self._rewound_from + seconds)
