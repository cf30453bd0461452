"""The unit that stands at the end of a name, where nothing else can be meant."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from simcompare import units
from simcompare.hardware.conditioning.units import quantity
from simcompare.units import endings, spelling

#: units that are words of their own: in names they are nothing else
_TELLING = frozenset(
    ("rpm", "volts", "amps", "watts", "newtons", "psi", "celsius", "fahrenheit", "degc", "hpa",
     "kpa", "mbar", "knots", "mph", "dps")
)  # fmt: skip
_CAPITALS = {suffix.upper() for suffix in units.UNITS_BY_SUFFIX}
#: signs that are no letters are units wherever they end a name
_SIGNS = re.compile(r"(.*[\w)\]])\s*(°/s|°[CF]?|℃|%|Ω)")
_PER = ("per", "pro")


@dataclass(frozen=True)
class Ending:
    """What a name says of its unit.

    Attributes:
        stem: the name without it.
        unit: as it is written with signs, empty where the name does not decide.
        proposed: what it may be then.
    """

    stem: str
    unit: str = ""
    proposed: str = ""


def of(name: str, names: Sequence[str] = ()) -> Ending:
    """The unit that a name ends with; ``omega_m`` is no length, ``phase_A`` beside ``_B`` none.

    Args:
        name: of a column.
        names: of all columns beside it.
    """
    end = Ending(name) if _is_index(name, names) else _ending(name)
    return end if quantity.si_of(end.proposed) else replace(end, proposed="")


def _ending(name: str) -> Ending:
    match = _SIGNS.fullmatch(name)
    every = endings.words(name)
    if match or (len(every) > 1 and "/" in every[-1] and units.is_written(every[-1])):
        return Ending(match[1], match[2]) if match else Ending(_stem(name, 1), every[-1])
    if {*_PER} & {word.lower() for word in every[1:-1]}:
        return _per(name, every)
    run = endings.run(name)
    own = units.suffix_of(name.rstrip("_ "))
    if endings.is_several(name, own):
        return _several(name, run, own)
    return _own(name, own) if own else _one(name, run, every[-1])


def _is_index(name: str, names: Sequence[str]) -> bool:
    """Whether the last letter counts, as in ``phase_A`` beside ``phase_B``."""
    alike = [other for other in names if other[:-1] == name[:-1] and other != name]
    beside = [other[-2:].upper() for other in alike]
    return name[-2:-1] == "_" and any(end[1].isalpha() and end not in _CAPITALS for end in beside)


def _stem(name: str, words: int) -> str:
    """A name without its last words; itself where nothing is left."""
    every = endings.words(name)
    return "_".join(every[:-words]) or name


def _per(name: str, every: Sequence[str]) -> Ending:
    """``rate_rad_per_s``; what is no unit over another is no unit alone either."""
    at = max(i for i, word in enumerate(every[:-1]) if word.lower() in _PER)
    text = f"{every[at - 1]}/{'*'.join(every[at + 1 :])}"
    known = units.is_written(text) or every[at - 1] in ("count", "counts", "ticks", "px")
    return Ending("_".join(every[: at - 1]) or name, text) if known else Ending(name)


def _own(name: str, suffix: str) -> Ending:
    """One of the suffixes that names have here."""
    stem = name.rstrip("_ ").removesuffix(suffix)
    unit, known = units.unit_of(f"x{suffix}"), quantity.of_letter(stem)
    if known and unit not in known:
        return Ending(name)
    said = quantity.possible(stem)
    rate = said - {"s"} or "rate" in quantity.words(stem)
    if suffix == "_s" and rate and "s" not in said and not quantity.is_time(stem):
        return Ending(name, "", "s")  # tick_rate_s, speed_s
    return Ending(name.rstrip("_ "), unit)


def _several(name: str, run: Sequence[str], own: str) -> Ending:
    """A run of units that is longer than the suffix at its end: ``flow_l_s``, ``kv_rpm_V``."""
    stem = _stem(name, len(run))
    counted = [word for word in run if word in ("px", "count", "counts", "ticks", "LSB")]
    if counted:
        return Ending(stem, "/".join(run))
    texts = list(_placed(endings.readings(run[-3:])))
    if len(run) == 1 + (own.count("_") or 1) and endings.is_weak(run[0]):
        texts += [units.unit_of(f"x{own}") if own else run[-1]]
    if run[-1] == "s" and quantity.is_time(stem):
        return Ending(name, "s")
    said = quantity.possible(stem)
    if run[-1][-1].isdigit() and not said:  # kg_cm2 may be a pressure or an inertia
        return Ending(name)
    fitting = [text for text in texts if not said or {*_si(text)} & said]
    if len({si for text in fitting for si in _si(text) or ("?",)}) == 1:
        if fitting[0] == units.unit_of(f"x{own}"):
            return Ending(name, fitting[0])
        return Ending(_stem(name, 1) if fitting[0] == run[-1] else stem, fitting[0])
    return Ending(name, "", next(iter(fitting or texts), ""))


def _placed(texts: Iterable[str]) -> Iterator[str]:
    """Readings that are units; those over a time also where none has a place."""
    for text in texts:
        over_time = text.endswith(("/s", "/min", "/h")) and text.count("/") == 1 and "*" not in text
        if {*_si(text)} - {"1"} or (over_time and spelling.read(text)):
            yield text


def _si(text: str) -> tuple[str, ...]:
    """SI units of every meaning of a text."""
    return tuple(filter(None, map(quantity.si_of, units.ways(text))))


def _one(name: str, run: Sequence[str], last: str) -> Ending:
    """One word at the end, which fits to what the name measures in one way only."""
    stem = _stem(name, 1)
    if last.lower() in _TELLING:
        return Ending(stem, last)
    if last in ("px", "pixel", "pixels"):
        return Ending(stem, last)
    told = quantity.words(name)
    if told[:1] == ["rpm"] and not {*told} & (quantity.OTHERWISE | quantity.GAINS):
        return Ending(name, "rpm")  # rpm_left
    said = quantity.measured(stem) if len(endings.words(name)) > 1 else frozenset()
    every = [way for way in spelling.any_case(last) if quantity.si_of(way)]
    ways = {units.si_of(way, ""): way for way in every[::-1]}
    fitting = [way for (_, _, si), way in ways.items() if si in said][::-1]
    if len(fitting) == 1 and last != "in":
        return Ending(stem, fitting[0])
    usual = units.nearest(last)
    likely = [usual] if usual in fitting else fitting or [last] * (len(last) > 1 and bool(run))
    return Ending(name, "", next((text for text in likely if text != "min"), ""))
