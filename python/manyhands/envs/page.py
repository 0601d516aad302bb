"""What `render_mode="human"` opens."""

from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from manyhands.viewer import view
from manyhands.viewer.notebook import is_notebook, show_in_cell

if TYPE_CHECKING:
    from manyhands.viewer import Viewer


class Page:
    """A page in the browser, made when it is first needed. Copies begin without one.

    A notebook shows it below the cell; where there is a screen, the browser opens (the variable BROWSER says which).
    """

    def __init__(self) -> None:
        self._viewer: Viewer | None = None
        self._camera: tuple[ArrayLike, ArrayLike] | None = None

    def show(self, shown: Any, *, real_time: bool = True) -> None:
        """After each step of what is shown: waits for real time, and while the page is paused. Raises
        ModuleNotFoundError without the extra `viewer`."""
        if self._viewer is None or self._viewer.is_closed:
            self._viewer = view(shown)
            if is_notebook():
                show_in_cell(self._viewer)
            if self._camera is not None:
                self._viewer.look(*self._camera)
        if not real_time:
            self._viewer.speed = float("inf")
        self._viewer.sync()

    def look(self, position: ArrayLike, look_at: ArrayLike) -> None:
        """Puts the camera at a position (3) [m], turned to another."""
        self._camera = position, look_at
        if self._viewer is not None:
            self._viewer.look(position, look_at)

    def close(self) -> None:
        """Takes the page away; may be called again."""
        if self._viewer is not None:
            self._viewer.close()
            self._viewer = None

    def __deepcopy__(self, _memo: Any) -> "Page":
        return Page()
