"""Tosses replayed in an engine, and the friction and restitution with which they land best.

Every toss starts where its own flight says and is stepped through the same backend as any other
run. What is fitted is the mean distance of the eight corners over all samples and tosses, in which
place and turn are one length. It is not smooth: a box that falls on another face is a jump. So a
search on a grid that is halved finds the parameters, and tosses that it did not see tell the error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simcompare.engine import engines
from simcompare.errors import InputError, SimcompareError
from simcompare.fitting.tosses.tosses import Errors, Start, Toss, errors, start_of
from simcompare.model.settings import Settings
from simcompare.scenarios.scenario_file import ScenarioFile

#: longest step of a replay [s]
STEP_S = 5.0e-4
#: draws of the bootstrap, and the part of them inside an interval
DRAWS, INSIDE = 2000, 0.95

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Interval:
    """A mean over tosses.

    Attributes:
        mean: over the tosses.
        sd: standard deviation over them, with n in the denominator as in published tables.
        low: lower end of the 95 % interval of the mean (percentiles of a bootstrap over tosses).
        high: upper end.
    """

    mean: float
    sd: float
    low: float
    high: float


@dataclass(frozen=True)
class Found:
    """Parameters that a search found.

    Attributes:
        engine: where they were found.
        values: parameter -> value.
        spacing: parameter -> spacing of the last grid.
        cost: mean distance of the corners there [% of the width].
        tried: every point and its cost, in the order of the search.
    """

    engine: str
    values: Mapping[str, float]
    spacing: Mapping[str, float]
    cost: float
    tried: tuple[tuple[Mapping[str, float], float], ...] = field(repr=False, default=())


def replay(
    file: ScenarioFile, engine: str, toss: Toss, values: Mapping[str, float], *, contact: str
) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) and orientations (n, 4) of an engine at the samples of a toss.

    The recorded step is a whole part of the time between samples, so nothing is interpolated.

    Args:
        file: a scenario with a body ``cube`` and parameters of its start.
        engine: name of the engine.
        toss: what is replayed.
        values: parameters that differ from the file.
        contact: contact level.

    Raises:
        InputError: samples that are not evenly spaced.
    """
    gaps = np.diff(toss.time_s)
    spacing = float(gaps.mean())
    if np.abs(gaps - spacing).max() > 1e-6 * spacing:
        raise InputError(toss.name, ["its samples are not evenly spaced"])
    known = {name: parameter.value for name, parameter in file.parameters.items()} | dict(values)
    start = start_of(toss, known["width_m"], known["gravity_m_s2"])
    parts = math.ceil(spacing / STEP_S - 1e-9)
    told = {**values, **parameters_of(start), "duration_s": float(toss.time_s[-1])}
    scenario = file.resolve(told, step_s=spacing / parts)
    found = engines.get(engine).simulate(scenario, Settings(contact)).signals
    rows = slice(0, parts * len(toss.time_s), parts)
    return found["cube.position_m"][rows], found["cube.orientation_wxyz"][rows]


def parameters_of(start: Start) -> dict[str, float]:
    """A start as the scenario's parameters."""
    parts = (
        ("start_{}_m", "xyz", start.position_m),
        ("start_orientation_{}", "wxyz", start.orientation_wxyz),
        ("start_velocity_{}_m_s", "xyz", start.velocity_m_s),
        ("start_rate_{}_rad_s", "xyz", start.rate_rad_s),
    )
    return {
        name.format(axis): float(value)
        for name, axes, held in parts
        for axis, value in zip(axes, held, strict=True)
    }


def errors_of(
    file: ScenarioFile,
    engine: str,
    tosses: Sequence[Toss],
    values: Mapping[str, float],
    *,
    contact: str = "assisted",
) -> list[Errors]:
    """Errors of all tosses in an engine."""
    width = values.get("width_m", file.parameters["width_m"].value)
    return [
        errors(toss, *replay(file, engine, toss, values, contact=contact), width) for toss in tosses
    ]


def interval(values: Sequence[float], seed: int = 0) -> Interval:
    """Mean over tosses with its interval, by a bootstrap over the tosses."""
    held = np.asarray(values, dtype=float)
    drawn = np.random.default_rng(seed).integers(0, len(held), (DRAWS, len(held)))
    low, high = np.quantile(held[drawn].mean(axis=1), ((1 - INSIDE) / 2, (1 + INSIDE) / 2))
    return Interval(float(held.mean()), float(held.std()), float(low), float(high))


def fit(
    file: ScenarioFile,
    engine: str,
    tosses: Sequence[Toss],
    start: Mapping[str, float],
    spacing: Mapping[str, float],
    bounds: Mapping[str, tuple[float, float]],
    *,
    halvings: int = 3,
    fixed: Mapping[str, float] | None = None,
    progress: Progress | None = None,
) -> Found:
    """The parameters with which tosses land best, by a grid that is halved.

    Neighbours along each axis are tried until none is better, then the grid is halved.

    Args:
        file: the scenario.
        engine: name of the engine.
        tosses: those that are fitted.
        start: parameter -> value of the first point.
        spacing: parameter -> spacing of the first grid.
        bounds: parameter -> smallest and largest value.
        halvings: how often the grid is halved.
        fixed: other parameters that differ from the file.
        progress: called with a line for every point.

    Raises:
        InputError: the engine fails at the first point.
    """
    tried: dict[tuple[float, ...], float] = {}
    names = list(start)

    def cost(point: tuple[float, ...]) -> float:
        if point not in tried:
            values = {**(fixed or {}), **dict(zip(names, point, strict=True))}
            try:
                found = errors_of(file, engine, tosses, values)
                tried[point] = float(np.mean([one.corners for one in found]))
            except SimcompareError as error:
                if not tried:
                    raise InputError(f"fit of {file.name}, {engine}", [str(error)]) from None
                tried[point] = math.inf  # the engine cannot; others can be better
            if progress is not None:
                told = ", ".join(f"{n} {v:.4g}" for n, v in zip(names, point, strict=True))
                progress(f"{engine}: {told}: {tried[point]:.2f} %")
        return tried[point]

    best = tuple(start[name] for name in names)
    step = [spacing[name] for name in names]
    for halving in range(halvings + 1):
        while True:
            around = _neighbours(best, step, [bounds[name] for name in names])
            nearest = min(around, key=cost)
            if cost(nearest) >= cost(best):
                break
            best = nearest
        if halving < halvings:
            step = [one / 2 for one in step]
    points = tuple((dict(zip(names, p, strict=True)), c) for p, c in tried.items())
    return Found(
        engine, dict(zip(names, best, strict=True)), dict(zip(names, step, strict=True)),
        cost(best), points,
    )  # fmt: skip


def _neighbours(
    point: tuple[float, ...], step: Sequence[float], bounds: Sequence[tuple[float, float]]
) -> list[tuple[float, ...]]:
    found = []
    for i, (size, (low, high)) in enumerate(zip(step, bounds, strict=True)):
        for side in (-1, 1):
            value = round(min(max(point[i] + side * size, low), high), 9)
            if value != point[i]:
                found.append((*point[:i], value, *point[i + 1 :]))
    return found
