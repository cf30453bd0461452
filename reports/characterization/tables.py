"""The answers of the experiments as tables, for the page and the terminal."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from simcompare.characterization.bounce import BounceQuestion
from simcompare.characterization.friction import LOAD
from simcompare.reports.characterization.figures import LEVELS
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table, of_engines

Record = Mapping[str, Any]
Row = Mapping[str, Any]
#: parts below this are rounding
_ROUNDING = 5e-6

_HEADS = {
    "bounce": ("Restitution ± s", "Bounces down to (m/s)", "Hops on at (m/s)",
               "1 % too large at (ms)", "1 % too small at (ms)", "Gains energy beyond (ms)"),
    "friction": ("Lets go at (× µ·N)", "Creeps (mm/s)", "Sinks (mm)", "Braked (× µ·g)"),
    "joint": ("Damping", "With armature", "Inertia", "Frequency", "Damping ratio"),
    "force": ("Rest: off (%)", "Rest: jitter (%)", "Slides: jitter (%)", "Pushed weld: off (%)",
              "Shaken weld: off (%)"),
}  # fmt: skip
_ASKED = BounceQuestion("", 0.0)
_NOTES = {
    "bounce": (
        f"Restitution at {_ASKED.speed_m_s:g} m/s, {_ASKED.restitution:g} wanted: mean ± standard"
        " deviation over 25 phases of the step; a drop that does not bounce counts as 0. Down to:"
        " slower impacts give back less than half; some engines have a threshold of their own,"
        " which simcompare doctor tells. Hops on: the ball never comes to rest, since slower"
        " impacts gain in the mean and faster ones lose; sought down to 3.5·g·dt. Too large, too"
        " small: steps between 0.25 and 8 ms at which the mean is off by more, with the number"
        " held; a step without < or > is the one of the table itself. Gains energy: the longest"
        " step up to which no phase gives more than 1."
    ),
    "friction": (
        "By Coulomb a block sticks up to a load along the plane of µ·N, the coefficient of friction"
        " times the normal force, and one that slides is braked by µ·g: 1 is right. Creep and"
        f" sinking: under {LOAD:g} of that load, after 0.4 s. Braked: mean deceleration from 1 m/s."
        " “>” is more than was tried."
    ),
    "joint": "Each over its closed form, which is 1; “held”: the joint does not move.",
    "force": "Mean over the truth, and standard deviation in parts of the truth.",
}


def of(record: Record, experiment: str) -> Table:
    """What engines answered to an experiment, a group for each level."""
    groups = []
    for level in record["contact"]:
        rows = tuple(
            (answer["engine"], *_cells(experiment, answer))
            for answer in record["answers"]
            if (answer["experiment"], answer["contact"]) == (experiment, level)
        )
        groups.append(Group(LEVELS[level], rows))
    columns = [Column(head) for head in _HEADS[experiment]]
    return of_engines(columns, groups, _NOTES[experiment])


def reasons(record: Record, experiment: str) -> list[str]:
    """Why something was not answered, each reason once, with whose and at which levels."""
    found: dict[tuple[str, str], list[str]] = {}
    for answer in record["answers"]:
        if answer["experiment"] != experiment:
            continue
        lacking = (answer["found"] or {}).get("lacks", {}).values()
        for reason in dict.fromkeys([answer["reason"], *lacking]):
            if reason:
                found.setdefault((answer["engine"], reason), []).append(answer["contact"])
    return [
        f"{name}, {', '.join(levels)}: {why.removeprefix(f'{name}: ')}"
        for (name, why), levels in found.items()
    ]


def _cells(experiment: str, answer: Row) -> Sequence[str]:
    if answer["found"] is None:
        return ["–"] * (len(_HEADS[experiment]) - 1) + [answer["status"]]
    return _CELLS[experiment](answer["found"])


def _bounce(found: Row) -> Sequence[str]:
    rows = found["over_speed"]
    row = min(rows, key=lambda one: abs(one["speed_m_s"] - _ASKED.speed_m_s))
    dies = found["dies_below_m_s"]
    slowest = (
        f"≤ {numbers.plain(found['slowest_m_s'], 2)}" if dies is None else numbers.plain(dies, 2)
    )
    if dies is not None and dies >= rows[-1]["speed_m_s"]:
        slowest = "never"
    return (
        numbers.with_u(row["mean"], row["scatter"], digits=4),
        slowest,
        numbers.plain(found["hops_at_m_s"], 1),
        _steps(found["too_large"]),
        _steps(found["too_small"]),
        _thousandfold(found["gains_above_s"]),
    )


def _friction(found: Row) -> Sequence[str]:
    at_load = next(row for row in found["creep"] if row["load"] == LOAD)
    braked = next(row for row in found["braking"] if row["speed_m_s"] == 1.0)
    lets_go = found["lets_go_at"]
    return (
        "> 4" if lets_go is None else f"{lets_go:.3f}",
        _small(_times(1e3, at_load["creep_m_s"], abs), 1e-6),
        _small(_times(1e3, at_load["sinks_m"]), 5e-4),
        "at once" if braked["stops_at_once"] else _digits(braked["braking"]),
    )


def _joint(found: Row) -> Sequence[str]:
    names = ("damping", "damping_with_armature", "inertia", "frequency", "damping_ratio")
    return [
        "–" if name not in found else "held" if found[name] is None else _digits(found[name])
        for name in names
    ]


def _force(found: Row) -> Sequence[str]:
    wanted = (
        ("contact_rest", "ratio"), ("contact_rest", "jitter"), ("contact_slides", "jitter"),
        ("weld_pushed", "ratio"), ("weld_shaken", "ratio"),
    )  # fmt: skip
    cells = []
    for case, part in wanted:
        one = found["cases"].get(case)
        if one is None:
            cells.append("–")
        else:
            value = None if one[part] is None else one[part] - (part == "ratio")
            cells.append(_small(_times(100, value), 100 * _ROUNDING))
    return cells


_CELLS: Mapping[str, Callable[[Row], Sequence[str]]] = {
    "bounce": _bounce,
    "friction": _friction,
    "joint": _joint,
    "force": _force,
}


def _steps(off: Mapping[str, float | None]) -> str:
    """Steps at which something is off, such as "> 2.9" [ms]."""
    below, above = off["below_s"], off["above_s"]
    if below is not None and below == above:
        return _thousandfold(below)
    ends = [f"{sign} {_thousandfold(s)}" for sign, s in (("<", below), (">", above)) if s]
    return ", ".join(ends) or "–"


def _thousandfold(value: float | None) -> str:
    return "–" if value is None else numbers.plain(1e3 * value, 2)


def _digits(value: float | None) -> str:
    return "–" if value is None else f"{value:.4f}".replace("-", "−")


def _times(
    factor: float, value: float | None, of: Callable[[float], float] = float
) -> float | None:
    return None if value is None else factor * of(value)


def _small(value: float | None, least: float) -> str:
    if value is None:  # it ran away
        return "–"
    return "0" if abs(value) < least else numbers.plain(value, 2)
