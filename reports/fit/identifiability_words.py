"""What data can tell about unknowns, in sentences."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from dataclasses import dataclass

from simcompare import units
from simcompare.results.records.fit_forms import Prior
from simcompare.statistics.identifiability import BLIND, Direction, Identifiability

#: correlation that is mentioned
CORRELATED = 0.95
_TITLES = {
    "restitution": "restitution", "exponent": "velocity exponent",
    "terminal_speed_m_s": "terminal speed", "drop_height_m": "drop height",
    "release_time_s": "release time", "clock_skew": "clock skew", "floor_m": "floor level",
    "scale": "length scale",
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
    words = _words(known, _Language(_title, lambda names: _advice(what, names)))
    for name, u in zip(known.names, known.u, strict=True):
        prior = priors.get(name)
        if prior is not None and u is not None and u > 0.9 * prior.u:
            words.append(f"{_title(name)} is known from its prior alone; the data add nothing")
    return tuple(words)


def of_signals(known: Identifiability) -> tuple[str, ...]:
    """What signals over time can tell about parameters of a scenario."""
    return tuple(_words(known, _Language(parameter, _signal_advice)))


def parameter(name: str) -> str:
    """A parameter as people call it: ``damping_N_m_s_rad`` is "damping"."""
    return name.removesuffix(units.suffix_of(name)).replace("_", " ")


def _words(known: Identifiability, language: _Language) -> list[str]:
    weak = [d for d in known.directions if d.weak]
    if weak:
        words = [_weak(d, known.directions[0].singular_value, language) for d in weak]
    else:
        words = [f"all unknowns are determined by the data (condition {known.condition:.0f})"]
    names = known.names
    pairs = [
        (abs(rho), i, j, rho)
        for i, row in enumerate(known.correlation)
        for j, rho in enumerate(row[:i])
        if rho is not None and abs(rho) > CORRELATED
    ]
    for _, i, j, rho in sorted(pairs, reverse=True)[:4]:
        a, b = language.title(names[j]), language.title(names[i])
        words.append(
            f"{a} and {b} are correlated by {rho:+.3f}: an error of one is"
            " made up for by the other, so neither should be quoted without it"
        )
    return words


def _weak(direction: Direction, largest: float, language: _Language) -> str:
    """One combination that the data do not determine, and what would help."""
    kinds = {name.partition("[")[0] for name in direction.moves}
    moves = ", ".join(
        f"{language.title(name)} {move:+.2g}{language.unit(name)}"
        for name, move in direction.moves.items()
    )
    advice = language.advise(kinds)
    if largest > BLIND * direction.singular_value:
        names = ", ".join(language.title(name) for name in direction.moves)
        return f"nothing in the data tells {names} apart: {advice}"
    return (
        f"{advice}. Changing {moves} together moves the data by one standard"
        f" deviation only (condition {largest / direction.singular_value:.0f})"
    )


def _advice(what: str, kinds: Set[str]) -> str:
    if {"terminal_speed_m_s", "exponent"} <= kinds:
        return (f"{what} cannot separate drag from velocity dependence: give the terminal speed"
                " (√(2·m·g/(ρ·c_d·A)) from mass and diameter) as a prior")  # fmt: skip
    if "clock_skew" in kinds:
        return "a fast clock looks like a weaker gravity or a lower drop: give the clock's skew"
    if "scale" in kinds:
        return "a length scale looks like another gravity or drop height: measure a length in it"
    names = " and ".join(_TITLES[kind] for kind in sorted(kinds))
    return f"{what} cannot separate {names}: fix one of them or give a prior"


def _signal_advice(names: Set[str]) -> str:
    together = " and ".join(parameter(name) for name in sorted(names))
    if len(names) == 1:
        return f"the recording hardly changes with {together}: give it (--set)"
    return (
        f"the recording cannot separate {together}: give one of them (--set), or compare another"
        " channel"
    )


def _title(name: str) -> str:
    head, _, rest = name.partition("[")
    return _TITLES[head] + (f" of drop {rest[:-1]}" if rest else "")
