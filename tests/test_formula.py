"""Formulas that a user types: arithmetic, and nothing else."""

import GTC
import numpy as np
import pytest

from simcompare.model.expressions import ExpressionError
from simcompare.model.formula import read


def test_a_formula_names_its_quantities_in_order():
    assert read("2*tau/r/(m + 2*J/r**2) + pi").names == ("tau", "r", "m", "J")


def test_arrays_numbers_and_uncertain_numbers_are_taken_alike():
    formula = read("a**2 / b - 1")
    assert formula.at({"a": 3.0, "b": 2.0}) == 3.5
    assert list(formula.at({"a": np.array([1.0, 3.0]), "b": 2.0})) == [-0.5, 3.5]
    traced = formula.at({"a": GTC.ureal(3, 0.1), "b": 2.0})
    # 2·3/2·0.1
    assert traced.u == pytest.approx(0.3)


def test_functions_take_arrays():
    formula = read("max(abs(a), 2) + sqrt(4) + atan2(0, 1) + min(1, 3)")
    assert list(formula.at({"a": np.array([-5.0, 1.0])})) == [8.0, 5.0]


ALLOWED = (
    "; expected numbers, names, + - * / ** and sqrt, exp, log, sin, cos, tan, atan2, abs, min, max"
)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (
            "__import__('os').system('x')",
            "\"__import__('os').system('x')\" is more than arithmetic: "
            f"\"__import__('os').system\" is no known function{ALLOWED}",
        ),
        ("a.real", f"'a.real' is more than arithmetic: 'a.real'{ALLOWED}"),
        ("a if b else c", f"'a if b else c' is more than arithmetic: 'a if b else c'{ALLOWED}"),
        ("[a]", f"'[a]' is more than arithmetic: '[a]'{ALLOWED}"),
        ("'a'*3", f"\"'a'*3\" is more than arithmetic: \"'a'\" is no number{ALLOWED}"),
        ("f(a)", f"'f(a)' is more than arithmetic: 'f' is no known function{ALLOWED}"),
        ("sin(a, b)", f"'sin(a, b)' is more than arithmetic: sin takes 1 value{ALLOWED}"),
        ("a == b", f"'a == b' is more than arithmetic: 'a == b'{ALLOWED}"),
        ("a % b", f"'a % b' is more than arithmetic: 'a % b'{ALLOWED}"),
        ("a==1", f"'a==1' is more than arithmetic: 'a==1'{ALLOWED}"),
        (
            "(" * 100 + "a" + ")" * 100 + " % 2",
            f"'{'(' * 59}…' is more than arithmetic: '{'(' * 59}…'{ALLOWED}",
        ),
        ("r^2", "'r^2': a power is written with ** here, such as r**2"),
        ("2*sin", "'2*sin': sin is a function; write sin(…)"),
        ("2*", "'2*' is no formula; expected one such as 2*tau/r/(m + 2*J/r**2)"),
        ("", "'' is no formula; expected one such as 2*tau/r/(m + 2*J/r**2)"),
        ("a" * 2001, "the formula has 2001 letters; expected 2000 at most"),
    ],
)
def test_what_is_more_than_arithmetic_is_refused(text, fault):
    with pytest.raises(ExpressionError) as error:
        read(text)
    assert str(error.value) == fault


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1/0", "a division by zero"),
        ("10**400", "a number in it gets too large"),
        ("(-8)**0.5", "the root of a negative number is not real"),
        ("-" * 1900 + "1", "its parts are nested too deep"),
    ],
)
def test_why_there_is_no_number(text, why):
    with pytest.raises(ExpressionError, match=f"gives no finite number: {why}"):
        read(text).at({})


def test_powers_cannot_grow_without_end():
    with pytest.raises(ExpressionError, match="gives no finite number"):
        read("9**9**9**9").at({})
