"""A client whose methods are pybullet's functions."""

import inspect
import os
from contextlib import suppress
from functools import partial
from typing import Any

from manyhands import pybullet

_pybullet: Any = pybullet  # its stubs do not know `error`


class BulletClient:
    """A connection of its own to a simulation: `client.stepSimulation()` is `pybullet.stepSimulation` of that client.

    Constants and whatever else pybullet has are found here, too.
    """

    def __init__(self, connection_mode: int | None = None, hostName: str | None = None, options: str = "") -> None:
        """connection_mode: pybullet.DIRECT, GUI and so on; None joins a simulation in shared memory, or else makes one
        without a window. Raises pybullet.error if there can be no connection."""
        self._client = -1
        self._pid = os.getpid()
        if connection_mode is None:
            self._client = _pybullet.connect(_pybullet.SHARED_MEMORY, options=options)
            connection_mode = _pybullet.DIRECT
        if self._client < 0:
            host = {} if hostName is None else {"hostName": hostName}
            self._client = _pybullet.connect(connection_mode, options=options, **host)

    def disconnect(self) -> None:
        """Ends the connection. Raises pybullet.error if it has ended."""
        client, self._client = self._client, -1
        for name in [name for name, value in vars(self).items() if isinstance(value, partial)]:
            delattr(self, name)
        _pybullet.disconnect(physicsClientId=client)

    def __getattr__(self, name: str) -> Any:
        if name in ("_client", "_pid"):  # while it is being made or copied
            raise AttributeError(name)
        found = getattr(_pybullet, name)
        if not inspect.isbuiltin(found):
            return found
        bound = partial(found, physicsClientId=self._client)
        setattr(self, name, bound)  # the next call finds it without asking here
        return bound

    def __del__(self) -> None:
        if vars(self).get("_client", -1) >= 0 and self._pid == os.getpid():
            with suppress(_pybullet.error):
                self.disconnect()
