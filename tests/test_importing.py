"""``simcompare import``: what a user sees and what is stored."""

import json

import numpy as np
import pytest
import yaml

import simcompare
from simcompare.errors import InputError
from simcompare.model import recording_store

GOOD = "t (ms),angle (deg),speed (rpm)\n" + "".join(
    f"{5 * k},{3 * np.sin(0.03 * k):.4f},{10 + k % 7}\n" for k in range(200)
)


def test_a_log_becomes_a_recording_in_si(call, write, tmp_path):
    log = write("swing.csv", GOOD)
    code, out, err = call("import", log)
    assert code == 0, err
    assert "angle_rad" in out
    found = recording_store.load(tmp_path / "swing.rec")
    (stream,) = found.streams.values()
    assert stream.time_s[-1] == pytest.approx(0.995)
    assert stream.channels["angle_rad"].values[50] == pytest.approx(
        np.radians(round(3 * np.sin(1.5), 4))
    )
    assert stream.channels["speed_rad_s"].values[0] == pytest.approx(10 * 2 * np.pi / 60)
    assert found.provenance.importer == "csv"
    assert found.provenance.size_bytes == len(GOOD)


def test_json_tells_every_repair_and_conversion(call, write):
    rows = GOOD.splitlines()
    rows.insert(31, rows[30])  # one row twice
    log = write("twice.csv", "\n".join(rows) + "\n")
    code, out, err = call("import", log, "--json")
    assert code == 0, err
    record = json.loads(out)
    (repair,) = [r for r in record["provenance"]["repairs"] if r["severity"] == "repair"]
    assert repair["rule"] == "duplicate_row"
    assert repair["rows"] == [[32, 32]]
    assert {row["channel"] for row in record["provenance"]["conversions"]} >= {"angle_rad"}


def test_strict_refuses_what_would_be_repaired_and_stores_nothing(call, write, tmp_path):
    rows = GOOD.splitlines()
    rows.insert(31, rows[30])
    log = write("twice.csv", "\n".join(rows) + "\n")
    code, _, err = call("import", log, "--strict")
    assert code == 2
    assert "32" in err
    assert "--strict" in err
    assert not (tmp_path / "twice.rec").exists()


def test_a_template_is_a_mapping_file_once_the_units_are_in(call, write, tmp_path):
    log = write("raw.csv", GOOD.replace(" (deg)", "").replace(" (rpm)", ""))
    code, _, err = call("import", log)
    assert code == 2
    assert "--template" in err
    code, out, err = call("import", log, "--template")
    assert code == 0, err
    tree = yaml.safe_load(out)
    assert set(tree["channels"]) == {"angle", "speed"}
    tree["channels"]["angle"]["unit"] = "deg"
    del tree["channels"]["speed"]
    mapping = write("map.yaml", yaml.safe_dump(tree))
    code, out, err = call("import", log, "--map", mapping)
    assert code == 0, err
    assert "left out: 'speed': no unit is known" in out


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("hello", "expected|columns|no known format|holds"),
        ("t (s),x (m)\n0,1\n1,two\n2,3\n3,4\n", "line 3"),
        ("t (s),x (quux)\n0,1\n1,2\n2,3\n", "quux"),
    ],
)
def test_bad_logs_are_one_clear_sentence(call, write, text, message):
    code, _, err = call("import", write("bad.csv", text))
    assert code == 2
    assert "Traceback" not in err
    import re

    assert re.search(message, err), err


def test_every_fault_of_a_mapping_file_has_its_line(write):
    mapping = write(
        "map.yaml",
        "channels:\n  angle: {column: a, unit: deg, sgin: -1}\n  B: {column: b}\ntime: {}\n",
    )
    with pytest.raises(InputError) as error:
        simcompare.import_log(write("a.csv", GOOD), mapping=mapping)
    text = str(error.value)
    assert "line 2" in text
    assert "sgin" in text
    assert "line 4" in text


def test_a_column_that_the_log_does_not_have_is_told_with_those_it_has(write):
    mapping = write("map.yaml", "channels:\n  angle: {column: winkel, unit: deg}\n")
    with pytest.raises(InputError, match=r"winkel.*angle.*speed"):
        simcompare.import_log(write("a.csv", GOOD), mapping=mapping)


def test_a_template_asks_for_the_unit_of_a_time_that_has_none(call, write):
    log = write("raw.csv", GOOD.replace("t (ms)", "t"))
    _, out, _ = call("import", log, "--template")
    assert yaml.safe_load(out)["time"] == {"column": "t", "unit": "?"}
    code, _, err = call("import", log, "--map", write("map.yaml", out))
    assert code == 2
    assert "time: unit is still ?; replace the ?" in err
    _, out, _ = call("import", write("good.csv", GOOD), "--template")
    assert "time" not in yaml.safe_load(out)


def test_a_template_for_a_log_without_a_time_is_yaml_and_its_gaps_are_told(call, write):
    log = write("raw.csv", GOOD.replace("t (ms)", "n").replace(" (deg)", ""))
    _, out, _ = call("import", log, "--template")
    assert yaml.safe_load(out)["time"] == {"column": "?", "unit": "?"}
    code, _, err = call("import", log, "--map", write("map.yaml", out))
    assert code == 2
    assert "time: column and unit is still ?" in err
    assert "channels.angle: unit is still ?" in err


def test_a_bare_question_mark_is_told_as_what_it_is(call, write):
    mapping = write("map.yaml", "time: {column: ?, unit: ?}\n")
    code, _, err = call("import", write("a.csv", GOOD), "--map", mapping)
    assert code == 2
    assert "replace the ?" in err


def test_a_column_that_becomes_time_s_does_not_take_the_place_of_the_clock(write, tmp_path):
    rows = "".join(f"{i * 5},{100 - i / 10:.1f}\n" for i in range(50))
    mapping = write("map.yaml", "channels:\n  time: {column: left, unit: s}\n")
    log = write("a.csv", f"t (ms),left (s)\n{rows}")
    simcompare.import_log(log, mapping=mapping, out=tmp_path / "a.rec")
    (stream,) = recording_store.load(tmp_path / "a.rec").streams.values()
    assert stream.time_s[-1] == pytest.approx(0.245)
    assert stream.channels["recorded_time_s"].values[-1] == pytest.approx(95.1)


def test_a_unit_that_is_not_understood_is_told_with_one_that_is(write):
    log = write("a.csv", GOOD.replace("speed (rpm)", "torque [Nnm]"))
    (_, left) = simcompare.import_log(log).provenance.conversions
    assert (left.raw, left.channel) == ("torque [Nnm]", "")
    assert left.reason.startswith("'Nnm' is not a unit; did you mean N*m?")
    assert left.cure == 'channels: {torque_nnm: {column: "torque [Nnm]", unit: 1}}'


@pytest.mark.parametrize("place", [".", "/"])
def test_a_place_that_cannot_be_a_recording_is_one_clear_sentence(call, write, place):
    code, _, err = call("import", write("a.csv", GOOD), "-o", place)
    assert code == 2
    assert "choose another -o" in err
    assert "Traceback" not in err
