"""Units that contradict physics are refused with the unit that fits, or replaced if so asked."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.conditioning.units import derivative, meaning, plausible_units
from simcompare.hardware.mapping import NOTHING
from simcompare.hardware.raw import RawColumn, RawLog, RawStream
from simcompare.model.recording import REPAIR, WARNING, Provenance
from tests.conditioned import work_of

DATA = os.environ.get("SIMCOMPARE_DATA")
needs_data = pytest.mark.skipif(not DATA, reason="SIMCOMPARE_DATA names no folder of recordings")
TIME = np.arange(0, 20, 0.01)
G = 9.80665


def resting(size, seed=0):
    """An accelerometer that lies, is turned twice, and shows ``size`` at rest."""
    random = np.random.default_rng(seed)
    tilt = np.interp(TIME, [0, 6, 7, 12, 13, 20], [0.1, 0.1, 1.2, 1.2, -0.4, -0.4])
    force = np.column_stack([np.sin(tilt), np.zeros_like(tilt), np.cos(tilt)])
    shaken = random.normal(0, 0.2, (len(TIME), 3)) * (np.gradient(tilt) != 0)[:, None]
    return size * (force + shaken + random.normal(0, 0.002, (len(TIME), 3)))


def triad(values, unit, name="acc_{}"):
    return {name.format(axis): (values[:, i], unit) for i, axis in enumerate("xyz")}


def checked(*args, **kwargs):
    work = work_of(*args, **kwargs)
    plausible_units.check(work)
    return work


@pytest.mark.parametrize("size", [9.7, 9.8227, 8.6, 10.9])
def test_gravity_within_the_errors_of_cheap_sensors_is_fine(size):
    work = checked(TIME, triad(resting(size), "m/s^2"))
    assert work.faults == []
    assert work.repairs == []


@pytest.mark.parametrize(
    ("size", "declared", "line"),
    [
        (1.0, "m/s^2", "unit: g_0}"),
        (0.9935, "m/s^2", "unit: g_0}"),
        (1000.0, "m/s^2", "unit: mg_0}"),
        (16384.0, "m/s^2", "unit: g_0, scale: 6.10352e-05}"),
        (8192.0, "g", "unit: g_0, scale: 0.00012207}"),
        (4096.0, "m/s^2", "unit: g_0, scale: 0.000244141}"),
        (2048.0, "m/s^2", "unit: g_0, scale: 0.000488281}"),
        (G, "g", "unit: m/s^2}"),
        (1000.0, "g", "unit: mg_0}"),
        (1.0, "mg", "unit: g_0}"),
    ],
)
def test_a_wrong_unit_of_an_accelerometer_is_refused_with_the_right_one(size, declared, line):
    work = checked(TIME, triad(resting(size), declared))
    (fault,) = work.faults
    assert "'acc_x', 'acc_y', 'acc_z'" in fault
    assert f"acc_x: {{column: acc_x, {line}" in fault
    assert "--assume-units" in fault


@pytest.mark.parametrize(
    ("size", "declared"),
    [(1.0, "m/s^2"), (1000.0, "m/s^2"), (16384.0, "m/s^2"), (G, "g"), (16384.0, ""), (2048.0, "")],
)
def test_assume_units_takes_the_unit_that_fits_and_records_it(size, declared):
    work = checked(TIME, triad(resting(size), declared), assume_units=True)
    assert work.faults == []
    assert [(r.rule, r.severity) for r in work.repairs] == [("unit_mistake", REPAIR)] * 3
    assert [r.channel for r in work.repairs] == ["acc_x", "acc_y", "acc_z"]
    assert work.repairs[0].after["rest_m_s2"] == pytest.approx(G, rel=0.01)
    found = meaning.claims(work)
    assert np.hypot(*(c.values(slice(0, 400)).mean() for c in found[::2])) == pytest.approx(
        G, rel=0.01
    )


def test_assume_units_also_overrules_the_mapping_file():
    channels = {
        f"a{axis}": {"column": f"acc_{axis}", "unit": "m/s^2", "limits": [-32768, 32767]}
        for axis in "xyz"
    }
    work = checked(
        TIME, triad(resting(16384.0), ""), {"channels": channels}, assume_units=True
    )  # fmt: skip
    assert len(work.repairs) == 3
    claim = meaning.claims(work)[2]
    assert (claim.name, claim.unit, claim.wish.scale) == ("az", "g_0", 1 / 16384)
    # the raw values stay as the log has them
    assert work.stream.column("acc_z").values[:100].mean() > 10000


@pytest.mark.parametrize(("mode", "refused"), [("repair", False), ("strict", True)])
def test_an_assumed_unit_is_a_repair_that_strict_refuses(mode, refused):
    columns = [RawColumn("t", TIME.copy(), "s")]
    columns += [RawColumn(n, v.copy(), u) for n, (v, u) in triad(resting(1.0), "m/s^2").items()]
    log = RawLog([RawStream("log", columns, time="t")])
    about = Provenance("a.csv", "", 0, "csv", "1", mode)
    if refused:
        with pytest.raises(InputError, match="unit_mistake; refused by --strict"):
            condition(log, NOTHING, about, assume_units=True)
        return
    made = condition(log, NOTHING, about, assume_units=True)
    channel = made.streams["log"].channels["acc_z_m_s2"]
    assert channel.values[:100].mean() == pytest.approx(G * np.cos(0.1), rel=0.01)
    assert {r.rule for r in made.provenance.repairs} >= {"unit_mistake"}


def test_a_device_that_never_rests_is_not_judged():
    random = np.random.default_rng(1)
    wild = random.normal(0, 1.0, (len(TIME), 3))
    assert checked(TIME, triad(wild, "m/s^2")).faults == []


def test_an_odd_but_steady_magnitude_is_warned_of():
    work = checked(TIME, triad(resting(4.9), "m/s^2"))
    assert work.faults == []
    assert [(r.rule, r.severity) for r in work.repairs] == [("rest_magnitude", WARNING)]


def swing(seed=0, noise=0.003, lag_s=0.0, step=0.01):
    """A pendulum's angle [rad], rounded like an encoder's, and its noisy, filtered rate."""
    random = np.random.default_rng(seed)
    time = np.arange(0, 20, step) + random.uniform(0, 0.2 * step, round(20 / step))
    angle = 0.8 * np.exp(-time / 30) * np.sin(5 * time)
    late = time - lag_s
    rate = 0.8 * np.exp(-late / 30) * (5 * np.cos(5 * late) - np.sin(5 * late) / 30)
    angle = np.round((angle + random.normal(0, noise, len(time))) / 0.0015) * 0.0015
    return time, angle, rate + random.normal(0, 20 * noise, len(time))


@pytest.mark.parametrize("noise", [0.0, 0.003, 0.02])
@pytest.mark.parametrize("lag_s", [0.0, 0.05])
def test_noise_rounding_and_a_filter_do_not_make_a_unit_mistake(noise, lag_s):
    for seed in range(10):
        time, angle, rate = swing(seed, noise, lag_s)
        work = checked(time, {"angle": (angle, "rad"), "angle_rate": (rate, "rad/s")})
        assert work.faults == []
        assert work.repairs == []


TURN = 2 * np.pi
DEG = 180 / np.pi


@pytest.mark.parametrize(
    ("of_angle", "of_rate", "units_", "cure"),
    [
        (DEG, 1, ("rad", "rad/s"), "angle: {column: angle, unit: deg}"),
        (1, DEG, ("rad", "rad/s"), "angle_rate: {column: angle_rate, unit: deg/s}"),
        (1 / TURN, 1, ("rad", "rad/s"), "angle: {column: angle, unit: turn}"),
        (1, 1 / TURN, ("rad", "rad/s"), "angle_rate: {column: angle_rate, unit: turn/s}"),
        (1, 60 / TURN, ("rad", "rad/s"), "angle_rate: {column: angle_rate, unit: turn/min}"),
        (1, DEG, ("deg", "deg/s"), "angle: {column: angle, unit: rad}"),
        (DEG, 1, ("deg", "deg/s"), "angle_rate: {column: angle_rate, unit: rad/s}"),
        (1, 1, ("rad", "rpm"), "angle_rate: {column: angle_rate, unit: rad/s}"),
        (1000, 1, ("m", "m/s"), "angle: {column: angle, unit: mm}"),
        (1, 3.6, ("m", "m/s"), "angle_rate: {column: angle_rate, unit: km/h}"),
    ],
)
def test_a_rate_that_is_not_the_derivative_names_the_unit(of_angle, of_rate, units_, cure):
    time, angle, rate = swing()
    columns = {
        "angle": (of_angle * angle, units_[0]), "angle_rate": (of_rate * rate, units_[1])
    }  # fmt: skip
    (fault,) = checked(time, columns).faults
    assert cure in fault
    assert "or simcompare import LOG --assume-units" in fault
    work = checked(time, columns, assume_units=True)
    assert work.faults == []
    (repair,) = work.repairs
    assert (repair.rule, repair.severity) == ("unit_mistake", REPAIR)
    assert repair.after["slope"] == pytest.approx(1, abs=0.05)
    # what was assumed is in order now
    again = len(work.repairs)
    plausible_units.check(work)
    assert (work.faults, len(work.repairs)) == ([], again)


def test_a_rate_that_counts_the_other_way_is_refused_even_with_assume_units():
    time, angle, rate = swing()
    for assume in (False, True):
        work = checked(
            time, {"q1": (angle, "rad"), "dq1": (-rate, "rad/s")}, assume_units=assume
        )  # fmt: skip
        (fault,) = work.faults
        assert "dq1: {column: dq1, unit: rad/s, sign: -1}" in fault
        assert "counts the other way" in fault


def test_a_factor_of_the_clock_is_called_so():
    time, angle, rate = swing()
    (fault,) = checked(1000 * time, {"pos": (angle, "rad"), "vel": (rate, "rad/s")}).faults
    assert "1/1000 on all rates means a wrong unit of the time" in fault


def test_another_scale_is_warned_of():
    time, angle, rate = swing()
    work = checked(time, {"pos": (0.43 * angle, "rad"), "vel": (rate, "rad/s")})
    assert work.faults == []
    (warning,) = work.repairs
    assert (warning.rule, warning.severity) == ("rate_scale", WARNING)
    assert warning.before["slope"] == pytest.approx(0.43, rel=0.02)


def test_an_angle_that_wraps_and_gaps_are_no_mistake():
    time = np.arange(0, 60, 0.01)
    rate = 3 + np.sin(time)
    angle = np.cumsum(rate) * 0.01
    wrapped = (angle + np.pi) % TURN - np.pi
    keep = (time < 20) | (time > 40)
    work = work_of(
        time[keep], {"angle": (wrapped[keep], "rad"), "angle_rate": (rate[keep], "rad/s")}
    )  # fmt: skip
    work.gaps = [int(np.flatnonzero(time[keep] < 20)[-1])]
    plausible_units.check(work)
    assert work.faults + work.repairs == []


@pytest.mark.parametrize(
    ("names", "same"),
    [
        (("angle", "angle_rate"), True),
        (("pos_meas1", "vel_meas1"), True),
        (("joint2Position", "joint2Velocity"), True),
        (("theta", "theta_dot"), True),
        (("q1", "dq1"), True),
        (("position.shoulder", "velocity.shoulder"), True),
        (("pos_meas1", "vel_meas2"), False),
        (("pos_meas1", "vel_filt1"), False),
        (("goal_position", "velocity"), False),
    ],
)
def test_positions_and_rates_are_paired_by_their_names(names, same):
    work = work_of(TIME, {names[0]: (TIME, "rad"), names[1]: (TIME, "rad/s")})
    assert len(derivative.pairs(meaning.claims(work))) == same


def test_a_pose_and_a_twist_in_different_frames_are_not_compared():
    time, x, v = swing()
    work = work_of(time, {"x": (x, "m"), "vx": (-v, "m/s")})
    work.stream.column("x").frame, work.stream.column("vx").frame = "odom", "base_link"
    plausible_units.check(work)
    assert work.faults == []


def wheel(of_rate=1.0, of_speed=1.0, unit="rad/s", **more):
    random = np.random.default_rng(0)
    rate = 10 + 5 * np.sin(TIME) + random.normal(0, 0.2, len(TIME))
    speed = of_speed * 0.05 * (10 + 5 * np.sin(TIME)) + random.normal(0, 0.01, len(TIME))
    columns = {"left_speed": (speed, "m/s"), "left_wheel_rate": (of_rate * rate, unit)}
    return checked(TIME, columns, {"wheel_diameter_m": 0.1}, **more)


def test_a_wheel_that_rolls_is_fine():
    assert wheel().faults + wheel().repairs == []


def test_turns_and_radians_of_a_wheel_are_told_apart():
    (fault,) = wheel(of_rate=1 / TURN).faults
    assert "left_wheel_rate: {column: left_wheel_rate, unit: turn/s}" in fault
    assert "π·D·n" in fault
    work = wheel(of_rate=1 / TURN, assume_units=True)
    assert work.faults == []
    assert work.repairs[0].after["ratio"] == pytest.approx(1, abs=0.05)
    assert "turn/s" in wheel(of_speed=TURN).faults[0]


def test_a_radius_that_was_taken_for_a_diameter_is_warned_of():
    (warning,) = wheel(of_speed=2.0).repairs
    assert warning.rule == "wheel_diameter"


@pytest.mark.parametrize(
    ("values", "declared", "right"),
    [
        (1013.25, "Pa", "hPa"), (101325.0, "hPa", "Pa"), (1013.25, "kPa", "hPa"),
        (101.3, "Pa", "kPa"),
    ],
)  # fmt: skip
def test_pressure_of_the_air_in_another_unit(values, declared, right):
    air = values * (1 + 1e-4 * np.sin(TIME))
    columns = {"barometer": (air, declared)}
    (fault,) = checked(TIME, columns).faults
    assert f"unit: {right}}}" in fault
    work = checked(TIME, columns, assume_units=True)
    assert work.faults == []
    assert work.repairs[0].after["median_Pa"] == pytest.approx(101325, rel=0.01)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("barometer", 101325 + np.sin(TIME)),
        ("gauge_pressure", 1013 + np.sin(TIME)),
        ("pressure", 1000 + 800 * np.sin(TIME)),
        ("force", 1013 + np.sin(TIME)),
    ],
)
def test_other_pressures_are_left_alone(name, values):
    assert checked(TIME, {name: (values, "Pa")}).faults == []


@needs_data
def test_real_pendulums_agree_with_their_rates():
    import pandas

    for file in sorted(Path(DATA, "pendulum_actuated").rglob("*measured*.csv")):
        table = pandas.read_csv(file)
        position = "pos" if "pos" in table else "position"
        rate = "vel" if "vel" in table else "velocity"
        columns = {position: (table[position], "rad"), rate: (table[rate], "rad/s")}
        work = checked(table["time"], columns)
        assert work.faults + work.repairs == [], file
        # and the same with degrees is refused
        columns[position] = (table[position] * DEG, "rad")
        assert "unit: deg}" in checked(table["time"], columns).faults[0], file


@needs_data
def test_a_real_double_pendulum_agrees_with_its_rates_even_at_rest():
    import pandas

    for file in sorted(Path(DATA, "double_pendulum").glob("*.csv")):
        table = pandas.read_csv(file)
        columns = {
            name: (table[name], "rad" if name.startswith("pos") else "rad/s")
            for name in table.columns
            if name[:3] in ("pos", "vel")
        }
        work = checked(table["time"], columns)
        assert work.faults + work.repairs == [], file


@needs_data
def test_the_jaw_of_a_real_arm_has_another_scale_and_its_joints_have_not():
    import pandas

    for file in sorted(Path(DATA, "servo_so101").glob("*/state_motor.csv")):
        table = pandas.read_csv(file)
        x, v = (np.array([json.loads(t) for t in table[n]]) for n in ("positions", "velocities"))
        columns = {f"position_{i}": (x[:, i], "rad") for i in range(6)}
        columns |= {f"velocity_{i}": (v[:, i], "rad/s") for i in range(6)}
        work = checked(table["timestamp"] * 1e-6, columns)
        assert work.faults == [], file
        assert {r.channel for r in work.repairs} <= {"velocity_5"}, file
        for repair in work.repairs:
            assert repair.before["slope"] == pytest.approx(0.43, abs=0.02)
