"""What data can tell about unknowns, in sentences."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from dataclasses import dataclass

from simcompare import units
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_forms import Prior, Unknown
from simcompare.statistics.identifiability import BLIND, Direction, Identifiability

_SPEED, _SLOPE = "terminal_speed_m_s", "exponent"
#: kind of a recording -> what of it is fitted, where that says more
_RECORDED = {"stopwatch": "impact times"}
#: correlation that is mentioned
CORRELATED = 0.95
_TITLES = {
    "restitution": "restitution", "exponent": "exponent",
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
    known: Identifiability,
    priors: Mapping[str, Prior],
    recorded: str,
    parameters: Mapping[str, Unknown] | None = None,
) -> tuple[str, ...]:
    """What drops can tell about the unknowns of a closed form.

    Args:
        known: what was found.
        priors: what was known of unknowns.
        recorded: kind of what was recorded, such as "sound".
        parameters: what was found of the unknowns.
    """
    sure = _sure(parameters or {})

    def advise(kinds: Set[str]) -> str:
        return _advice(recorded, kinds - sure, priors) if kinds - sure else ""

    words = _words(known, _Language(called, advise))
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
    told = [
        f"{language.title(names[j])} and {language.title(names[i])} ({_near_one(rho)})"
        for _, i, j, rho in sorted(pairs, reverse=True)[:4]
    ]
    if told:
        words.append(f"these go together, with their correlation: {', '.join(told)}; quote both")
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
        words = [blind + (" apart" if len(direction.moves) > 1 else ""), advice]
        return [text for text in words if text]
    moves = ", ".join(
        f"{language.title(name)} {move:+.2g}{language.unit(name)}".replace("-", "−")
        for name, move in direction.moves.items()
    )
    return [text for text in (advice, f"the noise hides this change: {moves}") if text]


def _sure(parameters: Mapping[str, Unknown]) -> set[str]:
    """Drag and slope where a 95 % interval says that they are there: these were separated."""
    speed, slope = parameters.get(_SPEED), parameters.get(_SLOPE)
    sure = {_SPEED} if speed is not None and _is_drag(speed) else set()
    return sure | ({_SLOPE} if slope is not None and _is_slope(slope) else set())


def _is_drag(speed: Unknown) -> bool:
    """Whether the terminal speed has an upper end: the ball is slowed by the air."""
    return speed.value is not None and speed.high is not None and not speed.open_high


def _is_slope(slope: Unknown) -> bool:
    """Whether the interval of the exponent leaves 0 out."""
    return (slope.low is not None and slope.low > 0) or (slope.high is not None and slope.high < 0)


def _advice(recorded: str, kinds: Set[str], priors: Mapping[str, Prior]) -> str:
    what = f"by the {_RECORDED.get(recorded, recorded)}"
    if {_SPEED, _SLOPE} <= kinds:
        if _SPEED in priors:
            return (f"drag and a restitution that depends on speed are hardly separated {what}: a"
                    " terminal speed that is better known helps")  # fmt: skip
        return (
            f"drag and a restitution that depends on speed are not separated {what}: give the"
            " terminal speed, √(2·m·g/(ρ·c_d·A)) from mass and diameter, with --prior"
        )
    if "clock_skew" in kinds:
        return "a fast clock looks like a weaker gravity or a lower drop: give the clock's skew"
    if "scale" in kinds:
        return "a length scale looks like another gravity or drop height: measure a length"
    names = " and ".join(_TITLES[kind] for kind in sorted(kinds))
    if len(kinds) == 1:
        return f"the {names} is hardly told {what}: give it with --fix or --prior"
    return f"{names} are not separated {what}: give one of them with --fix or --prior"


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
