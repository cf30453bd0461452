"""The answer of ``uncertainty`` in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterable

from simcompare import units
from simcompare.propagation.engine_runs import NUMERICAL
from simcompare.propagation.propagated import Propagated
from simcompare.reports.render import numbers
from simcompare.reports.run.listing import joined
from simcompare.results.records.uncertainty import CLOSED_FORM, Uncertainty, Way
from simcompare.statistics.budget import Budget

#: a share that is named beside the largest one
_NAMED = 0.05
#: a share beside which the others are nothing
_ALL = 0.995
#: degrees of freedom beyond which they are not counted
_MANY = 1000
#: parts of U below which a difference is not worth its digits
_NOTHING = 0.01


def sentences(result: Uncertainty) -> list[str]:
    """The value with its uncertainty first, then whether that holds, then the engines."""
    if not result.known:
        return [f"No way gave a result: {why}" for why in not_run(result)]
    way, found = result.known[0]
    said = [_value(result, way, found.budget) + _most(found.budget)]
    said += _doubt(result, found)
    said += _bent(result)
    said += _engines(result)
    where = "in all of this range" if way.source == CLOSED_FORM else "here"
    said += [f"The closed form does not hold {where}: {why.rstrip('.')}." for why in result.beyond]
    said += [f"Caution: {caution}." for caution in result.cautions]
    return said


def not_run(result: Uncertainty) -> list[str]:
    """Why some ways have no result."""
    return [f"{way.source}: {_reason(way)}" for way in result.ways if way.found is None]


def _reason(way: Way) -> str:
    return (way.reason or way.status).removeprefix(f"{way.source}: ")


def _value(result: Uncertainty, way: Way, budget: Budget) -> str:
    by = f" on {way.source}" if way.contact else ""
    value = numbers.with_u(budget.estimate, budget.expanded, units.symbol(result.unit))
    what = f"The {words(result.of)}" if result.of else result.subject
    verb = "is" if result.of else "="
    return f"{what} {verb} {value}{by} ({coverage(budget)})"


def words(name: str) -> str:
    """The name of a result as people say it."""
    return name.replace("_", " ")


def coverage(budget: Budget) -> str:
    """Probability, coverage factor and degrees of freedom, such as ``95 %, k = 1.96``."""
    k = f"{100 * budget.probability:g} %, k = {budget.k:.2f}"
    return f"{k}, {degrees(budget)}" if budget.degrees_of_freedom <= _MANY else k


def degrees(budget: Budget) -> str:
    """Effective degrees of freedom as words."""
    return f"{count_of(budget.degrees_of_freedom)} degrees of freedom"


def count_of(degrees_of_freedom: float) -> str:
    """Degrees of freedom; with many of them k is that of ∞."""
    if not math.isfinite(degrees_of_freedom):
        return "∞"
    return f"> {_MANY}" if degrees_of_freedom > _MANY else numbers.plain(degrees_of_freedom, 2)


def _most(budget: Budget) -> str:
    """Which input matters most."""
    rows = budget.largest_first
    if not budget.u:
        return "; to first order no input changes it."
    if len(rows) == 1 or rows[0].share > _ALL:
        part = "all" if len(rows) == 1 else "nearly all"
        return f"; {part} of it comes from {rows[0].name}."
    named = [f"{rows[0].name} makes {numbers.percent(rows[0].share)} of the variance"]
    named += [
        f"{row.name} {numbers.percent(row.share)}" for row in rows[1:3] if row.share >= _NAMED
    ]
    return f"; {', '.join(named)}."


def _doubt(result: Uncertainty, found: Propagated) -> Iterable[str]:
    """That first order is not enough, where Monte Carlo shows it."""
    trials, checked = found.monte_carlo, found.validation
    if trials is None or checked is None or checked.passed:
        return
    width = trials.shortest[1] - trials.shortest[0]
    low, high = (beside(end, width / 4)[0] for end in trials.shortest)
    unit = units.symbol(result.unit)
    mean = f"with the mean {numbers.with_u(trials.estimate, trials.u, unit)} (u)"
    if trials.u > width:
        mean = "and its mean does not settle: far values are too likely"
    yield (
        f"First order is not enough here: by Monte Carlo the value lies between {low} and {high}"
        f"{'' if unit == '1' else f' {unit}'} ({100 * trials.probability:g} %, shortest interval),"
        f" {mean}."
    )


def beside(value: float, u: float) -> tuple[str, str]:
    """A value and its uncertainty, each to the last digit that matters."""
    if not u:
        return numbers.plain(value), "0"
    text = numbers.with_u(value, u)
    if "·" in text or "±" not in text:
        return numbers.plain(value), numbers.plain(u, 2)
    left, _, right = text.partition(" ± ")
    return left, right


def _bent(result: Uncertainty) -> Iterable[str]:
    """That first order says little of an engine without trials, and how to do better."""
    for way, found in result.known:
        if found.bent and found.monte_carlo is None:
            yield (
                f"On {way.source} first order says little: the result bends or jumps within the"
                f" uncertainty of {joined(found.bent)}. Trials tell more: --trials 200."
            )


def _engines(result: Uncertainty) -> Iterable[str]:
    """How far engines are off the closed form, in parts of what the inputs leave open."""
    if result.known[0][0].source != CLOSED_FORM:
        return
    true = result.known[0][1].budget
    parts = {
        way.source: (found.budget.estimate - true.estimate) / true.expanded
        for way, found in result.known[1:]
        if true.expanded
    }
    if not parts:
        return
    worst = max(parts, key=lambda name: abs(parts[name]))
    size, alone = abs(parts[worst]), len(parts) == 1
    who = "" if alone else f" at most ({worst})"
    subject = f"{worst} differs" if alone else "The engines differ"
    if size < _NOTHING:
        told = "by less than 1 % of U, which is nothing beside what the inputs leave open"
    elif size <= 1:
        told = f"by {numbers.percent(size)} of U{who}, less than the inputs leave open"
    else:
        told = f"by {numbers.plain(size, 2)} times U{who}, more than the inputs leave open"
    yield f"{subject} from the closed form {told}."


def notes(result: Uncertainty) -> list[str]:
    """What was assumed."""
    said = []
    known = result.known
    trials = next((found.monte_carlo for _, found in known if found.monte_carlo), None)
    if trials is not None:
        stable = "" if trials.stable else "; more (--trials) make the second digit of u sure"
        said.append(f"Monte Carlo: {numbers.thousands(trials.trials)} trials{stable}")
    if any(row.name == NUMERICAL for _, found in known for row in found.budget.rows):
        said.append(f"{NUMERICAL}: between repeats of an engine that fall otherwise in its steps")
    if not result.correlation:
        said.append("The inputs are taken as independent")
    return said
