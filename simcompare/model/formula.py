"""Formulas that a user types, such as ``2*tau/r/(m + 2*J/r**2)``: arithmetic and nothing else.

They are evaluated by the library ``simpleeval``, for numbers and for whatever can be added,
multiplied and raised to powers: arrays, quantities with units, numbers that carry uncertainties.
"""

from __future__ import annotations

import ast
import functools
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import simpleeval

from simcompare.model.expressions import CONSTANTS, FUNCTIONS, ExpressionError

#: what a formula may call, for numbers and arrays
OF_ARRAYS: Mapping[str, Callable[..., Any]] = {
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "atan2": np.arctan2,
    "abs": np.abs,
    "min": np.minimum,
    "max": np.maximum,
}
#: how many things a function takes where that is not one
_COUNTS = {"atan2": 2, "min": 2, "max": 2}
_LONGEST = 2000
#: letters of a formula that a message repeats
_SHOWN = 60


def _power(base: Any, exponent: Any) -> Any:  # noqa: ANN401
    """A power that stays real."""
    value = base**exponent
    if isinstance(value, complex):
        raise ValueError("the root of a negative number is not real")
    return value


_OPERATORS: Mapping[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: _power,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}


@dataclass(frozen=True)
class Formula:
    """A formula that was read and is arithmetic.

    Attributes:
        text: as it was typed.
        names: of its quantities, in the order in which they appear.
    """

    text: str
    names: tuple[str, ...]

    def at(
        self,
        values: Mapping[str, Any],
        functions: Mapping[str, Callable[..., Any]] = OF_ARRAYS,
    ) -> Any:  # noqa: ANN401
        """The result for numbers or arrays, or other kinds of values with their functions.

        Raises:
            ExpressionError: there is none, such as where a number is divided by 0.
        """
        evaluator = _evaluator(functions)
        evaluator.names = {**CONSTANTS, **values}
        try:
            return evaluator.eval(self.text, previously_parsed=_parsed(self.text))
        except (ArithmeticError, ValueError, RecursionError) as error:
            why = _WHY.get(type(error), str(error))
            raise ExpressionError(f"{shown(self.text)} gives no finite number: {why}") from None


_WHY = {
    OverflowError: "a number in it gets too large",
    ZeroDivisionError: "a division by zero",
    RecursionError: "its parts are nested too deep",
}


def shown(text: str) -> str:
    """A formula as a message repeats it: its begin, where it is long."""
    return repr(text if len(text) <= _SHOWN else f"{text[: _SHOWN - 1]}…")


def read(text: str) -> Formula:
    """Reads a formula.

    Raises:
        ExpressionError: it is not arithmetic; the message says what in it is not.
    """
    tree = _parsed(text)
    called = {node.func for node in ast.walk(tree) if isinstance(node, ast.Call)}
    names: dict[str, None] = {}
    # in the order of the text
    for node in sorted(ast.walk(tree), key=lambda one: getattr(one, "col_offset", 0)):
        fault = _fault(node, called, text.strip())
        if fault is not None:
            raise ExpressionError(f"{shown(text)} is more than arithmetic: {fault}; {_ALLOWED}")
        if isinstance(node, ast.Name) and node not in called and node.id not in CONSTANTS:
            names[node.id] = None
    for name in names:
        if name in FUNCTIONS:
            raise ExpressionError(f"{shown(text)}: {name} is a function; write {name}(…)")
    return Formula(text, tuple(names))


_ALLOWED = f"expected numbers, names, + - * / ** and {', '.join(FUNCTIONS)}"
_HARMLESS = (ast.Expression, ast.Load, ast.operator, ast.unaryop, ast.Name)


def _fault(node: ast.AST, called: set[ast.expr], text: str) -> str | None:
    """What of a part is no arithmetic, as the user wrote it."""
    match node:
        case ast.Constant(value=value):
            is_number = isinstance(value, int | float) and not isinstance(value, bool)
            return None if is_number and _is_finite(value) else f"{_part(node, text)} is no number"
        case ast.BinOp(op=op) | ast.UnaryOp(op=op):
            return None if type(op) in _OPERATORS else _part(node, text)
        case ast.Call():
            return _fault_of_call(node, text)
    return None if isinstance(node, _HARMLESS) else _part(node, text)


def _part(node: ast.AST, text: str) -> str:
    return shown(ast.get_source_segment(text, node) or text)


def _fault_of_call(node: ast.Call, text: str) -> str | None:
    if not isinstance(node.func, ast.Name) or node.func.id not in FUNCTIONS:
        return f"{_part(node.func, text)} is no known function"
    count = _COUNTS.get(node.func.id, 1)
    if node.keywords or len(node.args) != count:
        return f"{node.func.id} takes {count} value{'s' if count > 1 else ''}"
    return None


def _is_finite(value: Any) -> bool:  # noqa: ANN401
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False


@functools.lru_cache(maxsize=256)
def _parsed(text: str) -> ast.expr:
    """The tree; all its numbers are floats, so that powers cannot grow without end."""
    if len(text) > _LONGEST:
        raise ExpressionError(f"the formula has {len(text)} letters; expected {_LONGEST} at most")
    if "^" in text:
        raise ExpressionError(f"{shown(text)}: a power is written with ** here, such as r**2")
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        raise ExpressionError(
            f"{shown(text)} is no formula; expected one such as 2*tau/r/(m + 2*J/r**2)"
        ) from None
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and type(node.value) is int and _is_finite(node.value):
            node.value = float(node.value)
    return tree


def _evaluator(functions: Mapping[str, Callable[..., Any]]) -> Any:  # noqa: ANN401
    return simpleeval.SimpleEval(operators=dict(_OPERATORS), functions=dict(functions))
