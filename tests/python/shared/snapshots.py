"""Snapshots taken apart and put together again: see the format in manyhands/physics/world/snapshot.h."""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray


def worlds_of(snapshot: bytes, n: int) -> NDArray[np.uint8]:
    """A copy of the numbers of n worlds, a row of bytes each."""
    return np.frombuffer(snapshot[_payload(snapshot) :], np.uint8).reshape(n, -1).copy()


def sealed(snapshot: bytes, worlds: NDArray[np.uint8]) -> bytes:
    """The snapshot with other numbers and the check sum that belongs to them."""
    data = snapshot[: _payload(snapshot)] + worlds.tobytes()
    check = 0xCBF29CE484222325 ^ len(data)
    for part in (data[:24], data[32:]):
        padded = part + bytes(-len(part) % 8)
        for (word,) in struct.iter_unpack("<Q", padded):
            check = (check ^ word) * 0x100000001B3 % 2**64
            check ^= check >> 32
    return data[:24] + struct.pack("<Q", check) + data[32:]


def _payload(snapshot: bytes) -> int:
    return 32 + struct.unpack_from("<I", snapshot, 12)[0]
