"""One line of a data sheet in SI, with the rule that makes a distribution of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from simcompare.hardware.sensors import sheet_units
from simcompare.hardware.sensors.device import REFERENCE_C
from simcompare.hardware.sensors.sheet_file import EntryFile
from simcompare.hardware.sensors.sheet_rules import CHOICES, RULE_OF_KIND, RULES, Rule, Stated
from simcompare.hardware.sensors.sheet_terms import TERMS, Term
from simcompare.statistics.distributions import Distribution


@dataclass(frozen=True)
class Entry:
    """One line of a data sheet.

    Attributes:
        name: of the entry, unique in its part, such as ``offset_xy``.
        term: which term of the error model it states.
        title: the term in words.
        says: what the sheet calls it.
        text: the value as the sheet states it.
        kind: typ, max, min_max, typ_max, rms or density.
        unit: SI unit of the distribution.
        axes: letters of its axes.
        ranges: names of the ranges for which it holds; empty: all.
        stated: its numbers in SI.
        rule: by which it becomes a distribution.
        bandwidth_Hz: at which an rms was stated; ``nan`` where it is that of one reading.
        about: reading at which a sensitivity is not off, SI.
        used: whether it is a part of the error model; otherwise a cross-check.
        page: page or table of the source.
        confirmed: whether it was read in the maker's own text.
        source: document and revision.
        note: what was assumed.
    """

    name: str
    term: str
    title: str
    says: str
    text: str
    kind: str
    unit: str
    axes: str
    ranges: tuple[str, ...]
    stated: Stated
    rule: Rule
    bandwidth_Hz: float
    about: float
    used: bool
    page: str
    confirmed: bool
    source: str
    note: str

    @property
    def distribution(self) -> Distribution:
        """What is known of the deviation of one device; of noise, of one reading or its density."""
        return self.rule.known(self.stated)

    @property
    def rule_in_words(self) -> str:
        """The rule as a student can repeat it."""
        return f"{self.title}: the sheet says {self.text}. {self.rule.words}"

    def holds_for(self, range_name: str, axis: str) -> bool:
        """Whether it is used for this range and axis."""
        return self.used and axis in self.axes and (not self.ranges or range_name in self.ranges)

    def with_sigma(self, typ_is_sigma: float) -> Entry:
        """The same where another part of a typical value is one standard deviation."""
        return replace(self, stated=replace(self.stated, typ_is_sigma=typ_is_sigma))


def faults_of_kind(given: EntryFile) -> Iterator[tuple[str, str]]:
    """Place and sentence of what is wrong with an entry before its numbers are read."""
    term = TERMS.get(given.term)
    if term is None:
        yield "term", f"no term is called {given.term!r}; known: {', '.join(TERMS)}"
        return
    if not given.kind:
        yield "", f"expected one value or a pair: {_KINDS_WANTED}"
    elif given.kind not in term.kinds:
        wanted = " or ".join(kind.replace("_", " and ") for kind in term.kinds)
        yield "", f"{given.kind} says nothing of {given.term}; expected {wanted}"
    if given.rule is not None:
        yield from (("rule", fault) for fault in _faults_of_rule(given.rule, given.kind, term))
    if given.over_C is not None and term.per != "K":
        yield "over_C", "only what changes with temperature has a range of temperatures"
    if given.bandwidth is not None and given.rms is None:
        yield "bandwidth", "only an rms was stated at a bandwidth; leave it out"
    for name in ("within", "about"):
        if getattr(given, name) is not None and given.term != "sensitivity":
            yield name, "only a sensitivity is stated so; leave it out"


def _faults_of_rule(name: str, kind: str, term: Term) -> Iterator[str]:
    if name not in CHOICES:
        yield f"no rule is called {name!r} that can be chosen; known: {', '.join(CHOICES)}"
    elif term.is_noise:
        yield "noise has the rule of its kind; leave it out"
    elif "typ" in RULES[name].needs and kind in ("max", "min_max"):
        yield f"{name} needs a typical value; state typ, or choose another rule"
    elif name == "truncated_normal" and kind == "typ":
        yield f"{name} needs limits; state max, or choose another rule"


_KINDS_WANTED = "typ, max, min and max, typ and max, rms or density"


def entry(given: EntryFile, unit: str, axes: str, count: float, source: str) -> Entry:
    """The entry in SI.

    Args:
        given: as it stands in the file.
        unit: of the signal.
        axes: of the part.
        count: size of one count, of values that are stated in LSB.
        source: of the sheet.

    Raises:
        ValueError: a number that cannot be read, or that no sensor has; place and sentence.
    """
    term = TERMS[given.term]
    own = axes if given.axes is None else given.axes
    base = "1" if term.relative else unit
    suffix = "" if own == axes else f"_{own}"
    suffix += "".join(f"_{name.replace(' ', '')}" for name in given.ranges)
    return Entry(
        name=given.term + suffix + ("" if given.used else "_check"),
        term=given.term,
        title=term.title,
        says=given.says,
        text=_text(given),
        kind=given.kind,
        unit=sheet_units.written(base, "" if given.rms is not None else term.per),
        axes=own,
        ranges=given.ranges,
        stated=_Amounts(given, unit, count).stated(),
        rule=RULES[given.rule or term.rule or RULE_OF_KIND[given.kind]],
        bandwidth_Hz=_frequency(given.bandwidth),
        about=0.0 if given.about is None else _read("about", given.about, unit),
        used=given.used,
        page=f"p. {given.page}" if isinstance(given.page, int) else given.page,
        confirmed=given.confirmed,
        source=given.source or source,
        note=given.note,
    )


def _frequency(text: str | None) -> float:
    return math.nan if text is None else _read("bandwidth", text, "Hz")


def _read(name: str, text: str, unit: str, per: str = "") -> float:
    try:
        return sheet_units.amount(text, unit, per)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


class _Amounts:
    """The numbers of an entry in SI."""

    def __init__(self, given: EntryFile, unit: str, count: float) -> None:
        term = TERMS[given.term]
        self.given, self.unit, self.count = given, unit, count
        self.base = "1" if term.relative and given.within is None else unit
        # an rms is in the unit of the signal; a change over temperatures is not yet divided
        self.per = "" if given.rms is not None or given.over_C is not None else term.per
        self.span = 1.0
        if given.over_C is not None:
            self.span = _span(given.over_C)
        if given.within is not None:
            self.span = _read("within", given.within, unit)

    def stated(self) -> Stated:
        """All of them.

        Raises:
            ValueError: one cannot be read, or no sensor has it.
        """
        given = self.given
        if given.kind in ("rms", "density"):
            return Stated(given.kind, typ=self._size(given.kind))
        typ = math.nan if given.typ is None else self._size("typ")
        if given.max is None:
            return Stated(given.kind, typ=typ)
        high = self._deviation("max")
        low = -high if given.min is None else self._deviation("min")
        if not low < high:
            wrong = f"{given.max} is not above {given.min or 0}"
            raise ValueError(f"max: {wrong}; expected the larger one")
        if typ > max(abs(low), abs(high)):
            raise ValueError(f"max: {given.max} is below the typical {given.typ}; expected more")
        return Stated(given.kind, typ=typ, low=low, high=high)

    def _size(self, name: str) -> float:
        value = self._deviation(name)
        if not value > 0:
            text = getattr(self.given, name)
            raise ValueError(f"{name}: {text} is no size; expected a number above 0")
        return value

    def _deviation(self, name: str) -> float:
        """A value as a deviation: 282 LSB/g where 256 LSB/g are nominal is +10.2 %."""
        text = getattr(self.given, name)
        try:
            if self.given.nominal is not None and sheet_units.is_counts(text):
                nominal = sheet_units.step(self.given.nominal, self.unit)
                return nominal / sheet_units.step(text, self.unit) - 1
            if text.endswith(" LSB") and self.count:
                return float(text.removesuffix(" LSB")) * self.count
            return sheet_units.amount(text, self.base, self.per) / self.span
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None


def _span(over_C: tuple[float, float]) -> float:
    """Largest distance from the reference temperature, at which the change is the largest."""
    low, high = over_C
    if not low < high:
        raise ValueError(f"over_C: {low:g} to {high:g} is no range; expected the lower one first")
    return max(abs(low - REFERENCE_C), abs(high - REFERENCE_C))


def _text(given: EntryFile) -> str:
    """The value as the sheet states it."""
    if given.kind in ("min_max", "typ_max") and given.min is not None:
        text = f"{given.min} to {given.max}"
    elif given.kind in ("max", "typ_max"):
        text = f"at most ±{str(given.max).lstrip('±')}"
    else:
        text = str(getattr(given, given.kind))
        signed = given.kind == "typ" and TERMS[given.term].kinds != ("typ",)
        text = f"±{text.lstrip('±')}" if signed else text
    if given.kind == "typ_max":
        text = f"±{str(given.typ).lstrip('±')} typical, {text}"
    if given.within is not None:
        text += f" within {given.within}"
    if given.over_C is not None:
        text += f" from {given.over_C[0]:g} to {given.over_C[1]:g} °C"
    return f"{text} at {given.bandwidth}" if given.bandwidth else text
