"""``${…}`` expressions over parameters, evaluated by the library ``simpleeval``, never ``eval``."""

from __future__ import annotations

import ast
import functools
import math
import operator
import re
import warnings
from collections.abc import Mapping
from typing import Any

import simpleeval

#: everything an expression may call
FUNCTIONS = {
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "atan2": math.atan2,
    "abs": abs,
    "min": min,
    "max": max,
}
_OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    # of floats, as whole numbers may grow without end
    ast.Mult: lambda a, b: float(a) * float(b),
    ast.Pow: lambda a, b: float(a) ** float(b),
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: lambda a, b: float(a) % float(b),
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Not: operator.not_,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
#: characters of an expression that are evaluated, and those that a message repeats
_MOST, _SHOWN = 10_000, 100
CONSTANTS = {"pi": math.pi}
_EXPRESSION = re.compile(r"^\s*\$\{(.*)\}\s*$", re.DOTALL)


class ExpressionError(ValueError):
    """An expression that cannot be evaluated; the message says why."""


def is_expression(value: object) -> bool:
    """Whether a value from YAML is a ``${…}`` expression."""
    return isinstance(value, str) and _EXPRESSION.match(value) is not None


@functools.cache
def _evaluator() -> Any:  # noqa: ANN401
    evaluator = simpleeval.SimpleEval(operators=_OPERATORS, functions=FUNCTIONS)
    # numbers have methods, and none of them belongs here; nor does an assignment
    for node in (ast.Attribute, ast.Assign, ast.AugAssign):
        del evaluator.nodes[node]
    return evaluator


@functools.lru_cache(maxsize=4096)
def _parsed(source: str) -> Any:  # noqa: ANN401
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # simpleeval only warns when it drops a part
        return _evaluator().parse(source)


def evaluate(text: str, names: Mapping[str, float]) -> float:
    """Evaluates ``"${a + b}"`` with the given names.

    Args:
        text: the expression with its ``${`` and ``}``.
        names: values that the expression may use, in SI units.

    Returns:
        The finite number.

    Raises:
        ExpressionError: a syntax error, an unknown name, or a result that is not a finite number.
    """
    return _value(text, {**CONSTANTS, **names})


def _value(text: str, known: dict[str, float]) -> float:
    """The number of an expression, from all that it may name."""
    match = _EXPRESSION.match(text)
    if match is None:
        raise ExpressionError(f"{text!r} is not of the form ${{…}}")
    shown = text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"
    if len(text) > _MOST:
        raise ExpressionError(f"{shown} has {len(text)} characters; at most {_MOST} are evaluated")
    evaluator = _evaluator()
    evaluator.names = known
    try:
        source = match[1].strip()
        value = evaluator.eval(source, previously_parsed=_parsed(source))
        if not isinstance(value, bool) and isinstance(value, int | float):
            number = float(value)
            if math.isfinite(number):
                return number
    except OverflowError:
        raise ExpressionError(f"{shown} makes a number that is too large") from None
    # simpleeval raises many kinds; all mean the same here
    except Exception as error:  # noqa: BLE001
        raise ExpressionError(f"{shown} cannot be evaluated: {error!s:.300}") from None
    raise ExpressionError(f"{shown} gives {value!r:.60}, not a finite number")


def resolve(node: Any, names: Mapping[str, float], path: str, faults: dict[str, str]) -> Any:  # noqa: ANN401
    """A copy of a YAML tree with every ``${…}`` replaced by its number.

    Args:
        node: dict, list or scalar as read from YAML.
        names: values that expressions may use.
        path: dotted place of ``node``, for the faults.
        faults: every fault is added here as place -> sentence.
    """
    known, found = {**CONSTANTS, **names}, dict[str, float]()

    def filled(node: Any, place: Any) -> Any:  # noqa: ANN401
        if isinstance(node, dict):
            return {key: filled(child, (place, key)) for key, child in node.items()}
        if isinstance(node, list):
            return [filled(child, (place, i)) for i, child in enumerate(node)]
        if not is_expression(node):
            return node
        if node not in found:  # the same one often stands in many places
            try:
                found[node] = _value(node, known)
            except ExpressionError as error:
                faults[_dotted(place)] = str(error)
                return 1.0  # a number that most places accept, so that this fault is told once
        return found[node]

    return filled(node, path)


def _dotted(place: Any) -> str:  # noqa: ANN401
    if isinstance(place, str):
        return place
    before = _dotted(place[0])
    return f"{before}.{place[1]}" if before else str(place[1])
