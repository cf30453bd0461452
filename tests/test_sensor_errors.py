"""Errors of sensors in scenario files: what can be said, what cannot, and what is drawn."""

import math

import numpy as np
import pytest
import yaml

from simcompare.errors import InputError
from simcompare.hardware.sensors import sheets
from simcompare.hardware.sensors.drawn import drawn
from simcompare.model.sensor_errors import SensorErrors, keys_of
from simcompare.scenarios import scenario_file

IMU = {"imu.specific_force_m_s2": 3, "imu.rate_rad_s": 3}
#: an accelerometer that weighs the world, and a wheel with a motor and marks
SCENE = """
name: bench
title: Bench
question: What do sensors read?
parameters:
  noise: {value: 0.004, min: 0, max: 1, text: "Noise of the accelerometer."}
world: {duration_s: 1.0, step_s: 0.002}
bodies:
  post: {fixed: true}
  wheel: {mass_kg: 1, inertia_kg_m2: [1, 1, 1]}
joints:
  axle: {type: hinge, parent: post, child: wheel}
inputs:
  drive: {signal: constant, value: 0.1}
actuators:
  motor: {type: torque, joint: axle, input: drive}
sensors:
  imu: {type: imu, body: wheel}
  code: {type: encoder, joint: axle, marks: 20}
  height: {type: barometer, body: wheel}
"""


def read(tmp_path, **errors):
    """The scene with errors under its parts."""
    tree = yaml.safe_load(SCENE)
    for owner, said in errors.items():
        kind = next(k for k in ("joints", "actuators", "sensors") if owner in tree[k])
        tree[kind][owner]["errors"] = said
    path = tmp_path / "bench.yaml"
    path.write_text(yaml.safe_dump(tree, sort_keys=False), encoding="utf-8")
    return scenario_file.read(path)


def faults(tmp_path, **errors):
    with pytest.raises(InputError) as error:
        read(tmp_path, **errors)
    return "\n".join(error.value.faults)


def one(errors, signals=None, seed=0):
    return drawn(SensorErrors.model_validate(errors), signals or IMU, seed)


# --- what can be said -----------------------------------------------------------------------------


def test_a_data_sheet_is_two_words(tmp_path):
    scene = read(tmp_path, imu={"sheet": "mpu6050"}).resolve()
    said = scene.sensor_errors()
    assert list(said) == ["imu"]
    devices = drawn(said["imu"], IMU, 0)
    assert [(one.part, one.device.rate_Hz) for one in devices] == [
        ("accelerometer", 1000.0), ("gyroscope", 1000.0)
    ]  # fmt: skip


def test_sensors_joints_and_actuators_take_own_terms(tmp_path):
    scene = read(
        tmp_path,
        imu={"rate_Hz": 100, "noise_m_s2_per_rtHz": "${noise}", "offset_rad_s": [0.1, 0.2, 0.3]},
        code={"resolution": 1, "sensitivity": {"typ": 0.01}},
        height={"offset_Pa": {"max": 100}},
        axle={"noise_rad_per_rtHz": 0.001, "latency_s": 0.01},
        motor={"resolution_N_m": 0.01, "full_scale_N_m": 0.08},
    ).resolve()
    assert list(scene.sensor_errors()) == ["axle", "motor", "imu", "code", "height"]
    force, rate = drawn(scene.sensor_errors()["imu"], IMU, 0)
    assert force.device.noise_density.tolist() == [0.004] * 3
    assert rate.device.offset.tolist() == [0.1, 0.2, 0.3]
    assert force.device.rate_Hz == rate.device.rate_Hz == 100.0


def test_terms_of_one_unit_are_of_the_signal_in_that_unit():
    (angle,) = one({"noise_rad_per_rtHz": 0.1}, {"axle.angle_rad": 1, "axle.rate_rad_s": 1})
    assert angle.signal == "axle.angle_rad"


@pytest.mark.parametrize(
    ("said", "kind", "u"),
    [
        (0.2, "fixed", 0.0),
        ({"typ": 0.2}, "normal", 0.2),
        ({"max": 0.3}, "rectangular", 0.3 / math.sqrt(3)),
        ({"min": 0.1, "max": 0.5}, "rectangular", 0.2 / math.sqrt(3)),
        # standard deviation of N(0, 1) cut at ±1
        ({"typ": 0.2, "max": 0.2}, "truncated_normal", 0.2 * math.sqrt(0.2911250947)),
    ],
)
def test_what_is_known_of_a_term_is_drawn(said, kind, u):
    offsets = [
        one({"offset_m_s2": said}, {"a.specific_force_m_s2": 3}, seed)[0] for seed in range(700)
    ]
    row = offsets[0].terms[0]
    assert (row.term, row.axis, row.kind) == ("offset", "x", kind)
    assert row.u == pytest.approx(u)
    values = np.concatenate([each.device.offset for each in offsets])
    assert row.value == values[0]
    # 2100 draws: five times the 1.5 % of their standard deviation
    assert values.std() == pytest.approx(u, rel=0.08, abs=1e-12)


def test_own_terms_take_the_place_of_those_of_the_sheet():
    plain = one({"sheet": "mpu6050"})[0]
    own = one({"sheet": "mpu6050", "offset_m_s2": 0.0})[0]
    assert own.device.offset.tolist() == [0.0, 0.0, 0.0]
    assert np.array_equal(own.device.sensitivity, plain.device.sensitivity)
    assert [row.source for row in own.terms if row.term == "offset"] == ["the scenario"] * 3


def test_a_chip_is_turned_in_its_box_as_a_whole():
    force, rate = one({"misalignment_rad": {"typ": 0.02}})
    assert force.device.mounting_wxyz == rate.device.mounting_wxyz
    assert force.device.mounting_wxyz[0] < 1.0


def test_every_term_that_can_be_said_has_a_title_and_a_unit():
    known = keys_of("rate_rad_s")
    (device,) = one({**dict.fromkeys(known, 0.5), "misalignment_rad": 0.1}, {"imu.rate_rad_s": 3})
    told = {row.term: (row.title, row.unit) for row in device.terms}
    assert {*told} == {*known.values(), "misalignment"}
    assert told["resolution"] == ("resolution", "rad/s")
    assert told["noise_density"] == ("noise", "rad/s/√Hz")
    assert told["sensitivity_per_K"] == ("sensitivity with temperature", "1/K")


def test_cross_axis_terms_stand_beside_the_diagonal():
    (force,) = one({"cross_axis": [0.01, 0.02, 0.03], "offset_m_s2": 0})
    assert force.device.sensitivity.tolist() == [
        [1.0, 0.01, 0.01], [0.02, 1.0, 0.02], [0.03, 0.03, 1.0]
    ]  # fmt: skip


def test_a_signal_that_the_sheet_does_not_measure_takes_own_terms_and_settings(tmp_path):
    path = tmp_path / "force.yaml"
    sheet = yaml.safe_load(sheets.files()["mpu6050"].read_text(encoding="utf-8"))
    del sheet["parts"]["gyroscope"]
    path.write_text(yaml.safe_dump(sheet), encoding="utf-8")
    force, rate = one({"sheet": str(path), "rate_Hz": 200, "noise_rad_s_per_rtHz": 0.1})
    assert (force.part, rate.part) == ("accelerometer", "")
    assert rate.device.rate_Hz == force.device.rate_Hz == 200.0
    assert rate.device.noise_density.tolist() == [0.1] * 3


def test_a_setting_is_taken_by_the_part_that_has_it():
    force, rate = one({"sheet": "mpu6050", "range": "8 g", "bandwidth_Hz": 188})
    assert force.device.full_scale == pytest.approx(8 * 9.80665)
    assert rate.device.bandwidth_Hz == 188.0
    assert force.device.bandwidth_Hz == 44.0


# --- the same device every time -------------------------------------------------------------------


def test_a_seed_is_a_device_and_a_name_another():
    names = {"front.specific_force_m_s2": 3}, {"rear.specific_force_m_s2": 3}
    front, again, other_seed, rear = (
        one({"sheet": "mpu6050"}, signals, seed)[0].device.offset
        for signals, seed in ((names[0], 0), (names[0], 0), (names[0], 1), (names[1], 0))
    )
    assert np.array_equal(front, again)
    assert not np.allclose(front, other_seed)
    assert not np.allclose(front, rear)


# --- what cannot be -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("said", "place", "sentence"),
    [
        ({"noise_m_s2_per_rtHz": -1}, "noise_m_s2_per_rtHz", "is -1; expected 0 or more"),
        ({"rate_Hz": 100, "bandwidth_Hz": 60}, "bandwidth_Hz", "above Nyquist's 50 Hz"),
        ({"temperature_C": -400}, "temperature_C", "expected a number of at least -100"),
        ({"temperature_C": 1e9}, "temperature_C", "expected a number of at most 250"),
        ({"latency_s": 100}, "latency_s", "expected a number of at most 10"),
        ({"rate_Hz": 100, "jitter_s": 10}, "jitter_s", "expected at most 0.005 s, half of the tim"),
        ({"jitter_s": 0.0011}, "jitter_s", "expected at most 0.001 s"),
        ({"offset_m_s2": 1e300}, "offset_m_s2", "is 1e+300; expected a size of at most 1e+12"),
        ({"sensitivity": {"max": 1e300}}, "sensitivity", "expected a size of at most 1e+12"),
        ({"misalignment_rad": 1e300}, "misalignment_rad", "expected a size of at most 1e+12"),
        ({"rate_error": -1}, "rate_error", "is 1; expected a size of at most 0.5"),
        ("mpu6050", "", "expected terms, such as {sheet: mpu6050} or {offset_m_s2: 0.2}"),
        ([1, 2], "", "expected terms, such as {sheet: mpu6050} or {offset_m_s2: 0.2}"),
        ({"sheet": None}, "", "says nothing; give a sheet"),
        ({"offset_m_s2": True}, "offset_m_s2", "expected a number, or {typ: s}"),
        ({"full_scale_m_s2": 0}, "full_scale_m_s2", "is 0; expected more"),
        ({"bandwidth_Hz": 0.01, "poles": 4}, "bandwidth_Hz", "expected at least 0.05 Hz"),
        ({"resolution_m_s2": 1e-320}, "resolution_m_s2", "expected 0, or at least 1e-15"),
        ({"bandwidth_Hz": 300}, "bandwidth_Hz", "half of the simulation's rate 500 Hz"),
        ({"ofset_m_s2": 1}, "ofset_m_s2", "did you mean offset_m_s2 or"),
        ({"offset_m": 1}, "offset_m", "no term of these errors is called"),
        ({"offset_m_s2": {"min": 1}}, "offset_m_s2", "or {typ: s}, {max: a}"),
        ({"offset_m_s2": {"typ": 2, "max": 1}}, "offset_m_s2", "below the typical 2"),
        ({"offset_m_s2": {"min": 2, "max": 1}}, "offset_m_s2", "max 1 is not above 2"),
        ({"offset_m_s2": "50 mg"}, "offset_m_s2", "expected a number, or {typ: s}"),
        ({"offset_m_s2": [1, 2]}, "offset_m_s2", "or a list of three of these"),
        ({"offset_m_s2": {"typ": -1}}, "offset_m_s2", "typ: input should be greater than 0"),
        ({"offset_m_s2": {"mean": 1}}, "offset_m_s2", "mean: extra inputs are not permitted"),
        ({"misalignment_rad": "1 deg"}, "misalignment_rad", "expected a number, or {typ: s}"),
        ({"resolution_m_s2": {"typ": 1}}, "resolution_m_s2", "every device has it alike"),
        ({"full_scale_m_s2": [1, 2, 3]}, "full_scale_m_s2", "one number for all axes"),
        ({"nonlinearity": 0.01}, "nonlinearity", "give full_scale_m_s2 and full_scale_rad_s too"),
        ({"mounting_wxyz": [1, 1, 0, 0]}, "mounting_wxyz", "a rotation has length 1"),
        ({"range": "2 g"}, "range", "give a sheet"),
        ({}, "errors", "says nothing; give a sheet"),
        ({"rate_Hz": 0}, "rate_Hz", "greater than 0"),
        ({"sheet": "mpu6051"}, "sheet", "did you mean mpu6050?"),
        ({"sheet": "mpu6050", "range": "3 g"}, "sheet", "range of MPU-6050"),
        ({"sheet": "mpu6050", "rate_Hz": 9000}, "sheet", "9000 Hz"),
    ],
)
def test_faults_are_told_with_their_place(tmp_path, said, place, sentence):
    told = faults(tmp_path, imu=said)
    assert "sensors.imu.errors" in told
    assert place in told
    assert sentence in told
    assert "line" in told


def test_a_sheet_must_measure_what_the_sensor_reads(tmp_path):
    told = faults(tmp_path, height={"sheet": "mpu6050"})
    assert "specific force (m/s², 3 axes), angular rate (rad/s, 3 axes)" in told
    assert "height.pressure_Pa" in told


def test_all_faults_come_at_once(tmp_path):
    told = faults(
        tmp_path,
        imu={"noise_m_s2_per_rtHz": -1, "ofset_m_s2": 1},
        code={"sheet": "nothing"},
        motor={"resolution_N_m": -1},
    )
    assert len(told.splitlines()) >= 4


def test_a_single_axis_takes_no_list_and_no_cross_axis_term(tmp_path):
    told = faults(tmp_path, height={"offset_Pa": [1, 2, 3], "cross_axis": 0.01})
    assert "one number for all axes" in told
    assert "there is only one axis" in told
