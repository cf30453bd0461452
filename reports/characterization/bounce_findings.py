"""What a class must see of a bounce."""

from __future__ import annotations

import math
from collections.abc import Mapping

from simcompare.characterization.behaviour import BounceBehaviour, StepLimits
from simcompare.characterization.bounce import OFF, BounceQuestion
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED
from simcompare.notation import capital
from simcompare.reports.characterization.words import (
    HEADS,
    amounts,
    milli,
    percent,
    rounded,
    signed,
)
from simcompare.reports.run.listing import joined
from simcompare.results.records.characterization import Sentence

#: engine -> what it did
Found = Mapping[str, BounceBehaviour]
BOUNCE = "bounce"

#: the bounce that was wanted, and an impact at which the number of another speed is looked at [m/s]
_PLAN, _SLOW_M_S = BounceQuestion("", 0.0), 0.5
#: a scatter, or a deviation, below this part of the restitution is not named
_NAMED = 0.005
#: and below this part it is no more than told as such
_SEEN = 1e-4


def sentences(found: Mapping[str, Found], step_s: float) -> list[Sentence]:
    """A sentence for each level and for what changes over steps."""
    said = []
    if found[DEFAULT]:
        said.append(Sentence(BOUNCE, _default(found[DEFAULT], step_s), leads=True))
    for level in (COEFFICIENTS, TUNED, ASSISTED):
        texts = _given(level, found[level], step_s) if found[level] else []
        if level == TUNED:
            texts += _over_steps(found[TUNED], step_s)
        said += [Sentence(BOUNCE, text, leads=level != COEFFICIENTS) for text in texts]
    return said


def _default(found: Found, step_s: float) -> str:
    """How little comes back by default."""
    lost, found = _without_lost(found)
    rows = {name: one.at(_PLAN.speed_m_s) for name, one in found.items()}
    bounces = {n: (row.mean, row.scatter) for n, row in rows.items() if row.mean}
    dead = [name for name in rows if name not in bounces]
    parts = [f"comes back with {amounts(bounces, _with_scatter)}"] if bounces else []
    if dead:
        parts.append(f"{'not at all' if bounces else 'does not bounce'} in {_all_or(dead, found)}")
    parts += _runs_away(lost)
    ball = f"a ball that should come back with {_PLAN.restitution:g} of its speed"
    where = f"at {_PLAN.speed_m_s:g} m/s and {1e3 * step_s:g} ms"
    return f"By default, {where}, {ball} {', '.join(parts)}."


def _all_or(names: list[str], every: Found) -> str:
    return f"all {len(names)} engines" if len(names) == len(every) > 2 else joined(names)


def _without_lost(found: Found) -> tuple[list[str], Found]:
    """Engines in which the ball runs away, and what was found of the others."""
    lost = [name for name, one in found.items() if not math.isfinite(one.at(_PLAN.speed_m_s).mean)]
    return lost, {name: one for name, one in found.items() if name not in lost}


def _runs_away(lost: list[str]) -> list[str]:
    return [f"it runs away in {joined(lost)}"] if lost else []


def _with_scatter(value: tuple[float, float]) -> str:
    return " ± ".join(map(rounded, value))


def _given(level: str, found: Found, step_s: float) -> list[str]:
    """Mean and scatter at the speed of the plan; then slower impacts, and where it ends."""
    tuned = f" for {_PLAN.restitution:g} at {_PLAN.speed_m_s:g} m/s" if level == TUNED else ""
    head = f"{capital(HEADS[level])}{tuned}, at {1e3 * step_s:g} ms"
    lost, found = _without_lost(found)
    dead = [name for name, one in found.items() if _dies(one) >= _fastest(one)]
    alive = {name: one for name, one in found.items() if name not in dead}
    parts = [f"{joined(dead)} {'does' if len(dead) == 1 else 'do'} not bounce"] if dead else []
    parts += _runs_away(lost)
    if not alive:
        return [f"{head}: {'; '.join(parts)}."]
    slow = [*_slower(alive), *_ends(alive)]
    said = [f"{head}: {'; '.join([*parts, *_mean(alive), _scatter(alive)])}."]
    return [*said, f"{capital(HEADS[level])}, slower impacts: {'; '.join(slow)}."] if slow else said


def _mean(found: Found) -> list[str]:
    off = _off(found, _PLAN.speed_m_s)
    if not off:
        where = _all_or(list(found), found)
        return [f"the mean restitution is right in {where}, within {percent(_NAMED)}"]
    return [f"at {_PLAN.speed_m_s:g} m/s the mean restitution is off by {amounts(off, signed)}"]


def _scatter(found: Found) -> str:
    """How much a bounce depends on where in the step the impact falls."""
    rows = {name: one.at(_PLAN.speed_m_s) for name, one in found.items()}
    scatter = {n: row.scatter / _PLAN.restitution for n, row in rows.items()}
    wide = {name: part for name, part in scatter.items() if part > _NAMED}
    words = "it scatters, over where in the step the impact falls, by"
    rest = {name: part for name, part in scatter.items() if name not in wide}
    told = [amounts(wide, lambda part: f"± {percent(part)}")] if wide else []
    if rest:
        # less than so much nobody can see
        most = max(max(rest.values()), _SEEN)
        at_most = " at most" if len(rest) > 1 or most == _SEEN else ""
        where = (
            "" if not wide else f" in {next(iter(rest))}" if len(rest) == 1 else " in the others"
        )
        told.append(f"± {percent(most)}{at_most}{where}")
    return f"{words} {', '.join(told)}"


def _slower(found: Found) -> list[str]:
    """Slower impacts with the same number."""
    off = {name: part for name, part in _off(found, _SLOW_M_S).items() if part > -0.5}
    speed = next(iter(found.values())).at(_SLOW_M_S).speed_m_s
    if not off:
        return []
    same = "the same number" if len(found) > 1 else "its number"
    return [f"at {speed:g} m/s the mean that {same} gives is off by {amounts(off, signed)}"]


def _off(found: Found, speed_m_s: float) -> dict[str, float]:
    """Deviations of the mean that are worth a word."""
    means = {name: one.at(speed_m_s).mean for name, one in found.items()}
    parts = {n: mean / _PLAN.restitution - 1 for n, mean in means.items() if math.isfinite(mean)}
    return {name: part for name, part in parts.items() if abs(part) > _NAMED}


def _ends(found: Found) -> list[str]:
    """Where the bounce dies, and where it never does."""
    dies = {name: _dies(one) for name, one in found.items() if _dies(one)}
    hops = {n: one.hops_at_m_s for n, one in found.items() if one.hops_at_m_s}
    parts = []
    if dies:
        parts.append(f"the bounce dies below {amounts(dies, _speed)}")
    if hops:
        # one digit: a step alone changes the speed by a quarter of it
        told = amounts(hops, lambda speed: f"{rounded(speed, 1)} m/s")
        parts.append(f"the ball never comes to rest, but hops on at about {told}")
    return parts


def _over_steps(found: Found, step_s: float) -> list[str]:
    """What the number of one step does at others."""
    gains = {n: one.gains_above_s for n, one in found.items() if one.gains_above_s}
    lost = {n: step for n, one in found.items() if (step := _first_untuned(one)) is not None}
    too_large = {name: one.too_large for name, one in found.items()}
    too_small = {name: one.too_small for name, one in found.items()}
    off = [*_off_over_steps(too_large, "large"), *_off_over_steps(too_small, "small")]
    parts = [f"the mean restitution is {', and '.join(off)}"] if off else []
    if gains:
        parts.append(f"some impacts gain energy beyond {amounts(gains, _step)}")
    head = f"With the number of {1e3 * step_s:g} ms held at other steps"
    said = [f"{head}, {'; '.join(parts)}."] if parts else []
    if lost:
        steps = amounts(lost, lambda step: f"{_step(step)} or more")
        ball = f"this ball of {1e3 * _PLAN.size_m:g} mm"
        said.append(f"No number gives {ball} a steady bounce at {steps}.")
    return said


def _off_over_steps(found: Mapping[str, StepLimits], too: str) -> list[str]:
    """Below and beyond which steps the mean is too "large", or too "small"."""
    parts = []
    below = {name: limits.below_s for name, limits in found.items() if limits.below_s}
    above = {name: limits.above_s for name, limits in found.items() if limits.above_s}
    for steps, word in ((below, "below"), (above, "beyond")):
        if steps:
            parts.append(f"more than {percent(OFF)} too {too} {word} {amounts(steps, _step)}")
    return parts


def _first_untuned(one: BounceBehaviour) -> float | None:
    """The step from which on, of those tried, none has a number of its own."""
    found = None
    for row in reversed(one.retuned):
        if not row.reason:
            break
        found = row.step_s
    return found


def _dies(one: BounceBehaviour) -> float:
    return one.dies_below_m_s or 0.0


def _fastest(one: BounceBehaviour) -> float:
    return one.over_speed[-1].speed_m_s


def _speed(value: float) -> str:
    return f"{rounded(value)} m/s"


def _step(value: float) -> str:
    return milli(value, "s")
