"""A page in the browser that shows a simulation, to play with; needs the extra `viewer`."""

from typing import TYPE_CHECKING, Any

from manyhands.extras import needs

if TYPE_CHECKING:
    from manyhands.viewer.viewer import Viewer

__all__ = ["Viewer", "view"]


def view(shown: Any, **options: Any) -> "Viewer":
    """A page that shows a `World`, or an environment made by `gymnasium.make`; `options` are those of `Viewer`.

    Raises ModuleNotFoundError without the extra `viewer`.
    """
    return _viewer_class()(shown, **options)


def _viewer_class() -> "type[Viewer]":
    with needs("viewer", "the viewer"):
        from manyhands.viewer.viewer import Viewer
    return Viewer


def __getattr__(name: str) -> Any:
    if name == "Viewer":
        return _viewer_class()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
