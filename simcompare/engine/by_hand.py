"""Engines with contact values that the user typed in: the level "by hand"."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from simcompare import units
from simcompare.engine import engines
from simcompare.engine.contacts import bouncing_pairs
from simcompare.engine.own_values import OwnValue
from simcompare.errors import InputError, SimcompareError, UnknownName
from simcompare.model.scenario import Scenario
from simcompare.model.settings import TUNED, PairNumbers, Settings

OPTION = "--own"


@dataclass(frozen=True)
class ByHand:
    """What somebody typed in for some engines.

    Attributes:
        values: engine -> its values by name.
    """

    values: Mapping[str, Mapping[str, float]]

    def settings(self, engine: str, scene: Scenario) -> Settings | None:
        """How an engine is run with its values; ``None`` where it was given none.

        What is not typed in stays as the engine comes where it stands for a restitution. All else
        is as in "tuned", so that what happens is the doing of these values.
        """
        typed = self.values.get(engine)
        if typed is None:
            return None
        own = known(engine)
        numbers = tuple(typed.get(one.name, one.value) for one in own if one.tuned is None)
        other = tuple(
            (one.name, typed[one.name])
            for one in own
            if one.tuned is not None and one.name in typed
        )
        pairs = tuple(PairNumbers(contact.pair, numbers) for contact in bouncing_pairs(scene))
        return Settings(TUNED, numbers=pairs, own=other)


def known(engine: str) -> tuple[OwnValue, ...]:
    """What may be typed in for an engine; nothing where its backend declares nothing."""
    declared: tuple[OwnValue, ...] = getattr(engines.get(engine), "own_values", ())
    return declared


def typed(engine: str, numbers: Sequence[float]) -> dict[str, float]:
    """An engine's numbers for a restitution, such as those of a fit, by the names of its values."""
    found = tuple(numbers)
    as_typed = getattr(engines.get(engine), "as_typed", None)
    values = found if as_typed is None else as_typed(found)
    return {one.name: value for one, value in zip(known(engine), values, strict=False)}


def read(asked: Mapping[str, str | float], chosen: Sequence[str], scene: Scenario) -> ByHand:
    """What was typed in for each engine.

    Args:
        asked: ``{"ENGINE.VALUE": number}``; text may carry a unit.
        chosen: engines that run.
        scene: in which something must bounce.

    Raises:
        InputError: all faults at once.
    """
    faults: list[str] = []
    values: dict[str, dict[str, float]] = {}
    for given, value in asked.items():
        try:
            engine, one = _place(given, chosen)
            values.setdefault(engine, {})[one.name] = _number(one, value, given)
        except SimcompareError as error:
            faults.append(str(error))
    if asked and not bouncing_pairs(scene):
        faults.append(
            f"nothing in {scene.name} has a restitution above 0, so values for a bounce do nothing"
        )
    if faults:
        raise InputError(OPTION, faults)
    return ByHand(values)


def _place(given: str, chosen: Sequence[str]) -> tuple[str, OwnValue]:
    """The engine and its value that a name means."""
    engine, _, name = given.partition(".")
    if engine not in engines.names() and engine not in chosen:
        raise UnknownName("engine", engine, engines.names())
    if engine not in chosen:
        raise InputError(given, [f"{engine} is not among the engines that run"])
    own = {one.name: one for one in known(engine)}
    if not own:
        raise InputError(given, [f"{engine} has no values of its own for a bounce"])
    if name not in own:
        raise UnknownName(f"value of {engine}", name, own)
    return engine, own[name]


def _number(one: OwnValue, value: str | float, given: str) -> float:
    found = units.to_si(value, one.unit, given)
    if not (math.isfinite(found) and one.min <= found <= one.max):
        raise InputError(given, [f"{found:g} is not within {one.min:g} … {one.max:g}"])
    return found
