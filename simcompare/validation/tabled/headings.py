"""What each column of a table of results holds, by its name and its unit."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.mapping_lines import channels_line, quoted, unit_text
from simcompare.hardware.recordings.results_table import Heading
from simcompare.validation.tabled.meaning import (
    COUNT,
    LEFT_OUT,
    MEASURED,
    PARAMETER,
    TOTAL,
    UNCERTAINTY,
    Guess,
    Meaning,
)
from simcompare.validation.tabled.owners import with_owners
from simcompare.validation.tabled.vocabulary import Entry, Vocabulary, spoken, told, words

#: an uncertainty as a range in which the value certainly lies
_LIMITS = ("±", "+")
_U = frozenset((
    "±", "+", "−", "Δ", "δ", "σ", "u", "uncertainty", "uncertainties", "unc", "error", "err",
    "sigma", "std", "stdev", "sd", "stderr", "sem", "delta", "unsicherheit", "fehler",
    "standard", "deviation"
))  # fmt: skip
#: words before the number of a repeat
_TRIALS = frozenset((
    "trial", "run", "attempt", "try", "measurement", "meas", "reading", "repeat", "rep", "test",
    "versuch", "messung"
))  # fmt: skip
_NUMBER_OF = frozenset(["number", "count", "anzahl", "num", "n", "N"])
#: what is calculated from another column
_DERIVED = re.compile(r"[\^²³√*/=]|sqrt|squared?\b|\blog\b|\bln\b", re.IGNORECASE)


def meanings(
    headings: Sequence[Heading], vocabulary: Vocabulary, faults: list[str]
) -> list[Meaning]:
    """What every column holds.

    Args:
        headings: of all columns, from left to right.
        vocabulary: the names that columns may have.
        faults: what is wrong is added here.
    """
    guesses = [_guess(heading, vocabulary) for heading in headings]
    found = _with_repeats(guesses)
    found = _with_totals(found, vocabulary)
    found = with_owners(found, guesses, vocabulary)
    found = _without_means(found)
    faults += _twice(found)
    faults += _without_unit(found)
    return [_with_factor(one, faults) for one in found]


# ---- one column alone --------------------------------------------------------------------------


def _guess(heading: Heading, known: Vocabulary) -> Guess:
    if not heading.holds_numbers:
        return _left(heading, "holds no numbers")
    name = heading.plain
    if _DERIVED.search(name):
        return _left(heading, "is calculated from another column")
    change = re.match(r"d[A-Z]", name)
    every = words(name[1:] if change else name)
    numbers = tuple(int(word) for word in every if word.isdigit())
    plain = [word for word in every if not word.isdigit()]
    if {*plain} & _U or change:
        return _uncertainty(heading, plain, numbers, known)
    entry = _best(heading, plain, known)
    if entry is not None:
        role = PARAMETER if entry.is_parameter else MEASURED
        counted = bool(told(plain, entry.counted, known.fillers | TOTAL))
        twice = name != heading.name
        return Guess(Meaning(heading, role, entry), numbers, counted and bool(numbers), twice)
    return _unnamed(heading, plain, numbers, known)


def _left(heading: Heading, note: str) -> Guess:
    return Guess(Meaning(heading, LEFT_OUT, note=note))


def _uncertainty(
    heading: Heading, plain: Sequence[str], numbers: tuple[int, ...], known: Vocabulary
) -> Guess:
    """The uncertainty of what the rest of the name says; columns beside it may say more."""
    rest = tuple(word for word in plain if word not in _U)
    is_part = heading.unit in ("%", "percent")
    if is_part and not {*plain} & {"u", "uncertainty", "unsicherheit"}:
        return _left(heading, "may be a deviation from theory; an uncertainty is called u")
    entry = _best(heading, rest, known, fits=not is_part)
    limits = any(word in _LIMITS for word in plain)
    return Guess(Meaning(heading, UNCERTAINTY, entry, limits=limits), numbers, rest=rest)


def _best(
    heading: Heading, plain: Sequence[str], known: Vocabulary, *, fits: bool = True
) -> Entry | None:
    """The parameter or result of which a name has the most words, if its unit fits."""
    found: list[tuple[int, int, int, Entry]] = []
    for entry in known.entries:
        extra = TOTAL if entry.counted else frozenset()
        fillers = known.fillers | _TRIALS
        said = told(plain, entry.called, fillers)
        if entry.counted and not said:
            said = told(plain, entry.counted, fillers | extra)
        if said:
            unit_fits = not fits or _fits(heading.unit, entry.unit)
            found.append((said + unit_fits, said, -len(found), entry))
    return max(found, key=lambda one: one[:3])[3] if found else None


def _unnamed(
    heading: Heading, plain: Sequence[str], numbers: tuple[int, ...], known: Vocabulary
) -> Guess:
    """A repeat that is only numbered, how many were timed together, or nothing that is used."""
    left = {*plain} - known.fillers
    if left and left <= _TRIALS and numbers and heading.unit:
        fitting = [one for one in known.entries if one.name in known.leading
                   and _fits(heading.unit, one.unit)]  # fmt: skip
        if len(fitting) == 1:
            return Guess(Meaning(heading, MEASURED, fitting[0]), numbers)
    counted = {word for one in known.entries for phrase in one.counted for word in phrase}
    if left and left <= _NUMBER_OF | counted and heading.unit in ("", "1"):
        return Guess(Meaning(heading, COUNT))
    return _left(heading, "is neither a parameter nor a result of the scenario")


def _fits(given: str, wanted: str) -> bool:
    """Whether a unit is of the wanted kind; one that is not said may be."""
    if not given:
        return True
    try:
        units.conversion_factor(given, wanted, "")
    except InputError:
        return False
    return True


# ---- columns beside each other -----------------------------------------------------------------


def _with_repeats(guesses: Sequence[Guess]) -> list[Meaning]:
    """Numbers of headings told apart: those of repeats, and how many were timed together."""
    found = []
    for guess in guesses:
        one = guess.meaning
        if one.role != MEASURED or not guess.numbers:
            found.append(replace(one, note="twice") if guess.is_twice else one)
            continue
        last = [
            other.numbers[-1]
            for other in guesses
            if (other.meaning.role, other.meaning.entry) == (one.role, one.entry)
            and len(other.numbers) == len(guess.numbers)
        ]
        are_repeats = len(last) > 1 and sorted(last) == [*range(min(last), min(last) + len(last))]
        counts = guess.numbers[:-1] if are_repeats else guess.numbers
        repeat = guess.numbers[-1] if are_repeats else None
        count = next((n for n in counts if n > 1), 1)
        found.append(replace(one, count=count, repeat=repeat))
    return found


def _with_totals(found: list[Meaning], known: Vocabulary) -> list[Meaning]:
    """The time of many, where a column says of how many it is."""
    if not any(one.role == COUNT for one in found):
        return found
    if any(one.role == MEASURED and one.entry and one.entry.counted for one in found):
        note = "is not needed beside the other columns"
        return [replace(one, role=LEFT_OUT, note=note) if one.role == COUNT else one
                for one in found]  # fmt: skip
    made = []
    for one in found:
        plain = {word for word in words(one.heading.name) if not word.isdigit()} - known.fillers
        fitting = [e for e in known.entries if e.counted and _fits(one.heading.unit, e.unit)]
        if one.role == LEFT_OUT and plain and plain <= TOTAL and one.heading.unit and fitting:
            one = Meaning(one.heading, MEASURED, fitting[0], of_total=True)
        made.append(one)
    return made


def _without_means(found: list[Meaning]) -> list[Meaning]:
    """Repeats stand for themselves: what is calculated from them is left out."""
    better = {
        one.entry.name
        for one in found
        if one.role == MEASURED and one.entry and (one.repeat is not None or one.count > 1)
    }
    note = "is told by the columns that were measured"
    return [
        replace(one, role=LEFT_OUT, note=note)
        if one.role == MEASURED and one.entry and one.entry.name in better
        and one.repeat is None and one.count == 1
        else one
        for one in found
    ]  # fmt: skip


def _twice(found: Sequence[Meaning]) -> Iterator[str]:
    """Columns that hold the same, which nothing tells apart."""
    keys = [
        (one.role, one.entry.name, one.repeat) if one.entry and one.role != LEFT_OUT else None
        for one in found
    ]
    for key in dict.fromkeys(key for key in keys if key and keys.count(key) > 1):
        same = [one for one, other in zip(found, keys, strict=True) if other == key]
        entry = same[0].entry
        assert entry is not None
        places = " and ".join(f"{one.heading.number} ({one.heading.text!r})" for one in same[:4])
        cure = "take one away"
        if key[0] == MEASURED:
            letter = same[0].heading.plain
            cure = f"if they are repeats, number them: {letter} 1, {letter} 2; else {cure}"
        of = " the uncertainty of" if key[0] == UNCERTAINTY else ""
        yield f"columns {places} both hold{of} the {spoken(entry)}; {cure}"


def _with_factor(one: Meaning, faults: list[str]) -> Meaning:
    if one.role in (LEFT_OUT, COUNT) or one.entry is None:
        return one
    unit, wanted = one.heading.unit, one.entry.unit
    if one.role == UNCERTAINTY and unit in ("%", "percent"):
        return replace(one, factor=0.01, relative=True)
    if not unit and wanted != "1":
        return one  # all that say none are told together
    try:
        factor = units.conversion_factor(unit, wanted, "") if unit else 1.0
    except InputError as error:
        faults.append(f"column {one.heading.number} ({one.heading.text!r}): {error.faults[0]}")
        return one
    return replace(one, factor=factor * one.heading.scale / one.count)


def _without_unit(found: Sequence[Meaning]) -> Iterator[str]:
    """That columns say no unit, with the line of a mapping file that says all of them."""
    bare = {
        one.heading: one.entry
        for one in found
        if one.entry and one.role in (PARAMETER, MEASURED, UNCERTAINTY)
        and not one.heading.unit and one.entry.unit != "1"
    }  # fmt: skip
    if not bare:
        return
    named = " and ".join(f"{one.number} ({one.plain!r})" for one in bare)
    lines = [_line(heading, entry) for heading, entry in bare.items()]
    first, entry = next(iter(bare.items()))
    several = len(bare) > 1
    yield (
        f"column{'s' if several else ''} {named} {'say' if several else 'says'} no unit; write it"
        f" into the heading, such as {first.plain} ({_usual(entry)}), or into a mapping file"
        f" (--map): {channels_line(*lines)}"
    )


def _line(heading: Heading, entry: Entry) -> str:
    name = spoken(entry).replace(" ", "_")
    return f"{name}: {{column: {quoted(heading.name)}, unit: {unit_text(_usual(entry))}}}"


def _usual(entry: Entry) -> str:
    """The unit in which a quantity is mostly written."""
    return "deg" if entry.unit == "rad" else units.symbol(entry.unit)
