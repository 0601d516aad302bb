"""The tab that keeps what was seen as a page that opens alone."""

from collections import deque
from typing import Any

import numpy as np
import viser
from viser import _messages as messages

from manyhands.viewer.host import Host
from manyhands.viewer.player import Frame

_SECONDS = 180.0
_PASSING = ("/contacts", "/push", "/gizmo", "/beside")  # what does not belong into a recording


class RecordPanel:
    """Remembers the poses of the last three minutes, and writes them as one HTML file."""

    def __init__(self, viewer: Host, tabs: viser.GuiTabGroupHandle) -> None:
        self._viewer = viewer
        self._frames: deque[Frame] = deque(maxlen=round(_SECONDS * viewer.player.fps))
        gui = viewer.server.gui
        with tabs.add_tab("Share"):
            gui.add_markdown("The last seconds as one page that opens alone, in any browser, without this program.")
            self._length = gui.add_number("Seconds", 20.0, min=1.0, max=_SECONDS, step=1.0)
            save = gui.add_button("Save as a page", icon=viser.Icon.FILE_DOWNLOAD)
            save.on_click(self._save)

    def close(self) -> None:
        """Nothing is left behind."""
        self._frames.clear()

    def add_frame(self, frame: Frame) -> None:
        """Remembers a moment; what came after it in another run of events is forgotten."""
        if self._frames and frame.parts != self._frames[-1].parts:
            self._frames.clear()
        while self._frames and self._frames[-1].moment >= frame.moment:
            self._frames.pop()
        self._frames.append(frame)

    def html(self, seconds: float | None) -> str:
        """What was seen in the last seconds, as the text of a page."""
        frames = list(self._frames)
        if seconds is not None:
            frames = [frame for frame in frames if frame.moment >= frames[-1].moment - seconds]
        if not frames:
            raise RuntimeError("nothing has been shown yet")
        server, stage = self._viewer.server, self._viewer.stage
        serializer = server.get_scene_serializer()
        # From here on the server tells the recording all that it draws; only what is told below shall be in it.
        recorded: list[Any] = serializer._messages
        recorded[:] = [each for each in recorded if not _passes(each[1])]
        taken = len(recorded)
        told: list[Any] = []
        shown: dict[str, Any] = {}
        for frame in frames:
            clock = float(frame.moment - frames[0].moment)
            for name, *pose in stage.placed(frame):
                position: Any = tuple(map(float, pose[0]))
                wxyz: Any = tuple(map(float, np.roll(pose[1], 1)))
                for message in (
                    messages.SetPositionMessage(name, position),
                    messages.SetOrientationMessage(name, wxyz),
                ):
                    key = f"{type(message).__name__} {name}"
                    if shown.get(key) != message:
                        shown[key] = message
                        told.append((clock, message.as_serializable_dict(serializer._binary_buffers)))
        recorded[taken:] = told
        serializer._time = float(frames[-1].moment - frames[0].moment)
        return serializer.as_html()

    def _save(self, event: Any) -> None:
        if event.client is None:
            return
        page = self.html(float(self._length.value)).encode()
        name = f"{self._viewer.source.title}.html".replace("/", "-")
        event.client.send_file_download(name, page, save_immediately=True)


def _passes(message: dict[str, Any]) -> bool:
    return str(message.get("name", "")).startswith(_PASSING)
