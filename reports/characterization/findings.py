"""What a class must see of the experiments, in sentences that are computed from the answers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from simcompare.characterization.behaviour import (
    BounceBehaviour,
    ForceBehaviour,
    FrictionBehaviour,
    JointBehaviour,
)
from simcompare.characterization.force import CASES
from simcompare.characterization.friction import LOAD, SIZE_M
from simcompare.model.settings import CONTACT_LEVELS, TUNED
from simcompare.notation import capital
from simcompare.reports.characterization import bounce_findings
from simcompare.reports.characterization.words import (
    HEADS,
    amounts,
    by_engine,
    milli,
    percent,
    signed,
)
from simcompare.reports.run.listing import joined
from simcompare.results.records.characterization import Sentence, Trial

#: engine -> what it did
Blocks = Mapping[str, FrictionBehaviour]
#: creep below this is none that one would see [m/s]
_CREEPS_M_S = 1e-5
#: so many standard uncertainties are no deviation
_COVERS = 2.0
#: a deviation, or a jitter, below this part is not named
_NAMED = 0.01


def sentences(trials: Sequence[Trial], step_s: float) -> list[Sentence]:
    """All of them, each with its experiment and whether it stands at the top of the page."""
    bounces = {level: by_engine(trials, BounceBehaviour, level) for level in CONTACT_LEVELS}
    found = bounce_findings.sentences(bounces, step_s)
    said: dict[tuple[str, str], list[str]] = {}
    for level in CONTACT_LEVELS:
        for experiment, text in _at_level(trials, level):
            said.setdefault((experiment, text), []).append(level)
    order = ["friction", "joint", "force"]
    for (experiment, text), levels in sorted(said.items(), key=lambda one: order.index(one[0][0])):
        head = capital(joined([HEADS[level] for level in levels]))
        whole = f"{head}, at {1e3 * step_s:g} ms: {text}."
        found.append(Sentence(experiment, whole, leads=TUNED in levels))
    return found


def _at_level(trials: Sequence[Trial], level: str) -> Iterator[tuple[str, str]]:
    """Experiment and sentence, of all experiments but the bounce."""
    if blocks := by_engine(trials, FrictionBehaviour, level):
        yield "friction", _friction(blocks)
    if hinges := by_engine(trials, JointBehaviour, level):
        yield "joint", _joint(hinges)
    if forces := by_engine(trials, ForceBehaviour, level):
        yield "force", _force(forces)


def _friction(found: Blocks) -> str:
    fallen = [name for name, one in found.items() if one.under(LOAD).sinks_m > SIZE_M[2]]
    lying = {name: one for name, one in found.items() if name not in fallen}
    parts = [f"a block falls through the floor in {joined(fallen)}"] if fallen else []
    return "; ".join([*parts, *_holding(lying), *_creeping(lying), *_braking(lying)])


def _holding(found: Blocks) -> list[str]:
    wrong = _lets_go_wrongly(found)
    holds = [name for name, one in found.items() if one.lets_go_at is None]
    parts = []
    if wrong:
        loads = amounts(wrong, lambda load: f"{load:.2f}")
        parts.append(f"of the load that friction should hold, a block lets go at {loads}")
    if holds:
        parts.append(f"it holds whatever pulls in {joined(holds)}")
    right = found and not parts
    where = "all engines" if len(found) > 2 else joined(list(found)) if found else ""
    right_words = (
        f"friction holds a block up to the load that it should in {where}, within {percent(_NAMED)}"
    )
    return [right_words] if right else parts


def _lets_go_wrongly(found: Blocks) -> dict[str, float]:
    loads = {name: one.lets_go_at for name, one in found.items()}
    return {n: load for n, load in loads.items() if load is not None and abs(load - 1) > _NAMED}


def _creeping(found: Blocks) -> list[str]:
    """Only where the block sticks under the load at which creep is looked at."""
    holds = {n: one.lets_go_at is None or one.lets_go_at > LOAD for n, one in found.items()}
    speeds = {name: abs(one.under(LOAD).creep_m_s) for name, one in found.items() if holds[name]}
    creeps = {name: speed for name, speed in speeds.items() if speed > _CREEPS_M_S}
    told = amounts(creeps, lambda speed: milli(speed, "m/s"))
    return [f"while it should stick it creeps by {told}"] if creeps else []


def _braking(found: Blocks) -> list[str]:
    """Only where the block lets go as it should: else another friction is all there is to say."""
    wrong = _lets_go_wrongly(found)
    worst = {n: _worst_braking(one) for n, one in found.items() if n not in wrong}
    off = {n: part for n, part in worst.items() if part is not None and abs(part) > _NAMED}
    return [f"sliding, its deceleration is off by up to {amounts(off, signed)}"] if off else []


def _worst_braking(one: FrictionBehaviour) -> float | None:
    parts = [row.braking - 1 for row in one.braking if math.isfinite(row.braking)]
    return max(parts, key=abs, default=None)


#: what is told of a hinge, with its words
_OF_HINGE = {
    "damping": "the damping of a hinge is",
    "inertia": "the inertia that a motor feels is",
    "frequency": "the frequency of a sprung hinge is",
    "damping_ratio": "the damping ratio of a sprung hinge is",
}


def _joint(found: Mapping[str, JointBehaviour]) -> str:
    parts = []
    held = [
        name
        for name, one in found.items()
        if not math.isfinite(one.damping) and "damping" not in one.lacks
    ]
    if held:
        parts.append(f"a hinge that is set turning does not turn on in {joined(held)}")
    for quantity, words in _OF_HINGE.items():
        parts_off = {name: getattr(one, quantity) - 1 for name, one in found.items()}
        off = {n: p for n, p in parts_off.items() if math.isfinite(p) and abs(p) > _NAMED}
        if off:
            parts.append(f"{words} off by {amounts(off, signed)}")
    right = "damping, inertia, frequency and damping ratio of a hinge are right"
    return "; ".join(parts) if parts else f"{right} within {percent(_NAMED)}"


def _force(found: Mapping[str, ForceBehaviour]) -> str:
    parts = []
    for case, words in CASES.items():
        every = {name: one.cases[case] for name, one in found.items() if case in one.cases}
        read = {name: one for name, one in every.items() if math.isfinite(one.ratio)}
        lost = [name for name in every if name not in read]
        # a mean that jitters is off only where that is more than what it jitters by itself
        off = {
            n: one.ratio - 1
            for n, one in read.items()
            if abs(one.ratio - 1) > max(_NAMED, _COVERS * one.u)
        }
        jitters = {n: one.jitter for n, one in read.items() if one.jitter > _NAMED}
        both = []
        if off:
            both.append(f"is off by {amounts(off, signed)}")
        if jitters:
            both.append(f"jitters by {amounts(jitters, lambda part: f'± {percent(part)}')}")
        if lost:
            both.append(f"runs away in {joined(lost)}")
        if both:
            parts.append(f"the force on a {words} {' and '.join(both)}")
    if not parts:
        parts.append(f"every force that is told is right within {percent(_NAMED)}, and steady")
    silent = [name for name, one in found.items() if one.lacks]
    if silent:
        parts.append(f"not all forces are told in {joined(silent)}")
    return "; ".join(parts)
