"""A page in the browser that shows a simulation, to play with; needs `pip install 'manyhands[viewer]'`."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from manyhands.viewer.viewer import Viewer

__all__ = ["Viewer", "view"]


def view(shown: Any, **options: Any) -> "Viewer":
    """A page that shows a `World`, or an environment made by `gymnasium.make`; `options` are those of `Viewer`.

    Raises ModuleNotFoundError without the extra `viewer`.
    """
    return _viewer_class()(shown, **options)


def _viewer_class() -> "type[Viewer]":
    try:
        from manyhands.viewer.viewer import Viewer
    except ModuleNotFoundError as reason:
        if reason.name is not None and reason.name.startswith("manyhands"):
            raise
        text = f"the viewer needs {reason.name}: pip install 'manyhands[viewer]'"
        raise ModuleNotFoundError(text, name=reason.name) from reason
    return Viewer


def __getattr__(name: str) -> Any:
    if name == "Viewer":
        return _viewer_class()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
