"""Rays of range sensors in a replay: where they begin and how they go, and how far at each time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from simcompare.engine.range_sensing import REACH_M, zone_rays
from simcompare.model.drawing import DrawnBody, DrawnEye
from simcompare.model.rotations import rotate
from simcompare.model.trajectory import Array, Trajectory
from simcompare.reports.render.replays import Actor, Eye

Indices = NDArray[np.int_]


def eyes_of(
    scene: Mapping[str, DrawnBody], looking: Mapping[str, DrawnEye]
) -> Iterator[tuple[str, Eye]]:
    """The sensors on bodies that can be seen."""
    for name, eye in looking.items():
        body = scene.get(eye.body)
        if body is None:
            continue
        origin = np.array([eye.position_m])
        rays = zone_rays(eye.zones, eye.geometry or "equal_angle")[:, 0]
        rays = _turned(eye.orientation_wxyz, rays)
        if body.fixed:
            origin = _turned(body.orientation_wxyz, origin) + body.position_m
            rays = _turned(body.orientation_wxyz, rays)
        yield name, Eye("" if body.fixed else eye.body, origin[0], rays, eye.reach_m or REACH_M)


def ranges_of(
    eyes: Mapping[str, Eye], trajectory: Trajectory, samples: Indices
) -> Iterator[tuple[str, Array]]:
    """How far the rays go that a source tells of, at some of its samples."""
    for name, eye in eyes.items():
        told = trajectory.signals.get(f"{name}.range_m")
        moved = not eye.body or f"{eye.body}.position_m" in trajectory.signals
        if told is not None and moved:
            seen = told[samples]
            yield name, np.where(seen < eye.reach_m, seen, np.nan)


def widened(
    low: Array, high: Array, actors: Sequence[Actor], eyes: Mapping[str, Eye]
) -> tuple[Array, Array]:
    """Lowest and highest corner of a picture in which most sources' rays end."""
    ends = [
        actor.ray_ends(name, eyes[name]).reshape(-1, 3) for actor in actors for name in actor.ranges
    ]
    met = [places[np.isfinite(places[:, 0])] for places in ends]
    met = [places for places in met if len(places)]
    if not met:
        return low, high
    lows, highs = ([end(places, axis=0) for places in met] for end in (np.min, np.max))
    return np.minimum(low, np.median(lows, axis=0)), np.maximum(high, np.median(highs, axis=0))


def _turned(orientation_wxyz: Sequence[float], vectors: Array) -> Array:
    return rotate(np.tile(orientation_wxyz, (len(vectors), 1)), vectors)
