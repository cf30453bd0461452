"""What reports ask of a fit: its record, and the names of its parts."""

from __future__ import annotations

import math
from collections.abc import Mapping

from simcompare import units
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Scale, scale_of
from simcompare.reports.validation import phrases, validations
from simcompare.results.records.fit import AnyFit, FitRecord
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_engines import BouncesEngine, EffectiveValue
from simcompare.results.records.fit_forms import REFERENCE_M_S, AtSpeed, Form, Repeats, Unknown
from simcompare.results.records.fit_parts import EngineParameter, Value
from simcompare.results.records.fit_tosses import TossFit
from simcompare.results.records.fit_waveforms import WaveEngine, WaveformFit, WaveParameter
from simcompare.results.run import Run

#: a value with its standard uncertainty, and what has an interval besides
Estimate = Value | Unknown | EngineParameter | EffectiveValue | AtSpeed
Ranged = Unknown | EngineParameter | Repeats | AtSpeed
CLOSED = "closed form"
#: how an interval came about that is over all closed forms
AVERAGED = "averaged"
RESTITUTION, EXPONENT = "restitution", "exponent"
#: kinds of measured numbers that are in seconds
_TIMES = ("times", "intervals")
#: drops that are drawn beside each other; the tables have all
MAX_DROPS = 3
#: an interval whose ends are this much of its half-width further on one side is written out
_LOPSIDED = 0.1


def of_any(run: Run) -> AnyFit:
    """The record of a fit of any kind."""
    assert isinstance(run.record, FitRecord)
    return run.record.fit


def record(run: Run) -> BouncesFit | WaveformFit:
    """The record of a fit of bounces, or to signals over time."""
    found = of_any(run)
    assert not isinstance(found, TossFit)
    return found


def bounces(run: Run) -> BouncesFit:
    """The record of a fit of bounces."""
    found = record(run)
    assert isinstance(found, BouncesFit)
    return found


def signals(run: Run) -> WaveformFit:
    """The record of a fit to signals over time."""
    found = record(run)
    assert isinstance(found, WaveformFit)
    return found


def engines(run: Run) -> list[BouncesEngine]:
    """Engines whose fit of bounces succeeded."""
    return [row for row in bounces(run).sources if row.parameters]


def wave_engines(run: Run) -> list[WaveEngine]:
    """Engines whose fit to signals over time succeeded."""
    return [row for row in signals(run).sources if row.parameters]


def fitted(run: Run) -> list[BouncesEngine | WaveEngine]:
    """Engines whose fit of any kind succeeded."""
    return [row for row in record(run).sources if row.parameters]


def failed(run: Run) -> list[BouncesEngine | WaveEngine]:
    """Engines that could not be fitted."""
    return [row for row in record(run).sources if not row.parameters]


def of_95(row: WaveParameter, name: str = "") -> str:
    """A parameter of signals with its unit and half of its 95 % interval."""
    after = "" if not name or unit(name) == "1" else f" {unit(name)}"
    return f"{numbers.with_u(row.value, (row.high - row.low) / 2)}{after}"


def law_of(found: BouncesFit) -> str:
    """How the restitution depends on the speed, such as "constant" or "power"."""
    return next(c.law for c in found.choice.candidates if c.model == found.closed_form.model)


def determined_words(run: Run) -> str:
    """Whether the data determine what was fitted, in a few words."""
    weak = any(one.weak for one in record(run).identifiability.directions)
    return "not all unknowns are determined" if weak else "all unknowns are determined"


def titles(found: BouncesFit) -> dict[str, str]:
    """Every unknown as people say it; a restitution with its speed where it may depend on that."""
    names = {name: title(name) for name in found.closed_form.parameters}
    if not is_for_all_speeds(found) and RESTITUTION in names:
        names[RESTITUTION] = f"{RESTITUTION} at {REFERENCE_M_S:g} m/s"
    return names


def is_for_all_speeds(found: BouncesFit) -> bool:
    """Whether one number is the restitution, whatever the speed."""
    return found.choice.is_alone and law_of(found) == "constant"


def how(form: Form, name: str) -> str:
    """Where the value of an unknown comes from."""
    prior = form.priors.get(name)
    if prior is None:
        return "fitted"
    if name in form.assumed:
        return "assumed" if prior.reason else "given, with u"
    return "fitted, with a prior"


def restitution_words(found: BouncesFit) -> str:
    """The restitution, at the slowest and the fastest impact where it may depend on the speed."""
    slow, fast = found.closed_form.restitution
    row = found.closed_form.parameters.get(RESTITUTION)
    if row is None:
        return f"The restitution was given: {numbers.plain(fast.value)}."
    if is_for_all_speeds(found):
        return f"The restitution is {with_95(row)} (95 %)."
    ends = (slow, fast) if _speed(slow) != _speed(fast) else (fast,)
    if found.choice.disagree:
        at = [f"{interval_words(one)} at {_speed(one)}" for one in ends]
        return (f"The restitution lies in the range {' and '.join(at)} (95 %); models that fit as"
                " well disagree.")  # fmt: skip
    seen = len(ends) > 1 and depends(found.closed_form)
    verb = "depends on the speed:" if seen else "is"
    at = [f"{with_95(one)} at {_speed(one)}" for one in ends]
    none = "" if seen or len(ends) == 1 else "; no dependence on the speed is seen"
    return f"The restitution {verb} {' and '.join(at)} (95 %){none}."


def depends(form: Form) -> bool:
    """Whether the restitution changes with the speed by more than its uncertainty.

    Where the closed form has an exponent, that must differ from 0; else the restitutions at the
    slowest and the fastest impact from each other.
    """
    slope = form.parameters.get(EXPONENT)
    if slope is not None:
        low, high = interval(slope)
        return low > 0 or high < 0
    slow, fast = form.restitution
    return abs(slow.value - fast.value) > 2 * math.hypot(slow.u, fast.u)


def restitution_of_first(found: BouncesFit) -> tuple[str, str]:
    """The restitution at the fastest impact, or at all, and what it is called."""
    row, fast = found.closed_form.parameters[RESTITUTION], found.closed_form.restitution[1]
    if is_for_all_speeds(found):
        return RESTITUTION, with_95(row)
    words = interval_words(fast) if found.choice.disagree else with_95(fast)
    return f"{RESTITUTION} at {_speed(fast)}", words


def _speed(one: AtSpeed) -> str:
    return f"{numbers.plain(one.speed_m_s, 3)} m/s"


def title(name: str) -> str:
    """An unknown as people say it, with its drop."""
    head, _, drop = name.partition("[")
    return phrases.parameter(head) + (f" of drop {drop[:-1]}" if drop else "")


def unit(name: str) -> str:
    """The unit of an unknown as people write it; "1" for none."""
    return units.symbol(units.unit_of(name.partition("[")[0]))


def with_unit(name: str) -> str:
    """An unknown with its unit in brackets."""
    symbol = unit(name)
    return title(name) + ("" if symbol == "1" else f" ({symbol})")


def value_words(row: Estimate | None, name: str = "") -> str:
    """A value with its standard uncertainty; a dash where it was not fitted."""
    if row is None:
        return "–"
    if row.value is None:
        return "no drag seen" if name.startswith("terminal_speed") else "not finite"
    return numbers.with_u(row.value, row.u)


def interval(row: Ranged) -> tuple[float, float]:
    """The 95 % interval of a parameter; ends that the data leave open are infinite."""
    low, high = row.interval95 if isinstance(row, EngineParameter) else (row.low, row.high)
    return (-math.inf if low is None else low), (math.inf if high is None else high)


def interval_words(row: Ranged | None) -> str:
    """The interval as "low to high", with as many digits as its width deserves."""
    if row is None:
        return "–"
    low, high = interval(row)
    places = _places(row)
    if math.isinf(low) and math.isinf(high):
        return "open"
    if math.isinf(high):
        return f"above {numbers.plain(low, 4)}"
    if math.isinf(low):
        return f"below {numbers.plain(high, 4)}"
    return phrases.ends(places.text(low), places.text(high))


def _places(row: Ranged) -> Scale:
    """As many decimal places as the width of an interval deserves."""
    low, high = interval(row)
    width = high - low
    scale = scale_of([width if math.isfinite(width) else row.u or 0.0], 2)
    return Scale(0, max(scale.places - scale.power, 0))


def with_95(row: Unknown | EngineParameter | AtSpeed, name: str = "") -> str:
    """A value with its unit and what must be added and taken away for 95 %: ``0.774 ± 0.003``."""
    low, high = interval(row)
    after = "" if not name or unit(name) == "1" else f" {unit(name)}"
    if row.value is None:
        return value_words(row, name)
    if not math.isfinite(high - low):
        return f"{interval_words(row)}{after}"
    half = (high - low) / 2
    if abs(high + low - 2 * row.value) > _LOPSIDED * half:
        return f"{_places(row).text(row.value)}{after} ({interval_words(row)})"
    return f"{numbers.with_u(row.value, half)}{after}"


def told_95(found: BouncesFit, row: Unknown, name: str = "") -> str:
    """The same, but as a range where it is averaged over models that disagree."""
    if not found.choice.disagree or row.interval != AVERAGED or row.value is None:
        return with_95(row, name)
    after = "" if not name or unit(name) == "1" else f" {unit(name)}"
    return f"{interval_words(row)}{after}"


def drop_title(run: Run, number: int) -> str:
    """A drop with its file; the number only where there are several."""
    drops = bounces(run).measured
    source = validations.short(str(drops[number - 1].source))
    return f"drop {number}: {source}" if len(drops) > 1 else source


def drawn_drops(run: Run) -> list[int]:
    """Numbers of the drops that are drawn."""
    return list(range(1, min(len(bounces(run).measured), MAX_DROPS) + 1))


def drawn_words(run: Run) -> str:
    """Which drops are drawn, where that is not all of them."""
    count = len(bounces(run).measured)
    return f" The first {MAX_DROPS} of {count} drops." if count > MAX_DROPS else ""


def speeds(ends: tuple[float, float]) -> str:
    """Slowest and fastest impact, as people write them."""
    return phrases.ends(*(numbers.plain(end, 3) for end in ends))


def rms_words(rms: Mapping[str, float]) -> str:
    """Root mean squares of residuals, each in a unit of its size."""
    parts = []
    for kind, value in rms.items():
        parts.append(f"{kind} {phrases.human(value, 's' if kind in _TIMES else 'm')}")
    return ", ".join(parts)
