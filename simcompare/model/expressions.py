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


class Template:
    """A YAML tree with ``${…}`` in it, to be filled with numbers again and again.

    Args:
        tree: dict, list or scalar as read from YAML.
        path: dotted place of it, for the faults.
    """

    def __init__(self, tree: Any, path: str = "") -> None:  # noqa: ANN401
        self.tree = tree
        self._plan = _plan_of(tree, path)

    def filled(self, names: Mapping[str, float], faults: dict[str, str]) -> Any:  # noqa: ANN401
        """The tree with every ``${…}`` replaced by its number; parts without any are not copied.

        Args:
            names: values that expressions may use.
            faults: every fault is added here as place -> sentence.
        """
        known, found = {**CONSTANTS, **names}, dict[str, float]()

        def fill(node: Any, plan: Any) -> Any:  # noqa: ANN401
            if isinstance(plan, list):
                made = node.copy()
                for key, below in plan:
                    made[key] = fill(node[key], below)
                return made
            if node not in found:  # the same one often stands in many places
                try:
                    found[node] = _value(node, known)
                except ExpressionError as error:
                    faults[plan] = str(error)
                    return 1.0  # most places accept this, so that the fault is not told twice
            return found[node]

        return self.tree if self._plan is None else fill(self.tree, self._plan)


def _plan_of(node: Any, place: str) -> Any:  # noqa: ANN401
    """The place of an expression; of a dict or list its parts with any; ``None`` without any."""
    if isinstance(node, dict | list):
        children = node.items() if isinstance(node, dict) else enumerate(node)
        plans = [(k, _plan_of(child, f"{place}.{k}" if place else str(k))) for k, child in children]
        return [(key, plan) for key, plan in plans if plan is not None] or None
    return place if is_expression(node) else None


def resolve(node: Any, names: Mapping[str, float], path: str, faults: dict[str, str]) -> Any:  # noqa: ANN401
    """A YAML tree, or a part of one, with every ``${…}`` replaced by its number; see `Template`."""
    return Template(node, path).filled(names, faults)
