"""Accelerometers and gyroscopes that contradict gravity, on turns that are known exactly."""

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcompare.errors import InputError
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.conditioning.units import inertial, meaning, plausible_units, turning
from simcompare.hardware.mapping import NOTHING, of_tree
from simcompare.hardware.raw import RawColumn, RawLog, RawStream
from simcompare.model.recording import REPAIR, WARNING, Provenance
from tests.conditioned import work_of

DATA = os.environ.get("SIMCOMPARE_DATA")
needs_data = pytest.mark.skipif(not DATA, reason="SIMCOMPARE_DATA names no folder of recordings")
G = 9.80665
STEP = 0.01
TIME = np.arange(0, 40, STEP)


def turned(seed=0, shaken=0.3):
    """Specific force [m/s²] and rate [rad/s] of a device that rests, is turned by hand, rests."""
    random = np.random.default_rng(seed)
    moving = ((TIME > 8) & (TIME < 32))[:, None]
    knots = random.normal(0, 1.2, (9, 3))
    rate = moving * np.column_stack(
        [np.interp(TIME, np.linspace(8, 32, 9), knots[:, i]) for i in range(3)]
    )
    attitude = Rotation.identity()
    force = np.empty((len(TIME), 3))
    for i, omega in enumerate(rate):
        force[i] = attitude.apply([0, 0, G], inverse=True)
        attitude = attitude * Rotation.from_rotvec(omega * STEP)
    # rate[i] turns from sample i to i+1: the mean over both is what a sensor shows at i
    rate[1:] = 0.5 * (rate[1:] + rate[:-1])
    force += random.normal(0, 0.02, force.shape) + moving * random.normal(0, shaken, force.shape)
    return force, rate + random.normal(0, 0.005, rate.shape) + 0.01


def columns(force, rate, force_unit="m/s^2", rate_unit="rad/s"):
    made = {f"acc_{axis}": (force[:, i], force_unit) for i, axis in enumerate("xyz")}
    return made | {f"gyr_{axis}": (rate[:, i], rate_unit) for i, axis in enumerate("xyz")}


def checked(*args, **kwargs):
    work = work_of(*args, **kwargs)
    plausible_units.check(work)
    inertial.check(work)
    return work


def rules(work):
    return [(repair.rule, repair.severity) for repair in work.repairs]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("force_unit", "by", "rate_unit", "of"),
    [
        ("m/s^2", 1, "rad/s", 1), ("g", 1 / G, "deg/s", 180 / np.pi),
        ("mg", 1e3 / G, "rps", 0.1591549),
    ],
)  # fmt: skip
def test_a_sound_device_passes_and_its_kind_is_told(seed, force_unit, by, rate_unit, of):
    force, rate = turned(seed)
    work = checked(TIME, columns(by * force, of * rate, force_unit, rate_unit))
    assert work.faults + work.repairs == []
    kinds = {column.name: column.kind for column in work.data}
    assert {kinds[f"acc_{axis}"] for axis in "xyz"} == {"specific_force"}
    assert {kinds[f"gyr_{axis}"] for axis in "xyz"} == {""}


def without_gravity():
    random = np.random.default_rng(2)
    return random.normal(0, 0.03, (len(TIME), 3)) + 0.05


def of_mapping(kind):
    return {
        "channels": {
            f"a{axis}": {"column": f"acc_{axis}", "unit": "m/s^2", "kind": kind} for axis in "xyz"
        }
    }


def test_removed_gravity_is_warned_of_and_marked():
    work = checked(TIME, columns(without_gravity(), np.zeros((len(TIME), 3))))
    assert work.faults == []
    assert rules(work) == [("gravity", WARNING)]
    assert "kind: gravity_removed" in work.repairs[0].text
    assert work.stream.column("acc_x").kind == "gravity_removed"


def test_removed_gravity_that_the_log_tells_of_is_no_defect():
    work = work_of(TIME, columns(without_gravity(), np.zeros((len(TIME), 3))))
    for axis in "xyz":
        work.stream.column(f"acc_{axis}").kind = "gravity_removed"
    plausible_units.check(work)
    inertial.check(work)
    assert work.faults + work.repairs == []


def test_a_mapping_that_calls_it_specific_force_is_refused():
    data = columns(without_gravity(), np.zeros((len(TIME), 3)))
    (fault,) = checked(TIME, data, of_mapping("specific_force")).faults
    assert "write kind: gravity_removed" in fault
    assert checked(TIME, data, of_mapping("gravity_removed")).faults == []


def test_gravity_that_was_not_removed_after_all_is_found():
    force, rate = turned()
    (fault,) = checked(TIME, columns(force, rate), of_mapping("gravity_removed")).faults
    assert "write kind: specific_force" in fault


@pytest.mark.parametrize(("mode", "refused"), [("repair", False), ("strict", True)])
def test_strict_refuses_what_repair_marks(mode, refused):
    data = columns(without_gravity(), np.zeros((len(TIME), 3)))
    raw = [RawColumn("t", TIME.copy(), "s")]
    raw += [RawColumn(name, values.copy(), unit) for name, (values, unit) in data.items()]
    log = RawLog([RawStream("log", raw, time="t")])
    about = Provenance("a.csv", "", 0, "csv", "1", mode)
    if refused:
        with pytest.raises(InputError, match="gravity was removed"):
            condition(log, NOTHING, about)
        return
    made = condition(log, NOTHING, about)
    assert made.streams["log"].channels["acc_x_m_s2"].kind == "gravity_removed"


@pytest.mark.parametrize(
    ("factor", "declared", "right"),
    [(180 / np.pi, "rad/s", "deg/s"), (1, "deg/s", "rad/s"), (0.1591549, "rad/s", "turn/s")],
)
def test_a_wrong_unit_of_a_gyroscope_is_found_by_gravity(factor, declared, right):
    force, rate = turned()
    data = columns(force, factor * rate, rate_unit=declared)
    (fault,) = checked(TIME, data).faults
    assert f"gyr_x: {{column: gyr_x, unit: {right}}}" in fault
    work = checked(TIME, data, assume_units=True)
    assert work.faults == []
    assert rules(work) == [("unit_mistake", REPAIR)] * 3
    assert [c.unit for c in meaning.claims(work) if c.name.startswith("gyr")] == [right] * 3


@pytest.mark.parametrize(
    ("axes", "told", "left_handed"),
    [
        (np.diag([1, -1, 1]), "(+x, -y, +z)", True),
        (np.diag([-1, -1, -1]), "(-x, -y, -z)", True),
        (np.diag([-1, -1, 1]), "(-x, -y, +z)", False),
        (np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1]]), "(+y, +x, +z)", True),
        (np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), "(+y, -x, +z)", False),
    ],
)
def test_axes_of_a_gyroscope_that_do_not_fit_are_warned_of(axes, told, left_handed):
    force, rate = turned(3)
    work = checked(TIME, columns(force, rate @ axes.T))
    assert work.faults == []
    assert rules(work) == [("gyroscope_axes", WARNING)]
    text = work.repairs[0].text
    assert told in text
    assert ("left-handed" in text) == left_handed
    assert work.repairs[0].after["explained"] > 0.9
    # the lines that the message proposes bring it in order
    import yaml

    channels = yaml.safe_load(text.split("mapping file: ")[1])["channels"]
    channels |= {
        f"acc_{axis}": {"column": f"acc_{axis}", "unit": "m/s^2"} for axis in "xyz"
    }  # fmt: skip
    mended = checked(TIME, columns(force, rate @ axes.T), {"channels": channels})
    assert mended.faults + mended.repairs == []


def test_a_device_that_only_turns_about_the_upright_is_not_judged():
    force = np.tile([0, 0, G], (len(TIME), 1))
    rate = np.column_stack([0 * TIME, 0 * TIME, np.sin(TIME)])
    assert turning.compare(*_triads(columns(force, rate))) is None
    assert checked(TIME, columns(force, -rate)).repairs == []


def _triads(data):
    work = work_of(TIME, data)
    found = meaning.triads(meaning.claims(work))
    force, rate = (next(t for t in found if t[0].si == si) for si in ("m/s**2", "rad/s"))
    return work, force, rate


def test_a_gyroscope_alone_that_is_too_fast_is_warned_of():
    _, rate = turned()
    data = columns(0 * rate, 180 / np.pi * rate)
    alone = {name: value for name, value in data.items() if name.startswith("gyr")}
    work = checked(TIME, alone)
    assert rules(work) == [("gyroscope_range", WARNING)]
    assert "in deg/s?" in work.repairs[0].text


def test_missing_values_and_gaps_do_not_disturb():
    force, rate = turned()
    force[100:110, 0] = np.nan
    rate[2000:2030, 1] = np.nan
    keep = (TIME < 15) | (TIME > 17)
    data = {n: (v[keep], u) for n, (v, u) in columns(force, rate).items()}
    assert checked(TIME[keep], data).faults == []
    assert checked(TIME[keep], data).repairs == []


@pytest.mark.parametrize("up", ["+z", "-z", "+x", "-x", "+y", "-y"])
def test_the_axis_that_the_mapping_calls_up_points_up_at_rest(up):
    force, rate = turned()
    force = np.tile(force[:800], (5, 1))
    work = checked(TIME, columns(force, 0 * rate), {"up": up})
    assert bool(work.faults) == (up != "+z")
    if work.faults:
        assert f"says that {up} is up" in work.faults[0]
        assert "3 other rotations" in work.faults[0]


def test_a_proposed_rotation_is_right_handed_and_fits():
    force = np.tile([0.0, -G, 0.0], (len(TIME), 1)) + np.random.default_rng(0).normal(
        0, 0.01, (len(TIME), 3)
    )
    (fault,) = checked(TIME, columns(force, 0 * force), {"up": "+z"}).faults
    # least turn: a quarter about x, so that y becomes -z
    assert "acc_z: {column: acc_y, unit: m/s^2, sign: -1}" in fault
    assert "acc_y: {column: acc_z, unit: m/s^2}" in fault
    assert "acc_x: {column: acc_x, unit: m/s^2}" in fault


def test_a_slanted_device_has_no_axis_up():
    force = np.tile(G * np.array([1, 1, 1]) / 3**0.5, (len(TIME), 1))
    force += np.random.default_rng(0).normal(0, 0.01, force.shape)
    (fault,) = checked(TIME, columns(force, 0 * force), {"up": "+z"}).faults
    assert "near none of the axes" in fault


def test_up_is_one_of_six_axes():
    with pytest.raises(InputError, match="up"):
        of_tree({"up": "z"}, "map")


def test_there_are_24_rotations_that_bring_axes_onto_axes():
    found = turning.rotations()
    assert len({tuple(turn.ravel()) for turn in found}) == 24
    assert all(np.linalg.det(turn) == pytest.approx(1) for turn in found)
    assert len(turning.signed_permutations()) == 48


def broad(name):
    import h5py

    with h5py.File(name) as file:
        force, rate = file["imu_acc"][:], file["imu_gyr"][:]
    time = np.arange(len(force)) / 285.7142857142857
    data = {f"imu_acc.{i}": (force[:, i], "m/s^2") for i in range(3)}
    return time, data, rate


@needs_data
def test_real_inertial_sensors_pass_and_explain_gravity():
    for file in sorted(Path(DATA, "imu_broad").glob("*.hdf5")):
        time, data, rate = broad(file)
        work = checked(time, data | {f"imu_gyr.{i}": (rate[:, i], "rad/s") for i in range(3)})
        assert work.faults + work.repairs == [], file
        assert work.stream.column("imu_acc.0").kind == "specific_force"


@needs_data
@pytest.mark.parametrize("axis", range(3))
def test_a_reversed_axis_of_a_real_gyroscope_is_found(axis):
    time, data, rate = broad(sorted(Path(DATA, "imu_broad").glob("02*.hdf5"))[0])
    rate[:, axis] *= -1
    work = checked(time, data | {f"imu_gyr.{i}": (rate[:, i], "rad/s") for i in range(3)})
    assert rules(work) == [("gyroscope_axes", WARNING)]
    assert f"-{'xyz'[axis]}" in work.repairs[0].text


@needs_data
def test_a_real_table_in_g_and_degrees_passes_and_wrong_units_do_not():
    import pandas

    table = pandas.read_csv(Path(DATA, "imu_xio", "sensor_data.csv"))
    time = table["Time (s)"]

    def of(force_unit, rate_unit):
        data = {f"Accelerometer {a}": (table[f"Accelerometer {a} (g)"], force_unit) for a in "XYZ"}
        return data | {
            f"Gyroscope {a}": (table[f"Gyroscope {a} (deg/s)"], rate_unit) for a in "XYZ"
        }

    good = checked(time, of("g", "deg/s"))
    assert good.faults + good.repairs == []
    first, second = checked(time, of("m/s^2", "rad/s")).faults
    assert "unit: g_0}" in first
    assert "unit: deg/s}" in second
