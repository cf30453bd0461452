"""Names and numbers of a validation as they stand in its sentences."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Protocol

from simcompare import units

if TYPE_CHECKING:  # reports of runs and fits use these words too, and need no more of it
    from simcompare.results.records.validation import Validation, WaveformRecord

#: a share below this is nothing
NOTHING = 5e-4
#: what noise alone spans is less than so many times its expected range
_NOISE_ALONE = 1.5
#: outside of these sizes a number is written with a power of ten
_PLAIN = (1e-3, 1e5)
#: angles that people say in degrees, and units that they say with "milli" and "micro"
_ANGLES = ("°", "°/s", "°/s²")
_PREFIXED = ("m", "s", "m/s", "V", "A", "N", "N·m", "W", "J", "T")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class OfStream(Protocol):
    """A row of one stream."""

    @property
    def stream(self) -> str:
        """Its stream."""


class OfEngine(Protocol):
    """A row of one engine."""

    @property
    def source(self) -> str:
        """Its engine."""


def label(validation: Validation, probe: str) -> str:
    """The label of a compared quantity, in lower case unless it begins with an abbreviation."""
    text = validation.compare[probe].label
    # DC and E_n stay as they are
    return text[:1].lower() + text[1:] if text[1:2].islower() else text


def where(validation: Validation, row: OfStream) -> str:
    """The segment of a row where there are several."""
    return f" on {row.stream}" if len(validation.streams) > 1 else ""


def engines_of(rows: Iterable[OfEngine]) -> list[str]:
    """The engines of some rows."""
    return list(dict.fromkeys(row.source for row in rows))


def whose(names: Sequence[str], every: Sequence[str]) -> str:
    """Engines by name, or all of them."""
    if len(every) == len(names) == 2:
        return "both engines"
    if len(every) > 1 and len(names) == len(every):
        return f"all {len(every)} engines"
    return listed(list(names))


def spaced(name: str) -> str:
    """A name with spaces for its underscores."""
    return name.replace("_", " ")


def parameter(name: str) -> str:
    """A parameter without its unit."""
    return spaced(name.removesuffix(units.suffix_of(name)))


def parameters(names: Sequence[str]) -> str:
    """Parameters without their units, with commas and an "and"."""
    return listed([parameter(name) for name in names])


def listed(names: Sequence[str]) -> str:
    """Names with commas and an "and"."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} and {names[-1]}"


def first_up(text: str) -> str:
    """The beginning of a sentence."""
    return text[:1].upper() + text[1:]


def places(recording: str, streams: Sequence[str]) -> str:
    """Streams of a recording; one that has only one is called by its own name."""
    if list(streams) == ["log"]:
        return recording
    return f"{', '.join(streams)} of {recording}"


def ends(low: str, high: str) -> str:
    """The ends of a range as they are written; one number where both are the same."""
    return low if low == high else f"{low} to {high}"


def counted(count: int, noun: str, plural: str = "") -> str:
    """A number of things: ``1 impact``, ``2 impacts``."""
    return f"{count} {noun if count == 1 else plural or noun + 's'}"


def span(shares: Sequence[float]) -> str:
    """The least and the greatest share in per cent."""
    return ends(percent(min(shares)), percent(max(shares)))


def percent(value: float) -> str:
    """A share of 1 in per cent, in two digits."""
    if 0 < value < NOTHING:
        return "below 0.05 %"
    return f"{100 * value:.2g} %" if value < 0.0995 else f"{100 * value:.0f} %"


def people_unit(unit: str, sizes: Iterable[float]) -> tuple[float, str]:
    """A factor and the unit in which people say such sizes: degrees for rad, mm for small lengths.

    Args:
        unit: SI unit.
        sizes: in that unit; the largest is at least 1 in the unit that is returned, if possible.
    """
    symbol = units.symbol(unit)
    turned = symbol.replace("rad", "°")
    if turned in _ANGLES:
        return math.degrees(1.0), turned
    most = max((abs(size) for size in sizes if math.isfinite(size)), default=0.0)
    if symbol not in _PREFIXED or most >= 1 or most == 0:
        return 1.0, symbol
    factor, prefix = (1e3, "m") if most >= 1e-3 else (1e6, "µ")
    return factor, f"{prefix}{symbol}"


def human(value: float, unit: str) -> str:
    """A size in three digits, in a unit that a person uses."""
    factor, symbol = people_unit(unit, [value])
    return sized(factor * value, symbol).replace(" °", "°")


def sized(value: float, unit: str) -> str:
    """A number with its unit, in three digits."""
    shown = units.symbol(unit)
    return _digits(value) + ("" if shown == "1" else f" {shown}")


def _digits(value: float) -> str:
    if value == 0 or _PLAIN[0] <= abs(value) < _PLAIN[1]:
        return f"{value:.3g}".replace("-", "−")
    mantissa, _, power = f"{value:.2e}".partition("e")
    return f"{mantissa}·10{str(int(power)).translate(_RAISED)}".replace("-", "−")


def size_span(values: Sequence[float], unit: str) -> str:
    """The least and the greatest of some sizes, in a unit that a person uses."""
    return ends(*sizes((min(values), max(values)), unit))


def sizes(values: Sequence[float], unit: str) -> list[str]:
    """Some sizes, all in the one unit that a person uses for the largest."""
    factor, symbol = people_unit(unit, values)
    return [sized(factor * value, symbol).replace(" °", "°") for value in values]


def noise_of(validation: Validation, stream: str, probe: str) -> float | None:
    """Standard uncertainty of a sample; ``None`` where it is not known."""
    for case in validation.cases:
        if case.stream == stream:
            return case.probes[probe].u if probe in case.probes else None
    return None


def is_constant(validation: Validation, row: WaveformRecord) -> bool:
    """Whether a measured signal spans no more than its noise, so that its range has no meaning.

    Args:
        validation: the record of the validation.
        row: of its waveforms.
    """
    if row.nrmse is None:
        return True
    u = noise_of(validation, row.stream, row.probe)
    if not u or not row.nrmse:
        return False
    # the range of n normal deviates is about 2·√(2·ln n) standard deviations
    expected = 2 * math.sqrt(2 * math.log(max(row.n, 2))) * u
    return row.rmse / row.nrmse < _NOISE_ALONE * expected
