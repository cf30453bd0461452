"""What a report draws of a fit: what is left, e(v), ratios of single bounces, and profiles."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from simcompare.errors import InputError
from simcompare.fitting.bounces import bounce_models, profile, ratios
from simcompare.fitting.bounces.averaging import Averaged
from simcompare.fitting.bounces.deviations import Deviation, engine_bounces
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import NUISANCE, Fit
from simcompare.fitting.bounces.problem import U_ASSUMED_M, U_ASSUMED_S
from simcompare.fitting.bounces.unknowns import base, own_drop
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_forms import Law, ProfileRow, Ratios, Residuals

#: samples of a video whose residuals are kept, speeds of the law, and most profiles
_SAMPLES, _SPEEDS, _PROFILES = 200, 25, 6
#: samples of the height over time
_HEIGHTS = 600


def residuals(fit: Fit, shown: Sequence[Deviation] | None = None) -> tuple[Residuals, ...]:
    """Measured less predicted, for every kind of number of every drop.

    Args:
        fit: with which parameters.
        shown: how an engine differs from the closed form in each drop; ``None`` for the closed
            form itself.
    """
    found = []
    for number, drop in enumerate(fit.problem.drops):
        values = fit.problem.values(fit.x, number)
        closed = fit.problem.bounces(fit.x, number, drop.count)
        ours = closed if shown is None else engine_bounces(closed, shown[number])
        if len(drop.times_s):
            residual = drop.times_s - ours.impact_s[np.array(drop.numbers) - 1]
            found.append(_row(fit, number, "times", drop.numbers, residual, drop.u_s))
        if len(drop.intervals_s):
            after = np.array(drop.interval_numbers)
            residual = drop.intervals_s - (ours.impact_s[after] - ours.impact_s[after - 1])
            begin = drop.interval_numbers
            found.append(_row(fit, number, "intervals", begin, residual, drop.u_intervals_s))
        if len(drop.heights_m):
            residual = drop.heights_m - ours.apex_m[np.array(drop.height_numbers)]
            at = drop.height_numbers
            found.append(_row(fit, number, "heights", at, residual, drop.u_heights_m))
        if drop.track is not None:
            track = drop.track
            heights = bounce_models.height_at(ours, values, track.time_s, track.flight)
            kept = slice(None, None, math.ceil(len(track.time_s) / _SAMPLES))
            at, residual = track.time_s[kept].tolist(), (track.height_m - heights)[kept]
            found.append(_row(fit, number, "track", at, residual, track.u_m[kept]))
    return tuple(found)


def heights(fit: Fit, number: int) -> tuple[Array, Array]:
    """Height of the ball over time as the closed form has it, on the recording's clock and level.

    Args:
        fit: with which parameters.
        number: of the drop, first is 0.
    """
    values = {**bounce_models.DEFAULTS, **fit.problem.values(fit.x, number)}
    found = fit.problem.bounces(fit.x, number, fit.problem.drops[number].count)
    release, last = float(values["release_time_s"]), float(found.apex_s[-1])
    end = release + (1 + float(values["clock_skew"])) * last
    track = fit.problem.drops[number].track
    end = end if track is None else max(end, float(track.time_s[-1]))
    times = np.union1d(np.linspace(release, end, _HEIGHTS), found.impact_s)
    flight = np.searchsorted(found.impact_s, times)
    return times, bounce_models.height_at(found, values, times, flight)


def _row(
    fit: Fit, number: int, kind: str, at: Sequence[float], residual: Array, u: Array
) -> Residuals:
    assumed = U_ASSUMED_M if kind in ("heights", "track") else U_ASSUMED_S
    assumed *= math.sqrt(fit.s2)
    return Residuals(
        drop=number + 1, kind=kind, at=tuple(at), residuals=_row_of(residual),
        u=_row_of(np.where(np.isfinite(u), u, assumed)), stated=bool(np.all(np.isfinite(u))),
        judged=kind == "track" or fit.problem.drops[number].track is None,
    )  # fmt: skip


def _row_of(values: Array) -> tuple[float, ...]:
    return tuple(np.ravel(values).tolist())


def law_of(fit: Fit, told: Averaged) -> Law:
    """Restitution against speed as all closed forms have it, and the speed of every impact."""
    low, high = fit.speeds_m_s
    speeds = np.linspace(low, high, _SPEEDS)
    both = [told.restitution_at(float(speed))[:2] for speed in speeds]
    impacts = []
    for number, drop in enumerate(fit.problem.drops):
        found = fit.problem.bounces(fit.x, number, drop.count)
        impacts.append(_row_of(found.speed_m_s))
    return Law(
        _row_of(speeds), tuple(value for value, _ in both), tuple(u for _, u in both),
        tuple(impacts),
    )  # fmt: skip


def measured_ratios(fit: Fit) -> tuple[Ratios, ...]:
    """Ratios of neighbouring flights, or roots of ratios of heights, and what the fit expects."""
    found = []
    for number, drop in enumerate(fit.problem.drops, start=1):
        try:
            best = ratios.ratios(drop)
            numbers, values, u, how = best.numbers, best.values, best.u, "flight times"
        except InputError:
            numbers, values, u, how = _of_heights(drop)
        if len(numbers):
            closed = fit.problem.bounces(fit.x, number - 1, max(numbers) + 1)
            times, heights = np.ravel(closed.impact_s), np.ravel(closed.apex_m)
            at = np.array(numbers)
            if how == "heights":
                expected = np.sqrt(heights[at] / heights[at - 1])
            else:
                before = times[at - 1] - times[at - 2]
                expected = (times[at] - times[at - 1]) / before
            found.append(
                Ratios(drop=number, how=how, numbers=numbers, values=_row_of(values),
                       expected=_row_of(expected), u=_row_of(u))
            )  # fmt: skip
    return tuple(found)


def _of_heights(drop: Impacts) -> tuple[tuple[int, ...], Array, Array, str]:
    at = np.array(drop.height_numbers, dtype=int)
    pairs = [k for k in range(1, len(at)) if at[k] - at[k - 1] == 1]
    after, before = drop.heights_m[pairs], drop.heights_m[[k - 1 for k in pairs]]
    u_after, u_before = drop.u_heights_m[pairs], drop.u_heights_m[[k - 1 for k in pairs]]
    values = np.sqrt(after / before)
    u = values / 2 * np.hypot(u_after / after, u_before / before)
    return tuple(at[pairs].tolist()), values, u, "heights"


def profiles_of(fit: Fit) -> tuple[ProfileRow, ...]:
    """How χ² rises when one unknown is held and all others make up for it."""
    names = [n for n in fit.found if base(n) not in NUISANCE and own_drop(n) in (None, 0)]
    found = []
    for name in names[:_PROFILES]:
        one = fit.profiles.get(name) or profile.profile(fit, name)
        finite = np.isfinite(one.values)
        order = np.argsort(one.values[finite])
        found.append(
            ProfileRow(name, _row_of(one.values[finite][order]), _row_of(one.chi2[finite][order]),
                       one.low, one.high)
        )  # fmt: skip
    return tuple(found)
