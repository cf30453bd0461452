"""What a real sensor would read of a trajectory, a run or a recording."""

from dataclasses import replace

import numpy as np
import pytest

import simcompare
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors.device import perfect
from simcompare.model.recording import Channel, Clock, Provenance, Recording, Stream
from simcompare.model.trajectory import Trajectory

TIME = np.linspace(0.0, 2.0, 2001)
FORCE = np.column_stack((np.sin(TIME), np.cos(TIME), 9.81 + 0 * TIME))
MOVED = Trajectory(
    "test bench",
    TIME,
    {
        "imu.specific_force_m_s2": FORCE,
        "imu.rate_rad_s": 0.1 * FORCE,
        "axle.angle_rad": TIME**2,
        "code.marks": np.floor(10 * TIME),
        "cart.orientation_wxyz": np.tile([1.0, 0, 0, 0], (len(TIME), 1)),
    },
)


def recording():
    gap = FORCE[:, 0].copy()
    gap[100:200] = np.nan
    channels = {
        "x_m_s2": Channel(gap, "m/s**2"),
        "y_m_s2": Channel(FORCE[:, 1], "m/s**2"),
        "z_m_s2": Channel(FORCE[:, 2], "m/s**2"),
    }
    stream = Stream(TIME, channels, Clock("test"))
    return Recording({"phone": stream}, Provenance("log.csv", "", 0, "", "", "strict"))


def test_a_chip_reads_both_signals_of_an_imu():
    read = simcompare.sense(MOVED, "imu", "mpu6050")
    assert list(read.readings) == ["imu.specific_force_m_s2", "imu.rate_rad_s"]
    assert list(read.devices) == list(read.readings)
    assert read.reading.measured.shape == FORCE.shape
    assert np.abs(read.reading.ideal - FORCE).max() < 1e-12
    assert list(read.samples("imu.rate_rad_s").columns) == [
        "time_s", "ideal.x", "ideal.y", "ideal.z", "measured.x", "measured.y", "measured.z",
        "saturated.x", "saturated.y", "saturated.z",
    ]  # fmt: skip


def test_one_axis_of_a_chip_reads_one_component():
    whole = simcompare.sense(MOVED, "imu.specific_force_m_s2", "mpu6050")
    alone = simcompare.sense(MOVED, "imu.specific_force_m_s2.z", "mpu6050")
    (one,) = alone.devices.values()
    (all_axes,) = whole.devices.values()
    assert one.axes == 1
    assert one.offset[0] == all_axes.offset[2]
    assert {row.axis for row in alone.drawn[0].terms} == {"z"}


def test_own_terms_and_a_device_are_taken_as_well():
    terms = simcompare.sense(MOVED, "axle", {"offset_rad": 0.5, "rate_Hz": 100})
    assert terms.reading.measured == pytest.approx(terms.reading.ideal + 0.5)
    assert len(terms.reading.time_s) == 201
    device = replace(perfect("angle", 1), offset=np.array([0.25]))
    given = simcompare.sense(MOVED, "axle.angle_rad", device)
    assert given.reading.measured == pytest.approx(TIME**2 + 0.25)


def test_marks_are_never_read_between_two_of_them():
    read = simcompare.sense(MOVED, "code", {"rate_Hz": 333}).reading
    assert set(read.measured) <= set(np.floor(10 * TIME))


@pytest.mark.parametrize(
    ("signal", "sheet", "quantity"),
    [
        ("motor.current_A", "ina219", "current"),
        ("motor.voltage_V", "ina219", "bus_voltage"),
        ("cart.position_m.x", "vl53l5cx", "distance"),
        ("height.pressure_Pa", "bmp280", "barometer"),
    ],
)
def test_currents_voltages_ranges_and_pressures_are_read_too(signal, sheet, quantity):
    signals = {
        "motor.current_A": 0.2 + 0 * TIME,
        "motor.voltage_V": 5.9989 + 0 * TIME,
        "cart.position_m": np.column_stack((1.0 + TIME, 0 * TIME, 0 * TIME)),
        "height.pressure_Pa": 1e5 + TIME,
    }
    read = simcompare.sense(Trajectory("bench", TIME, signals), signal, sheet)
    assert read.record.sensors[0].part == quantity
    off = np.abs(read.reading.measured - read.reading.ideal)
    assert 0 < off.max() < 0.05 * np.abs(read.reading.ideal).max()


def test_the_same_seed_reads_the_same_and_another_does_not():
    first, again = (simcompare.sense(MOVED, "imu", "mpu6050").reading for _ in range(2))
    other = simcompare.sense(MOVED, "imu", "mpu6050", seed=1).reading
    assert np.array_equal(first.measured, again.measured)
    assert not np.allclose(first.measured, other.measured)


def test_a_run_is_read_at_its_truth_or_at_an_engine(sweep):
    true = simcompare.sense(sweep[0], "ball.position_m.z", {"resolution_m": 0.01})
    assert true.whose == "closed form"
    engine = simcompare.sense(
        sweep[0], "ball.position_m.z", {"resolution_m": 0.01}, engine="pymunk", contact="tuned"
    )
    assert engine.whose == "pymunk tuned"
    assert np.allclose(engine.reading.measured * 100, np.rint(engine.reading.measured * 100))


def test_a_recording_is_read_channel_by_channel_or_as_three_axes():
    one = simcompare.sense(recording(), "y", "mpu6050")
    assert list(one.readings) == ["phone.y_m_s2"]
    three = simcompare.sense(recording(), ["x", "y", "z"], "mpu6050")
    assert three.reading.measured.shape == (2001, 3)
    assert np.isfinite(three.reading.measured).all()


def test_it_shows_itself():
    read = simcompare.sense(MOVED, "imu", "mpu6050")
    assert "imu.specific_force_m_s2 of test bench" not in repr(read)
    assert "imu.rate_rad_s of test bench, as a real sensor reads it" in repr(read)
    assert "read by one MPU-6050 (accelerometer): off by x" in repr(read)
    page = read._repr_html_()
    assert "±50 mg" in page
    assert "<img" in page
    assert "normal, u = 0.49" in read.table().to_string()
    read.plot("imu.rate_rad_s")


@pytest.mark.parametrize(
    ("signal", "device", "said"),
    [
        ("imo", "mpu6050", "no sensor or signal of test bench is called 'imo'; did you mean imu?"),
        ("cart", "mpu6050", "no sensor or signal of test bench is called 'cart'"),
        ("imu", "mpu6051", "no data sheet is called 'mpu6051'"),
        ("axle.angle_rad", "mpu6050", "it measures specific force"),
        ("axle", {"noise_rad_per_rtHz": -1}, "noise_rad_per_rtHz: is -1; expected 0 or more"),
        ("axle", {"bandwidth_Hz": 501}, "above Nyquist's 500 Hz"),
        ("axle", {"ofset_rad": 1}, "did you mean offset_rad"),
        ("axle", {}, "says nothing"),
    ],
)
def test_what_cannot_be_is_told(signal, device, said):
    with pytest.raises((InputError, UnknownName)) as error:
        simcompare.sense(MOVED, signal, device)
    assert said in str(error.value)


def test_axes_that_do_not_fit_are_told():
    with pytest.raises(InputError, match="it has 3 axes and the signal has 1"):
        simcompare.sense(MOVED, "axle.angle_rad", perfect("imu", 3))
    with pytest.raises(InputError, match="2 channels; expected one, or three"):
        simcompare.sense(recording(), ["x", "y"], "mpu6050")
    with pytest.raises(InputError, match="only a recording has its axes in channels"):
        simcompare.sense(MOVED, ["imu.rate_rad_s"], "mpu6050")


def test_unknown_sources_of_a_run_are_told(sweep):
    with pytest.raises(UnknownName, match="no source of this run is called 'dart'"):
        simcompare.sense(sweep[0], "ball", "mpu6050", engine="dart")
