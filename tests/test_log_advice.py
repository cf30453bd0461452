"""What a refusal of a log proposes opens it when it is pasted."""

from __future__ import annotations

import re

import numpy as np
import pytest
import yaml

import simcompare
from simcompare.errors import InputError

SECONDS = np.arange(200) * 0.01


def table(head, *columns):
    rows = zip(*columns, strict=True)
    return head + "\n" + "".join(",".join(f"{cell:.9g}" for cell in row) + "\n" for row in rows)


SWING = np.sin(3 * SECONDS)
NUMBERS = np.arange(200.0)
CLOSED = {
    "a name with a colon": table('"Latest: ticker",u (V)', SECONDS, SWING),
    "a name with quotes": table("""it's 5,u (V)""", SECONDS, SWING),
    "a counter beside a clock": table("Packet number,ticker,u (V)", NUMBERS, SECONDS, SWING),
    "a board's milliseconds": table("ticker,u (V)", 12 * NUMBERS + 4000, SWING),
    "stamps since 1970": table("ticker,u (V)", 1.7e9 + SECONDS, SWING),
    "a counter alone": table("Packet number,u (V)", 2 * NUMBERS, SWING),
    "row numbers alone": table("what,u (V)", NUMBERS, SWING),
    "a position that increases": table("place (m),u (V)", SECONDS, SWING),
    "two times that differ": table("time,timestamp,u (V)", SECONDS, 1.3 * SECONDS**2, SWING),
    "no header": "".join(f"{t:.2f} {x:.5f}\n" for t, x in zip(SECONDS, SWING, strict=True)),
    "numbers alone": "".join(f"{x:.5f}\n" for x in SWING),
    "milliseconds and counts": table("time,left,right", 10 * NUMBERS, SWING, SWING),
    "names alone": table("t (s)," + ",".join(f"q{k}_" for k in range(12)), SECONDS, *[SWING] * 12),
    "no header, many columns": "".join(
        f"{t:.2f} " + f"{x:.5f} " * 12 + "\n" for t, x in zip(SECONDS, SWING, strict=True)
    ),
    "fractions without unit": table("time,u (V)", 96.328 + 1.002 * NUMBERS, SWING),
    "an angle that increases": table("theta,phi,u (V)", SWING, 0.1745 + SECONDS, SWING),
    "times without unit": table("t,u (V)", 10 * NUMBERS, SWING),
    "seconds that are milliseconds": table("t (s),u (V)", 5000 * NUMBERS, SWING),
    "a time that stands still": table("t (s),u (V)", 0 * NUMBERS, SWING),
    "stamps in no pattern": table(
        "t (s),u (V)", 0.01 * np.sort(np.random.default_rng(2).integers(0, 900, 200)), SWING
    ),
    "degrees that are radians": table(
        "t (s),angle (rad),angle_rate (rad/s)", SECONDS, np.degrees(SWING),
        3 * np.cos(3 * SECONDS),
    ),
    "a rate in another time": table(
        "t (ms),angle (rad),angle_rate (rad/s)", 1000 * SECONDS, SWING, 3e-3 * np.cos(3 * SECONDS)
    ),
    "gravity in another unit": table(
        "t (s),acc_x (m/s^2),acc_y (m/s^2),acc_z (m/s^2)", SECONDS, 0.01 * SWING, 0.01 * SWING,
        1 + 0 * SECONDS,
    ),
}  # fmt: skip
_MAP = r"(?:time|channels): \{(?:[^{}]|\{[^{}]*\})*\}"
LINE = re.compile(rf"(\{{{_MAP}, {_MAP}\}}|{_MAP})")


@pytest.mark.parametrize("name", CLOSED)
def test_what_a_refusal_proposes_opens_the_log(tmp_path, name):
    (tmp_path / "log.csv").write_text(CLOSED[name], encoding="utf-8")
    with pytest.raises(InputError) as error:
        simcompare.import_log(tmp_path / "log.csv")
    lines = LINE.findall(" ".join(str(error.value).split()))
    assert lines
    for line in lines:
        assert isinstance(yaml.safe_load(line), dict)
        (tmp_path / "map.yaml").write_text(line + "\n", encoding="utf-8")
        made = simcompare.import_log(tmp_path / "log.csv", mapping=tmp_path / "map.yaml")
        assert len(made.streams["log"].time_s) == 200


def told(tmp_path, text):
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        simcompare.import_log(tmp_path / "log.csv")
    return str(error.value)


@pytest.mark.parametrize("name", ["a counter alone", "row numbers alone"])
def test_a_counter_is_never_offered_as_the_time(tmp_path, name):
    message = told(tmp_path, CLOSED[name])
    assert "time: {rate_Hz: " in message
    assert "column:" not in message


def test_a_column_in_another_unit_is_never_offered_as_the_time(tmp_path):
    assert "column:" not in told(tmp_path, CLOSED["a position that increases"])


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("a name with a colon", 'time: {column: "Latest: ticker", unit: s}'),
        ("a counter beside a clock", "time: {column: ticker, unit: s}"),
        ("a board's milliseconds", "time: {column: ticker, unit: ms}"),
        ("a rate in another time", "time: {column: t, unit: s}"),
        ("fractions without unit", "time: {column: time, unit: s}"),
        ("an angle that increases", "time: {rate_Hz: 100}"),
    ],
)
def test_the_best_line_is_proposed_and_no_other(tmp_path, name, line):
    assert LINE.findall(" ".join(told(tmp_path, CLOSED[name]).split())) == [line]


def test_a_table_of_results_is_told_as_what_it_is(tmp_path):
    message = told(tmp_path, "Length (m),Period (s)\n0.15,0.78\n0.25,1.01\n0.40,1.27\n")
    assert "'Period' says how long something takes" in message
    assert "3 rows of Length, Period are a table of results, no log" in message
    assert "column:" not in message


@pytest.mark.parametrize("name", ["T", "10T"])
def test_the_letter_of_a_period_in_a_short_table_is_no_clock(tmp_path, name):
    text = f"L (cm),{name} (s)\n10,0.63\n20,0.90\n30,1.10\n"
    message = " ".join(told(tmp_path, text).split())
    assert f"{name!r} says how long something takes" in message
    (line,) = LINE.findall(message)
    (tmp_path / "map.yaml").write_text(line, encoding="utf-8")
    made = simcompare.import_log(tmp_path / "log.csv", mapping=tmp_path / "map.yaml")
    assert [*made.streams["log"].channels] == ["l_m"]


@pytest.mark.parametrize(
    ("head", "streams"),
    [
        ('"Latest: Time (s)","Latest: Position (m)","Run 1: Time (s)","Run 1: Position (m)"',
         ["latest", "run_1"]),
        ("Time (s) Run #1,Position (m) Run #1,Time (s) Run #2,Position (m) Run #2",
         ["run_1", "run_2"]),
        ("t (s),x (m),t (s),x (m)", ["run_1", "run_2"]),
        ("Time (s),Temperature (°C),Time (s),Force (N)", ["run_1", "run_2"]),
    ],
)  # fmt: skip
def test_runs_beside_each_other_are_streams_each_as_long_as_it_is(tmp_path, head, streams):
    rows = [f"{0.05 * i:.2f},{i},{0.06 * i:.2f},{2 * i}" for i in range(40)]
    rows += [f"{0.05 * i:.2f},{i},," for i in range(40, 60)]
    (tmp_path / "log.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    made = simcompare.import_log(tmp_path / "log.csv", strict=True)
    assert [*made.streams] == streams
    first, second = made.streams.values()
    assert (len(first.time_s), len(second.time_s)) == (60, 40)
    assert second.time_s[-1] == pytest.approx(39 * 0.06)
    assert [len(stream.channels) for stream in made.streams.values()] == [1, 1]


def test_a_name_that_yaml_cannot_hold_is_told_without_a_line_for_it(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("a\x01b,c\n" + "".join(f"{i},{i % 5}\n" for i in range(50)))
    with pytest.raises(InputError):
        simcompare.import_log(path)
