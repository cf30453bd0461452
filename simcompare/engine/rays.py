"""Rays that meet shapes: exact, in double precision, for many shapes and many rays at once.

Every shape here is convex, so a ray is inside it between two distances. It is seen where it enters,
ahead of where it begins: what it begins in is not seen. Box and cylinder are intersections of slabs
and a tube (Kay and Kajiya 1986), a capsule is a tube with two spheres. What a ray passes a round
shape at is taken from the point that is nearest to its middle, where no digits are lost far away
(Haines et al., Ray Tracing Gems, 2019, chapter 7).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simcompare.model.rotations import rotate
from simcompare.model.shapes import Shape
from simcompare.model.trajectory import Array

Indices = NDArray[np.intp]
#: added to the components of directions: it changes only a 0, by which nothing can be divided
_TINY = 1e-150
#: distances (shapes times rays) that are worked out at once, so that they stay in a cache
_AT_ONCE = 40_000
#: as many cost less than looking which shapes are in sight
_FEW = 4_000
_KINDS = ("plane", "sphere", "box", "cylinder", "capsule")


@dataclass(frozen=True, eq=False)
class Hits:
    """What rays meet first.

    Attributes:
        distance_m: along each ray (n,); ``inf`` where it meets nothing.
        normal: of the surface there, out of the solid (n, 3); 0 where there is none.
        index: of the shape (n,); -1 where there is none.
    """

    distance_m: Array
    normal: Array
    index: Indices


class Solids:
    """Shapes that stay where they are in one frame, ready to be met by many rays.

    Args:
        shapes: placed in that frame.
    """

    def __init__(self, shapes: Sequence[Shape]) -> None:
        places = {kind: [i for i, s in enumerate(shapes) if s.type == kind] for kind in _KINDS}
        self._groups = [
            _Group(kind, [shapes[i] for i in found]) for kind, found in places.items() if found
        ]
        self._order = np.array([*itertools.chain(*places.values()), -1], dtype=np.intp)
        self._firsts = [0, *itertools.accumulate(len(group.middle) for group in self._groups)]
        self._rows = np.arange(max(1, self._firsts[-1]))
        self._all: list[tuple[_Group, Any]] = [(group, slice(None)) for group in self._groups]
        if self._groups:
            self._middle = np.concatenate([group.middle for group in self._groups])
            self._around = np.concatenate([group.around for group in self._groups])

    def distances(self, origins: Array, directions: Array) -> tuple[Array, Indices]:
        """How far each ray goes until it enters a shape, and which one.

        Args:
            origins: where rays begin (n, 3), or (1, 3) or (3,) where all begin at one place [m];
                then what they all pass by costs next to nothing.
            directions: unit vectors (n, 3).

        Returns:
            Distances (n,) [m], ``inf`` for nothing, and indices of shapes (n,), -1 for none.
        """
        distance, row = self._nearest(np.atleast_2d(origins), directions)
        return distance, self._order[row]

    def ranges(self, origins: Array, directions: Array) -> Array:
        """The distances alone, which cost less."""
        tables = [
            table.min(axis=0) for table, _ in self._tables(np.atleast_2d(origins), directions)
        ]
        return tables[0] if len(tables) == 1 else np.concatenate(tables)

    def cast(self, origins: Array, directions: Array) -> Hits:
        """The same with the normals of the surfaces that are met."""
        origins = np.atleast_2d(origins)
        distance, row = self._nearest(origins, directions)
        normal = np.zeros((len(row), 3))
        for group, first, end in zip(self._groups, self._firsts, self._firsts[1:], strict=False):
            here = np.flatnonzero((row >= first) & (row < end))
            if len(here):
                along = directions[here]
                begin = origins if len(origins) == 1 else origins[here]
                place = begin + distance[here, None] * along
                normal[here] = group.normals(row[here] - first, place, along)
        return Hits(distance, normal, self._order[row])

    def _nearest(self, origins: Array, directions: Array) -> tuple[Array, Indices]:
        """Distances, and rows of shapes in the order of the groups; -1 where nothing is met."""
        found = []
        for table, rows in self._tables(origins, directions):
            nearest = table.argmin(axis=0)
            distance = table[nearest, np.arange(table.shape[1])]
            found.append((distance, np.where(distance < np.inf, rows[nearest], -1)))
        distances, nearest_rows = zip(*found, strict=True)
        return np.concatenate(distances), np.concatenate(nearest_rows)

    def _tables(self, origins: Array, directions: Array) -> Iterator[tuple[Array, Indices]]:
        """Distances (k, n) at which some rays enter the shapes of some rows (k,), for all rays."""
        is_one, seen, parts = len(origins) == 1, self._rows, self._all
        if is_one and parts and len(directions) * len(seen) > _FEW:
            seen = self._in_sight(origins[0], directions)
            ends = np.searchsorted(seen, self._firsts)
            parts = [
                (group, seen[i:k] - first)
                for group, first, i, k in zip(
                    self._groups, self._firsts, ends, ends[1:], strict=False
                )
                if i < k
            ]
        if not parts or not len(directions):
            yield np.full((1, len(directions)), np.inf), self._rows[:1]
            return
        starts, columns = np.ascontiguousarray(origins.T), np.ascontiguousarray(directions.T)
        size = max(1, _AT_ONCE // len(seen))
        for i in range(0, len(directions), size):
            along = columns[:, i : i + size]
            begin = starts if is_one else starts[:, i : i + size]
            # rays along a plane, and those that pass a round shape by
            with np.errstate(divide="ignore", invalid="ignore"):
                both = [group.stretches(begin, along, rows) for group, rows in parts]
            near, far = (np.concatenate(tables) for tables in zip(*both, strict=True))
            # what is entered behind the start, or left before it is entered, is not met
            yield np.where((near <= far) & (near >= 0), near, np.inf), seen

    def _in_sight(self, origin: Array, directions: Array) -> Indices:
        """Rows of the shapes that come near the narrowest cone about all rays."""
        axis = directions.sum(axis=0)
        length = math.hypot(*axis.tolist())
        cosine = min(float((directions @ axis).min()) / length, 1.0) if length else 0.0
        if cosine <= 0:
            return self._rows
        away = self._middle - origin
        along = away @ (axis / length)
        aside = np.sqrt(np.maximum((away * away).sum(axis=1) - along * along, 0.0))
        beyond = aside * cosine - along * math.sqrt(1 - cosine * cosine)
        return np.flatnonzero(beyond <= self._around)


def cast(shapes: Sequence[Shape], origins: Array, directions: Array) -> Hits:
    """What rays meet first.

    Args:
        shapes: in the frame of the rays, placed in it.
        origins: where rays begin (n, 3) or (3,) [m].
        directions: unit vectors (n, 3).
    """
    return Solids(shapes).cast(origins, directions)


class _Group:
    """Shapes of one kind.

    Attributes:
        middle: where they are (k, 3); of a plane, a point on it.
        around: radii of spheres about them (k,), a little larger than needed.
    """

    def __init__(self, kind: str, shapes: Sequence[Any]) -> None:
        self.kind = kind
        self.middle = np.array([shape.position_m for shape in shapes], dtype=float)
        if kind == "plane":
            normals = np.array([shape.normal for shape in shapes], dtype=float)
            self._up = normals / np.linalg.norm(normals, axis=1, keepdims=True)
            self._above = np.sum(self._up * self.middle, axis=1)[:, None]
            self.around = np.full(len(shapes), np.inf)
            return
        turns = np.repeat([shape.orientation_wxyz for shape in shapes], 3, axis=0)
        # the frame's vectors in the shape's
        into = rotate(turns, np.tile(np.eye(3), (len(shapes), 1))).reshape(-1, 3, 3)
        self._into = np.ascontiguousarray(np.moveaxis(into, 0, 1))
        self._shift = (into @ self.middle[:, :, None]).transpose(1, 0, 2)
        if kind == "box":
            self._half = np.array([shape.size_m for shape in shapes]).T[:, :, None] / 2
            self.around = 1.001 * np.linalg.norm(self._half[:, :, 0], axis=0)
            return
        self._radius = np.array([shape.radius_m for shape in shapes])[:, None]
        self._long = np.array([getattr(shape, "length_m", 0.0) for shape in shapes])[:, None] / 2
        self.around = 1.001 * (self._radius + self._long)[:, 0]

    def stretches(self, starts: Array, directions: Array, rows: Any) -> tuple[Array, Array]:  # noqa: ANN401
        """Distances (k, n) between which rays (3, 1 or n) and (3, n) are inside.

        Where a ray never is, the first is larger than the second, or one of them no number.

        Args:
            starts: where they begin.
            directions: unit vectors.
            rows: which of the shapes (k,), or a slice of them.
        """
        if self.kind == "plane":
            above = self._up[rows] @ starts - self._above[rows]
            down = -(self._up[rows] @ directions)
            near = np.where(down > 0, above / down, np.inf)  # it is entered from above
            return near, np.full(down.shape, np.inf)
        into = self._into[:, rows]
        flat = into.reshape(-1, 3)  # x of all shapes, then y, then z
        o = (flat @ starts).reshape(*into.shape[:2], -1) - self._shift[:, rows]
        d = (flat @ directions).reshape(*into.shape[:2], -1)
        if self.kind == "sphere":
            return _round(o, d, self._radius[rows])
        d += _TINY
        if self.kind == "box":
            return _box(o, d, self._half[:, rows])
        long, radius = self._long[rows], self._radius[rows]
        return (_cylinder if self.kind == "cylinder" else _capsule)(o, d, radius, long)

    def normals(self, row: Indices, place: Array, directions: Array) -> Array:
        """Outward normals (n, 3) at places (n, 3) on the shapes of these rows (n,)."""
        if self.kind == "plane":
            return np.asarray(self._up[row], dtype=float)
        into = self._into[:, row]
        p = np.einsum("inj,nj->ni", into, place - self.middle[row])
        d = np.einsum("inj,nj->ni", into, directions)
        if self.kind == "sphere":
            out = p
        elif self.kind == "box":
            out = _side(p / self._half[:, row, 0].T, d)
        else:
            half, radius = self._long[row, 0], self._radius[row, 0]
            if self.kind == "capsule":
                out = p - np.clip(p[:, 2], -half, half)[:, None] * [0.0, 0.0, 1.0]
            else:
                tube, flat = p * [1.0, 1.0, 0.0], p * [0.0, 0.0, 1.0]
                is_end = np.abs(p[:, 2]) / half > np.linalg.norm(tube, axis=1) / radius
                out = np.where(is_end[:, None], flat, tube)
        out = out / np.sqrt((out * out).sum(axis=1, keepdims=True))
        return np.asarray(np.einsum("inj,ni->nj", into, out), dtype=float)


def _side(p: Array, d: Array) -> Array:
    """The face of a cube of half edge 1 on which places (n, 3) lie, of those that look at a ray."""
    facing = np.where(p * d < 0, np.abs(p), -np.inf)
    at, out = (np.arange(len(p)), facing.argmax(axis=1)), np.zeros_like(p)
    out[at] = p[at]
    return out


def _slab(o: Array, d: Array, half: Array) -> tuple[Array, Array]:
    """Where rays are between two planes across an axis, by their components along it."""
    inverse = 1 / d
    middle = -o * inverse
    np.abs(inverse, out=inverse)
    inverse *= half
    return middle - inverse, middle + inverse


def _box(o: Array, d: Array, half: Array) -> tuple[Array, Array]:
    near, far = _slab(o, d, half)
    return (
        np.maximum(np.maximum(near[0], near[1]), near[2]),
        np.minimum(np.minimum(far[0], far[1]), far[2]),
    )


def _round(o: Array, d: Array, radius: Array) -> tuple[Array, Array]:
    """Where rays (3, k, n) are inside spheres about the origin: from, to (k, n)."""
    along = -(o * d).sum(axis=0)
    beside = o + along * d
    return _within(along, radius**2 - (beside * beside).sum(axis=0))


def _tube(o: Array, d: Array, radius: Array) -> tuple[Array, Array]:
    """The same for endless cylinders along z."""
    (x, y, _), (u, v, _) = o, d
    across = u * u + v * v
    beside = x * v - y * u
    return _within(-(x * u + y * v) / across, (radius**2 - beside * beside / across) / across)


def _within(along: Array, inside: Array) -> tuple[Array, Array]:
    half = np.sqrt(inside)  # no number for a ray that passes by
    return along - half, along + half


def _cylinder(o: Array, d: Array, radius: Array, long: Array) -> tuple[Array, Array]:
    (near, far), (under, over) = _tube(o, d, radius), _slab(o[2], d[2], long)
    return np.maximum(near, under), np.minimum(far, over)


def _capsule(o: Array, d: Array, radius: Array, long: Array) -> tuple[Array, Array]:
    parts = [_cylinder(o, d, radius, long)]
    for end in (-long, long):
        moved = o.copy()
        moved[2] -= end
        parts.append(_round(moved, d, radius))
    # together they are convex, so where a ray is in one of them it is in one stretch
    near = np.minimum.reduce([np.where(n <= f, n, np.inf) for n, f in parts])
    return near, np.full(near.shape, np.inf)
