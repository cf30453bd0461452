"""Rotations of whole recordings, as numpy arrays; scipy's class costs half a second to import."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from simcompare.trajectory import Array


def quaternions_of(rotation_vectors_rad: Array) -> Array:
    """Unit quaternions wxyz (n, 4) of rotation vectors (n, 3) [rad]."""
    half = np.linalg.norm(rotation_vectors_rad, axis=1, keepdims=True) / 2
    # sin(x)/x is 1 at 0; numpy's sinc has the factor π inside
    return np.hstack((np.cos(half), rotation_vectors_rad * np.sinc(half / np.pi) / 2))


def rotation_vector_of(orientation_wxyz: Sequence[float]) -> Array:
    """Rotation vector (3,) [rad] of one unit quaternion wxyz (4,)."""
    w, axis = float(orientation_wxyz[0]), np.asarray(orientation_wxyz[1:], dtype=float)
    sine = math.hypot(*axis)  # exact also where squares underflow
    # for small angles sin x = x; it also keeps clear of dividing two tiny numbers
    factor = 2 / w if sine < 1e-8 else 2 * math.atan2(sine, w) / sine
    return np.asarray(axis * factor, dtype=float)


def rotate(orientation_wxyz: Array, vectors: Array) -> Array:
    """Vectors (n, 3) turned by quaternions wxyz (n, 4): body frame to world frame."""
    w, u = orientation_wxyz[:, :1], orientation_wxyz[:, 1:]
    t = 2.0 * np.cross(u, vectors)
    return np.asarray(vectors + w * t + np.cross(u, t), dtype=float)


def matrix_of(orientation_wxyz: Sequence[float]) -> Array:
    """Rotation matrix (3, 3) of one quaternion wxyz (4,)."""
    four = np.repeat(np.asarray([orientation_wxyz], dtype=float), 3, axis=0)
    return rotate(four, np.eye(3)).T
