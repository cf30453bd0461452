"""The answers of the experiments as tables, for the page and the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence

from simcompare.characterization.behaviour import (
    BounceBehaviour,
    ForceBehaviour,
    Forces,
    FrictionBehaviour,
    Hinge,
    JointBehaviour,
    StepLimits,
)
from simcompare.characterization.bounce import BounceQuestion
from simcompare.characterization.friction import LOAD
from simcompare.reports.characterization.curves import LEVELS
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table, of_engines
from simcompare.results.records.characterization import Characterization, Trial

#: parts below this are rounding
_ROUNDING = 5e-6
#: decimals of a restitution that matter to anybody
_PLACES = 5

_HEADS = {
    "bounce": ("Restitution ± s", "Bounces down to (m/s)", "Hops on at (m/s)",
               "1 % too large at (ms)", "1 % too small at (ms)", "Gains energy beyond (ms)"),
    "friction": ("Lets go at (× µ·N)", "Creeps (mm/s)", "Sinks (mm)", "Braked (× µ·g)"),
    "joint": ("Damping", "With armature", "Inertia", "Frequency", "Damping ratio"),
    "force": ("Rest: off (%)", "Rest: jitter (%)", "Slides: jitter (%)", "Pushed weld: off (%)",
              "Shaken weld: off (%)"),
}  # fmt: skip
_PLAN = BounceQuestion("", 0.0)
_NOTES = {
    "bounce": (
        f"Restitution at {_PLAN.speed_m_s:g} m/s, {_PLAN.restitution:g} wanted: mean ± standard"
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


def of(result: Characterization, experiment: str) -> Table:
    """What engines did in an experiment, a group for each level."""
    groups = []
    for level in result.contact:
        rows = tuple(
            (trial.engine, *_cells(trial))
            for trial in result.answers
            if (trial.experiment, trial.contact) == (experiment, level)
        )
        groups.append(Group(LEVELS[level], rows))
    columns = [Column(head) for head in _HEADS[experiment]]
    return of_engines(columns, groups, _NOTES[experiment])


def reasons(result: Characterization, experiment: str) -> list[str]:
    """Why something was not answered, each reason once, with whose and at which levels."""
    found: dict[tuple[str, str], list[str]] = {}
    for trial in result.answers:
        if trial.experiment != experiment:
            continue
        lacks = trial.found.lacks if isinstance(trial.found, Hinge | Forces) else {}
        for reason in dict.fromkeys([trial.reason, *lacks.values()]):
            if reason:
                found.setdefault((trial.engine, reason), []).append(trial.contact)
    return [
        f"{name}, {', '.join(levels)}: {why.removeprefix(f'{name}: ')}"
        for (name, why), levels in found.items()
    ]


def _cells(trial: Trial) -> Sequence[str]:
    match trial.found:
        case BounceBehaviour():
            return _bounce(trial.found)
        case FrictionBehaviour():
            return _friction(trial.found)
        case JointBehaviour():
            return _joint(trial.found)
        case ForceBehaviour():
            return _force(trial.found)
    return ["–"] * (len(_HEADS[trial.experiment]) - 1) + [trial.status]


def _bounce(found: BounceBehaviour) -> Sequence[str]:
    row = min(found.over_speed, key=lambda one: abs(one.speed_m_s - _PLAN.speed_m_s))
    dies = found.dies_below_m_s
    slowest = f"≤ {numbers.plain(found.slowest_m_s, 2)}" if dies is None else numbers.plain(dies, 2)
    if dies is not None and dies >= found.over_speed[-1].speed_m_s:
        slowest = "never"
    return (
        numbers.with_u(row.mean, row.scatter, digits=4, places=_PLACES),
        slowest,
        numbers.plain(found.hops_at_m_s, 1),
        _steps(found.too_large),
        _steps(found.too_small),
        _thousandfold(found.gains_above_s),
    )


def _friction(found: FrictionBehaviour) -> Sequence[str]:
    at_load = found.under(LOAD)
    braked = next(row for row in found.braking if row.speed_m_s == 1.0)
    lets_go = found.lets_go_at
    return (
        "> 4" if lets_go is None else f"{lets_go:.3f}",
        _small(1e3 * abs(at_load.creep_m_s), 1e-6),
        _small(1e3 * at_load.sinks_m, 5e-4),
        "at once" if braked.stops_at_once else _digits(braked.braking),
    )


def _joint(found: Hinge) -> Sequence[str]:
    needs = {
        "damping": "damping",
        "damping_with_armature": "damping_with_armature",
        "inertia": "inertia",
        "frequency": "spring",
        "damping_ratio": "spring",
    }
    values = {name: getattr(found, name) for name in needs}
    return [
        "–" if needs[name] in found.lacks else _digits(value) if math.isfinite(value) else "held"
        for name, value in values.items()
    ]


def _force(found: Forces) -> Sequence[str]:
    wanted = (
        ("contact_rest", "ratio"), ("contact_rest", "jitter"), ("contact_slides", "jitter"),
        ("weld_pushed", "ratio"), ("weld_shaken", "ratio"),
    )  # fmt: skip
    cells = []
    for case, part in wanted:
        one = found.cases.get(case)
        if one is None:
            cells.append("–")
        else:
            value = one.ratio - 1 if part == "ratio" else one.jitter
            cells.append(_small(100 * value, 100 * _ROUNDING))
    return cells


def _steps(off: StepLimits) -> str:
    """Steps at which something is off, such as "> 2.9" [ms]."""
    below, above = off.below_s, off.above_s
    if below is not None and below == above:
        return _thousandfold(below)
    ends = [f"{sign} {_thousandfold(s)}" for sign, s in (("<", below), (">", above)) if s]
    return ", ".join(ends) or "–"


def _thousandfold(value: float | None) -> str:
    return "–" if value is None else numbers.plain(1e3 * value, 2)


def _digits(value: float) -> str:
    return f"{value:.4f}".replace("-", "−") if math.isfinite(value) else "–"


def _small(value: float, least: float) -> str:
    return "0" if abs(value) < least else numbers.plain(value, 2)  # a dash where it ran away
