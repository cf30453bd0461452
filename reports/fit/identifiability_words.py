"""What data can tell about unknowns, in sentences."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from dataclasses import dataclass

from simcompare import units
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_forms import Prior
from simcompare.statistics.identifiability import BLIND, Direction, Identifiability

#: correlation that is mentioned
CORRELATED = 0.95
_TITLES = {
    "restitution": "restitution", "exponent": "velocity exponent",
    "terminal_speed_m_s": "terminal speed", "drop_height_m": "drop height",
    "release_time_s": "release time", "clock_skew": "clock skew", "floor_m": "floor level",
    "scale": "length scale", "gravity_m_s2": "gravity",
}  # fmt: skip


@dataclass(frozen=True)
class _Language:
    """How unknowns are called, and what would help where the data do not separate them."""

    title: Callable[[str], str]
    advise: Callable[[Set[str]], str]

    def unit(self, name: str) -> str:
        """The unit of an unknown after a number, with a space before it."""
        symbol = units.symbol(units.unit_of(name.partition("[")[0]))
        return "" if symbol == "1" else f" {symbol}"


def of_bounces(
    known: Identifiability, priors: Mapping[str, Prior], *, filmed: bool
) -> tuple[str, ...]:
    """What drops can tell about the unknowns of a closed form.

    Args:
        known: what was found.
        priors: what was known of unknowns.
        filmed: whether a drop was filmed, not only heard.
    """
    what = "video" if filmed else "sound"
    words = _words(known, _Language(called, lambda names: _advice(what, names, priors)))
    for name, u in zip(known.names, known.u, strict=True):
        prior = priors.get(name)
        if prior is not None and u is not None and u > 0.9 * prior.u:
            words.append(f"the {called(name)} is known from its prior alone")
    return tuple(words)


def of_signals(known: Identifiability) -> tuple[str, ...]:
    """What signals over time can tell about parameters of a scenario."""
    return tuple(_words(known, _Language(phrases.parameter, _signal_advice)))


def _words(known: Identifiability, language: _Language) -> list[str]:
    weak = [d for d in known.directions if d.weak]
    words = [text for d in weak for text in _weak(d, known.directions[0].singular_value, language)]
    if not weak:
        count = len(known.names)
        words = ["the data determine " + ("all unknowns" if count > 1 else "the unknown")]
    names = known.names
    pairs = [
        (abs(rho), i, j, rho)
        for i, row in enumerate(known.correlation)
        for j, rho in enumerate(row[:i])
        if rho is not None and abs(rho) > CORRELATED
    ]
    for _, i, j, rho in sorted(pairs, reverse=True)[:4]:
        a, b = language.title(names[j]), language.title(names[i])
        words.append(f"{a} and {b} go together (correlation {_near_one(rho)}): quote both")
    return words


def _near_one(value: float) -> str:
    # what is below 1 must not be rounded to it
    digits = next((n for n in (2, 3, 4, 5) if abs(value) < 1 - 0.5 / 10**n), 6)
    return f"{value:.{digits}f}".replace("-", "−")


def _weak(direction: Direction, largest: float, language: _Language) -> list[str]:
    """One combination that the data do not determine, and what would help."""
    kinds = {name.partition("[")[0] for name in direction.moves}
    names = phrases.listed([language.title(name) for name in direction.moves])
    advice = language.advise(kinds)
    if largest > BLIND * direction.singular_value:
        blind = "the data do not tell " + names
        return [blind + (" apart" if len(direction.moves) > 1 else ""), advice]
    moves = ", ".join(
        f"{language.title(name)} {move:+.2g}{language.unit(name)}".replace("-", "−")
        for name, move in direction.moves.items()
    )
    return [advice, f"the noise hides this change: {moves}"]


def _advice(what: str, kinds: Set[str], priors: Mapping[str, Prior]) -> str:
    if {"terminal_speed_m_s", "exponent"} <= kinds:
        if "terminal_speed_m_s" in priors:
            return (f"a {what} hardly separates drag from a restitution that depends on speed: a"
                    " terminal speed that is better known helps")  # fmt: skip
        return (
            f"a {what} cannot separate drag from a restitution that depends on speed: give the"
            " terminal speed, √(2·m·g/(ρ·c_d·A)) from mass and diameter, with --prior"
        )
    if "clock_skew" in kinds:
        return "a fast clock looks like a weaker gravity or a lower drop: give the clock's skew"
    if "scale" in kinds:
        return "a length scale looks like another gravity or drop height: measure a length"
    names = " and ".join(_TITLES[kind] for kind in sorted(kinds))
    return f"a {what} cannot separate {names}: give one of them with --fix or --prior"


def _signal_advice(names: Set[str]) -> str:
    together = " and ".join(phrases.parameter(name) for name in sorted(names))
    if len(names) == 1:
        return f"the recording hardly depends on {together}: give it with --set"
    return (
        f"the recording cannot separate {together}: give one of them with --set, or compare"
        " another channel"
    )


def called(name: str) -> str:
    """An unknown of a bounce as people call it, with its drop."""
    head, _, rest = name.partition("[")
    return _TITLES[head] + (f" of drop {rest[:-1]}" if rest else "")
