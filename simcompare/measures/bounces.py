"""Impacts, restitution, apexes, energy and rest of a body that bounces on a floor at height 0."""

from __future__ import annotations

import itertools
import math

import numpy as np

from simcompare.measures import Measured, Pairs, Request
from simcompare.measures._arcs import Arc, find
from simcompare.model.trajectory import Array, Trajectory

#: impacts whose times are judged; each carries the errors of all before it
TIMED_IMPACTS = 6
#: an impact slower than this part of the first one may be missing
SLOW_PART = 0.2
#: at rest: within this part of the drop height of the final height, for good
REST_PART = 1e-3

#: measured once per event; the rest once per run
SERIES = ("impact_time", "impact_speed", "restitution", "rebound_height")
UNITS = {
    "restitution": "1",
    "impact_time": "s",
    "impact_time_error": "s",
    "impact_speed": "m/s",
    "rebound_height": "m",
    "settling_time": "s",
    "energy_gain": "1",
    "penetration": "m",
    "resolved_bounces": "1",
}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Measures every bounce that the samples resolve.

    Series, one entry per impact: ``impact_time``, ``impact_speed``; one per resolved bounce:
    ``restitution`` (speed after over speed before, both where the arcs cross the floor),
    ``rebound_height``. Values: ``resolved_bounces``, ``energy_gain`` (largest relative gain of
    kinetic energy at a bounce, or of height after the last resolved one; never below 0),
    ``penetration`` (largest depth), ``settling_time``.

    Args:
        trajectory: the source.
        request: its probe sees the height of the lowest point above the floor.
    """
    height = request.observed(trajectory)
    arcs = find(trajectory.time_s, height)
    downs = [arc for arc in arcs if math.isfinite(arc.end_s)]
    bounces = list(itertools.pairwise(arcs))
    restitution = np.array(
        [after.start_speed_m_s / before.end_speed_m_s for before, after in bounces]
    )
    notes: tuple[str, ...] = ()
    if len(arcs) == 1 and downs:
        if _stays_down(trajectory.time_s, height, downs[0]):
            restitution = np.zeros(1)
            notes = ("does not bounce: it never leaves the floor after the first impact",)
        else:
            notes = ("its bounces are too short for the time between samples",)
    times = [(before.end_s + after.start_s) / 2 for before, after in bounces]
    times += [arc.end_s for arc in downs[len(times) :]]
    gains = [*(restitution**2 - 1), _late_gain(trajectory.time_s, height, arcs)]
    return Measured(
        values={
            "resolved_bounces": float(len(bounces)),
            "energy_gain": max(0.0, *map(float, gains)),
            "penetration": max(0.0, -float(height.min())),
            "settling_time": settling_time(trajectory.time_s, height),
        },
        series={
            "impact_time": np.array(times),
            "impact_speed": np.array([arc.end_speed_m_s for arc in downs]),
            "restitution": restitution,
            # an apex after the end of the record is not seen
            "rebound_height": np.array(
                [after.apex_m for _, after in bounces if math.isfinite(after.apex_m)]
            ),
        },
        notes=notes,
    )


def against(measured: Measured, truth: Measured) -> Pairs:
    """What is judged: name -> (value of the source, value of the truth).

    ``restitution`` is the mean over the bounces that both resolve, ``impact_time_error`` the
    largest deviation of the first six impacts as far as both resolve them, unknown (``None``) if
    one is missing that is not slow; ``resolved_bounces`` tells how many the source is short of.
    """
    ours, theirs = measured.series["restitution"], truth.series["restitution"]
    both = min(len(ours), len(theirs))
    pairs: Pairs = {}
    if both:
        pairs["restitution"] = (float(ours[:both].mean()), float(theirs[:both].mean()))
    times, true_times = measured.series["impact_time"], truth.series["impact_time"]
    timed = min(len(times), len(true_times), TIMED_IMPACTS)
    speeds = truth.series["impact_speed"][:TIMED_IMPACTS]
    if len(speeds):
        needed = int(np.count_nonzero(speeds >= SLOW_PART * speeds[0]))
        error = float(np.abs(times[:timed] - true_times[:timed]).max()) if timed >= needed else None
        pairs["impact_time_error"] = (error, 0.0)
    for name in ("settling_time", "energy_gain", "penetration", "resolved_bounces"):
        true_value = truth.values[name]
        if true_value is not None:
            pairs[name] = (measured.values[name], true_value)
    return pairs


def _stays_down(time_s: Array, height_m: Array, fall: Arc) -> bool:
    """Whether no sample after the first impact is above the floor, or it rests where it is."""
    later = height_m[time_s > fall.end_s]
    moves = 1e-6 * float(np.ptp(height_m))
    return bool(len(later) == 0 or later.max() <= moves or np.ptp(later) <= moves)


def _late_gain(time_s: Array, height_m: Array, arcs: list[Arc]) -> float:
    """Relative gain of height after the last resolved flight: what rests must not jump up."""
    if not arcs:
        return 0.0
    later = height_m[time_s > arcs[-1].end_s]
    apex = arcs[-1].apex_m
    return float(later.max()) / apex - 1 if len(later) and math.isfinite(apex) else 0.0


def settling_time(time_s: Array, height_m: Array) -> float | None:
    """Time from which the height stays within 1/1000 of the drop height of its last value [s].

    ``None`` if the record ends while it still moves.
    """
    band = REST_PART * abs(float(height_m[0] - height_m.min()))
    moving = np.flatnonzero(np.abs(height_m - height_m[-1]) > band)
    if len(moving) == 0:
        return float(time_s[0])
    last = int(moving[-1])
    # a record that ends in flight looks still for as long as it stays within the band
    if last + 1 + len(height_m) // 200 >= len(time_s):
        return None
    return float(time_s[last + 1])
