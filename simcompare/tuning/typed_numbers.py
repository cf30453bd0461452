"""An engine's own numbers for a restitution, as somebody types them in."""

from __future__ import annotations

import math
from collections.abc import Mapping

from simcompare.engine import engines
from simcompare.errors import InputError
from simcompare.model.settings import COEFFICIENT, SPRING


def numbers_of(options: Mapping[str, str], engine: str) -> tuple[float, ...]:
    """Numbers from an option that is called as an engine calls them, such as ``--elasticity``.

    Args:
        options: name without dashes -> text; none, or one.
        engine: the one engine that was named.

    Raises:
        InputError: an option that is none, of no engine, given twice, or without such numbers.
    """
    if not options:
        return ()
    chosen = engines.select(engine)
    called = getattr(engines.get(chosen[0]), "typed_as", "") if len(chosen) == 1 else ""
    for name in options:
        if name.lower() != called.lower():
            cure = f"{chosen[0]} calls it --{called}" if called else "--numbers needs --engine NAME"
            raise InputError(f"--{name}", [f"there is no such option; {cure}"])
    if len(options) > 1:
        raise InputError(f"--{called}", ["is given twice"])
    ((name, text),) = options.items()
    numbers = read_numbers(text, f"--{name}")
    check_numbers(chosen[0], numbers, f"--{name}")
    return numbers


def read_numbers(text: str, where: str) -> tuple[float, ...]:
    """Numbers with commas or blanks between them.

    Raises:
        InputError: it is not that.
    """
    parts = text.replace(",", " ").split()
    try:
        found = tuple(float(part) for part in parts)
    except ValueError:
        found = ()
    if not found:
        raise InputError(where, [f"{text!r}: expected a number, or several with commas"])
    return found


def check_numbers(engine: str, numbers: tuple[float, ...], where: str) -> None:
    """Refuses what is no spring and damper, or no coefficient, as the engine takes it.

    Raises:
        InputError: it is not; says what is.
    """
    backend = engines.get(engine)
    called = getattr(backend, "typed_as", "") or "restitution"
    if getattr(backend, "bounces_by", COEFFICIENT) == SPRING:
        wanted = "two numbers, both above 0 or both below"
        is_right = len(numbers) == 2 and (min(numbers) > 0 or max(numbers) < 0)
    else:
        wanted = "one number above 0"
        is_right = len(numbers) == 1 and numbers[0] > 0
    if not is_right or not all(map(math.isfinite, numbers)):
        given = ", ".join(f"{value:g}" for value in numbers)
        raise InputError(where, [f"{given}: {called} of {engine} is {wanted}"])
