"""The audit of foreign simulators: clean streams pass, known faults are found by name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from simcompare import cli
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors import data_sheet, error_model
from simcompare.model.trajectory import Array
from simcompare.reports.allan import tables, words
from simcompare.statistics import noise_audit
from simcompare.verbs import allan_audit
from simcompare.verbs.allan import allan
from simcompare.verbs.allan_shown import Allan
from simcompare.verbs.allan_stretch import Stretch
from tests import noise_records

RATE_HZ, COUNT = 100.0, 2000
#: rad/s of one reading with the density of mpu6050 at 100 Hz
SIZE = 0.005 * np.pi / 180 * np.sqrt(RATE_HZ / 2)
COUNTS = np.pi / 180 / 131


def gyroscope(seed: int, count: int = COUNT) -> Array:
    """A stream as a good simulator of mpu6050 makes it."""
    draw = np.random.default_rng(seed)
    rates = draw.normal(size=(count, 3)) * SIZE + draw.normal(size=3) * 0.3
    return np.asarray(np.round(rates / COUNTS) * COUNTS)


def audited(values: Array, **more: object) -> Allan:
    """An audit of a gyroscope."""
    return allan(values, rate_Hz=RATE_HZ, unit="rad/s", audit=True, **more)  # type: ignore[arg-type]


def faults(found: Allan) -> set[str]:
    return {one.test for one in found.findings if one.fault}


def test_a_good_stream_is_called_good_and_by_its_name() -> None:
    found = audited(gyroscope(1), sheet="mpu6050")
    assert not faults(found)
    said = words.audit(found)
    assert said[0].startswith("The noise of the gyroscope is that of mpu6050")
    assert said[1].startswith("No fault is found (")
    # no other gyroscope is within 20 %
    assert [one.sheet for one in found.matches if one.fits] == ["mpu6050"]


def test_the_whole_stream_is_audited() -> None:
    """A bias that wanders far looks like motion, and still belongs to the noise."""
    draw = np.random.default_rng(18)
    values = draw.normal(size=COUNT) + 3 * noise_records.gauss_markov(draw, COUNT, RATE_HZ, 1.0)
    found = audited(values)
    assert (found.chosen, found.axes[0].samples) == ("whole", COUNT)
    assert words.stretch(found) == "Taken: the whole record, 20 s at 100 Hz."


def test_noise_of_no_sheet_is_called_so() -> None:
    said, *_ = words.audit(audited(10 * gyroscope(2)))
    assert said.startswith("The noise of the gyroscope is that of no data sheet here (")


def test_clean_streams_are_called_clean() -> None:
    """Two in a hundred may fail; 60 have more than 6 failures once in 2000 times at most."""
    part, sheet = data_sheet.load("mpu6050").part("gyroscope"), data_sheet.load("mpu6050")
    failures, time_s = 0, np.arange(2000) / RATE_HZ
    for seed in range(60):
        device, draw = part.drawn(seed, "imu", rate_Hz=RATE_HZ), np.random.default_rng(seed)
        values = error_model.measured(device, time_s, np.zeros((2000, 3)), draw).measured
        columns = {name: values[:, i] for i, name in enumerate("xyz")}
        stream = Stretch(columns, dict.fromkeys("xyz", "rad/s"), RATE_HZ, 0.0, 20.0, "all")
        failures += any(one.fault for one in allan_audit.findings(stream, (), sheet, {}, None))
    assert failures <= 6


def uniform() -> Array:
    draw = np.random.default_rng(3)
    return np.asarray(SIZE * np.sqrt(3) * draw.uniform(-1, 1, (COUNT, 3)) + 0.3)


def one_for_all() -> Array:
    return np.asarray(np.repeat(gyroscope(4)[:, :1], 3, axis=1) + np.array([0.0, 0.1, 0.2]))


def table_of_numbers() -> Array:
    return np.asarray(np.tile(gyroscope(5, COUNT // 4), (4, 1)))


def held_readings() -> Array:
    return np.asarray(np.repeat(gyroscope(6, COUNT // 4), 4, axis=0))


@pytest.mark.parametrize(
    ("made", "test", "text"),
    [
        (uniform, "normal numbers", "numbers are uniform, not normal"),
        (one_for_all, "independent axes", "their noise is the same"),
        (table_of_numbers, "no repetition", "the same numbers come again after 500 readings"),
        (held_readings, "fresh readings", "readings repeat the one before"),
    ],
)
def test_faults_of_the_numbers(made: Callable[[], Array], test: str, text: str) -> None:
    found = audited(made())
    assert test in faults(found)
    (said,) = [one for one in words.audit(found) if "aults: " in one or one.startswith("Fault: ")]
    # once for all channels
    assert said.count(text.partition(" after ")[0]) == 1


def test_what_a_sheet_has_and_the_stream_has_not() -> None:
    draw = np.random.default_rng(7)
    found = audited(draw.normal(size=(COUNT, 3)) * SIZE, sheet="mpu6050")
    assert faults(found) == {"quantisation", "offset"}
    shaken = gyroscope(7)
    shaken[::100] += round(9.0 / COUNTS) * COUNTS
    assert "saturation" in faults(audited(shaken, sheet="mpu6050"))


def accelerometer(weight: float, **more: object) -> Allan:
    """An audit of an accelerometer without any offset that reads so much upright."""
    values = np.random.default_rng(8).normal(size=(COUNT, 3)) * 0.02 + np.array([0, 0, weight])
    return allan(values, rate_Hz=RATE_HZ, unit="m/s**2", audit=True, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("weight", "text"),
    [(9.80665, ""), (0.0, "gravity is missing"), (1.0, "readings are in g, not in m/s²")],
)
def test_gravity(weight: float, text: str) -> None:
    found = accelerometer(weight)
    assert faults(found) == ({"gravity"} if text else set())
    assert text in words.audit(found)[1]


def test_an_accelerometer_that_has_no_offset() -> None:
    assert faults(accelerometer(9.80665, sheet="mpu6050")) == {"offset", "quantisation"}


def test_degrees_in_place_of_radians() -> None:
    found = audited(gyroscope(16) * 180 / np.pi, sheet="mpu6050")
    assert faults(found) >= {"quantisation"}
    said = words.audit(found)
    assert "times that of mpu6050, as readings in °/s have)" in said[0]
    assert "readings have other counts than mpu6050" in said[1]


def test_a_seed_that_is_fixed() -> None:
    assert "other numbers each run" in faults(audited(gyroscope(9), again=gyroscope(9)))
    assert not faults(audited(gyroscope(9), again=gyroscope(10)))


def test_noise_that_does_not_know_the_rate() -> None:
    draw = np.random.default_rng(10)
    slow, fast = (SIZE * draw.normal(size=(COUNT, 2)) for _ in range(2))
    found = audited(slow, again=fast, again_rate_Hz=400.0)
    assert faults(found) == {"noise knows the rate"}
    assert "the same standard deviation is added to each reading" in words.audit(found)[1]
    right = audited(slow, again=2 * fast, again_rate_Hz=400.0)
    assert not faults(right)


def bias_of(time_s: float) -> Array:
    draw = np.random.default_rng(12)
    bias = noise_records.gauss_markov(draw, 10_000, RATE_HZ, time_s)
    return np.asarray(0.3 * draw.normal(size=10_000) + bias)


@pytest.mark.parametrize(("time_s", "expected"), [(1.0, set()), (0.2, {"claimed bias time"})])
def test_the_time_of_a_bias_process(time_s: float, expected: set[str]) -> None:
    claims = {"bias": 1.0, "bias_time": 1.0}
    found = audited(bias_of(time_s), claims=claims)
    assert faults(found) == expected


def test_a_wandering_bias_is_no_fault_of_the_numbers() -> None:
    """It moves by as much as the noise from one reading to the next, and in blocks of readings."""
    draw = np.random.default_rng(17)
    values = draw.normal(size=10_000) + np.cumsum(draw.normal(size=10_000))
    told = noise_audit.normal(values)
    assert told is not None
    assert told.p > 1e-3


def test_a_bias_process_that_is_never_added() -> None:
    claims = {"density": 0.3 * (2 / RATE_HZ) ** 0.5, "bias": 1.0, "bias_time": 1.0}
    white = 0.3 * np.random.default_rng(13).normal(size=10_000)
    assert faults(audited(white, claims=claims)) == {"claimed bias"}
    louder = audited(2 * white, claims={"density": claims["density"]})
    assert faults(louder) == {"claimed density"}


def test_a_correction_for_many_tests() -> None:
    assert noise_audit.holm([0.004, 0.5, 0.009, 0.2], 0.02) == [True, False, False, False]
    assert noise_audit.holm([0.004, 0.5, 0.006, 0.2], 0.02) == [True, False, True, False]


def test_the_size_of_a_count() -> None:
    draw = np.random.default_rng(14).normal(size=1000)
    assert noise_audit.smallest_step(np.round(draw / 0.1) * 0.1) == pytest.approx(0.1)
    assert noise_audit.smallest_step(draw) == 0
    # the same counts by way of another sum
    jitter = np.where(draw > 0, 0.1, 0.3) - np.where(draw > 0, 0.1, 0.3) * (1 + 1e-15)
    assert noise_audit.smallest_step(np.round(draw / 0.1) * 0.1 + jitter) == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("more", "error", "fault"),
    [
        ({"claims": {"drift": 1.0}}, UnknownName, "drift"),
        ({"claims": {"bias": 1.0}}, InputError, "give both"),
        ({"claims": {"density": -1.0}}, InputError, "density=-1: expected a number above 0"),
        ({"claims": {"density": 1.0}, "audit": False}, InputError, "are for an audit"),
    ],
)
def test_what_an_audit_refuses(more: dict[str, object], error: type, fault: str) -> None:
    with pytest.raises(error, match=fault):
        allan(gyroscope(1)[:200], rate_Hz=RATE_HZ, **{"audit": True, **more})  # type: ignore[arg-type]


def test_the_command_line_audits_a_log(tmp_path: Path) -> None:
    path, values = tmp_path / "stream.csv", uniform()[:1500]
    time_s = np.arange(len(values)) / RATE_HZ
    rows = [",".join(f"{one:.9f}" for one in row) for row in np.column_stack((time_s, values))]
    path.write_text("\n".join(["time_s,wx_rad_s,wy_rad_s,wz_rad_s", *rows]), encoding="utf-8")
    cli.register()
    result = CliRunner().invoke(
        cli.app, ["allan", str(path), "--audit", "--sheet", "mpu6050", "-v"]
    )
    assert result.exit_code == 0, result.output
    assert "numbers are uniform, not normal" in " ".join(result.output.split())
    assert "lsm6dso" in result.output  # among all sheets with a gyroscope
    refused = CliRunner().invoke(cli.app, ["allan", str(path), "--audit", "--claim", "density"])
    assert refused.exit_code == 2


def test_the_table_of_an_audit_has_every_test() -> None:
    found = audited(gyroscope(15))
    made = tables.of_findings(found)
    assert made is not None
    assert len(made.groups[0].rows) == len(found.findings) == 12
    assert len(found.audit()) == 12
