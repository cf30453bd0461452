"""The same for what swings, rises and turns: responses, periods, motors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.engine.scripting.text import number
from simcompare.exporters.scripts.measuring import Measuring, Snippet, Truth
from simcompare.model.scenario import Measure


def _list(values: object) -> str:
    return f"np.array({[float(f'{value:.9g}') for value in np.asarray(values, dtype=float)]})"


def _response(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    if truth.first is None:
        return {}
    probe, base, options = m.probe(measure.probe), m.probe(measure.also["base"]), measure.options
    dwell, settle = number(options["dwell_s"]), number(options["settle_s"])
    m.lines += [
        f"f = {_list(truth.first.series['frequency'])}",
        "ratio = []  # of the reading to the acceleration of the base, by least squares",
        "for k, omega in enumerate(2 * np.pi * f):",
        f"    i = (t > k * {dwell} + {settle} - 1e-9) & (t < (k + 1) * {dwell} - 1e-9)",
        "    s = t[i] - t[i].mean()",
        "    waves = np.column_stack((np.cos(omega * s), np.sin(omega * s), np.ones(len(s)), s))",
        f"    fits = np.linalg.lstsq(waves, np.column_stack(({probe}[i], {base}[i])))[0]",
        "    read, moved = fits[0] - 1j * fits[1]",
        f"    still = np.ptp({base}[i]) < 1e-15  # but for rounding",
        f"    felt = -{number(options['gain'])} * read / omega**2 / moved",
        "    ratio.append(np.nan if still else felt)",
    ]
    return _judged(m, truth)


def _sweep(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    if truth.first is None:
        return {}
    probe, base, options = m.probe(measure.probe), m.probe(measure.also["base"]), measure.options
    first, last = number(options["first_Hz"]), number(options["last_Hz"])
    taper = number(options["taper_s"])
    m.lines += [
        f"f = np.geomspace({first}, {last}, {round(options['count'])})",
        f"u = np.clip((t - t[-1] + {taper}) / {taper}, 0, 1)  # both fade out at the end",
        "fade = 1 - u**4 * (35 - 84 * u + 70 * u**2 - 20 * u**3)",
        f"slope = -140 * u**3 * (1 - u) ** 3 / {taper}",
        f"bend = -420 * u**2 * (1 - u) ** 2 * (1 - 2 * u) / {number(options['taper_s'] ** 2)}",
        "omega = 2 * np.pi * f",
        "waves = np.exp(-1j * omega[:, None] * t)",
        f"read = {number(options['gain'])} * waves @ (fade * ({probe} - {probe}[0]))",
        f"moved = {base} - {base}[0]",
        "shaken = waves @ (bend * moved) - 2j * omega * (waves @ (slope * moved))",
        "ratio = read / (shaken - omega**2 * (waves @ (fade * moved)))",
        f"ratio = np.where(np.ptp({base}) < 1e-15, np.nan, ratio)  # it moves but for rounding",
    ]
    return _judged(m, truth)


def _judged(m: Measuring, truth: Truth) -> Mapping[str, str]:
    assert truth.first is not None
    series, count = truth.first.series, int(truth.first.values["judged_frequencies"] or 0)
    m.lines += [
        "size, angle = abs(np.array(ratio)), np.degrees(np.angle(ratio))",
        f"true = {_list(series['amplitude'][:count])}",
        f"size_error = abs(size[:{count}] / true - 1)",
        f"true = {_list(series['phase'][:count])}",
        f"turned_by = angle[:{count}] - true",
        "below = np.append(np.flatnonzero(size < 0.5**0.5), 0)[0]  # the cutoff is just before it",
        "near = slice(max(below - 2, 0), max(below - 2, 0) + 3)",
        "missing = np.maximum(size[near], 1e-9) ** -2.0 - 2",
        "root = np.roots(np.polyfit(f[near] ** 2, missing, 2) if below else [1.0]) ** 0.5",
        "root = root.real[(root.real >= f[below - 1]) & (root.real <= f[below])]",
        "cutoff = root[0] if below and root.size else np.nan",
    ]
    return {
        "amplitude_error": "size_error.max()",
        "phase_error": "abs((turned_by + 180) % 360 - 180).max()",
        "cutoff_frequency": "cutoff",
        "judged_frequencies": "int(np.isfinite(turned_by).sum())",
    }


def _swings(m: Measuring, measure: Measure) -> None:
    """Passages and turning points, once for all measures of the same probe."""
    angle = m.probe(measure.probe)
    line = "passes = t[up] - away[up] * np.diff(away)[up] ** -1 * t[1]"
    if line in m.lines:
        return
    level = measure.options["level"]
    shifted = f" - {number(level)}" if level else ""
    m.lines += [
        *([f"away = {angle}{shifted}"] if shifted or angle != "away" else []),
        "up = np.flatnonzero(away[:-1] * away[1:] <= 0)  # it passes its rest, up or down",
        line,
    ]


def _tops(m: Measuring) -> None:
    """The largest angle of each half swing, once."""
    line = "tops = np.array([abs(away[a : b + 1]).max() for a, b in zip(up[:-1], up[1:])])"
    if line not in m.lines:
        m.lines.append(line)


def _period(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    del truth
    _swings(m, measure)
    m.lines.append("period = passes[2:] - passes[:-2]")
    found = {"mean_period": "period.mean() if len(period) else np.nan"}
    if m.wanted == {"mean_period"}:
        return found
    _tops(m)
    m.lines += [
        "a, b = np.ones(len(tops)), np.cos(tops / 2)",
        "for _ in range(6):  # the mean of Gauss: a large swing takes 1 / a times as long",
        "    a, b = (a + b) / 2, np.sqrt(a * b)",
        "small = period / ((1 / a[:-1] + 1 / a[1:]) / 2)",
    ]
    return found | {
        "small_angle_period": "small.mean() if len(small) else np.nan",
        "period_scatter": "small.std(ddof=1) if len(small) > 1 else np.nan",
    }


def _decay(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    del truth
    _swings(m, measure)
    _tops(m)
    m.lines.append("swings = (len(tops) - 2) / 2")
    enough = "if len(tops) >= 4 else np.nan"
    return {
        "log_decrement": f"np.log(tops[:2].mean() / tops[-2:].mean()) / swings {enough}",
        "amplitude_loss": f"(tops[:2].mean() - tops[-2:].mean()) / swings {enough}",
    }


def _rise(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    del truth
    way, options = m.probe(measure.probe), measure.options
    start, end = number(options["start_s"]), number(options["end_s"])
    m.lines += [
        f"i = (t > {start} - 1e-9) & (t < {end} + 1e-9)",
        "s = t[i] - t[i][0]",
        "",
        "",
        "def rise(tau):",
        '    """What c + v*t + b*exp(-t/tau) leaves at the best c, v, b, and these."""',
        "    shapes = np.column_stack((np.ones(len(s)), s, np.exp(-s / tau)))",
        f"    best = np.linalg.lstsq(shapes, {way}[i])[0]",
        f"    return np.sum(({way}[i] - shapes @ best) ** 2), best",
        "",
        "",
        "taus = np.geomspace(s[-1] / 1000, s[-1] * 100, 200)",
        "for _ in range(12):  # closer and closer about the best",
        "    best = min(max(np.argmin([rise(tau)[0] for tau in taus]), 1), len(taus) - 2)",
        "    taus = np.geomspace(taus[best - 1], taus[best + 1], 9)",
    ]
    return {"terminal_speed": "rise(taus[4])[1][1]", "time_constant": "taus[4]"}


def _motor_curves(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    del truth
    options, also = measure.options, measure.also
    force, angle = m.probe(measure.probe), m.probe(also["angle"])
    current, voltage = m.probe(also["current"]), m.probe(also["voltage"])
    step_s = m.scenario.world.step_s
    first, last = round(options["start_s"] / step_s), round(options["end_s"] / step_s)
    sections = min(round(options["count"]), last - first)
    m.lines += [
        f"speed = np.gradient({angle}, t, edge_order=2)",
        f"torque = {force} * {number(options['lever_m'])}",
        f"torque = torque + {number(options['inertia_kg_m2'])}"
        " * np.gradient(speed, t, edge_order=2)",
        f"edges = np.linspace({first}, {last}, {sections + 1}).round().astype(int)",
        f"rows = np.array((torque, speed, {current}, {voltage}))",
        "areas = np.cumsum((rows[:, 1:] + rows[:, :-1]) / 2, axis=1)",
        "areas = np.hstack((np.zeros((4, 1)), areas))",
        "torque, speed, amps, volts = np.diff(areas[:, edges], axis=1) / np.diff(edges)",
        "(fall, idle), (growth, idle_amps) = (np.polyfit(torque, y, 1) for y in (speed, amps))",
    ]
    return {
        "no_load_speed": "idle", "no_load_current": "idle_amps", "stall_torque": "-idle / fall",
        "stall_current": "idle_amps - growth * idle / fall",
    }  # fmt: skip


WAVES: Mapping[str, Snippet] = {
    "motor_curves": _motor_curves,
    "response": _response,
    "rise": _rise,
    "sweep_response": _sweep,
    "swing_decay": _decay,
    "swing_period": _period,
}
