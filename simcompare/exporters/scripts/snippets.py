"""A few lines of numpy for each measure: what a script computes itself."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from simcompare.engine.scripting.text import number
from simcompare.engine.sensing import LAPSE_K_M, PRESSURE_EXPONENT, SEA_LEVEL_K, SEA_LEVEL_PA
from simcompare.engine.simulation import sample_times
from simcompare.exporters.scripts.measuring import Measuring, Snippet, Truth
from simcompare.exporters.scripts.snippets_waves import WAVES
from simcompare.measures import _window
from simcompare.measures.bounces import SLOW_PART, TIMED_IMPACTS
from simcompare.model.scenario import Measure


def _inside(m: Measuring, measure: Measure) -> str:
    """The samples in a measure's window, as a slice."""
    found = _window.samples(sample_times(m.scenario), measure.options)
    count = len(sample_times(m.scenario))
    first = "" if found.start == 0 else str(found.start)
    return f"{first}:{'' if found.stop >= count else found.stop}"


def _final(m: Measuring, measure: Measure, _: Truth) -> Mapping[str, str]:
    return {"final": f"{m.probe(measure.probe)}[-1]"}


def _level(m: Measuring, measure: Measure, _: Truth) -> Mapping[str, str]:
    return {"mean": f"{m.probe(measure.probe)}[{_inside(m, measure)}].mean()"}


def _acceleration(m: Measuring, measure: Measure, _: Truth) -> Mapping[str, str]:
    part = _inside(m, measure)
    seen = m.probe(measure.probe)
    middle = number(float(np.mean([measure.options["start_s"], measure.options["end_s"]])))
    return {"acceleration": f"2 * np.polyfit(t[{part}] - {middle}, {seen}[{part}], 2)[0]"}


def _slip(m: Measuring, measure: Measure, _: Truth) -> Mapping[str, str]:
    part = _inside(m, measure)
    way, angle = m.probe(measure.probe), m.probe(measure.also["angle"])
    radius = number(measure.options["radius_m"])
    m.function("rolled", _ROLLED)
    return {"slip": f"1 - gone({way}[{part}]) / ({radius} * gone({angle}[{part}]))"}


_ROLLED = ("def gone(way):", "    return way[-1] - way[0]")


def _heading(m: Measuring, measure: Measure, _: Truth) -> Mapping[str, str]:
    observed, _width = m.signal(m.scenario.probes[measure.probe].observe)
    m.lines += [
        f"w, x, y, z = {observed}.T",
        "yaw = np.unwrap(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y**2 + z**2)))",
    ]
    return {"heading_drift": "abs(yaw - yaw[0]).max()", "heading_change": "yaw[-1] - yaw[0]"}


def _history(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    if truth.first is None:
        return {}
    seen = m.probe(measure.probe)
    places = _window.evenly(len(sample_times(m.scenario)), measure.options["count"])
    true = _table(m, f"{measure.probe}_true", truth, "history")
    return {"history_error": f"abs({seen}[{_places(m, places)}] - {true}).max()"}


def _places(m: Measuring, places: NDArray[np.intp]) -> str:
    """Places of samples as a slice, if they are even."""
    steps = set(np.diff(places).tolist())
    if len(steps) == 1:
        (step,) = steps
        return ":" if step == 1 else f"::{step}"
    if len(steps) == 0:
        return ":1"
    return m.store("places", np.asarray(places, dtype=float)) + ".astype(int)"


def _table(m: Measuring, name: str, truth: Truth, series: str) -> str:
    """A series of the closed form, in the file of inputs."""
    assert truth.first is not None
    true = np.asarray(truth.first.series[series], dtype=float)
    text = m.store(name, true)
    if truth.last is not None and len(truth.last.series[series]) == len(true):
        change = np.asarray(truth.last.series[series], dtype=float) - true
        if change.any():
            return f"({text} + phase * {m.store(f'{name}_change', change)})"
    return text


def _numbers(truth: Truth, series: str, count: int) -> list[str]:
    """The first numbers of a series of the closed form, as ``true``, which follows the phase."""
    assert truth.first is not None
    first = np.asarray(truth.first.series[series][:count], dtype=float)
    lines = [f"true = np.array({[float(f'{value:.7g}') for value in first]})"]
    if truth.last is not None and len(truth.last.series[series]) >= len(first):
        change = np.asarray(truth.last.series[series][: len(first)], dtype=float) - first
        if change.any():
            lines.append(f"true += phase * np.array({[float(f'{v:.4g}') for v in change]})")
    return lines


def _bounces(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    m.probe(measure.probe, "z")
    bodies = m.scenario.moving_bodies().values()
    dragged = any(body.drag is not None and body.drag.factor_kg_m > 0 for body in bodies)
    count = ":" if truth.first is None else f":{len(truth.first.series['restitution'])}"
    m.lines += [
        "low = np.flatnonzero((z[1:-1] < z[:-2]) & (z[1:-1] <= z[2:])) + 1",
        "flights = [i[2:-1][z[i[2:-1]] > 0] for i in np.split(np.arange(len(z)), low)]",
        "flights = [i for i in flights if len(i) > 11 and np.ptp(z[i]) > 1e-6 * np.ptp(z)]",
        *(_DRAGGED if dragged else _THROWN),
        "e = up[1:] / down[:-1] if len(up) > 1 else np.zeros(1)",
    ]
    found = {"penetration": "max(0, -z.min())", "resolved_bounces": "len(flights) - 1"}
    found["restitution"] = f"e[{count}].mean()"
    found["energy_gain"] = "max(0, (e**2 - 1).max())"
    if "restitution" in m.wanted:
        m.prints.append(f'print("restitution of each impact:", *e[{count}].round(4))')
    if "impact_time_error" in m.wanted and truth.first is not None:
        speeds = truth.first.series["impact_speed"][:TIMED_IMPACTS]
        needed = int(np.count_nonzero(speeds >= SLOW_PART * speeds[0]))
        m.lines += [*([] if dragged else _TIMED), *_numbers(truth, "impact_time", TIMED_IMPACTS)]
        m.lines.append("impacts = np.append((end[:-1] + start[1:]) / 2, end[-1])[: len(true)]")
        error = "abs(impacts - true[: len(impacts)]).max()"
        m.lines.append(f"late = {error} if len(impacts) >= {needed} else np.nan")
        found["impact_time_error"] = "late"
    if "settling_time" in m.wanted:
        m.lines.append("moving = np.flatnonzero(abs(z - z[-1]) > 0.001 * np.ptp(z))")
        late = len(sample_times(m.scenario)) // 200 + 1
        m.lines.append(f"rest_s = t[moving[-1] + 1] if moving[-1] + {late} < len(t) else np.nan")
        found["settling_time"] = "rest_s"
    return found


_THROWN = (
    "curves = np.array([np.polyfit(t[i], z[i], 2) for i in flights])",
    "up = down = np.sqrt(curves[:, 1] ** 2 - 4 * curves[:, 0] * curves[:, 2])  # at the floor",
)
_TIMED = ("start, end = np.sort([np.roots(curve).real for curve in curves]).T",)
#: air drag bends the parabola
_DRAGGED = (
    "ends = []  # of each flight: start, end, speeds at the floor there",
    "for i in flights:",
    "    curve = np.polyfit(t[i] - t[i[0]], z[i], 5)",
    "    roots = np.roots(curve)",
    "    roots = roots.real[abs(roots.imag) < 1e-9]",
    "    span = t[i[-1]] - t[i[0]]",
    "    pair = max(roots[roots <= 0], default=0), min(roots[roots >= span], default=span)",
    "    ends.append((*(t[i[0]] + np.array(pair)), *abs(np.polyval(np.polyder(curve), pair))))",
    "start, end, up, down = np.array(ends).T",
)


def _drift(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    x, y = m.probe(measure.probe), m.probe(measure.also["side"])
    found = {"path_length": f"np.hypot(np.diff({x}), np.diff({y})).sum()"}
    if truth.first is not None:
        places = _places(m, _window.evenly(len(sample_times(m.scenario)), measure.options["count"]))
        pairs = [
            f"{v if places == ':' else f'{v}[{places}]'} - {_table(m, f'{v}_true', truth, s)}"
            for v, s in ((x, "path_x"), (y, "path_y"))
        ]
        m.lines.append(f"apart = np.hypot({', '.join(pairs)})")
        length = number(float(truth.first.values["path_length"] or 1.0))
        found |= {
            "end_error": "apart[-1]", "largest_error": "apart.max()",
            "end_drift": f"apart[-1] / {length}",
        }  # fmt: skip
    return found


def _tilt(m: Measuring, measure: Measure, _: Truth) -> Mapping[str, str]:
    names = (measure.probe, measure.also["left"], measure.also["up"])
    x, y, z = (f"{m.probe(name)}.mean()" for name in names)
    return {
        "pitch": f"np.arctan2(-{x}, np.hypot({y}, {z}))", "roll": f"np.arctan2({y}, {z})"
    }  # fmt: skip


def _pressure_height(m: Measuring, measure: Measure, truth: Truth) -> Mapping[str, str]:
    pressure = m.probe(measure.probe)
    scale, exponent = number(SEA_LEVEL_K / LAPSE_K_M), number(1 / PRESSURE_EXPONENT)
    m.lines.append(f"told = {scale} * (1 - ({pressure} / {number(SEA_LEVEL_PA)}) ** {exponent})")
    found = {"climb": "told[-1] - told[0]"}
    if truth.first is not None:
        places = _window.evenly(len(sample_times(m.scenario)), measure.options["count"])
        true = _table(m, "height_true", truth, "true_height")
        found["height_error"] = f"abs(told[{_places(m, places)}] - {true}).max()"
    return found


def _joint_angle(m: Measuring, measure: Measure, _: Truth) -> Mapping[str, str]:
    options, also = measure.options, measure.also
    angle = m.probe(measure.probe)
    m.function(
        "angle_between",
        (
            "def angle_between(ax, az, bx, bz):",
            '    """Angle by which the second sensor is turned, if both feel the same vector."""',
            "    return np.arctan2(bz * ax - bx * az, ax * bx + az * bz)",
        ),
    )
    sides = ("first", "second")
    first, second = ((m.probe(also[f"{s}_x"]), m.probe(also[f"{s}_z"])) for s in sides)
    m.lines += [
        f"told = angle_between({', '.join((*first, *second))})",
        f"error = abs((told - {angle} + np.pi) % (2 * np.pi) - np.pi)",
    ]
    if "static_error" in m.wanted:
        m.lines.append(f"still = t <= {number(options['still_until_s'])} * (1 + 1e-9)")
    if m.wanted != {"static_error"}:
        m.lines.append(f"moving = t > {number(options['moving_from_s'])} * (1 + 1e-9)")
        m.lines.append("moving[-3:] = False")
    if "corrected_error" in m.wanted and (options["first_lever_m"] or options["second_lever_m"]):
        parts = []
        for side, (x, z) in zip(sides, (first, second), strict=True):
            lever, rate = number(options[f"{side}_lever_m"]), m.probe(also[f"{side}_rate"])
            parts += [f"{x} - np.gradient({rate}, t, edge_order=2) * {lever}"]
            parts += [f"{z} + {rate}**2 * {lever}"]
        m.lines += [
            f"rest = angle_between({', '.join(parts)})",
            f"rest = abs((rest - {angle} + np.pi) % (2 * np.pi) - np.pi)",
        ]
    elif "corrected_error" in m.wanted:
        m.lines.append("rest = error")
    if m.wanted & {"gated_error", "valid_fraction"}:
        g = number(options["gravity_m_s2"])
        gate = number(options["gate"] * options["gravity_m_s2"])
        m.lines += [
            f"valid = abs(np.hypot({', '.join(first)}) - {g}) < {gate}",
            f"valid &= abs(np.hypot({', '.join(second)}) - {g}) < {gate}",
        ]
    return {
        "static_error": "error[still].max()", "moving_error": "error[moving].max()",
        "corrected_error": "rest[moving].max()", "gated_error": "error[moving & valid].max()",
        "valid_fraction": "valid[moving].mean()",
    }  # fmt: skip


SNIPPETS: Mapping[str, Snippet] = {
    "acceleration": _acceleration,
    "bounces": _bounces,
    "drift": _drift,
    "final": _final,
    "heading": _heading,
    "history": _history,
    "joint_angle_estimate": _joint_angle,
    "level": _level,
    "pressure_height": _pressure_height,
    "slip": _slip,
    "tilt": _tilt,
    **WAVES,
}
