"""The tab of an environment of many worlds: which of them is shown, and how their episodes go."""

from typing import Any

import viser

from manyhands.viewer.batches import BatchSource
from manyhands.viewer.host import Host
from manyhands.viewer.player import Frame

_SQUARES, _MOST = (1, 4, 9, 16, 25), 25  # of worlds side by side


class WorldsPanel:
    """Chooses a world."""

    def __init__(self, viewer: Host, tabs: viser.GuiTabGroupHandle) -> None:
        self._viewer = viewer
        assert isinstance(viewer.source, BatchSource)
        self._source = viewer.source
        self._last = self._source.env.num_envs - 1
        gui = viewer.server.gui
        with tabs.add_tab("Worlds"):
            self._world: Any = gui.add_slider("World", 0, max(1, self._last), 1, 0, disabled=self._last == 0)
            self._world.on_update(lambda _: self._choose(self._world.value))
            buttons = gui.add_button_group("Other", ("Previous", "Next"), disabled=self._last == 0)
            buttons.on_click(lambda event: self._go(1 if event.target.value == "Next" else -1))
            counts = [
                str(count) for count in sorted({*_SQUARES, self._last + 1}) if count <= min(self._last + 1, _MOST)
            ]
            self._count: Any = gui.add_dropdown("Side by side", counts, hint="This world and the next ones")
            self._count.on_update(lambda _: self._spread())
            self._status = gui.add_markdown("")

    def _go(self, by: int) -> None:
        self._world.value = (self._source.chosen + by) % (self._last + 1)

    def _spread(self) -> None:
        self._choose(self._source.chosen)
        self._viewer.look(*self._viewer.stage.camera(int(self._count.value)))

    def _choose(self, world: int) -> None:
        def choose() -> None:
            self._source.choose(world, int(self._count.value))
            self._viewer.overlays.clear_trails()

        self._viewer.player.do(choose)

    def refresh(self, _: Frame) -> None:
        """Says how the episodes go."""
        tally, world = self._source.tally, self._source.chosen
        text = (
            f"World {world}: step {tally.length[world]}, return {tally.total[world]:.1f}\n\n"
            f"{_record(int(tally.episodes[world]), int(tally.successes[world]))}\n\n"
            f"All {self._last + 1} worlds: {_record(int(tally.episodes.sum()), int(tally.successes.sum()))}"
        )
        if self._status.content != text:
            self._status.content = text


def _record(episodes: int, successes: int) -> str:
    """How episodes went that are over."""
    if episodes == 0:
        return "no episode is over yet"
    return f"{episodes} episodes, of which {successes} reached the goal ({successes / episodes:.0%})"
