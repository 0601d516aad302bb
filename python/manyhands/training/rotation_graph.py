"""What a network sees of a cube's rotation, as operations of an ONNX graph: products of numbers, and sums of them."""

from collections.abc import Sequence
from itertools import combinations_with_replacement, product

import numpy as np
from numpy.typing import NDArray

from manyhands.training.policy_graph import PolicyGraph

Array = NDArray[np.float32]
_X, _Y, _Z, _W = range(4)
# Of the product of quaternions a b: each component's terms, (sign, component of a, component of b).
_PRODUCT = (
    ((1, _W, _X), (1, _X, _W), (1, _Y, _Z), (-1, _Z, _Y)),
    ((1, _W, _Y), (1, _Y, _W), (1, _Z, _X), (-1, _X, _Z)),
    ((1, _W, _Z), (1, _Z, _W), (1, _X, _Y), (-1, _Y, _X)),
    ((1, _W, _W), (-1, _X, _X), (-1, _Y, _Y), (-1, _Z, _Z)),
)


def add_cube_rotation(graph: PolicyGraph, observation_dim: int, first: int) -> list[str]:
    """The values, (batch, 9) and (batch, 15), that `cube_rotation` of a trainer's config adds to a network's input."""
    chosen = np.eye(observation_dim, dtype=np.float32)[:, first : first + 4]
    now = graph.apply("MatMul", ["observation", graph.constant("quaternion", chosen)], "cube_quaternion")
    way = _products(graph, "desired_goal", now, list(product(range(4), range(4))), (4, 4), "way_products")
    way = graph.apply("MatMul", [way, graph.constant("relative", _relative())], "way_quaternion")
    matrices = [_matrix(graph, quaternion, name) for quaternion, name in ((way, "cube_way"), (now, "cube_axes"))]
    return [matrices[0], _moments(graph, matrices[1])]


def _products(
    graph: PolicyGraph, a: str, b: str, pairs: Sequence[tuple[int, int]], sizes: tuple[int, int], output: str
) -> str:
    """a[i] b[k] for each pair."""
    factors = []
    for value, size, side in ((a, sizes[0], 0), (b, sizes[1], 1)):
        chosen = np.zeros((size, len(pairs)), np.float32)
        chosen[[pair[side] for pair in pairs], range(len(pairs))] = 1
        name = f"{output}_{side}"
        factors.append(graph.apply("MatMul", [value, graph.constant(f"of_{name}", chosen)], name))
    return graph.apply("Mul", factors, output)


def _relative() -> Array:
    """(16, 4): goal times the conjugate of the pose, from the products of their components."""
    matrix = np.zeros((4, 4, 4), np.float32)
    for component, terms in enumerate(_PRODUCT):
        for sign, a, b in terms:
            matrix[a, b, component] = sign if b == _W else -sign
    return matrix.reshape(16, 4)


def _matrix(graph: PolicyGraph, quaternion: str, output: str) -> str:
    """The rotation matrix (batch, 9), column by column: 1 - 2 (y^2 + z^2), ..."""
    squares = list(product(range(4), range(4)))
    terms = np.zeros((4, 4, 3, 3), np.float32)  # by column and row
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        terms[[j, k], [j, k], i, i] = -2
        terms[i, j, [i, j], [j, i]] = 2
        terms[_W, k, i, j], terms[_W, k, j, i] = 2, -2
    products = _products(graph, quaternion, quaternion, squares, (4, 4), f"{output}_products")
    of_products = graph.constant(f"{output}_terms", terms.reshape(16, 9))
    turned = graph.apply("MatMul", [products, of_products], f"{output}_turn")
    return graph.apply("Add", [turned, graph.constant(f"{output}_one", np.eye(3).reshape(1, 9))], output)


def _moments(graph: PolicyGraph, axes: str) -> str:
    """sum_k x^a y^b z^c over the columns (x, y, z) of a matrix, a + b + c = 4, in the order of a, then b."""
    pairs = list(combinations_with_replacement(range(3), 2))
    of_axes = [(3 * axis + i, 3 * axis + k) for axis in range(3) for i, k in pairs]
    seconds = _products(graph, axes, axes, of_axes, (9, 9), "second_order")
    powers = [(a, b, 4 - a - b) for a in range(5) for b in range(5 - a)]
    halves = [_halves(power, pairs) for power in powers]
    count = len(pairs)
    of_seconds = [(count * axis + i, count * axis + k) for axis in range(3) for i, k in halves]
    fourths = _products(graph, seconds, seconds, of_seconds, (3 * count, 3 * count), "fourth_order")
    over_axes = np.tile(np.eye(len(powers), dtype=np.float32), (3, 1))
    return graph.apply("MatMul", [fourths, graph.constant("over_axes", over_axes)], "cube_moments")


def _halves(power: tuple[int, int, int], pairs: Sequence[tuple[int, int]]) -> tuple[int, int]:
    """Two of the pairs whose product is this power of (x, y, z)."""
    factors = [axis for axis in range(3) for _ in range(power[axis])]
    return pairs.index((factors[0], factors[1])), pairs.index((factors[2], factors[3]))
