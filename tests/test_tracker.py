"""Text exports of Tracker: single tracks, several, decimal commas, and what is none."""

from __future__ import annotations

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import mapping
from simcompare.hardware.logs import importers
from simcompare.verbs.import_log import import_log

SINGLE = (
    "mass A\nt\tx\ty\tv_{x}\n0.000000000E0\t1.245986911E1\t2.0E0\t\n"
    "4.000000000E-2\t1.3E1\t2.1E0\t2.5E1\n8.000000000E-2\t1.4E1\t2.2E0\t\n"
)
FORMS = {
    "tab": SINGLE,
    "comma": SINGLE.replace("mass A", "\tmass A\t\t").replace("\t", ","),
    "ends with separators": SINGLE.replace("mass A", "\tmass A\t\t").replace("\n", "\t\n"),
    "semicolon": SINGLE.replace("\t", ";").replace(".", ","),
    "decimal comma": SINGLE.replace(".", ","),
    "byte order mark": "\ufeff" + SINGLE,
}


@pytest.fixture
def write_log(tmp_path):
    def make(text):
        path = tmp_path / "clip.txt"
        path.write_bytes(text.encode())
        return path

    return make


def read(path):
    assert importers.recognise(path) == "tracker"
    return importers.read(path, "tracker", mapping.NOTHING)


@pytest.mark.parametrize("form", FORMS)
def test_every_form_of_a_single_track_is_the_same(write_log, form):
    found = read(write_log(FORMS[form]))
    (stream,) = found.streams
    assert (stream.time, stream.first_row, stream.column("t").unit) == ("t", 3, "s")
    assert stream.column("t").values.tolist() == [0.0, 0.04, 0.08]
    assert stream.column("x").values.tolist() == [12.45986911, 13.0, 14.0]
    # velocities need neighbours: the first and last are empty
    assert np.isnan(stream.column("v_{x}").values).tolist() == [True, False, True]
    assert found.about["tracks"] == "mass A"


@pytest.mark.parametrize("mark", [".", ","])
def test_several_tracks_share_the_clock_and_keep_their_names(write_log, mark):
    text = (
        "#multi:\n\tball\t\tfloor\t\t\nt\tx\ty\tx\ty\t\n0.0E0\t1.2E1\t2.0E0\t\t\t\n"
        "4.0E-2\t1.3E1\t2.1E0\t1.0E0\t5.0E-1\t\n8.0E-2\t\t\t1.1E0\t6.0E-1\t\n"
    )
    found = read(write_log(text.replace(".", mark)))
    (stream,) = found.streams
    assert [c.name for c in stream.columns] == ["t", "ball x", "ball y", "floor x", "floor y"]
    assert np.isnan(stream.column("ball x").values).tolist() == [False, False, True]
    assert stream.column("floor y").values[1:].tolist() == [0.5, 0.6]
    assert stream.first_row == 4


def test_frames_that_count_by_one_are_a_counter(write_log):
    text = ",A,,\nt,frame,x,\n0.0E0,1.2E2,1.0E0,\n4.0E-2,1.21E2,1.1E0,\n"
    stream = read(write_log(text)).streams[0]
    assert (stream.counter, stream.column("frame").unit) == ("frame", "1")


def test_a_mapping_gives_the_units_that_tracker_does_not_write(write_log, tmp_path):
    (tmp_path / "map.yaml").write_text(
        "channels:\n  height: {column: y, unit: cm}\n  side: {column: x, unit: cm}\n"
    )
    found = import_log(write_log(SINGLE), mapping=tmp_path / "map.yaml")
    assert found.streams["log"].channels["height_m"].values == pytest.approx([0.02, 0.021, 0.022])


def test_lengths_are_metres_where_nobody_says_otherwise_and_this_is_told(write_log, tmp_path):
    path = write_log("ball\nt\tx\ty\tv_{y}\ta\n0\t1\t2\t3\t4\n0.1\t1\t2\t3\t4\n")
    found = import_log(path)
    units = {one.raw: one.unit for one in found.streams["log"].channels.values()}
    assert units == {"x": "m", "y": "m", "v_{y}": "m/s", "a": "m/s**2"}
    assumed = [one.channel for one in found.provenance.repairs if one.rule == "no_units"]
    assert assumed == ["x", "y", "v_{y}", "a"]
    (tmp_path / "map.yaml").write_text("channels: {height: {column: y, unit: m}}")
    found = import_log(path, mapping=tmp_path / "map.yaml")
    assumed = [one.channel for one in found.provenance.repairs if one.rule == "no_units"]
    assert assumed == ["x", "v_{y}", "a"]


def test_angles_have_no_usual_unit(write_log):
    path = write_log("ball\nt\tx\tθ\n0\t1\t2\n0.1\t1\t2\n")
    left_out = [one for one in import_log(path).provenance.conversions if not one.channel]
    assert [(one.raw, one.reason) for one in left_out] == [("θ", "no unit is known")]


def test_a_comma_that_separates_and_decides_is_refused(write_log):
    path = write_log(",mass A,,\nt,x,y,\n0,00E0,1,24E1,2,0E0,\n4,0E-2,1,3E1,2,1E0,\n")
    with pytest.raises(InputError) as error:
        read(path)
    assert error.value.faults == (
        "line 3: has 6 numbers for 3 columns: the comma is the decimal mark too; export again with"
        " a semicolon or tab as delimiter",
    )


def test_faults_have_their_lines(write_log):
    with pytest.raises(InputError) as error:
        read(write_log(SINGLE.replace("1.3E1", "1.3F1") + "1\t2\n"))
    assert error.value.faults == (
        "line 4, column 'x': '1.3F1' is not a number",
        "line 6: has 2 cells, expected 4",
    )


def test_another_table_is_no_export_of_tracker(write_log):
    path = write_log("a remark\nu,v\n0,1\n1,2\n")
    with pytest.raises(InputError, match=r"line 2: 'u,v' is no header of Tracker"):
        importers.read(path, "tracker", mapping.NOTHING)
    assert importers.recognise(path) == "csv"


def test_a_text_without_a_line_end_is_no_trace(write_log):
    with pytest.raises(InputError, match="is no header of Tracker"):
        importers.read(write_log("mass A " * 20_000), "tracker", mapping.NOTHING)
