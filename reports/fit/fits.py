"""What reports ask of a fit: its record, and the names of its parts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from simcompare import units
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Scale, scale_of
from simcompare.reports.validation import phrases, validations
from simcompare.results.records.fit import AnyFit, FitRecord
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_engines import BouncesEngine, EffectiveValue
from simcompare.results.records.fit_forms import Repeats, Unknown
from simcompare.results.records.fit_parts import EngineParameter, Value
from simcompare.results.records.fit_tosses import TossFit
from simcompare.results.records.fit_waveforms import WaveEngine, WaveformFit
from simcompare.results.run import Run

#: a value with its standard uncertainty, and what has an interval besides
Estimate = Value | Unknown | EngineParameter | EffectiveValue
Ranged = Unknown | EngineParameter | Repeats
CLOSED = "closed form"
RESTITUTION = "restitution"
#: drops that are drawn beside each other; the tables have all
MAX_DROPS = 3
_SMALL_UNITS = {"s": ("s", "ms", "µs"), "m": ("m", "mm", "µm")}


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


def other_form(run: Run) -> str:
    """That engines were fitted with another contact than the closed form's, empty if not."""
    found = bounces(run)
    if found.engine_form is None:
        return ""
    return (
        f"The closed form has: {found.closed_form.text}. Engines have no such contact; they"
        f" were fitted with: {found.engine_model_text}."
    )


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
    low, high = row.limits
    return (-math.inf if low is None else low), (math.inf if high is None else high)


def interval_words(row: Ranged | None) -> str:
    """The interval as "low to high", with as many digits as its width deserves."""
    if row is None:
        return "–"
    low, high = interval(row)
    width = high - low
    scale = scale_of([width if math.isfinite(width) else row.u or 0.0], 2)
    places = Scale(0, max(scale.places - scale.power, 0))
    if math.isinf(low) and math.isinf(high):
        return "open"
    if math.isinf(high):
        return f"above {numbers.plain(low, 4)}"
    if math.isinf(low):
        return f"below {numbers.plain(high, 4)}"
    return f"{places.text(low)} to {places.text(high)}"


def smaller(unit: str, sizes: Sequence[float]) -> tuple[float, str]:
    """A factor and a unit in which the largest of some sizes in s or m is above 1."""
    most = max((abs(v) for v in sizes if math.isfinite(v)), default=0.0)
    for factor, name in zip((1.0, 1e3, 1e6), _SMALL_UNITS[unit], strict=True):
        if most * factor >= 1:
            return factor, name
    return 1e6, _SMALL_UNITS[unit][2]


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
    return f"{numbers.plain(ends[0], 3)} to {numbers.plain(ends[1], 3)}"


def rms_words(rms: Mapping[str, float]) -> str:
    """Root mean squares of residuals, each in a unit of its size."""
    parts = []
    for kind, value in rms.items():
        factor, small = smaller("s" if kind == "times" else "m", [value])
        parts.append(f"{kind} {numbers.plain(factor * value, 3)} {small}")
    return ", ".join(parts)
