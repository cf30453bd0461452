"""``simcompare calibrate``: from a table, a log, a stored calibration, or a drawn device."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import simcompare
from simcompare.cli import app, register
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors.six_position import POSITIONS
from simcompare.model import recording_store
from simcompare.reports.calibration import coverage, figures, words
from simcompare.statistics.streams import stream

G_M_S2 = 9.80665
EXAMPLE = Path(__file__).parents[1] / "examples" / "six_positions.csv"
TRUE_S = np.eye(3) + np.array([[0.02, -0.01, 0.015], [0.008, -0.03, 0.004], [-0.02, 0.01, 0.01]])
TRUE_O = np.array([0.5, -0.4, 0.8])


def log_of(poses: list[np.ndarray], path: Path) -> Path:
    """A log at 50 Hz: five seconds in each pose, half a second of shaking between."""
    generator = stream(2, "log")
    parts = []
    for up in poses:
        read = TRUE_S @ (G_M_S2 * up) + TRUE_O
        parts += [np.tile(read, (250, 1)), read + generator.normal(0, 4, (25, 3))]
    force = np.concatenate(parts)
    force = force + generator.normal(0, 0.02, force.shape)
    rows = np.column_stack([np.arange(len(force)) / 50, force])
    lines = [",".join(f"{value:.5f}" for value in row) for row in rows]
    head = "time (s),acc_x (m/s^2),acc_y (m/s^2),acc_z (m/s^2)"
    path.write_text("\n".join([head, *lines]) + "\n")
    return path


@pytest.fixture(scope="module")
def log(tmp_path_factory) -> Path:
    return log_of(list(POSITIONS.values()), tmp_path_factory.mktemp("log") / "poses.csv")


def invoke(*words: str):
    register()
    return CliRunner().invoke(app, ["calibrate", *map(str, words)])


def test_a_drawn_device_is_recovered():
    found = simcompare.calibrate(simulate="mpu6050", seed=3)
    true = np.r_[np.ravel(found.truth.sensitivity), found.truth.offset]
    off = np.r_[np.ravel(found.sensitivity), found.offset] - true
    u = np.r_[np.ravel(found.u_sensitivity), found.u_offset]
    assert np.all(np.abs(off) < 3 * u)
    # drawn by its own streams: the same seed is the same device
    assert simcompare.calibrate(simulate="mpu6050", seed=3).truth == found.truth


def test_a_log_with_still_poses_is_calibrated(log):
    found = simcompare.calibrate(log, gravity=G_M_S2, gravity_u="0.001", level="0.1deg")
    assert found.kind == "six-position"
    # 0.02 m/s² over 4 s at 50 Hz: 1.4 mm/s²; S to 1e-4 of g besides; cross terms by levelling
    assert np.array(found.offset) == pytest.approx(TRUE_O, abs=0.005)
    assert np.array(found.sensitivity) == pytest.approx(TRUE_S, abs=0.001)
    reading = TRUE_S @ [1.0, 2.0, 9.0] + TRUE_O
    assert found.apply(reading) == pytest.approx([1.0, 2.0, 9.0], abs=0.02)
    assert found.u(reading).shape == (3,)


def test_a_stored_calibration_corrects_a_log(log, tmp_path):
    first = simcompare.calibrate(log, out=tmp_path)
    again = simcompare.calibrate(first.folder / "calibration.json", out=tmp_path, apply=log)
    with pytest.raises(InputError, match="a stored calibration: gravity is in it already"):
        simcompare.calibrate(first.folder / "calibration.json", gravity=9.81)
    assert again.sensitivity == first.sensitivity
    assert again.calibration.u_offset == pytest.approx(first.calibration.u_offset)
    corrected = recording_store.load(again.applied)
    channels = next(iter(corrected.streams.values())).channels
    sizes = np.linalg.norm([channels[f"acc_{axis}_m_s2"].values[100:200] for axis in "xyz"], axis=0)
    assert sizes.mean() == pytest.approx(9.806, abs=0.005)  # of the assumed g
    assert any(one.rule == "calibrated" for one in corrected.provenance.repairs)


def test_the_command_prints_answer_table_and_limits(tmp_path):
    printed = invoke(EXAMPLE, "--gravity", "9.8128", "--gravity-u", "0.0002", "--out", tmp_path)
    assert printed.exit_code == 0, printed.output
    wanted = (
        "As it is, the sensor is off by up to", "Offset x", "S, x", "12 of 12",
        "cannot tell apart", "rotation of the sensor in its box", "report.html",
    )  # fmt: skip
    assert [text for text in wanted if text not in printed.output] == []
    page = next(tmp_path.rglob("report.html")).read_text(encoding="utf-8")
    assert "What poses are off by" in page
    assert "http://" not in page.split("<script", 1)[0]


def test_the_json_is_one_object(tmp_path):
    printed = invoke("--simulate", "adxl345", "--json", "--no-report", "--out", tmp_path)
    told = json.loads(printed.stdout)
    assert {"kind", "sensitivity", "u_sensitivity", "offset", "u_offset", "covariance", "truth",
            "degrees_of_freedom", "chi2", "expected_chi2", "poses", "not_separable",
            "assumptions", "folder"} <= told.keys()  # fmt: skip
    assert json.loads(next(tmp_path.rglob("calibration.json")).read_text()) == told


def test_edges_alone_are_calibrated_by_their_size(tmp_path):
    found = simcompare.calibrate(EXAMPLE, kind="ellipsoid")
    assert found.kind == "ellipsoid"
    assert np.allclose(found.sensitivity, np.transpose(found.sensitivity))


def test_a_rate_table_and_two_pressures_are_read_from_tables(tmp_path):
    rates = ["pose,gx (deg/s),gy,gz", "rest,1,-2,0.5"]
    rates += [
        f"{sign}{axis} 90," + ",".join(
            str((1.01 * 90 * (1 if sign == "+" else -1) if a == axis else 0) + o)
            for a, o in zip("xyz", (1, -2, 0.5), strict=True)
        )
        for axis in "xyz" for sign in "+-"
    ]  # fmt: skip
    table = tmp_path / "rates.csv"
    table.write_text("\n".join(rates))
    found = simcompare.calibrate(table)
    assert found.kind == "rate-table"
    # the alignment's square lowers the known rates by 25 ppm
    assert np.diag(found.sensitivity) == pytest.approx(1.01, abs=5e-5)
    assert np.degrees(found.offset) == pytest.approx([1, -2, 0.5], abs=1e-9)
    stated = simcompare.calibrate(table, level="0.1deg").assumptions[1]
    assert (stated.quantity, stated.source) == ("alignment", "as stated, rectangular")

    table = tmp_path / "pressures.csv"
    table.write_text(
        "known (hPa),u (hPa),reading (hPa),noise\n950,0.1,951.5,0.05\n1010,0.1,1011.5,0.05\n"
    )
    found = simcompare.calibrate(table)
    assert found.kind == "two-point"
    assert found.sensitivity[0][0] == pytest.approx(1.0, abs=1e-9)
    assert found.offset[0] == pytest.approx(150, abs=1e-6)


def test_one_direction_tells_one_number(tmp_path):
    up = POSITIONS["+z"]
    flat = log_of([up, up, up], tmp_path / "flat.csv")
    told = r"(?s)-z missing.*9 or more.*all 3 still poses lie one way"
    with pytest.raises(InputError, match=told):
        simcompare.calibrate(flat)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({}, "give a table, log or recording"),
        ({"simulate": "bmp280"}, "has no accelerometer"),
        ({"source": str(EXAMPLE), "kind": "two-point"}, "table of accelerometer"),
        ({"source": str(EXAMPLE), "gravity": 1.62}, "no g on Earth"),
        ({"source": str(EXAMPLE), "level": "30deg"}, "expected up to 10 deg"),
        ({"source": str(EXAMPLE), "noise": "-1"}, "expected a number above 0"),
        ({"source": str(EXAMPLE), "noise": 1e300}, "is more than every reading; expected at most"),
        ({"simulate": "mpu6050", "noise": 0.01}, "noise of its data sheet; it is for a table"),
        ({"source": "imu_xio", "noise": 0.01}, "noise by the scatter within its poses"),
        ({"source": str(EXAMPLE), "apply": "x"}, "apply needs out"),
    ],
)
def test_bad_arguments_are_told(arguments, told):
    with pytest.raises(InputError, match=told):
        simcompare.calibrate(**arguments)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("pose,ax,ay,az\n+x,1,0,0\n-x,-1,0,0\n", "write the unit in the head"),
        ("pose,ax (g),ay,az\n+x,1,zero,0\n", r"line 2, column ay: 'zero' is no number"),
        ("pose,speed\n+x,1\n", "expected pose,ax,ay,az"),
        ("pose,ax (g),ax,az,u\n+x,1,0,0,1\n", "line 1: ax stands there twice"),
        (
            "pose,ax (g),ay,az\n+x,1,0,0\n-x,1,0,0\n+y,0,1,0\n-y,0,-1,0\n+z,0,0,1\n-z,0,0,-1\n",
            r"axis x has a sensitivity of .*: the readings of \+x and −x are equal or nearly so",
        ),
        (
            "known (hPa),u (hPa),reading (hPa),noise\n900,1,980,1\n1000,1,980,1\n",
            "its readings are equal or nearly so at all known values",
        ),
        ("pose,gx (deg/s),gy,gz\nfast,1,2,3\n", r"line 2: 'fast' is no pose"),
        ("pose,ax (g),ay,az\n", "has no rows"),
        ("pose,ax (kg),ay,az\n+x,1,0,0\n", "line 1: 'kg' is no unit that fits; .* such as 1 mg"),
        ("pose,ax (g),ay,az\n+x,nan,0,0\n", "'nan' is no number"),
        ("pose,ax (g),ay,az,u\n+x,1,0,0,-1\n", "line 2, column u: -1 is no uncertainty"),
    ],
)
def test_bad_tables_are_told(text, told, tmp_path):
    table = tmp_path / "table.csv"
    table.write_text(text)
    with pytest.raises(InputError, match=told):
        simcompare.calibrate(table)


def test_noise_that_few_readings_tell_widens_the_intervals(tmp_path):
    scatter = stream(3, "few").normal(0, 0.004, (6, 3))
    table = tmp_path / "few.csv"
    rows = [
        ",".join([name, *map(str, G_M_S2 * up + off)])
        for (name, up), off in zip(POSITIONS.items(), scatter, strict=True)
    ]
    table.write_text("\n".join(["pose,ax,ay,az", *rows]), encoding="utf-8")
    found = simcompare.calibrate(table)
    # Student's t of at most six degrees of freedom
    factor = words.pose_coverage(found)
    assert factor > 2.44
    assert "more where noise was told with few degrees of freedom" in words.notes(found)[-1]
    bars, left = figures.of(found).panels[1].series[0].u, [pose.u_after for pose in found.poses]
    assert bars == pytest.approx(factor * np.array(left))


def test_a_rectangular_source_that_does_all_needs_a_smaller_factor(tmp_path):
    table = tmp_path / "poses.csv"
    rows = [",".join([name, *map(str, 9.806 * up)]) for name, up in POSITIONS.items()]
    table.write_text("\n".join(["pose,ax,ay,az", *rows]), encoding="utf-8")
    found = simcompare.calibrate(table, noise=0.002, level="0.1deg")
    told = coverage.factors(found)
    # g, anywhere at sea level, against a noise of a tenth of its u: near 0.95·√3 = 1.645
    assert told["scale"] == pytest.approx(1.66, abs=0.02)
    assert told["cross-axis"] == told["offset"] == pytest.approx(1.96, abs=1e-3)
    generator, inside = stream(5, "draws"), 0
    for _ in range(2000):
        off = generator.normal(0, 0.002 / 2**0.5 / 9.806)
        scale = generator.uniform(9.780, 9.832) / 9.806 - 1
        inside += abs(off + scale) <= told["scale"] * found.u_sensitivity[0][0]
    # 2,000 draws: four times their 0.5 %
    assert inside / 2000 == pytest.approx(0.95, abs=0.02)


def test_a_table_with_semicolons_and_decimal_commas_is_the_same(tmp_path):
    table = tmp_path / "poses.csv"
    text = EXAMPLE.read_text(encoding="utf-8").replace(",", ";").replace(".", ",")
    table.write_text(text, encoding="utf-8")
    assert simcompare.calibrate(table).offset == simcompare.calibrate(EXAMPLE).offset


def test_a_pose_that_is_upside_down_is_told(tmp_path):
    table = tmp_path / "poses.csv"
    text = EXAMPLE.read_text(encoding="utf-8").replace("+y,", "?,").replace("-y,", "+y,")
    table.write_text(text.replace("?,", "-y,"), encoding="utf-8")
    with pytest.raises(InputError, match=r"axis y has a sensitivity of -1; expected about 1"):
        simcompare.calibrate(table)


def test_an_unknown_kind_or_sheet_is_told():
    with pytest.raises(UnknownName, match="six-position"):
        simcompare.calibrate(EXAMPLE, kind="five-position")
    with pytest.raises(UnknownName, match="mpu6050"):
        simcompare.calibrate(simulate="mpu605")
