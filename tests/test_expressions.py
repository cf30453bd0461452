"""Expressions in scenario files: arithmetic over parameters, and nothing else."""

from __future__ import annotations

import math
import warnings

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simcompare.model.expressions import (
    ExpressionError,
    Template,
    evaluate,
    is_expression,
    resolve,
)

NAMES = {"a": 2.0, "b": 3.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("${a + b * 2}", 8.0),
        ("${-a**2}", -4.0),
        ("  ${ (a + b) / 2 }  ", 2.5),
        ("${sqrt(2 * 9.81 * b)}", math.sqrt(2 * 9.81 * 3)),
        ("${min(a, b) + max(a, b) - abs(-1)}", 4.0),
        ("${2 * pi * a}", 4 * math.pi),
        ("${exp(log(a))}", 2.0),
        ("${sin(pi / 2) + cos(0) + tan(0) + atan2(0, 1)}", 2.0),
        ("${0.1 if a <= 1 else 0.2}", 0.2),
        ("${1e-3}", 0.001),
        ("${3}", 3.0),
    ],
)
def test_arithmetic_and_functions(text, value):
    found = evaluate(text, NAMES)
    assert isinstance(found, float)
    assert found == pytest.approx(value, rel=1e-14)


@given(x=st.floats(-1e100, 1e100), y=st.floats(-1e100, 1e100))
def test_sums_are_those_of_python(x, y):
    assert evaluate("${x - 2 * y}", {"x": x, "y": y}) == x - 2 * y


def test_a_name_keeps_no_value_from_an_earlier_call():
    assert evaluate("${a}", {"a": 1.0}) == 1.0
    with pytest.raises(ExpressionError, match="'a' is not defined"):
        evaluate("${a}", {"b": 1.0})


@pytest.mark.parametrize(
    "text",
    [
        "${__import__('os')}",
        "${open('/etc/passwd')}",
        "${a.__class__}",
        "${().__class__.__bases__}",
        "${[x for x in (1, 2)]}",
        "${(lambda: 1)()}",
        "${eval('1')}",
        "${a[0]}",
    ],
)
def test_nothing_but_arithmetic_is_reached(text):
    with pytest.raises(ExpressionError) as error:
        evaluate(text, NAMES)
    assert text in str(error.value)


@pytest.mark.parametrize("text", ["${a.real}", "${a.fromhex('0x10')}", "${(1).bit_length()}"])
def test_attributes_of_numbers_are_refused(text):
    with pytest.raises(ExpressionError):
        evaluate(text, NAMES)


@pytest.mark.parametrize(
    "text",
    ["${9**9**9}", "${2**(2**22)}", "${1 << 1000000}", "${0 * 999999**3999999}",
     "${" + "*".join(["9**300"] * 300) + "}", "${'a' * 99999}", "${'%99999999d' % 1}"],
)  # fmt: skip
def test_what_would_grow_for_ever_is_refused(text):
    with pytest.raises(ExpressionError):
        evaluate(text, NAMES)


def test_a_long_expression_is_refused_and_not_repeated():
    with pytest.raises(ExpressionError, match=r"1\+… has 20004 characters; at most") as error:
        evaluate("${1" + "+1" * 10_000 + "}", NAMES)
    assert len(str(error.value)) < 200


@pytest.mark.parametrize(
    "text",
    [
        "${1e308 * 10}",
        "${1e308 * 10 - 1e308 * 10}",
        "${exp(1000)}",
        "${1 / 0}",
        "${sqrt(-1)}",
        "${(-1)**0.5}",
        "${a > 1}",
        "${None}",
        "${'a'}",
        "${2**2000}",
        "${-10**400}",
    ],
)
def test_a_result_that_is_no_finite_number_is_refused(text):
    with pytest.raises(ExpressionError):
        evaluate(text, NAMES)


@pytest.mark.parametrize("text", ["${a +}", "${}", "${a} + ${b}", "${a b}", "${" + "(" * 500 + "}"])
def test_a_syntax_error_quotes_the_expression(text):
    with pytest.raises(ExpressionError) as error:
        evaluate(text, NAMES)
    assert "cannot be evaluated" in str(error.value)


@pytest.mark.parametrize("text", ["${a\n+ b}", "${a; b}", "${a = 3}"])
def test_no_part_of_an_expression_is_dropped_in_silence(text):
    """The evaluator's library only warns and takes the first line or the right-hand side."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            value = evaluate(text, NAMES)
        except ExpressionError:
            return
    assert value == 5.0, "either the whole expression or an error"


def test_only_a_whole_value_is_an_expression():
    assert is_expression("${a}")
    assert is_expression(" ${a} ")
    assert not is_expression("1 + ${a}")
    assert not is_expression(3.0)


def test_a_tree_is_resolved_and_every_fault_is_kept_with_its_place():
    faults: dict[str, str] = {}
    tree = {"x": ["${a}", {"y": "${zzz}"}], "z": "${1/0}", "text": "plain", "n": None}
    found = resolve(tree, NAMES, "", faults)
    assert found["x"][0] == 2.0
    assert found["text"] == "plain"
    assert found["n"] is None
    assert set(faults) == {"x.1.y", "z"}
    assert "zzz" in faults["x.1.y"]
    assert tree["z"] == "${1/0}", "the tree that was given is left as it was"


def test_a_template_is_filled_anew_each_time_and_left_as_it_was():
    tree = {"x": ["${a}", {"y": "${2 * a}"}, {"same": [1, 2]}], "text": "plain"}
    template = Template(tree)
    first, second = (template.filled({"a": value}, {}) for value in (2.0, 5.0))
    assert first == {"x": [2.0, {"y": 4.0}, {"same": [1, 2]}], "text": "plain"}
    assert second == {"x": [5.0, {"y": 10.0}, {"same": [1, 2]}], "text": "plain"}
    assert tree["x"][:2] == ["${a}", {"y": "${2 * a}"}]
    faults: dict[str, str] = {}
    template.filled({}, faults)
    assert set(faults) == {"x.0", "x.1.y"}


def test_a_fault_that_stands_in_two_places_is_told_in_both():
    faults: dict[str, str] = {}
    Template({"x": "${zzz}", "y": {"z": "${zzz}"}}).filled(NAMES, faults)
    assert set(faults) == {"x", "y.z"}
