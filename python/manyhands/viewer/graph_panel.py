"""The tab with plots of the last seconds."""

from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray

from manyhands.measures import contact_forces, hand_of, joint_forces, joints_of
from manyhands.viewer.environments import EnvSource
from manyhands.viewer.host import Host
from manyhands.viewer.player import Frame

_NOTHING = "none"
_FIRST = ("Hand position", "Energy", "Joint positions")  # what is plotted until something is chosen
_LENGTH = 600  # frames that a plot shows
_COLORS = ("#2670a8", "#e0722c", "#2f9e62", "#c23b54", "#7d5ac9", "#8a6d3b", "#d264ac", "#5f6b76", "#a3a52a", "#22a3b8")


class Quantity(NamedTuple):
    """Something that changes with time."""

    unit: str
    names: list[str]
    measure: Callable[[], ArrayLike]


class GraphPanel:
    """One plot of a chosen quantity; only that is measured."""

    def __init__(self, viewer: Host, tabs: viser.GuiTabGroupHandle) -> None:
        self._viewer, self._gui = viewer, viewer.server.gui
        self._own: dict[str, Quantity] = {}
        self._rows: deque[NDArray[np.float64]] = deque(maxlen=_LENGTH)
        self._plot: Any = None
        self._tab = tabs.add_tab("Plots")
        with self._tab:
            known = self._known()
            first = next((name for name in _FIRST if name in known), _NOTHING)
            self._choice = self._gui.add_dropdown("Quantity", (_NOTHING, *known), initial_value=first)
            self._choice.on_update(lambda _: self._choose())
        self._choose()

    def add(self, name: str, measure: Callable[[], ArrayLike]) -> None:
        """Offers another quantity."""
        self._own[name] = Quantity("", [], measure)
        self._choice.options = (_NOTHING, *self._known())

    def _known(self) -> dict[str, Quantity]:
        source, known = self._viewer.source, {}
        model, world = source.model, source.world
        joints = joints_of(model)
        names = [name.rpartition("/")[2] for name in joints.names]
        if names:
            known["Joint positions"] = Quantity("°, m", names, lambda: joints.in_degrees * source.q[joints.iq])
        if world is not None:
            if names:
                known["Joint velocities"] = Quantity("°/s, m/s", names, lambda: joints.in_degrees * world.v[joints.iv])
                known["Joint forces"] = Quantity("N m, N", names, lambda: joint_forces(world))
            known["Contact force"] = Quantity(
                "N", ["largest on a link"], lambda: max(contact_forces(world).values(), default=0.0)
            )
            known["Energy"] = Quantity("J", ["kinetic", "potential"], world.energy)
        if (hand := hand_of(model)) is not None:
            index = self._viewer.stage.index[hand]
            known["Hand position"] = Quantity("m", ["x", "y", "z"], lambda: source.poses()[0][index])
        if isinstance(source, EnvSource):
            known["Reward"] = Quantity("", ["reward"], lambda: source.outcome.reward)
        return known | self._own

    def _choose(self) -> None:
        name, watched = self._choice.value, self._viewer.player.watched
        quantity = self._known().get(name)

        def choose() -> None:
            watched.clear()
            self._rows.clear()
            if self._plot is not None:
                self._plot.remove()
                self._plot = None
            if quantity is not None:
                watched[name] = quantity.measure

        self._viewer.player.do(choose)

    def add_frame(self, frame: Frame) -> None:
        """Takes what was measured."""
        values = frame.values.get(self._choice.value)
        if values is None:
            return
        row = np.array([frame.moment, *values])
        if self._rows and (len(row) != len(self._rows[-1]) or row[0] < self._rows[-1][0]):
            self._rows.clear()
        if not self._rows or row[0] > self._rows[-1][0]:
            self._rows.append(row)

    def refresh(self, _: Frame) -> None:
        """Draws the plot anew."""
        if len(self._rows) < 2:
            return
        columns = tuple(np.array(self._rows).T)
        if self._plot is not None and len(self._plot.data) == len(columns):
            self._plot.data = columns
            return
        quantity = self._known()[self._choice.value]
        names = quantity.names if len(quantity.names) == len(columns) - 1 else [str(k) for k in range(len(columns) - 1)]
        series: list[Any] = [{"label": "t [s]"}]
        for k, name in enumerate(names):
            series.append({"label": name, "stroke": _COLORS[k % len(_COLORS)], "width": 2})
        title = f"{self._choice.value} [{quantity.unit}]" if quantity.unit else self._choice.value
        with self._tab:
            self._plot = self._gui.add_uplot(
                columns, tuple(series), title=title, scales={"x": {"time": False}}, legend={"show": True}, height=260
            )
