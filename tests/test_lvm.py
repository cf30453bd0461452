"""LabVIEW measurement files: headers, segments, columns of X, separators and decimal marks."""

from __future__ import annotations

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import mapping
from simcompare.hardware.logs import importers
from simcompare.hardware.logs.text import source as _source
from simcompare.verbs.import_log import import_log

#: line of the first row in GOOD
FIRST = 24


def lvm(rows, *, x="No", names="\tforce\tacc\tComment", extra="", samples="3\t3", decimal="."):
    text = f"""LabVIEW Measurement\t
Writer_Version\t2
Reader_Version\t2
Separator\tTab
Decimal_Separator\t{decimal}
Multi_Headings\tYes
X_Columns\t{x}
Time_Pref\tAbsolute
Operator\tAda
Date\t2013/02/19
Time\t09:51:39.1970510124996275989
***End_of_Header***\t
\t
Channels\t2\t\t
Samples\t{samples}\t
Date\t2013/02/19\t2013/02/19\t
Time\t09:51:40.7271890640258789063\t09:51:40.7271890640258789063\t
Y_Unit_Label\tNewtons\tm/s^2\t
X_Dimension\tTime\tTime\t
X0\t2.5E-1\t2.5E-1\t
Delta_X\t1.0E-2\t1.0E-2\t
***End_of_Header***\t\t\t
X_Value{names}
{rows}{extra}"""
    return text.replace(".", decimal) if decimal != "." else text


ROWS = "\t0.5\t1.5\n\t0.6\t1.6\n\t0.7\t1.7\n"
GOOD = lvm(ROWS)


@pytest.fixture
def save(tmp_path):
    def make(text):
        path = tmp_path / "bench.lvm"
        path.write_bytes(text.encode())
        return path

    return make


def read(path):
    assert importers.recognise(path) == "lvm"
    return importers.read(path, "lvm", mapping.NOTHING)


@pytest.fixture
def faults(save):
    def of(text):
        with pytest.raises(InputError) as error:
            importers.read(save(text), "lvm", mapping.NOTHING)
        return error.value.faults

    return of


@pytest.mark.parametrize("decimal", [".", ","])
def test_times_follow_from_the_header_where_no_column_holds_them(save, decimal):
    found = read(save(lvm(ROWS, decimal=decimal)))
    (stream,) = found.streams
    assert (stream.time, stream.start_s, stream.increment_s) == (None, 0.25, 0.01)
    assert (stream.first_row, stream.clock.start) == (FIRST, "2013-02-19T09:51:40.727189")
    assert [(c.name, c.unit) for c in stream.columns] == [("force", "N"), ("acc", "m/s^2")]
    assert stream.column("acc").values.tolist() == [1.5, 1.6, 1.7]
    assert (found.about["Operator"], found.ignored, stream.truncated) == ("Ada", {}, "")


def test_a_missing_decimal_separator_is_found_in_the_numbers(save):
    text = GOOD.replace("Decimal_Separator\t.\n", "")
    assert read(save(text)).streams[0].column("force").values.tolist() == [0.5, 0.6, 0.7]
    text = lvm(ROWS, decimal=",").replace("Decimal_Separator\t,\n", "")
    assert read(save(text)).streams[0].column("force").values.tolist() == [0.5, 0.6, 0.7]


def test_a_separator_of_commas_is_read(save):
    text = GOOD.replace("\t", ",").replace("Separator,Tab", "Separator\tComma", 1)
    assert read(save(text)).streams[0].column("acc").values.tolist() == [1.5, 1.6, 1.7]


def test_one_column_of_x_is_the_time(save):
    rows = "0.0\t0.5\t1.5\n0.011\t0.6\t1.6\tbang\n0.02\t0.7\t1.7\n"
    found = read(save(lvm(rows, x="One")))
    (stream,) = found.streams
    assert (stream.time, stream.column("X_Value").unit) == ("X_Value", "s")
    assert stream.column("X_Value").values.tolist() == [0.0, 0.011, 0.02]
    assert "Comment" in str(found.ignored)


MULTI = {
    "x": "Multi", "names": "\tforce\tX_Value\tacc\tComment", "samples": "3\t\t3",
}  # fmt: skip


def multi(rows):
    text = lvm(rows, **MULTI)
    day, clock = "2013/02/19", "09:51:40.7271890640258789063"
    for line in (
        f"{day}\t{day}",
        f"{clock}\t{clock}",
        "Newtons\tm/s^2",
        "2.5E-1\t2.5E-1",
        "1.0E-2\t1.0E-2",
        "Time\tTime",
    ):
        text = text.replace(line, line.replace("\t", "\t\t"))
    return text


def test_columns_of_x_that_agree_are_one_clock_and_others_are_two(save):
    same = read(save(multi("0.0\t0.5\t0.0\t1.5\n0.1\t0.6\t0.1\t1.6\n0.2\t0.7\t0.2\t1.7\n")))
    (stream,) = same.streams
    assert [c.name for c in stream.columns] == ["X_Value", "force", "acc"]
    assert stream.column("acc").unit == "m/s^2"
    other = read(save(multi("0.0\t0.5\t0.0\t1.5\n0.1\t0.6\t0.3\t1.6\n0.2\t0.7\t0.6\t1.7\n")))
    assert [s.name for s in other.streams] == ["log_force", "log_acc"]
    assert other.streams[1].column("X_Value").values.tolist() == [0.0, 0.3, 0.6]


def test_every_segment_is_a_stream(save):
    second = "\n".join(GOOD.split("\n")[13:]).replace("0.5", "9.5")
    found = read(save(GOOD + "\n" + second))
    assert [s.name for s in found.streams] == ["segment_1", "segment_2"]
    assert [s.first_row for s in found.streams] == [FIRST, FIRST + 14]
    assert found.streams[1].column("force").values[0] == 9.5


def test_empty_channels_are_missing_and_special_blocks_are_passed_over(save):
    special = "***Start_Special***\nanything\t1\n***End_Special***\n"
    text = GOOD.replace("Channels\t2", special + "Channels\t2").replace("\t0.6\t", "\t\t")
    stream = read(save(text)).streams[0]
    assert np.isnan(stream.column("force").values).tolist() == [False, True, False]
    assert stream.first_row == FIRST + 3


def test_fewer_samples_than_promised_are_said(save):
    stream = read(save(lvm(ROWS, samples="5\t5"))).streams[0]
    assert stream.truncated == "holds 3 of the 5 samples that its header promises"
    assert read(save(GOOD[:-4])).streams[0].truncated.startswith("line 26 ends in the middle")


def test_a_log_becomes_a_recording(save):
    stream = import_log(save(GOOD)).streams["log"]
    assert stream.time_s == pytest.approx([0, 0.01, 0.02])
    assert list(stream.channels) == ["force_N", "acc_m_s2"]


def test_bad_cells_have_their_lines(faults):
    assert faults(GOOD.replace("0.6", "O.6")) == ("line 25, column 'force': 'O.6' is not a number",)


def test_a_damaged_header_is_refused(faults):
    assert faults("LabVIEW Measurement\t\nWriter_Version\t2\n") == (
        "line 1: no segment of data follows; expected ***End_of_Header*** twice",
    )
    assert faults(GOOD.replace("Separator\tTab", "Separator\tBar", 1)) == (
        "Separator is 'Bar'; expected Tab, Comma or Semicolon",
    )
    assert faults(GOOD.split("\t0.5")[0]) == (f"line {FIRST}: no samples follow the header",)


def test_segments_longer_than_a_block_are_read_whole(save, monkeypatch):
    monkeypatch.setattr(_source, "BLOCK_BYTES", 500)
    rows = "".join(f"\t{i}.5\t{i}\n" for i in range(2000))
    stream = read(save(lvm(rows, samples="2000\t2000"))).streams[0]
    assert np.array_equal(stream.column("acc").values, np.arange(2000.0))
    assert stream.truncated == ""


def test_samples_beyond_the_promised_number_are_kept_and_said(save):
    found = read(save(lvm(ROWS + "\t0.8\t1.8\n")))
    assert found.streams[0].column("acc").values.tolist() == [1.5, 1.6, 1.7, 1.8]
    (told,) = [r for r in found.repairs if r.rule == "more_samples"]
    assert (told.severity, "promises 3 samples, and 4 are there" in told.text) == ("warning", True)


def test_a_start_that_is_missing_is_zero_and_a_step_without_end_is_none(save):
    found = read(save(GOOD.replace("X0\t2.5E-1\t2.5E-1", "X0")))
    assert found.streams[0].start_s == 0.0
    found = read(save(GOOD.replace("Delta_X\t1.0E-2\t1.0E-2", "Delta_X\tinf\tinf")))
    assert found.streams[0].increment_s is None
