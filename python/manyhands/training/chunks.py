"""Acting by policies that predict several actions at a time."""

import numpy as np
from numpy.typing import NDArray

_FADING = 0.01  # of the weight of a prediction with each that came before it


class ChunkBlend:
    """Blends what successive predictions say of the present step, in n worlds at once.

    The temporal ensemble of Zhao et al., *Learning fine-grained bimanual manipulation with low-cost hardware* (2023).
    """

    def __init__(self) -> None:
        self._sum = np.zeros((0, 0, 0))  # (n, chunk, action_dim), weighted, of the steps from the present one on
        self._weight = self._count = np.zeros((0, 0))  # (n, chunk)

    def next(self, predicted: NDArray[np.float32], begins: NDArray[np.bool_]) -> NDArray[np.float32]:
        """The actions (n, action_dim) now, from predictions (n, chunk, action_dim); episodes begin where `begins`."""
        if predicted.shape != self._sum.shape:
            self._sum = np.zeros(predicted.shape)
            self._weight, self._count = np.zeros((2, *predicted.shape[:2]))
        for values in (self._sum, self._weight, self._count):
            values[:, :-1] = values[:, 1:]
            values[:, -1] = 0
            values[begins] = 0
        weight = np.exp(-_FADING * self._count)
        self._sum += weight[:, :, None] * predicted
        self._weight += weight
        self._count += 1
        return (self._sum[:, 0] / self._weight[:, 0, None]).astype(np.float32)
