"""Restitution and friction that engines hold per body, and combine by a rule of their own."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

import numpy as np

from simcompare.errors import Unsupported
from simcompare.model.scenario import Scenario

#: how an engine combines the values of two bodies
Rule = Literal["product", "min", "max", "mean", "root", "harmonic"]


def combined(first: float, second: float, rule: Rule) -> float:
    """What an engine makes of the values of two bodies."""
    match rule:
        case "product":
            return first * second
        case "min":
            return min(first, second)
        case "max":
            return max(first, second)
        case "mean":
            return (first + second) / 2
        case "root":
            return math.sqrt(first * second)
        case _:
            return 2 * first * second / (first + second) if first + second else 0.0


_RULE_WORDS = {
    "product": "multiplies", "min": "takes the smaller", "max": "takes the larger",
    "mean": "takes the mean", "root": "takes the root of the product",
    "harmonic": "takes the harmonic mean",
}  # fmt: skip


def per_body(
    scenario: Scenario,
    wanted: Mapping[tuple[str, str], float],
    prop: str,
    rule: Rule,
    engine: str,
) -> dict[str, float]:
    """Values of all bodies whose combinations are those of the pairs.

    Args:
        scenario: the scene.
        wanted: pair -> value.
        prop: what the values are, for the message.
        rule: how the engine combines two of them.
        engine: its name, for the message.

    Raises:
        Unsupported: no values give all of them.
    """
    values = _candidates(scenario, wanted, rule)
    for (first, second), value in wanted.items():
        if abs(value - combined(values[first], values[second], rule)) > 1e-12:
            raise Unsupported(
                f"{engine} holds {prop} per body and {_RULE_WORDS[rule]}: no values give"
                f" {first}-{second} = {value:g} together with the other pairs"
            )
    return values


def _candidates(
    scenario: Scenario, wanted: Mapping[tuple[str, str], float], rule: Rule
) -> dict[str, float]:
    """The values that give all pairs, if any do."""
    match rule:
        case "product":
            return _factors(scenario, wanted)
        case "root":
            squares = {pair: value * value for pair, value in wanted.items()}
            return _factors(scenario, squares)
        case "min" | "max":
            # no body may hold less than its largest pair, or more than its smallest
            pick, own = (max, min)[rule == "max"], {n: list[float]() for n in scenario.bodies}
            for pair, value in wanted.items():
                for name in pair:
                    own[name].append(value)
            return {name: pick(found, default=0.0) for name, found in own.items()}
        case _:
            return _means(scenario, wanted, rule)


def _factors(scenario: Scenario, pairs: Mapping[tuple[str, str], float]) -> dict[str, float]:
    """Per-body values whose products are those of the pairs.

    Fixed bodies hold 1 and moving bodies the value of their pairs with fixed ones, so what is set
    is what the scenario says; two bodies that touch nothing fixed share theirs equally.
    """
    values = {name: 1.0 for name, body in scenario.bodies.items() if body.fixed}
    for pair, wanted in pairs.items():
        moving = [name for name in pair if not scenario.bodies[name].fixed]
        if len(moving) == 1:
            values.setdefault(moving[0], wanted)
    for pair, wanted in pairs.items():
        _share(values, pair, wanted)
    for name in scenario.bodies:  # those that touch nothing
        values.setdefault(name, 0.0)
    return values


def _share(values: dict[str, float], pair: tuple[str, str], wanted: float) -> None:
    """Gives the bodies of a pair that have no value yet one that fits."""
    first, second = pair
    if first not in values and second not in values:
        values[first] = values[second] = math.sqrt(wanted)
    for name, other in ((first, second), (second, first)):
        if name not in values:
            values[name] = wanted / values[other] if values[other] > 0 else 0.0


def _means(
    scenario: Scenario, wanted: Mapping[tuple[str, str], float], rule: Rule
) -> dict[str, float]:
    """Values with these means, or harmonic means: the smallest that solve the linear equations."""
    names = list(scenario.bodies)
    if not wanted:
        return dict.fromkeys(names, 0.0)
    if rule == "harmonic" and not all(wanted.values()):
        return dict.fromkeys(names, 0.0)  # right where all pairs are 0
    rows = np.array([[float(name in pair) for name in names] for pair in wanted])
    sums = np.array([2 / v if rule == "harmonic" else 2 * v for v in wanted.values()])
    found = np.linalg.lstsq(rows, sums, rcond=None)[0]
    if rule == "harmonic":
        found = np.where(found > 0, 1 / np.where(found > 0, found, 1.0), 0.0)
    # a negative value has no meaning in an engine, and is found not to fit
    return dict(zip(names, np.maximum(found, 0.0).tolist(), strict=True))
