"""Vectors and rotations as plain numbers, for what is worked out in every step.

``rotations`` has the same for whole recordings; for one vector numpy takes ten times as long.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from simcompare.model.shapes import Quaternion, Vector

Numbers = Sequence[float]


def dot(first: Numbers, second: Numbers) -> float:
    """Scalar product of two vectors."""
    (a, b, c), (x, y, z) = first, second
    return a * x + b * y + c * z


def cross(first: Numbers, second: Numbers) -> Vector:
    """Vector product of two vectors."""
    (a, b, c), (x, y, z) = first, second
    return b * z - c * y, c * x - a * z, a * y - b * x


def plus(first: Numbers, second: Numbers) -> Vector:
    """Sum of two vectors."""
    (a, b, c), (x, y, z) = first, second
    return a + x, b + y, c + z


def minus(first: Numbers, second: Numbers) -> Vector:
    """Difference of two vectors."""
    (a, b, c), (x, y, z) = first, second
    return a - x, b - y, c - z


def times(factor: float, vector: Numbers) -> Vector:
    """A vector that is so many times as long."""
    x, y, z = vector
    return factor * x, factor * y, factor * z


def turned(orientation_wxyz: Numbers, vector: Numbers) -> Vector:
    """A vector of a body's frame in the world's."""
    w, *axis = orientation_wxyz
    x, y, z = vector
    a, b, c = cross(axis, vector)
    i, j, k = cross(axis, (a, b, c))
    return x + 2 * (w * a + i), y + 2 * (w * b + j), z + 2 * (w * c + k)


def turned_back(orientation_wxyz: Numbers, vector: Numbers) -> Vector:
    """A vector of the world's frame in a body's, fast enough for every step."""
    # v - 2·w·(u × v) + 2·u × (u × v)
    (w, ux, uy, uz), (x, y, z) = orientation_wxyz, vector
    a, b, c = 2 * (uy * z - uz * y), 2 * (uz * x - ux * z), 2 * (ux * y - uy * x)
    return (
        x - w * a + uy * c - uz * b,
        y - w * b + uz * a - ux * c,
        z - w * c + ux * b - uy * a,
    )


def multiplied(first_wxyz: Numbers, second_wxyz: Numbers) -> Quaternion:
    """Product of two quaternions wxyz: the second rotation, then the first."""
    (w, x, y, z), (a, b, c, d) = first_wxyz, second_wxyz
    return (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c + y * a + z * b - x * d,
        w * d + z * a + x * c - y * b,
    )


def x_turned_to(axis: Numbers) -> Quaternion:
    """Orientation wxyz of a frame whose x axis is a unit vector, on the shortest way."""
    x, y, z = axis
    length = math.hypot(1 + x, y, z)
    if length < 1e-9:
        return 0.0, 0.0, 0.0, 1.0
    return (1 + x) / length, 0.0, -z / length, y / length
