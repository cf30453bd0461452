"""What an engine's bounces show beside those of the closed form, over the phases of its step."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare import measures
from simcompare.errors import InputError
from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.bounce_models import MODELS, Bounces
from simcompare.fitting.bounces.roles import Roles
from simcompare.model.scenario import Measure, Scenario
from simcompare.model.trajectory import TRUTH, Array, Trajectory

#: impacts after the measured ones that the closed form goes on for
_MORE = 3
#: what a camera and a clock add to the closed form; a simulation has none of it
NO_CLOCK = {"release_time_s": 0.0, "clock_skew": 0.0, "floor_m": 0.0, "scale": 1.0}


@dataclass(frozen=True)
class Deviation:
    """What simulations of one drop showed beside the closed form.

    Attributes:
        late_s: impact time less that of the closed form, mean over the dithers (K,) [s].
        scatter_s: its standard deviation over the dithers (K,) [s].
        higher_m: height of the apexes less those of the closed form (K + 1,) [m].
        restitution: effective restitution of each impact, mean over the dithers (K,).
        u_restitution: its standard deviation over the dithers (K,).
        times_s: impact times of the middle drop (K,) [s].
    """

    late_s: Array
    scatter_s: Array
    higher_m: Array
    restitution: Array
    u_restitution: Array
    times_s: Array


@dataclass(frozen=True)
class RunDeviation:
    """The same for one simulation, beside the closed form at its own drop height."""

    late_s: Array
    higher_m: Array
    restitution: Array
    times_s: Array
    penetration_m: float


def scenes(
    roles: Roles,
    closed: Mapping[str, Array | float],
    step_s: float | None,
    duration_s: float,
    count: int,
) -> list[Scenario]:
    """One drop, dithered in height over what it falls in one step at its first impact.

    Args:
        roles: the scenario.
        closed: parameters of the closed form.
        step_s: time between samples; the scenario's own where ``None``.
        duration_s: simulated time.
        count: number of dithers; the undithered one is in their middle.
    """
    values = roles.values(closed)
    nominal = roles.file.resolve(values, step_s=step_s)
    step, height = nominal.world.step_s, values[roles.height]
    gravity = float({**bounce_models.DEFAULTS, **closed}["gravity_m_s2"])
    span = math.sqrt(2 * gravity * height) * nominal.world.engine_step_s
    found = []
    for i in range(count):
        moved = height + (i - count // 2) / count * span
        scene = roles.file.vary(nominal, roles.height, moved) if i != count // 2 else nominal
        lasts = math.ceil(duration_s / step - 1e-9) * step
        world = scene.world.model_copy(update={"duration_s": lasts})
        found.append(scene.model_copy(update={"world": world}))
    return found


def ends_s(closed: Mapping[str, Array | float], count: int) -> float:
    """Time from release to the apex after so many impacts [s]."""
    found = bounce_models.bounces(MODELS["constant"], {**closed, **NO_CLOCK}, count)
    return float(np.ravel(found.apex_s)[-1])


def measure_of(scene: Scenario) -> Measure:
    """The measure of a scene that sees bounces.

    Raises:
        InputError: it has none.
    """
    for measure in scene.measures:
        if measure.function == "bounces":
            return measure
    raise InputError(scene.name, ["has no measure of bounces; expected one with function: bounces"])


def deviation_of(
    roles: Roles, closed: Mapping[str, Array | float], scene: Scenario, run: Trajectory, count: int
) -> RunDeviation:
    """One run beside the closed form, both seen by the same measure.

    Args:
        roles: the scenario.
        closed: parameters of the closed form, with a constant restitution.
        scene: the drop, whose height may be dithered.
        run: what the engine did.
        count: impacts that were measured.
    """
    own = {**closed, **NO_CLOCK, "drop_height_m": scene.parameters[roles.height],
           "restitution": scene.parameters[roles.restitution]}  # fmt: skip
    measure = measure_of(scene)
    deviation = measures.take(measure, scene, run)
    true = measures.take(measure, scene, _sampled(own, scene, measure, run, count))
    ours, theirs = deviation.series, true.series
    found = []
    for name in ("impact_time", "rebound_height", "restitution"):
        common = min(len(ours[name]), len(theirs[name]))
        found.append(ours[name][:common] - theirs[name][:common])
    late, higher, shows = found
    # the measure errs alike on both, so the closed form's own restitution replaces what it shows
    shows = shows + scene.parameters[roles.restitution]
    return RunDeviation(
        late, higher, shows, ours["impact_time"], deviation.values["penetration"] or 0.0
    )


def _sampled(
    own: Mapping[str, Array | float], scene: Scenario, measure: Measure, run: Trajectory, count: int
) -> Trajectory:
    """The closed form as the probe of a measure sees it, at the samples of a run."""
    probe = scene.probes[measure.probe]
    found = bounce_models.bounces(MODELS["constant"], own, count + _MORE)
    flight = np.searchsorted(found.impact_s, run.time_s)
    height = bounce_models.height_at(found, own, run.time_s, flight)
    signal = np.zeros_like(run.signals[probe.observe])
    column = signal[:, probe.component] if signal.ndim == 2 else signal
    column[...] = np.maximum(height, 0.0) - probe.offset
    return Trajectory(TRUTH, run.time_s, {probe.observe: signal})


def mean_deviation(parts: Sequence[RunDeviation], count: int, *, whole: bool) -> Deviation:
    """Mean over the dithers.

    Args:
        parts: one for each dither.
        count: impacts that were measured.
        whole: whether all of them must be there; else those that every dither resolves are told.

    Raises:
        InputError: the engine shows fewer impacts than were measured, or none.
    """
    fewest = min(len(part.late_s) for part in parts)
    least = min(count, *(len(part.restitution) for part in parts))
    if fewest < count if whole else not least:
        raise InputError(
            "fit", [f"only {fewest} impacts are seen in the simulation, {count} were measured"]
        )
    count = min(count, fewest)
    late = np.stack([part.late_s[:count] for part in parts])
    higher = np.stack(
        [np.pad(p.higher_m[:count], (0, max(0, count - len(p.higher_m)))) for p in parts]
    )
    restitution = np.stack([part.restitution[:least] for part in parts])
    ddof = 1 if len(parts) > 1 else 0
    return Deviation(
        late.mean(axis=0), late.std(axis=0, ddof=ddof),
        np.concatenate(([0.0], higher.mean(axis=0))),
        restitution.mean(axis=0), restitution.std(axis=0, ddof=ddof),
        parts[len(parts) // 2].times_s[:count],
    )  # fmt: skip


def uneven(shown: Sequence[Deviation]) -> float:
    """How an engine's restitution changes from impact to impact, as a standard uncertainty.

    It is the same at every phase of the step and at every height, so that no repeat tells it.
    """
    every = np.concatenate([deviation.restitution for deviation in shown])
    return float(every.std(ddof=1)) if len(every) > 1 else 0.0


def engine_bounces(closed: Bounces, deviation: Deviation) -> Bounces:
    """Bounces of an engine: those of the closed form, moved by what it shows beside it."""
    later = np.append(deviation.late_s[1:], deviation.late_s[-1])
    between = np.concatenate(([0.0], (deviation.late_s + later) / 2))
    return replace(
        closed,
        impact_s=closed.impact_s + deviation.late_s,
        apex_s=closed.apex_s + between,
        apex_m=closed.apex_m + deviation.higher_m,
    )
