"""JSON logs: records, columns, lines; what stands beside them; cut and faulty files."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import mapping
from simcompare.hardware.logs import importers

DATA = os.environ.get("SIMCOMPARE_DATA", "")
RECORDS = [{"t": i / 10, "angle_deg": float(i), "on": i > 1, "state": "run"} for i in range(4)]


@pytest.fixture
def save(tmp_path):
    def make(tree):
        path = tmp_path / "log.json"
        text = tree if isinstance(tree, str) else json.dumps(tree)
        path.write_text(text, encoding="utf-8")
        return path

    return make


def read(path, wishes=mapping.NOTHING):
    assert importers.recognise(path) == "json"
    return importers.read(path, "json", wishes)


@pytest.fixture
def faults(save):
    def of(tree):
        with pytest.raises(InputError) as error:
            importers.read(save(tree), "json", mapping.NOTHING)
        assert "log.json" in str(error.value)
        return error.value.faults

    return of


FORMS = {
    "list": RECORDS,
    "object with records": {"entries": RECORDS},
    "within": {"run": {"data": RECORDS}},
    "columns": {key: [r[key] for r in RECORDS] for key in RECORDS[0]},
    "lines": "\n".join(json.dumps(r) for r in RECORDS) + "\n",
    "indented": json.dumps(RECORDS, indent=1),
}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_gives_the_same_stream(save, form):
    found = read(save(FORMS[form]))
    (stream,) = found.streams
    assert (stream.name, stream.time, stream.truncated) == ("log", "t", "")
    assert [(c.name, c.unit) for c in stream.columns] == [("t", ""), ("angle", "deg"), ("on", "")]
    assert stream.column("angle").values.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert stream.column("on").values.tolist() == [0.0, 0.0, 1.0, 1.0]
    assert list(found.ignored) == ["state"]
    assert stream.row_word == ("line" if form == "lines" else "record")


def test_plain_values_beside_the_records_describe_the_log(save):
    found = read(save({"mass": 0.49, "motor": "xl330", "by": {"name": "Ada"}, "data": RECORDS}))
    assert found.about == {"mass": "0.49", "motor": "xl330", "by.name": "Ada"}


def test_several_lists_of_records_are_several_streams(save):
    found = read(save({"imu": RECORDS, "gps": RECORDS[:2]}))
    assert [(s.name, len(s)) for s in found.streams] == [("imu", 4), ("gps", 2)]


def test_lists_and_records_within_records_become_columns(save):
    tree = [{"t": i, "q": [1.0, 2.0], "pose": {"x": 3.0}} for i in range(2)]
    stream = read(save(tree)).streams[0]
    assert [c.name for c in stream.columns] == ["t", "q[0]", "q[1]", "pose.x"]


def test_what_a_record_lacks_is_missing_and_said(save):
    tree = [{"t": 0, "x": 1}, {"t": 1}, {"t": 2, "x": None}, {"t": 3, "x": 4}]
    found = read(save(tree))
    assert np.isnan(found.streams[0].column("x").values).tolist() == [False, True, True, False]
    (note,) = found.repairs
    assert (note.rule, note.text[:10]) == ("missing_keys", "1 records ")


def test_dates_and_long_stamps_become_seconds_since_the_first(save):
    dates = [{"time": f"2024-01-01T00:00:0{i}.5Z", "x": i} for i in range(3)]
    stream = read(save(dates)).streams[0]
    assert stream.column("time").values.tolist() == [0.0, 1.0, 2.0]
    assert stream.clock.start == "2024-01-01T00:00:00.500000"
    stamps = [{"timestamp_ns": 1700000000123456789 + i, "x": i} for i in (0, 3)]
    stream = read(save(stamps)).streams[0]
    assert (stream.time, stream.column("timestamp").values.tolist()) == ("timestamp", [0.0, 3.0])


def test_empty_lines_keep_the_numbers_of_the_others(save):
    lines = [json.dumps(r) for r in RECORDS]
    stream = read(save("\n\n".join(lines) + "\n")).streams[0]
    assert stream.rows.tolist() == [1, 3, 5, 7]


@pytest.mark.parametrize("cut", [1, 5, 20, 40, 60])
def test_a_cut_file_gives_its_whole_records_and_says_what_is_missing(save, cut):
    text = json.dumps({"mass": 1.5, "entries": RECORDS})
    found = read(save(text[:-cut]))
    stream = found.streams[0]
    expected = 4 if cut == 1 else 3
    assert (len(stream), found.about) == (expected, {"mass": "1.5"})
    whole = json.dumps({"mass": 1.5, "entries": RECORDS[:expected]})
    assert (
        stream.truncated == f"ends too early; its last whole record ends at byte {len(whole) - 2}"
    )


def test_a_cut_last_line_is_left_out_and_said(save):
    text = "\n".join(json.dumps(r) for r in RECORDS)
    stream = read(save(text[:-10])).streams[0]
    assert (len(stream), stream.truncated) == (3, "line 4 ends in the middle; it was left out")


# ---- bad input --------------------------------------------------------------------------------


def test_text_among_numbers_is_named_with_its_record(faults):
    tree = [{"t": i, "x": 1.0} for i in range(6)]
    tree[3]["x"], tree[4]["t"] = "ERR", "soon"
    assert faults(tree) == (
        "record 4, 'x': 'ERR' is not a number",
        "record 5, 't': 'soon' is not a number",
    )
    assert faults("\n".join(json.dumps(r) for r in tree))[0] == (
        "line 4, 'x': 'ERR' is not a number"
    )


def test_columns_of_different_lengths_are_refused(faults):
    assert faults({"t": [0, 1, 2], "x": [1, 2]}) == (
        "the document: lists of different lengths (t: 3, x: 2); expected columns of one length",
    )


def test_two_times_are_refused_until_a_mapping_says_which(faults, save):
    tree = [{"time": i, "stamp": i * i, "x": 1} for i in range(3)]
    assert "columns 'time' and 'stamp' may all be the time" in faults(tree)[0]
    wishes = mapping.of_tree({"time": {"column": "stamp", "unit": "s"}}, "map")
    assert read(save(tree), wishes).streams[0].time == "stamp"


@pytest.mark.parametrize(
    ("text", "words"),
    [('[{"t": 0, "x": 1},\n {"t": 1 "x": 2},\n {"t": 2, "x": 2}, {"t": 3, "x": 4},'
      ' {"t": 4, "x": 5}, {"t": 5, "x": 6}]', "line 2, column 10: is no JSON (Expecting ','"),
     ("{}", "holds no table"), ('{"a": 1}', "holds no table"), ("[]", "holds no records"),
     ('[{"x": "a"}, {"x": "b"}]', "no record holds a number"),
     ('{"t": "x"}\n[1]\n', "line 2, column 1: is no JSON"),
     ('{"t": 1}\n{"t": 2}\nnope\n', "line 3: is no JSON"),
     ("[" * 100_000, "nested too deeply")],
)  # fmt: skip
def test_what_is_no_log_is_refused(faults, text, words):
    assert words in str(faults(text))


@pytest.mark.skipif(not DATA, reason="SIMCOMPARE_DATA names no folder of recordings")
def test_real_servo_logs_are_read_with_what_they_say_of_themselves():
    folder = Path(DATA) / "servo_pendulum_xl330" / "xl330_raw"
    found = read(folder / "2026-01-15_10h28m17.json")
    (stream,) = found.streams
    assert (len(stream), stream.time) == (1510, "timestamp")
    assert (found.about["mass"], found.about["trajectory"]) == ("0.49", "lift_and_drop")
    assert stream.column("timestamp").values[0] == 0.003571152687072754


def test_records_are_read_as_any_table(save):
    tree = [{"time": i, "stamp": 1e3 * i, "note": "#" if i else "", "x": i} for i in range(9)]
    found = read(save(tree))
    assert (found.streams[0].time, [*found.ignored]) == ("time", ["note"])
    assert any("tells the same time" in repair.text for repair in found.repairs)
    anew = [{"t": 0.1 * (i % 20), "x": i} for i in range(60)]
    assert [len(stream) for stream in read(save(anew)).streams] == [20, 20, 20]


@pytest.mark.parametrize("text", ["# off", '"', "rst:0x1", "$GPGGA,1", "! x"])
def test_no_record_is_passed_over_for_the_text_in_it(faults, text):
    tree = [{"x": 1.0 * i, "t": i} for i in range(6)]
    tree[3]["x"] = text
    assert faults(tree)[0].startswith("record 4, 'x': ")
