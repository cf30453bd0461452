"""How long each swing of a pendulum takes, and how long a small one would take."""

from __future__ import annotations

import numpy as np

from simcompare.measures import Measured, Pairs, Request, _swings
from simcompare.model.trajectory import Trajectory

SERIES = ("swing_time", "period", "small_period", "swing_amplitude")
OPTIONS = ("level", "band")
AXES = {"period": "swing_time", "small_period": "swing_time", "swing_amplitude": "swing_time"}
UNITS = {
    "swing_time": "s",
    "period": "s",
    "small_period": "s",
    "swing_amplitude": "rad",
    "mean_period": "s",
    "small_angle_period": "s",
    "period_scatter": "s",
}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Periods of all full swings, from one passage through the level to the next but one.

    A swing of amplitude A takes 2·K(sin²(A/2))/π times as long as a small one (K the complete
    elliptic integral of the first kind of the parameter; Landau and Lifshitz, Mechanics, §11).
    Each swing is corrected by that, with the mean over its two halves, so that neither decay from
    half to half nor a level that is a little off counts. Viscous damping lengthens a swing by the
    part (c/2ω)²/2 besides, 10⁻⁵ where it loses 3 % of its angle; that is not taken off.

    Args:
        trajectory: the source, measured or computed; its times need not be even.
        request: its probe sees the angle [rad]; its option ``level`` is the angle of rest, and
            ``band`` what the probe must leave on both sides to count as swinging: more than its
            noise, and smaller swings are not counted.

    Returns:
        Series, one entry for each full swing (they overlap by half): ``swing_time`` at which it
        begins, ``period``, ``small_period``, ``swing_amplitude`` (mean of both halves). Values:
        ``mean_period``, ``small_angle_period``, ``period_scatter`` (standard deviation of
        ``small_period``); ``None`` where there is no full swing, or fewer than two.
    """
    swings = _swings.of(trajectory, request)
    if swings.full == 0:
        return Measured(
            values=dict.fromkeys(("mean_period", "small_angle_period", "period_scatter")),
            series={name: np.array([]) for name in SERIES},
            notes=("makes no full swing",),
        )
    period = swings.passage_s[2:] - swings.passage_s[:-2]
    longer = _swings.lengthening(swings.amplitude)
    small = period / ((longer[:-1] + longer[1:]) / 2)
    # two swings that overlap by half tell little more than one
    scatter = float(small.std(ddof=1) / np.sqrt(len(small) / 2)) if len(small) > 2 else np.nan
    return Measured(
        u={name: scatter for name in ("mean_period", "small_angle_period") if scatter > 0},
        values={
            "mean_period": float(period.mean()),
            "small_angle_period": float(small.mean()) if np.isfinite(small).all() else None,
            "period_scatter": float(small.std(ddof=1))
            if len(small) > 1 and np.isfinite(small).all()
            else None,
        },
        series={
            "swing_time": swings.passage_s[:-2],
            "period": period,
            "small_period": small,
            "swing_amplitude": (swings.amplitude[:-1] + swings.amplitude[1:]) / 2,
        },
    )


def against(measured: Measured, truth: Measured) -> Pairs:
    """What is judged: both mean periods, over the swings that source and truth have in common."""
    common = min(len(measured.series["period"]), len(truth.series["period"]))
    pairs: Pairs = {}
    for name, series in (("mean_period", "period"), ("small_angle_period", "small_period")):
        if truth.values[name] is None:
            continue
        if common == 0 or measured.values[name] is None:
            pairs[name] = (None, float(truth.values[name] or 0.0))
            continue
        ours, theirs = measured.series[series][:common], truth.series[series][:common]
        pairs[name] = (float(ours.mean()), float(theirs.mean()))
    return pairs
