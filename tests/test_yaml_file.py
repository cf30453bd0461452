"""YAML of users: no file hangs the program, and faults are told in plain words."""

import os
from collections.abc import Mapping
from pathlib import Path

import pytest
from pydantic import ValidationError

from simcompare.errors import InputError
from simcompare.hardware import mapping as mappings
from simcompare.model import yaml_file
from simcompare.model.frozen import Frozen


def bomb(first, line):
    return "\n".join([f"a0: &a0 {first}"] + [line.format(k, k - 1) for k in range(1, 10)]) + "\n"


LISTS = bomb("[x]", "a{0}: &a{0} [" + ", ".join(["*a{1}"] * 10) + "]")
MERGES = bomb("{x: 1}", "a{0}: &a{0} {{<<: [" + ", ".join(["*a{1}"] * 10) + "]}}")


@pytest.mark.parametrize("text", [LISTS, MERGES])
def test_aliases_of_aliases_are_refused_at_once(write, text):
    with pytest.raises(InputError, match=r"its aliases .* stand for more than"):
        yaml_file.read_yaml(write("bomb.yaml", text))


def test_an_alias_that_holds_itself_is_refused(write):
    with pytest.raises(InputError, match="an alias holds itself"):
        yaml_file.read_yaml(write("ring.yaml", "a: &a [1, *a]\n"))


def test_a_mapping_may_be_merged_and_used_again(write):
    text = "base: &x {unit: deg, u: 0.1}\na: {<<: *x, u: 0.2}\nb: *x\n"
    tree, lines, faults = yaml_file.read_yaml(write("merged.yaml", text))
    assert tree["a"] == {"unit": "deg", "u": 0.2}
    assert tree["b"] == tree["base"] == {"unit": "deg", "u": 0.1}
    assert (lines["a.u"], lines["b"], faults) == (2, 3, {})


def test_a_long_file_without_aliases_is_read(write):
    rows = "".join(f"- [{i}, {i + 1}]\n" for i in range(3000))
    tree, _, _ = yaml_file.read_yaml(write("long.yaml", rows))
    assert len(tree) == 3000


def test_a_file_that_is_far_too_large_is_refused_unread(write, monkeypatch):
    with pytest.raises(InputError, match="has more than 1 MB, which a YAML file never needs"):
        yaml_file.read_yaml(write("large.yaml", "#" * 1_000_001))
    monkeypatch.setattr(yaml_file, "_MAX_PARTS", 100)
    with pytest.raises(InputError, match=r"has 201 parts, and at most 100 are read"):
        yaml_file.read_yaml(write("many.yaml", "".join(f"k{i}: 1\n" for i in range(100))))


def test_what_is_no_file_is_refused_unread(tmp_path):
    os.mkfifo(tmp_path / "pipe.yaml")
    with pytest.raises(InputError, match="is a named pipe; expected a file"):
        yaml_file.read_yaml(tmp_path / "pipe.yaml")
    with pytest.raises(InputError, match="is a device"):
        yaml_file.read_yaml(Path("/dev/zero"))


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("a: {column: x, unit: m, u: wide}", "channels.a.u: expected a number, found 'wide'"),
        ("a: {column: x, unit: m, u: -1}", "channels.a.u: expected a number greater than 0"),
        ("a: {column: x, unit: 3}", "channels.a.unit: expected a text, found 3"),
        ("a: {column: x, unit: m, sign: 2}", "channels.a.sign: expected -1 or 1, found 2"),
        ("a: {column: x, unit: m, sentinels: 5}", "expected a list"),
    ],
)
def test_faults_are_told_in_plain_words(write, line, words):
    with pytest.raises(InputError) as error:
        mappings.read(write("map.yaml", f"channels:\n  {line}\n"))
    text = str(error.value)
    assert f"line 2, {words}" in text or words in text
    assert "Input should" not in text
    assert "valid" not in text


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e3", 1000.0), ("1.5e-3", 0.0015), (".5", 0.5), ("4.", 4.0), ("010", 10), ("0x29", 41),
        ("0o17", 15), ("-3", -3), ("1:30", "1:30"), ("1_000", "1_000"), ("no", "no"),
        ("true", True), ("0,5", "0,5"), ("~", None),
    ],
)  # fmt: skip
def test_numbers_and_truth_values_are_those_of_yaml_1_2(write, text, value):
    """Version 1.1 takes 1:30 for 90, 010 for 8, no for false, and 1e3 for a text."""
    (read,) = yaml_file.read_yaml(write("plain.yaml", f"- {text}\n"))[0]
    assert read == value
    assert type(read) is type(value)


def test_a_pin_that_is_called_no_keeps_its_name(write):
    assert yaml_file.read_yaml(write("pins.yaml", "NO: 1\n"))[0] == {"NO": 1}


class Inner(Frozen):
    switch: bool


class Outer(Frozen):
    number: float
    edges: tuple[float, float]
    named: Mapping[str, float]
    count: int | None = None
    either: bool | float = 0.0
    inner: Inner


def test_a_truth_value_is_no_number_and_is_told_at_its_place():
    inner = {"switch": True}
    right = {"number": 1, "edges": [1, 2], "named": {"a": 1}, "either": True, "inner": inner}
    assert Outer.model_validate(right).either is True
    wrong = {"number": True, "edges": [1, False], "named": {"a": True}, "count": True}
    with pytest.raises(ValidationError) as error:
        Outer.model_validate({**right, **wrong})
    assert yaml_file.faults_of(error.value) == {
        "number": "expected a number, found 'true'",
        "edges.1": "expected a number, found 'false'",
        "named.a": "expected a number, found 'true'",
        "count": "expected a whole number, found 'true'",
    }
