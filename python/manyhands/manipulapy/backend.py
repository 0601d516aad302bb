"""Where arrays are computed. manyhands computes in C++ on the processor and gives NumPy arrays; other names are known
so that programs which ask for them hear what is missing."""

from collections.abc import Iterator
from contextlib import contextmanager

_NAMES = ("numpy", "cupy", "torch", "jax")


def set_backend(name: str) -> None:
    """Raises ValueError on an unknown name, ImportError on any but "numpy"."""
    if name not in _NAMES:
        raise ValueError(f"unknown backend {name!r}; there are {', '.join(_NAMES)}")
    if name != "numpy":
        raise ImportError(
            f"the backend {name!r} is not here: manyhands computes in C++ and gives NumPy arrays ('numpy')"
        )


def get_backend() -> str:
    """Always "numpy"."""
    return "numpy"


@contextmanager
def use_backend(name: str) -> Iterator[str]:
    """`set_backend` for a while."""
    set_backend(name)
    yield name
