"""Shapes as triangles."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.model.rotations import rotate
from simcompare.model.shapes import Plane, Shape
from simcompare.model.trajectory import Array

Indices = NDArray[np.int64]
#: corners of what is round, along a full turn and from pole to pole
_ROUND, _POLES = 18, 9
#: of all shapes of a body but the first, so that they are seen as parts
_DARKER = 0.68


@dataclass(frozen=True)
class Mesh:
    """A surface of triangles.

    Attributes:
        corners: places (n, 3) [m].
        triangles: three numbers of corners each (m, 3).
        tones: part of the colour that each corner has (n,), below 1 where it is darker.
    """

    corners: Array
    triangles: Indices
    tones: Array


def mesh_of(shapes: Iterable[Shape]) -> Mesh:
    """All shapes of a body in the body's frame; a plane, which has no end, is left out."""
    solid = [shape for shape in shapes if not isinstance(shape, Plane)]
    return joined(_placed(shape, _DARKER if k else 1.0) for k, shape in enumerate(solid))


def joined(meshes: Iterable[Mesh]) -> Mesh:
    """Several meshes as one."""
    corners: list[Array] = [np.empty((0, 3))]
    triangles: list[Indices] = [np.empty((0, 3), dtype=np.int64)]
    tones: list[Array] = [np.empty(0)]
    count = 0
    for mesh in meshes:
        corners.append(mesh.corners)
        triangles.append(mesh.triangles + count)
        tones.append(mesh.tones)
        count += len(mesh.corners)
    return Mesh(np.concatenate(corners), np.concatenate(triangles), np.concatenate(tones))


def sheet(place_m: Array, normal: Array, low_m: Array, high_m: Array) -> Mesh:
    """The part of a plane that lies in a box, seen along z; along x where it stands upright.

    Args:
        place_m: a place on it (3,) [m].
        normal: its direction (3,).
        low_m: lowest corner of the box (3,) [m].
        high_m: highest corner (3,) [m].
    """
    lead = 2 if abs(normal[2]) > abs(normal[0]) else 0
    first, second = (axis for axis in range(3) if axis != lead)
    corners = np.empty((4, 3))
    corners[:, first] = [low_m[first], high_m[first], high_m[first], low_m[first]]
    corners[:, second] = [low_m[second], low_m[second], high_m[second], high_m[second]]
    slope = (corners[:, [first, second]] - place_m[[first, second]]) @ normal[[first, second]]
    corners[:, lead] = place_m[lead] - slope / normal[lead]
    return _even(corners, np.array([[0, 1, 2], [0, 2, 3]]))


def _even(corners: Array, triangles: Indices) -> Mesh:
    return Mesh(corners, triangles, np.ones(len(corners)))


def _placed(shape: Shape, tone: float) -> Mesh:
    assert not isinstance(shape, Plane)
    mesh = _box(shape.size_m) if shape.type == "box" else _turned(_profile(shape))
    turn = np.tile(shape.orientation_wxyz, (len(mesh.corners), 1))
    corners = rotate(turn, mesh.corners) + np.array(shape.position_m)
    return Mesh(corners, mesh.triangles, tone * mesh.tones)


def _box(size_m: tuple[float, float, float]) -> Mesh:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    halves = [half for a, b, c, d in faces for half in ((a, b, c), (a, c, d))]
    return _even(corners * size_m, np.array(halves))


def _profile(shape: Shape) -> Array:
    """What is turned about z: radius and height of a line from the lowest point to the highest."""
    assert not isinstance(shape, Plane)
    assert shape.type != "box"
    if shape.type == "cylinder":
        half = shape.length_m / 2
        return np.array([[0, -half], [shape.radius_m, -half], [shape.radius_m, half], [0, half]])
    angle = np.linspace(-np.pi / 2, np.pi / 2, _POLES)
    half = shape.length_m / 2 if shape.type == "capsule" else 0.0
    height = shape.radius_m * np.sin(angle) + np.where(angle < 0, -half, half)
    return np.column_stack([shape.radius_m * np.cos(angle), height])


def _turned(profile: Array) -> Mesh:
    """A line turned about z, as rings of corners that are joined to the next ring."""
    angle = np.arange(_ROUND) * 2 * np.pi / _ROUND
    radius, height = profile[:, :1], profile[:, 1:]
    corners = np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), height + 0 * angle], axis=-1
    )
    ring, place = np.meshgrid(np.arange(len(profile) - 1), np.arange(_ROUND), indexing="ij")
    here, beside = ring * _ROUND + place, ring * _ROUND + (place + 1) % _ROUND
    lower = np.stack([here, beside, beside + _ROUND], axis=-1).reshape(-1, 3)
    upper = np.stack([here, beside + _ROUND, here + _ROUND], axis=-1).reshape(-1, 3)
    return _even(corners.reshape(-1, 3), np.concatenate([lower, upper]))
