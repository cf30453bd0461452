"""What a class must see of the experiments, in sentences that are computed from the answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from simcompare.characterization.force import CASES
from simcompare.characterization.friction import LOAD, SIZE_M
from simcompare.model.settings import CONTACT_LEVELS, TUNED
from simcompare.reports.characterization import bounce_findings
from simcompare.reports.characterization.words import (
    HEADS,
    Found,
    amounts,
    by_engine,
    capital,
    listed,
    milli,
    percent,
    signed,
)

Answers = Sequence[Mapping[str, Any]]
#: creep below this is none that one would see [m/s]
_CREEPS_M_S = 1e-5
#: so many standard uncertainties are no deviation
_COVERS = 2.0
#: a deviation, or a jitter, below this part is not named
_NAMED = 0.01


def sentences(answers: Answers, step_s: float) -> list[dict[str, Any]]:
    """All of them, each with its experiment and whether it stands at the top of the page."""
    bounces = {level: by_engine(answers, "bounce", level) for level in CONTACT_LEVELS}
    found = [
        {"experiment": "bounce", "text": text, "leads": leads}
        for text, leads in bounce_findings.sentences(bounces, step_s)
    ]
    for experiment, tell in _TELL.items():
        said: dict[str, list[str]] = {}
        for level in CONTACT_LEVELS:
            at_level = by_engine(answers, experiment, level)
            if at_level:
                said.setdefault(tell(at_level), []).append(level)
        for text, levels in said.items():
            head = capital(listed(HEADS[level] for level in levels))
            whole = f"{head}, at {1e3 * step_s:g} ms: {text}."
            found.append({"experiment": experiment, "text": whole, "leads": TUNED in levels})
    return found


def _friction(found: Found) -> str:
    fallen = [name for name, one in found.items() if _sinks(one) > SIZE_M[2]]
    lying = {name: one for name, one in found.items() if name not in fallen}
    parts = [f"a block falls through the floor in {listed(fallen)}"] if fallen else []
    return "; ".join([*parts, *_holding(lying), *_creeping(lying), *_braking(lying)])


def _holding(found: Found) -> list[str]:
    wrong = _lets_go_wrongly(found)
    holds = [name for name, one in found.items() if one["lets_go_at"] is None]
    parts = []
    if wrong:
        loads = amounts(wrong, lambda load: f"{load:.2f}")
        parts.append(f"of the load that friction should hold, a block lets go at {loads}")
    if holds:
        parts.append(f"it holds whatever pulls in {listed(holds)}")
    right = found and not parts
    where = "all engines" if len(found) > 2 else listed(found) if found else ""
    right_words = (
        f"friction holds a block up to the load that it should in {where}, within {percent(_NAMED)}"
    )
    return [right_words] if right else parts


def _lets_go_wrongly(found: Found) -> dict[str, float]:
    loads = {name: one["lets_go_at"] for name, one in found.items()}
    return {n: load for n, load in loads.items() if load is not None and abs(load - 1) > _NAMED}


def _creeping(found: Found) -> list[str]:
    """Only where the block sticks under the load at which creep is looked at."""
    holds = {n: one["lets_go_at"] is None or one["lets_go_at"] > LOAD for n, one in found.items()}
    speeds = {name: abs(_creep(one)) for name, one in found.items() if holds[name]}
    creeps = {name: speed for name, speed in speeds.items() if speed > _CREEPS_M_S}
    told = amounts(creeps, lambda speed: milli(speed, "m/s"))
    return [f"while it should stick it creeps by {told}"] if creeps else []


def _braking(found: Found) -> list[str]:
    """Only where the block lets go as it should: else another friction is all there is to say."""
    wrong = _lets_go_wrongly(found)
    worst = {n: _worst_braking(one) for n, one in found.items() if n not in wrong}
    off = {n: part for n, part in worst.items() if part is not None and abs(part) > _NAMED}
    return [f"sliding, its deceleration is off by up to {amounts(off, signed)}"] if off else []


def _creep(one: Mapping[str, Any]) -> float:
    return float(_at_load(one)["creep_m_s"] or 0.0)


def _sinks(one: Mapping[str, Any]) -> float:
    return float(_at_load(one)["sinks_m"] or 0.0)


def _at_load(one: Mapping[str, Any]) -> Mapping[str, Any]:
    rows: list[Mapping[str, Any]] = one["creep"]
    return next(row for row in rows if row["load"] == LOAD)


def _worst_braking(one: Mapping[str, Any]) -> float | None:
    parts = [row["braking"] - 1 for row in one["braking"] if row["braking"] is not None]
    return max(parts, key=abs, default=None)


#: what is told of a hinge, with its words
_OF_HINGE = {
    "damping": "the damping of a hinge is",
    "inertia": "the inertia that a motor feels is",
    "frequency": "the frequency of a sprung hinge is",
    "damping_ratio": "the damping ratio of a sprung hinge is",
}


def _joint(found: Found) -> str:
    parts = []
    held = [name for name, one in found.items() if one.get("damping", 0) is None]
    if held:
        parts.append(f"a hinge that is set turning does not turn on in {listed(held)}")
    for quantity, words in _OF_HINGE.items():
        off = {
            name: one[quantity] - 1
            for name, one in found.items()
            if one.get(quantity) is not None and abs(one[quantity] - 1) > _NAMED
        }
        if off:
            parts.append(f"{words} off by {amounts(off, signed)}")
    right = "damping, inertia, frequency and damping ratio of a hinge are right"
    return "; ".join(parts) if parts else f"{right} within {percent(_NAMED)}"


def _force(found: Found) -> str:
    parts = []
    for case, words in CASES.items():
        every = {name: one["cases"][case] for name, one in found.items() if case in one["cases"]}
        told = {name: one for name, one in every.items() if one["ratio"] is not None}
        lost = [name for name in every if name not in told]
        # a mean that jitters is off only where that is more than what it jitters by itself
        off = {
            n: one["ratio"] - 1
            for n, one in told.items()
            if abs(one["ratio"] - 1) > max(_NAMED, _COVERS * one["u"])
        }
        jitters = {n: one["jitter"] for n, one in told.items() if one["jitter"] > _NAMED}
        both = []
        if off:
            both.append(f"is off by {amounts(off, signed)}")
        if jitters:
            both.append(f"jitters by {amounts(jitters, lambda part: f'± {percent(part)}')}")
        if lost:
            both.append(f"runs away in {listed(lost)}")
        if both:
            parts.append(f"the force on a {words} {' and '.join(both)}")
    if not parts:
        parts.append(f"every force that is told is right within {percent(_NAMED)}, and steady")
    silent = [name for name, one in found.items() if one["lacks"]]
    if silent:
        parts.append(f"not all forces are told in {listed(silent)}")
    return "; ".join(parts)


_TELL: Mapping[str, Callable[[Found], str]] = {
    "friction": _friction,
    "joint": _joint,
    "force": _force,
}
