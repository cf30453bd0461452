"""CSV of oscilloscopes: every maker's layout, clipped samples, probe factors, cut files."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import mapping
from simcompare.hardware.logs import importers
from simcompare.verbs.import_log import import_log

DATA = os.environ.get("SIMCOMPARE_DATA", "")
RIGOL = "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.2e-04,2.0e-07,\n" + "".join(
    f"{i},{1 + i / 10},{i},,,\n" for i in range(4)
)
LEFT = (
    "Record Length,4.0e+00,,-0.000002,0.10,\nSample Interval,1.0e-06,,-0.000001,0.20,\n"
    "Vertical Units,V,,0.000000,0.30,\nProbe Atten,1.0e+01,,0.000001,0.40,\n"
)
KEYED = (
    "Model,MSO58\nFirmware Version,2.0.3\n\nWaveform Type,ANALOG,ANALOG\nPoint Format,Y,Y\n"
    "Sample Interval,1e-06,1e-06\nRecord Length,4,4\nProbe Attenuation,10,1\nVertical Units,V,A\n"
    "Label,SDA,IOUT\n,,\nTIME,CH1,CH2,\n-2e-06,0.1,1,\n-1e-06,0.2,2,\n0,0.3,3,\n1e-06,0.4,4,\n"
)
SIGLENT = (
    "Record Length,Analog:4\nSample Interval,Analog:0.000001\nVertical Units,CH1:V\n"
    "Vertical Scale,CH1:1.00\nHorizontal Units,s\nModel Number,SDS1104X-E\nSource,CH1\n"
    "Second,Value\n-0.000002,0.10\n-0.000001,0.20\n0.0,0.30\n0.000001,0.40\n"
)
KEYSIGHT = "x-axis,1\nsecond,Volt\n-2E-06,100E-03\n-1E-06,200E-03\n0,300E-03\n+1E-06,4.0E-01\n"
PICO = "Time,Channel A\n(us),(mV)\n\n-2.0,100.0\n-1.0,200.0\n0.0,300.0\n1.0,400.0\n"
SCHWARZ = "in s,C1 in V\n-2.0E-06,1.0E-01\n-1.0E-06,2.0E-01\n0.0E+00,3.0E-01\n1.0E-06,4.0E-01\n"
#: text, maker, name of the first channel, line of the first sample
ALL = {
    "tektronix left": (LEFT, "Tektronix", "CH1", 1),
    "tektronix keyed": (KEYED, "Tektronix", "CH1", 13),
    "tektronix remarked": ("".join(f"#{line}\n" for line in KEYED.splitlines()[:12])
                           + "\n".join(KEYED.splitlines()[12:]) + "\n", "Tektronix", "CH1", 13),
    "siglent": (SIGLENT, "Siglent", "CH1", 9),
    "keysight": (KEYSIGHT, "Keysight", "channel 1", 3),
    "pico": (PICO, "PicoScope", "Channel A", 4),
    "pico decimal comma": (PICO.replace(",", ";").replace(".", ","), "PicoScope", "Channel A", 4),
    "rohde & schwarz": (SCHWARZ, "Rohde & Schwarz", "C1", 2),
}  # fmt: skip


@pytest.fixture
def save(tmp_path):
    def make(text):
        path = tmp_path / "scope.csv"
        path.write_bytes(text.encode())
        return path

    return make


def read(path):
    assert importers.recognise(path) == "scope"
    return importers.read(path, "scope", mapping.NOTHING)


@pytest.mark.parametrize("name", ALL)
def test_every_layout_gives_the_same_trace(save, name):
    text, maker, channel, first = ALL[name]
    found = read(save(text))
    (stream,) = found.streams
    assert (found.about["instrument"], stream.first_row, stream.truncated) == (maker, first, "")
    recording = import_log(save(text))
    made = recording.streams["log"]
    assert made.time_s == pytest.approx([0, 1e-6, 2e-6, 3e-6])
    assert made.clock.first_s == pytest.approx(-2e-6)
    (values,) = [c for c in made.channels.values() if c.raw == channel]
    assert (values.unit, values.values) == ("V", pytest.approx([0.1, 0.2, 0.3, 0.4]))


def test_rigol_gives_start_and_increment_instead_of_times(save):
    found = read(save(RIGOL))
    (stream,) = found.streams
    assert (stream.time, stream.start_s, stream.increment_s) == (None, -1.2e-4, 2e-7)
    assert (stream.counter, stream.first_row) == ("X", 3)
    assert stream.column("CH1").values.tolist() == [1.0, 1.1, 1.2, 1.3]
    assert [c.unit for c in stream.columns] == ["1", "V", "V"]
    one = RIGOL.replace(",CH2", "").replace("Volt,Volt", "Volt")
    rows = "".join(f"{i},{i},\n" for i in range(3))
    single = read(save("\n".join(one.split("\n")[:2]) + "\n" + rows)).streams[0]
    assert [c.name for c in single.columns] == ["X", "CH1"]


def test_samples_beyond_the_range_become_missing_and_the_range_is_noted(save):
    text = PICO.replace("200.0", "∞").replace("400.0", "-∞")
    found = read(save(text))
    column = found.streams[0].column("Channel A")
    assert np.isnan(column.values).tolist() == [False, True, False, True]
    assert column.limits == (100.0, 300.0)
    (repair,) = [r for r in found.repairs if r.rule == "clipped"]
    assert (repair.severity, repair.rows, repair.count) == ("repair", ((5, 5), (7, 7)), 2)
    assert repair.channel == "Channel A"


def test_only_the_end_at_which_a_trace_is_clipped_is_a_limit(save):
    column = read(save(PICO.replace("200.0", "∞"))).streams[0].column("Channel A")
    assert column.limits == (-np.inf, 400.0)


def test_the_probe_factor_is_noted_not_applied(save):
    found = read(save(KEYED))
    (note,) = [r for r in found.repairs if r.rule == "probe_factor"]
    assert (note.severity, "10, 1" in note.text) == ("info", True)
    assert found.streams[0].column("CH2").unit == "A"


def test_fewer_samples_than_promised_are_a_truncated_file(save):
    cut = SIGLENT.rsplit("\n", 2)[0] + "\n"
    assert read(save(cut)).streams[0].truncated == (
        "holds 3 of the 4 samples that its record length says"
    )
    assert read(save(SIGLENT[:-6])).streams[0].truncated.startswith("line 12 ends in the middle")


# ---- bad input --------------------------------------------------------------------------------

BAD = {
    "no increment": (RIGOL.replace("2.0e-07", "fast"),
                     "line 2: '-1.2e-04, fast' is no start and increment; expected two numbers,"
                     " such as -0.1,1e-6, the second above 0"),
    "increment 0": (RIGOL.replace("2.0e-07", "0"),
                    "line 2: '-1.2e-04, 0' is no start and increment; expected two numbers,"
                    " such as -0.1,1e-6, the second above 0"),
    "a word": (SIGLENT.replace("0.20", "ERR"),
               "line 10, column 'CH1': 'ERR' is not a number; where nothing was measured,"
               " leave the cell empty, or delete the line"),
    "a short row": (KEYSIGHT.replace(",300E-03", ""), "line 5: has 1 cells, expected 2"),
    "no samples": ("x-axis,1\nsecond,Volt\n", "line 3: no samples follow the header"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused_with_its_line(save, name):
    text, fault = BAD[name]
    with pytest.raises(InputError) as error:
        read(save(text))
    assert error.value.faults == (fault,)


def test_a_plain_table_is_no_oscilloscopes(save):
    path = save("time,angle\n(s),(deg)\n0,1\n1,2\n")
    assert importers.recognise(path) == "csv"
    with pytest.raises(InputError, match="line 1: no layout of an oscilloscope; known: Rigol"):
        importers.read(path, "scope", mapping.NOTHING)


@pytest.mark.skipif(not DATA, reason="SIMCOMPARE_DATA names no folder of recordings")
def test_a_real_trace_is_read_whole():
    path = Path(DATA) / "motor_dyno" / "back_emf" / "0250rpm1_CHAN1.csv"
    stream = read(path).streams[0]
    assert (len(stream), stream.column("time").values[0]) == (130896, -0.29999988)
    assert stream.column("C1").values[0] == 0.89530945
