"""Motion that follows from a track: an angle about a pivot, a rate of change."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from simcompare import units
from simcompare.errors import InputError
from simcompare.model.frozen import Frozen
from simcompare.model.recording import Channel, Stream
from simcompare.model.trajectory import Array

#: a centre that is less sure than this part of the radius is refused: the arc is too short
_UNSURE = 0.1


class Angle(Frozen):
    """The angle of a line from a pivot to a point, from hanging, and its length: ``angle``.

    It is positive towards +x and counted on through whole turns.

    Attributes:
        of: x and y of the point, in one unit.
        pivot: x and y of the pivot, in that unit in SI; the centre of the circle that fits the
            track best where it is left out.
        down: the direction in which the line hangs; "+y" where y is counted downwards.
    """

    function: Literal["angle"]
    of: Annotated[tuple[str, ...], Field(min_length=2, max_length=2)]
    pivot: tuple[float, float] | None = None
    down: Literal["-y", "+y"] = "-y"

    def names(self) -> tuple[str, ...]:
        """Channels that are needed."""
        return self.of


class Rate(Frozen):
    """How fast channels change, ``…_rate``: the slope between the samples before and after.

    Attributes:
        of: channels.
    """

    function: Literal["rate"]
    of: Annotated[tuple[str, ...], Field(min_length=1)]

    def names(self) -> tuple[str, ...]:
        """Channels that are needed."""
        return self.of


def angle(stream: Stream, channels: Mapping[str, Channel], wish: Angle, where: str) -> Stream:
    """The angle, and the distance from the pivot, as a stream on the same clock."""
    x, y = channels.values()
    if x.unit != y.unit:
        raise InputError(where, [f"{wish.of[0]} is in {x.unit}, {wish.of[1]} in {y.unit}"])
    pivot, u_pivot = (wish.pivot, 0.0) if wish.pivot else _centre(x.values, y.values, where)
    aside = x.values - pivot[0]
    below = (y.values - pivot[1]) * (-1 if wish.down == "-y" else 1)
    radius = np.hypot(aside, below)
    if not np.nanmin(radius) > 0:
        raise InputError(where, ["the point passes the pivot, where it has no angle"])
    turned = np.arctan2(aside, below)
    known = np.isfinite(turned)
    turned[known] = np.unwrap(turned[known])
    u_point = _u_of_point(channels.values(), radius)
    u_rad = float(np.hypot(u_point, u_pivot) / np.nanmedian(radius)) or None
    raw = ", ".join(wish.of)
    suffix = units.suffix_for(x.unit)
    made = {
        "angle_rad": Channel(turned, "rad", "", u_rad, raw=raw),
        f"radius{suffix}": Channel(radius, x.unit, "", u_point or None, raw=raw),
    }
    return replace(stream, channels=made)


def _u_of_point(channels: Iterable[Channel], radius: Array) -> float:
    """Standard uncertainty of a place: as stated, or what its distance scatters by."""
    stated = [float(np.max(c.u)) for c in channels if c.u is not None]
    return max(stated) if stated else float(np.nanstd(radius))


def _centre(x: Array, y: Array, where: str) -> tuple[tuple[float, float], float]:
    """Centre of the circle through a track, and its standard uncertainty."""
    from scipy.optimize import least_squares

    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    if len(x) < 5:
        raise InputError(where, [f"{len(x)} points; expected at least 5 to find the pivot by"])
    # the circle of least squares of x² + y² is near the right one, and a start for it
    table = np.column_stack((x - x.mean(), y - y.mean(), np.ones_like(x)))
    square = table[:, 0] ** 2 + table[:, 1] ** 2
    (a, b, c), *_ = np.linalg.lstsq(table, square, rcond=None)
    start = (a / 2, b / 2, np.sqrt(max(c + (a * a + b * b) / 4, 1e-300)))

    def off(circle: Array) -> Array:
        aside, above = table[:, 0] - circle[0], table[:, 1] - circle[1]
        return np.asarray(np.hypot(aside, above) - circle[2])

    fit = least_squares(off, start, x_scale=np.std(square) ** 0.5 or 1.0)
    scatter = float(np.sqrt(2 * fit.cost / (len(x) - 3)))
    slopes = np.asarray(fit.jac)
    u = scatter * np.sqrt(np.abs(np.diag(np.linalg.pinv(slopes.T @ slopes))[:2]).max())
    if not fit.success or max(u, scatter) > _UNSURE * abs(fit.x[2]):
        raise InputError(
            where,
            [
                f"the track is too short an arc, or too noisy, to tell its centre (u = {u:.2g} of a"
                f" radius of {abs(fit.x[2]):.2g}); measure where the pivot is and write"
                " pivot: [x, y]"
            ],
        )
    return (float(x.mean() + fit.x[0]), float(y.mean() + fit.x[1])), float(u)


def rates(stream: Stream, channels: Mapping[str, Channel]) -> Stream:
    """The rates of channels as a stream on the same clock; none is taken across a gap."""
    made: dict[str, Channel] = {}
    for name, channel in channels.items():
        unit = units.si_of(f"({channel.unit})/s" if channel.unit != "1" else "1/s", "")[2]
        stem = name.removesuffix(units.suffix_for(channel.unit))
        u = None if channel.u is None else _u_of_rate(stream.time_s, channel.u)
        values = _slopes(stream.time_s, channel.values, stream.gaps)
        made[f"{stem}_rate{units.suffix_for(unit)}"] = Channel(
            values, unit, channel.frame, u, raw=name, saturated=channel.saturated
        )
    return replace(stream, channels=made)


def _slopes(time_s: Array, values: Array, gaps: Sequence[int]) -> Array:
    slopes = np.full(len(values), np.nan)
    edges = [0, *(gap + 1 for gap in gaps), len(values)]
    for start, stop in itertools.pairwise(edges):
        if stop - start > 2:
            slopes[start:stop] = np.gradient(values[start:stop], time_s[start:stop], edge_order=2)
    return slopes


def _u_of_rate(time_s: Array, u: float | Array) -> float:
    """Of a slope between two samples, each with its own noise; the largest is told."""
    return float(np.sqrt(2) * np.max(u) / np.median(time_s[2:] - time_s[:-2]))
