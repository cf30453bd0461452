"""What an ideal range sensor of many zones reads: through an engine's rays, or through ours.

A sensor looks along its x axis, y is to its left, z up. It reads distances along this axis, not
along the ray, so that a wall across it is equally far in all zones.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from simcompare.engine.kinematics import placed_on
from simcompare.engine.ray_scene import RayScene
from simcompare.model.rotations import rotate
from simcompare.model.scenario import Scenario
from simcompare.model.sensor import Sensor
from simcompare.model.shapes import Vector
from simcompare.model.trajectory import Array

#: half of the angle of view, from left to right and from top to bottom: VL53L5CX, DS13754, Table 2
HALF_VIEW_RAD = math.radians(22.5)
#: of a sensor that says nothing of it: VL53L5CX, DS13754, Table 1
REACH_M = 4.0
#: an engine's way to cast rays, as ``EngineHooks.cast_rays``
Cast = Callable[[Vector, Array, str, float], Sequence[float] | Array]


@functools.lru_cache
def zone_rays(zones: int, geometry: str = "equal_angle", in_a_row: int = 1) -> Array:
    """Where the rays of each zone go, in the sensor's frame, until 1 m along its axis.

    Args:
        zones: in a row, and rows.
        geometry: "equal_angle", zones are as wide in angle; "rectilinear": in a plane before it.
        in_a_row: rays in a row of a zone, and rows of them.

    Returns:
        Rays (zones², in_a_row², 3), their x is 1. Zones along rows from the left, from the top, and
        so the rays in a zone.
    """
    count = zones * in_a_row
    part = 1 - (2 * np.arange(count) + 1) / count  # from the left to the right, from the top down
    if geometry == "equal_angle":
        across = np.tan(part * HALF_VIEW_RAD)
    else:
        across = part * math.tan(HALF_VIEW_RAD)
    cells = across.reshape(zones, in_a_row)
    row, column, up, left = np.meshgrid(
        range(zones), range(zones), range(in_a_row), range(in_a_row), indexing="ij"
    )
    rays = np.stack((np.ones(row.shape), cells[column, left], cells[row, up]), axis=-1)
    found = rays.reshape(zones**2, in_a_row**2, 3)
    found.setflags(write=False)
    return found


def middle_rays(zones: int, geometry: str = "equal_angle") -> tuple[Array, Array]:
    """Unit vectors (zones², 3) in the middle of each zone, and how long they are until x = 1."""
    rays = zone_rays(zones, geometry)[:, 0]
    lengths = np.linalg.norm(rays, axis=1)
    return rays / lengths[:, None], lengths


def rays_of(sensor: Sensor) -> tuple[Array, Array]:
    """The same of a sensor."""
    assert sensor.zones is not None
    return middle_rays(sensor.zones, sensor.geometry or "equal_angle")


def read_through(
    cast: Cast, scenario: Scenario, sensor: Sensor, signals: Mapping[str, Array]
) -> Array:
    """Ranges (1, zones²) [m] through an engine's own rays, at the one sample of the signals."""
    reach_m = sensor.reach_m or REACH_M
    place, turn = placed_on(scenario, sensor, 1, signals)
    rays, lengths = rays_of(sensor)
    x, y, z = place[0].tolist()
    along = rotate(np.repeat(turn, len(rays), axis=0), rays)
    found = cast((x, y, z), along, sensor.body or "", reach_m * float(lengths.max()))
    return np.minimum(np.asarray([found]) / lengths, reach_m)


def ranges(
    scenario: Scenario, sensor: Sensor, time_s: Array, signals: Mapping[str, Array]
) -> Array:
    """Ranges (n, zones²) [m] through our own rays, from the motion of all bodies."""
    place, turn = placed_on(scenario, sensor, len(time_s), signals)
    rays, lengths = rays_of(sensor)
    along = rotate(np.repeat(turn, len(rays), axis=0), np.tile(rays, (len(place), 1)))
    seen = RayScene(scenario, sensor.body or "")
    found = seen.distances(place, along.reshape(len(place), -1, 3), signals)
    return np.minimum(found / lengths, sensor.reach_m or REACH_M)
