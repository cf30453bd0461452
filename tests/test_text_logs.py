"""CSV and its kin: what every lab writes is read as it stands, or refused with line and column."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import mapping
from simcompare.hardware.logs import importers
from simcompare.hardware.logs.text import source as _source
from simcompare.verbs.import_log import import_log

DATA = os.environ.get("SIMCOMPARE_DATA", "")
needs_data = pytest.mark.skipif(not DATA, reason="SIMCOMPARE_DATA names no folder of recordings")
PLAIN = "time_s,angle_rad\n0.0,1.5\n0.1,2.5\n0.2,3.5\n"


@pytest.fixture
def log(tmp_path):
    def make(text, name="log.csv", encoding="utf-8"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
        return path

    return make


@pytest.fixture
def read(log):
    def of(text, encoding="utf-8", wishes=None):
        path = log(text, encoding=encoding)
        wanted = mapping.NOTHING if wishes is None else mapping.of_tree(wishes, "map")
        assert importers.recognise(path) == "csv"
        return importers.read(path, "csv", wanted)

    return of


@pytest.fixture
def faults(log):
    def of(text, encoding="utf-8"):
        with pytest.raises(InputError) as error:
            importers.read(log(text, encoding=encoding), "csv", mapping.NOTHING)
        assert "log.csv" in str(error.value)
        return error.value.faults

    return of


def table(found):
    stream = found.streams[0]
    return {c.name: (c.unit, c.values.tolist()) for c in stream.columns}


def rules(found):
    return {repair.rule: repair for repair in found.repairs}


SAME = {"time": ("s", [0.0, 0.1, 0.2]), "angle": ("deg", [1.5, 2.5, 3.5])}
VARIANTS = {
    "comma": "time (s),angle (deg)\n0,1.5\n0.1,2.5\n0.2,3.5\n",
    "semicolon": "time [s];angle [deg]\n0;1,5\n0,1;2,5\n0,2;3,5\n",
    "tab": "time / s\tangle / deg\n0\t1,5\n0,1\t2,5\n0,2\t3,5\n",
    "bar": "time (s)|angle (deg)\n0|1.5\n0.1|2.5\n0.2|3.5\n",
    "blanks": "time_sec   angle_deg\n  0.0   1.5\n  0.1    2.5\n  0.2   3.5\n",
    "quotes": '"time (s)","angle (deg)"\n"0","1.5"\n"0.1","2.5"\n"0.2","3.5"\n',
    "quoted decimal comma": '"time (s)","angle (deg)"\n"0,0","1,5"\n"0,1","2,5"\n"0,2","3,5"\n',
    "crlf": "time (s),angle (deg)\r\n0,1.5\r\n0.1,2.5\r\n0.2,3.5\r\n",
    "old mac": "time (s),angle (deg)\r0,1.5\r0.1,2.5\r0.2,3.5\r",
    "no last line end": "time (s),angle (deg)\n0,1.5\n0.1,2.5\n0.2,3.5",
    "trailing separators": "time (s),angle (deg),\n0,1.5,\n0.1,2.5,\n0.2,3.5,\n",
    "units row": "time,angle\ns,deg\n0,1.5\n0.1,2.5\n0.2,3.5\n",
    "units row in brackets": "time,angle\n(s),(deg)\n\n0,1.5\n0.1,2.5\n0.2,3.5\n",
    "preamble": "Logger: XY-3\nOperator=Ada\n\ntime (s),angle (deg)\n0,1.5\n0.1,2.5\n0.2,3.5\n",
    "comments": "# made by hand\n% twice\ntime (s),angle (deg)\n0,1.5\n0.1,2.5\n0.2,3.5\n",
    "header in a comment": "# time (s), angle (deg)\n0, 1.5\n0.1, 2.5\n0.2, 3.5\n",
    "exponents": "time (s),angle (deg)\n0.0E0,1.5e+00\n1E-1,.25e1\n2.0D-1,3.5\n",
}  # fmt: skip


@pytest.mark.parametrize("name", VARIANTS)
def test_every_way_to_write_the_same_table_gives_the_same_columns(read, name):
    found = read(VARIANTS[name])
    assert table(found) == SAME
    assert found.streams[0].time == "time"
    assert not found.streams[0].truncated


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"])
def test_every_encoding_is_read_and_recorded(read, encoding):
    found = read("time (s),temperature (°C),field (µT)\n0,20,1\n0.1,21,2\n", encoding)
    assert table(found)["temperature"] == ("°C", [20.0, 21.0])
    assert table(found)["field"] == ("µT", [1.0, 2.0])
    mark = encoding in ("utf-8-sig", "utf-16")
    assert ("byte_order_mark" in rules(found)) == mark
    assert ("encoding" in rules(found)) == (not mark)


def test_a_decimal_comma_is_recorded_as_harmless(read):
    assert rules(read(VARIANTS["semicolon"]))["decimal_comma"].severity == "info"
    assert "decimal_comma" not in rules(read(VARIANTS["comma"]))


def test_a_preamble_describes_the_log(read):
    assert read(VARIANTS["preamble"]).about == {"Logger": "XY-3", "Operator": "Ada"}


def test_rows_are_counted_as_lines_of_the_file(read):
    found = read("# a\n# b\nt,x\n0,1\n\n1,2\n# remark\n2,3\n")
    assert found.streams[0].rows.tolist() == [4, 6, 8]
    assert rules(found)["blank_line"].rows == ((5, 5),)
    assert rules(found)["comment_line"].rows == ((7, 7),)
    assert read("# a\nt,x\n0,1\n1,2\n").streams[0].first_row == 3


def test_a_header_that_stands_again_is_left_out_and_recorded_as_a_repair(read):
    found = read("t,x\n0,1\n1,2\nt,x\n2,3\n")
    assert table(found)["x"][1] == [1.0, 2.0, 3.0]
    assert found.streams[0].rows.tolist() == [2, 3, 5]
    assert (rules(found)["header_repeated"].severity, rules(found)["header_repeated"].rows) == (
        "repair", ((4, 4),),
    )  # fmt: skip


def test_columns_of_lists_become_numbered_columns_and_text_is_left_out_with_its_reason(read):
    found = read('type,timestamp,positions\nA,0,"[0.1, -2e-3]"\nB,1,"[0.3, 4]"\n')
    assert table(found)["positions[0]"][1] == [0.1, 0.3]
    assert table(found)["positions[1]"][1] == [-0.002, 4.0]
    assert found.ignored == {"type": "holds text such as 'A'"}


def test_cells_that_say_missing_are_missing_and_flags_are_numbers(read):
    found = read("t,x,on\n0,,true\n1,NaN,false\n2,n/a,TRUE\n3,4,True\n")
    assert np.isnan(found.streams[0].column("x").values).tolist() == [True, True, True, False]
    assert table(found)["on"][1] == [1.0, 0.0, 1.0, 1.0]


def test_what_a_spreadsheet_could_not_work_out_is_missing(read):
    found = read("t,x\n0,#VALUE!\n1,#DIV/0!\n2,3\n3,4\n")
    assert np.isnan(found.streams[0].column("x").values).tolist() == [True, True, False, False]


def test_a_log_without_header_has_no_time(read):
    found = read("0.0\t5\t\n0.1\t4\t\n0.2\t6\t\n")
    assert found.streams[0].time is None
    assert list(table(found)) == ["column_1", "column_2"]
    assert "no_header" in rules(found)


@pytest.mark.parametrize(
    ("head", "name", "unit"),
    [("t", "t", ""), ("Time (ms)", "Time", "ms"), ("time_us", "time", "us"), ("stamp", "stamp", ""),
     ("timestamp_ns", "timestamp", "ns"), ("seconds", "seconds", "s"), ("%time", "%time", ""),
     ("Zeit [s]", "Zeit", "s"), ("elapsed (s)", "elapsed", "s"), ("lap (s)", "lap", "s")],
)  # fmt: skip
def test_the_time_is_known_by_its_name_or_unit(read, head, name, unit):
    stream = read(f"x,{head}\n5,1\n6,2\n").streams[0]
    assert (stream.time, stream.column(name).unit) == (name, unit)


def test_two_columns_that_may_be_the_time_are_refused_until_a_mapping_says_which(faults, read):
    text = "time,timestamp,x\n0,5,1\n1,6,2\n2,9,2\n"
    assert faults(text) == (
        "columns 'time' and 'timestamp' may all be the time; say which in a mapping file (--map)"
        ", such as time: {column: time, unit: s}",
    )
    wishes = {"time": {"column": "timestamp", "unit": "s"}}
    assert read(text, wishes=wishes).streams[0].time == "timestamp"


def test_a_mapping_may_name_a_column_with_its_unit(read):
    wishes = {"channels": {"angle": {"column": "angle (deg)", "unit": "deg"}}}
    assert "angle (deg)" in table(read(VARIANTS["comma"], wishes=wishes))


DATES = {
    "iso": (["2024-02-28T23:59:59.5", "2024-02-29T00:00:00.25"], "2024-02-28T23:59:59.500000"),
    "zone": (["2024-02-28T23:59:59.5Z", "2024-02-29T01:00:00.25+01:00"],
             "2024-02-28T23:59:59.500000"),
    "comma": (["2024-02-28 23:59:59,5", "2024-02-29 00:00:00,25"], "2024-02-28T23:59:59.500000"),
    "points": (["28.02.2024 23:59:59.5", "29.02.2024 00:00:00.25"], "2024-02-28T23:59:59.500000"),
    "month first": (["02/28/2024 11:59:59.5 PM", "02/29/2024 12:00:00.25 AM"],
                    "2024-02-28T23:59:59.500000"),
}  # fmt: skip


@pytest.mark.parametrize("name", DATES)
def test_dates_become_seconds_with_the_start_in_the_clock(read, name):
    cells, start = DATES[name]
    found = read("when;x\n".replace("when", "date") + "".join(f"{c};1\n" for c in cells))
    stream = found.streams[0]
    assert stream.column("date").values.tolist() == [0.0, 0.75]
    assert (stream.time, stream.clock.start) == ("date", start)
    assert rules(found)["date_text"].channel == "date"


def test_a_date_beside_a_time_of_day_are_one_clock(read):
    found = read("Date,Time,x\n2024-01-31,23:59:59.5,1\n2024-02-01,00:00:00.5,2\n")
    assert found.streams[0].column("Time").values.tolist() == [0.0, 1.0]
    assert found.streams[0].clock.start == "2024-01-31T23:59:59.500000"
    assert found.ignored == {"Date": "was added to column 'Time'"}


def test_a_time_of_day_that_passes_midnight_goes_on_and_is_recorded(read):
    found = read("time,x\n23:59:59,1\n00:00:01,2\n00:00:02,3\n")
    assert found.streams[0].column("time").values.tolist() == [0.0, 2.0, 3.0]
    assert rules(found)["midnight"].rows == ((3, 3),)


def test_a_date_that_may_be_read_in_two_ways_is_refused_when_it_changes(faults, read):
    text = "date,x\n01/02/2024 23:00:00,1\n02/02/2024 01:00:00,2\n"
    assert faults(text) == (
        "column 'date': '01/02/2024 23:00:00' may be day/month/year or month/day/year, and the"
        " date changes in the log; write dates as 2024-12-31",
    )
    same = read("date,x\n01/02/2024 22:00:00,1\n01/02/2024 23:00:00,2\n")
    assert (same.streams[0].clock.start, same.streams[0].column("date").values.tolist()) == (
        "", [0.0, 3600.0],
    )  # fmt: skip


def test_stamps_of_nineteen_digits_keep_their_last_one(read):
    found = read("timestamp,x\n1700000000123456789,1\n1700000000123456792,2\n")
    stream = found.streams[0]
    assert stream.column("timestamp").values.tolist() == [0.0, 3.0]
    assert stream.clock.start == "2023-11-14T22:13:20.123456"


def test_an_echo_of_ros_takes_header_stamps_units_and_covariances(read):
    fields = ["%time", "field.header.seq", "field.header.stamp", "field.header.frame_id"]
    fields += [f"field.orientation.{a}" for a in "xyzw"]
    fields += [f"field.orientation_covariance{i}" for i in range(9)]
    fields += [f"field.linear_acceleration.{a}" for a in "xyz"]
    fields += [f"field.linear_acceleration_covariance{i}" for i in range(9)]
    covariances = "-1,0,0,0,0,0,0,0,0", "0.04,0,0,0,0.09,0,0,0,0.01"
    rows = [
        f"{17 * 10**17 + 7 + i},{i},{17 * 10**17 + i},imu,0,0,0,0,{covariances[0]},0,0,9.8,"
        f"{covariances[1]}"
        for i in (0, 5)
    ]
    path_text = ",".join(fields) + "\n" + "\n".join(rows) + "\n"
    found = read(path_text)
    stream = found.streams[0]
    assert stream.time == "field.header.stamp"
    assert stream.column(stream.time).values.tolist() == [0.0, 5.0]
    z = stream.column("field.linear_acceleration.z")
    assert (z.unit, z.kind, z.u) == ("m/s^2", "specific_force", pytest.approx(0.1))
    assert "not measured" in found.ignored["field.orientation.w"]


# ---- bad input --------------------------------------------------------------------------------

#: what is advised, once, where a word stands in a column of numbers
WORD = "; where nothing was measured, leave the cell empty, or delete the line"


def test_every_bad_cell_and_row_is_named_with_line_and_column(faults):
    text = "t,x,y\n0,1,2\n1,abc,3\n2,1\n3,4,5\n4,5,6,7\n5,1,-x-\n6,1,1\n7,1,1\n8,1,1\n9,1,1\n"
    assert faults(text) == (
        "line 3, column 'x': 'abc' is not a number" + WORD,
        "line 4: has 2 cells, expected 3",
        "line 6: has 4 cells, expected 3",
        "line 7, column 'y': '-x-' is not a number",
    )


def test_a_bad_first_row_is_no_header(faults):
    assert faults("t,x,y\n0,abc,1\n1,2,3\n2,3,4\n3,4,5\n") == (
        "line 2, column 'x': 'abc' is not a number" + WORD,
    )


def test_after_twenty_faults_the_rest_is_counted(faults):
    text = "t,x\n" + "0,1\n" * 60 + "1,bad\n" * 50
    found = faults(text)
    assert len(found) == 21
    assert found[0] == "line 62, column 'x': 'bad' is not a number" + WORD
    assert found[-1] == "and 30 more such faults"


@pytest.mark.parametrize("last", ["0.2", "0.2,", "0.2,3.", "0.2,1e-", "0.2,-"])
def test_a_last_line_that_is_cut_is_left_out_and_said(read, last):
    found = read(PLAIN.rsplit("\n", 2)[0] + "\n" + last)
    stream = found.streams[0]
    if last == "0.2,3.":  # nobody can see that this number is not whole
        assert (len(stream), stream.truncated) == (3, "")
    else:
        assert len(stream) == 2
        assert stream.truncated.startswith("line 4 ends in the middle")


def test_thousands_and_decimals_that_look_alike_are_refused(faults, read):
    assert faults("t;x\n0;1,234\n1;2,345\n")[0] == (
        "line 2, column 'x': '1,234' may be 1234 or 1.234; write the log with decimal points and"
        " without marks of thousands"
    )
    assert table(read("t;x\n0;1,234\n1;2,3\n"))["x"][1] == [1.234, 2.3]
    certain = read("t;x\n0;1,234.5\n1;2,345\n")
    assert table(certain)["x"][1] == [1234.5, 2345.0]
    assert "thousands" in rules(certain)
    assert table(read("t;x\n0;1.234,5\n1;2.345,0\n"))["x"][1] == [1234.5, 2345.0]


def test_a_mark_that_comes_late_decides_or_is_refused(read, faults):
    whole = "t;x\n" + "1;100\n" * 20_000  # longer than what is looked at first
    assert read(whole + "2;1,5\n").streams[0].column("x").values[-1] == 1.5
    assert "may be 1234 or 1.234" in faults(whole + "2;1,234\n")[0]
    assert faults(whole + "2;1.5\n3;1,5\n") == ("line 20003, column 'x': '1,5' is not a number",)


def test_a_comma_that_separates_and_decides_is_refused(faults):
    assert faults("t,x\n0,5,1,5\n1,5,2,5\n") == (
        "the header (line 1) has 2 cells but the rows below have 4; the comma seems to be the"
        " decimal mark too; export again with another separator",
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [("", "is empty"), (" \n \n", "is empty"), ("t,x\n", "has a header (t, x) and no rows"),
     ("a b c\nd e f\n", "holds no rows of numbers"), (b"\x00\x01\x02" * 100, "binary data"),
     ("t,x,y\n0,1\n1,2\n", "the header (line 1) has 3 cells but the rows below have 2")],
)  # fmt: skip
def test_what_is_no_table_is_refused(faults, text, words):
    assert words in faults(text)[0]


# ---- long logs --------------------------------------------------------------------------------


def test_blocks_join_without_a_seam_and_a_fault_in_one_keeps_its_line(log, monkeypatch, faults):
    monkeypatch.setattr(_source, "BLOCK_BYTES", 1000)
    rows = [f"{i / 8},{i}" for i in range(3000)]
    path = log("t,x\n" + "\n".join(rows) + "\n")
    found = importers.read(path, "csv", mapping.NOTHING).streams[0]
    assert np.array_equal(found.column("x").values, np.arange(3000.0))
    assert np.array_equal(found.column("t").values, np.arange(3000.0) / 8)
    assert found.rows is None
    rows[2000] = "250,oops"
    assert faults("t,x\n" + "\n".join(rows) + "\n") == (
        "line 2002, column 'x': 'oops' is not a number" + WORD,
    )


def test_remarks_and_midnights_in_a_long_log_keep_their_lines(log, monkeypatch):
    monkeypatch.setattr(_source, "BLOCK_BYTES", 1000)
    rows = [f"{(23 * 3600 + i) // 3600 % 24:02d}:{i // 60 % 60:02d}:{i % 60:02d},{i}"
            for i in range(4000)]  # fmt: skip
    lines = ["time,x"]
    for i, row in enumerate(rows):
        lines += [row] if i % 500 else ["# a remark", row]
    found = importers.read(log("\n".join(lines) + "\n"), "csv", mapping.NOTHING)
    stream = found.streams[0]
    assert np.array_equal(stream.column("time").values, np.arange(4000.0))
    expected = [n for n, line in enumerate(lines, start=1) if line[0].isdigit()]
    assert stream.rows.tolist() == expected
    assert rules(found)["midnight"].rows == ((expected[3600], expected[3600]),)
    assert rules(found)["comment_line"].count == 7  # the first stands above the rows


def test_numbers_are_read_to_the_last_bit(read):
    values = np.random.default_rng(3).normal(size=500) * 10.0 ** np.arange(-250, 250)
    found = read("t,x\n" + "".join(f"{i},{v!r}\n" for i, v in enumerate(values.tolist())))
    assert np.array_equal(found.streams[0].column("x").values, values)


def test_a_table_becomes_a_recording(log):
    found = import_log(log(VARIANTS["semicolon"]))
    stream = found.streams["log"]
    assert stream.time_s.tolist() == [0.0, 0.1, 0.2]
    assert stream.channels["angle_rad"].values == pytest.approx(np.deg2rad([1.5, 2.5, 3.5]))
    assert [c.raw_unit for c in found.provenance.conversions] == ["deg"]


# ---- recordings of others ---------------------------------------------------------------------


@needs_data
def test_an_imu_table_of_a_real_device_is_read_whole():
    path = Path(DATA) / "imu_xio" / "sensor_data.csv"
    stream = importers.read(path, importers.recognise(path), mapping.NOTHING).streams[0]
    assert (len(stream), stream.time) == (13514, "Time")
    units = [c.unit for c in stream.columns]
    assert units == ["s", *["deg/s"] * 3, *["g"] * 3, *["uT"] * 3]
    assert stream.column("Accelerometer Z").values[0] == 0.9970807


@needs_data
def test_lists_in_cells_of_a_real_servo_log_are_read():
    path = Path(DATA) / "servo_so101" / "step_response" / "state_motor.csv"
    found = importers.read(path, importers.recognise(path), mapping.NOTHING)
    stream = found.streams[0]
    assert (len(stream), len(stream.columns)) == (6000, 19)
    assert stream.column("torques[2]").values[0] == 0.524722
    assert found.ignored == {"type": "holds text such as 'STATE_MOTOR'"}


@needs_data
def test_every_table_of_the_recordings_is_recognised_and_read():
    paths = [p for p in sorted(Path(DATA).rglob("*.csv")) if p.stat().st_size > 200]
    assert len(paths) > 30
    for path in paths:
        stream = importers.read(path, importers.recognise(path), mapping.NOTHING).streams[0]
        lines = path.read_bytes().count(b"\n")
        assert lines - len(stream) in (0, 1), path


@pytest.mark.parametrize("name", ["time_s", "t_s", "timestamp_s", "Time_s", "elapsed_time_s"])
def test_a_time_with_its_unit_in_the_name_is_the_time(read, name):
    stream = read(f"{name},x_m\n0,1\n1,2\n2,3\n").streams[0]
    assert (stream.time, stream.column(name).unit) == (name, "s")


def test_a_last_number_with_fewer_decimals_and_no_line_end_is_cut(read):
    rows = "".join(f"{i / 10:.1f},{i / 8:.4f}\n" for i in range(20))
    stream = read(f"t,x\n{rows}2.0,2.5").streams[0]
    assert len(stream) == 20
    assert "line 22 ends in the middle ('2.5' has fewer decimals" in stream.truncated
    whole = read(f"t,x\n{rows}2.0,2.5000")
    assert (len(whole.streams[0]), whole.streams[0].truncated) == (21, "")
    assert rules(whole)["no_line_end"].rows == ((22, 22),)
    assert "no_line_end" not in rules(read(f"t,x\n{rows}2.0,2.5000\n"))
