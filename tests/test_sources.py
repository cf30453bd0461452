"""Logs without units whose header says who wrote them open at the first try, in SI."""

from __future__ import annotations

import numpy as np
import pytest

from simcompare.hardware.logs import profiles
from simcompare.verbs.import_log import import_log

#: g_0 by its definition [m/s^2]
G = 9.80665
DEG = np.pi / 180


def rows(template, count=40, step=0.01):
    """Lines of numbers: {t} is the time in s, {ms}, {us} and {ns} that in its units, {n} counts."""
    made = []
    for n in range(count):
        t = n * step
        wave = 0.1 * np.sin(7 * t)
        values = {"t": f"{t:.4f}", "n": n, "ms": round(1e3 * t), "us": round(1e6 * t),
                  "ns": 1711111111000000000 + round(1e9 * t), "w": f"{wave:.5f}",
                  "epoch": f"{1711111111 + t:.4f}"}  # fmt: skip
        made.append(template.format(**values))
    return "\n".join(made) + "\n"


#: file name, header, row, channel -> its value in the middle
CASES = {
    "sensor logger accelerometer": (
        "Accelerometer.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},0.5,{w},0.25",
        {"z_m_s2": 0.5, "x_m_s2": 0.25},
    ),
    "sensor logger with gravity": (
        "TotalAcceleration.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},9.81,{w},0.25",
        {"z_m_s2": 9.81},
    ),
    "sensor logger gyroscope": (
        "Gyroscope.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},0.5,{w},0.25",
        {"z_rad_s": 0.5},
    ),
    "sensor logger magnetometer": (
        "Magnetometer.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},40,{w},20",
        {"z_T": 40e-6},
    ),
    "sensor logger barometer": (
        "Barometer.csv", "time,seconds_elapsed,relativeAltitude,pressure\n",
        "{ns},{t},0.5,1013.25", {"pressure_Pa": 101325.0, "relativealtitude_m": 0.5},
    ),
    "sensor logger orientation": (
        "Orientation.csv", "time,seconds_elapsed,yaw,qx,qz,roll,qw,qy,pitch\n",
        "{ns},{t},0.5,0,0,{w},1,0,0.1", {"yaw_rad": 0.5, "qw": 1.0},
    ),
    "tum": (
        "poses.txt", "# timestamp tx ty tz qx qy qz qw\n", "{epoch} 1.5 {w} 0.5 0 0 0 1",
        {"tx_m": 1.5, "qw": 1.0},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_log_of_a_known_source_opens_at_the_first_try(case, tmp_path):
    name, header, row, expected = CASES[case]
    path = tmp_path / name
    path.write_text(header + rows(row), encoding="utf-8")
    recording = import_log(path)
    channels = {k: v for s in recording.streams.values() for k, v in s.channels.items()}
    for channel, value in expected.items():
        assert channel in channels, sorted(channels)
        middle = channels[channel].values[20]
        assert middle == pytest.approx(value, rel=1e-9, abs=1e-12)  # only conversions
    stream = next(iter(recording.streams.values()))
    assert stream.time_s[-1] == pytest.approx(0.39, abs=1e-3)  # stamps of 1 ms at the coarsest


def test_the_recording_says_what_was_recognised(tmp_path):
    path = tmp_path / "Accelerometer.csv"
    path.write_text(
        "time,seconds_elapsed,z,y,x\n" + rows("{ns},{t},0.5,{w},0.25"), encoding="utf-8"
    )
    recording = import_log(path)
    texts = [r.text for r in recording.provenance.repairs if r.rule == "source"]
    assert texts == [
        "recognised as Sensor Logger (acceleration without gravity), which defines the units"
    ]
    assert recording.streams["log"].channels["z_m_s2"].kind == "gravity_removed"
    assert recording.streams["log"].clock.start.startswith("2024-03-22T12:38:31")


def test_a_name_that_says_nothing_gives_no_units():
    # three axes of any sensor: only the name of the file said which
    assert (
        profiles.find("walk.csv", [], [(n, "") for n in ("time", "seconds_elapsed", "x")]) is None
    )


def test_every_unit_of_a_source_is_one():
    from simcompare import units

    for source in profiles.sources().values():
        for table in source.tables:
            for quantity in table.channels.values():
                if quantity.unit != "above":
                    units.si_of(quantity.unit, "")


def test_a_unit_that_the_log_says_stays():
    found = profiles.find(
        "Gyroscope.csv", [], [("time", ""), ("seconds_elapsed", ""), ("x", "deg/s")]
    )
    assert found is not None
    assert found.names[2] == ("x", "deg/s")
