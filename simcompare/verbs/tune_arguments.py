"""The arguments of ``tune`` as numbers in SI, or an error that says what is expected."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare import notation, units
from simcompare.comparison.repeats import one_step_s, step_found, step_wanted
from simcompare.errors import InputError

#: steps that make sense for something that bounces [s]
MIN_STEP_S, MAX_STEP_S = 1e-6, 0.1


def speeds_m_s(speed: str | float | Sequence[float]) -> tuple[float, float]:
    """The lowest and the highest impact speed.

    Raises:
        InputError: it is neither a speed nor a range.
    """
    parts: list[str | float]
    if isinstance(speed, str):
        parts = [*speed.split("..")]
    else:
        parts = [float(speed)] if isinstance(speed, (int, float)) else [*speed]
    if not 1 <= len(parts) <= 2 or any(isinstance(p, str) and not p.strip() for p in parts):
        raise InputError("--speed", [f"{speed}: expected one speed, or a range such as 1..2m/s"])
    unit = _unit_of(parts[-1])
    values = [above_0(_with_unit(part, unit), "m/s", "--speed") for part in parts]
    if values[0] > values[-1]:
        raise InputError("--speed", [f"{speed}: the first speed is above the second"])
    return values[0], values[-1]


def _unit_of(text: str | float) -> str:
    return "" if not isinstance(text, str) else text.strip().lstrip("+-0123456789.,eE").strip()


def _with_unit(text: str | float, unit: str) -> str | float:
    """A part of a range, in the unit that stands behind the other: ``50..400cm/s``."""
    return f"{text}{unit}" if isinstance(text, str) and not _unit_of(text) else text


def step_s(step: str | float) -> float:
    """A step that makes sense for something that bounces.

    Raises:
        InputError: it is no time, or too short or too long.
    """
    found = one_step_s(step)
    if not MIN_STEP_S <= found <= MAX_STEP_S:
        wrong = f"too {'short' if found < MIN_STEP_S else 'long'} for an impact"
        use = step_wanted(found, MIN_STEP_S, MAX_STEP_S, "1ms")
        raise InputError("--step", [f"{step_found(step, found)} is {wrong}; {use}"])
    return found


def above_0(value: str | float, unit: str, where: str) -> float:
    """A value above 0.

    Raises:
        InputError: it is not.
    """
    found = units.to_si(value, unit, where)
    if not found > 0:
        raise InputError(where, [f"{value}: expected a number above 0 in {units.symbol(unit)}"])
    return found


def between(value: str | float, unit: str, where: str, limits: tuple[float, float]) -> float:
    """A value within limits.

    Raises:
        InputError: it is not; names them.
    """
    found = above_0(value, unit, where)
    if not limits[0] <= found <= limits[1]:
        meant = notation.meant(found, unit, *limits)
        hint = f"; did you mean {meant}?" if meant else ""
        raise InputError(where, [f"{value}: expected {notation.span(*limits, unit)}{hint}"])
    return found


def part(value: str | float, where: str) -> float:
    """A part of something, between 0 and 1.

    Raises:
        InputError: it is not.
    """
    found = units.to_si(value, "1", where)
    if not 0 < found < 1:
        raise InputError(where, [f"{value}: expected a part between 0 and 1, such as 0.01 or 1%"])
    return found
