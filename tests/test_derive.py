"""What is derived from logs: wheel rates, sizes, angles, and what is slow."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from simcompare.errors import InputError, UnknownName
from simcompare.hardware.conditioning import derived_channels
from simcompare.model.recording import Channel, Clock, Provenance, Recording, Stream

# --- wheel rates from increments ------------------------------------------------------------------


@given(
    st.lists(
        st.tuples(st.floats(0.15, 0.25), st.floats(-0.5, 0.5), st.floats(-0.2, 0.2)),
        min_size=2, max_size=30,
    ),
    st.floats(0.01, 1.0),
)  # fmt: skip
def test_wheel_rates_lose_no_way_and_no_turn(rows, flank):
    lengths, way, turn = np.array(rows).T
    lengths[0] = lengths[1]  # the first interval is taken to be as long as the second
    time_s = np.cumsum(lengths)
    times, left, right = derived_channels.wheel_rates(way, turn, time_s, 0.1, 0.5, flank)
    fine = np.union1d(times, time_s - lengths / 2)
    turned = []
    for rate in (left, right):
        values = np.interp(fine, times, rate)
        turned.append(np.append(0, np.cumsum(np.diff(fine) * (values[1:] + values[:-1]) / 2)))
    # at the middle of each interval half of its increment, and at the end the whole
    expected_way = np.append(np.cumsum(way) - way / 2, way.sum())
    expected_turn = np.append(np.cumsum(turn) - turn / 2, turn.sum())
    at = np.searchsorted(fine, np.append(time_s - lengths / 2, times[-1]) - 1e-12)
    np.testing.assert_allclose(0.1 * (turned[0] + turned[1])[at] / 2, expected_way, atol=1e-9)
    np.testing.assert_allclose(0.1 * (turned[1] - turned[0])[at] / 0.5, expected_turn, atol=1e-9)


def test_a_turn_to_the_left_makes_the_right_wheel_faster():
    _, left, right = derived_channels.wheel_rates(
        np.array([0.2, 0.2]), np.array([0.1, 0.1]), np.array([0.2, 0.4]), 0.1, 0.5
    )
    np.testing.assert_allclose(left, (0.2 - 0.025) / 0.1 / 0.2)
    np.testing.assert_allclose(right, (0.2 + 0.025) / 0.1 / 0.2)


def increments(values=(0.1, 0.2, 0.3), unit="m"):
    time_s = np.arange(len(values)) * 0.2
    channels = {
        "ds_m": Channel(np.array(values, dtype=float), unit),
        "turn_rad": Channel(np.full(len(values), 0.01), "rad"),
    }
    streams = {"DR": Stream(time_s, channels, Clock("time column", first_s=10.0))}
    return Recording(streams, Provenance("log.mat", "0" * 64, 1, "mat", "0", "repair"))


BLOCK = {
    "wheels": {
        "function": "wheel_rates", "way": "ds", "turn": "turn", "wheel_radius_m": 0.1,
        "track_m": 0.5,
    }
}  # fmt: skip


def test_a_derived_stream_is_added_on_the_clock_of_its_own_and_recorded():
    made = derived_channels.add(increments(), BLOCK, "data, derive")
    stream = made.streams["wheels"]
    assert stream.clock.first_s == pytest.approx(9.8)
    assert stream.time_s[0] == 0
    assert len(stream.time_s) == 6
    assert stream.channels["left_rate_rad_s"].unit == "rad/s"
    conversion = made.provenance.conversions[-1]
    assert conversion.channel == "wheels/right_rate_rad_s"
    assert "wheel_rates" in conversion.reason
    assert "wheel_radius_m 0.1" in conversion.reason


@pytest.mark.parametrize(
    ("recording", "block", "message"),
    [
        (increments((0.1, math.nan, 0.3)), BLOCK, "lacks 1 increments"),
        (increments(unit="1"), BLOCK, "ds_m is in 1; expected m"),
        (increments(), {"wheels": {**BLOCK["wheels"], "track_m": -1}}, "track_m"),
        (increments(), {"DR": BLOCK["wheels"]}, "a stream of that name"),
    ],
    ids=["missing", "unit", "negative", "name"],
)
def test_what_cannot_be_derived_is_refused_with_its_place(recording, block, message):
    with pytest.raises(InputError, match=message):
        derived_channels.add(recording, block, "data, derive")


def test_an_unknown_channel_is_named():
    block = {"wheels": {**BLOCK["wheels"], "way": "steps"}}
    with pytest.raises(UnknownName, match="steps"):
        derived_channels.add(increments(), block, "data, derive")


# --- sizes, angles, and what is slow --------------------------------------------------------------


def a_recording(**columns):
    time_s = np.arange(len(next(iter(columns.values()))[0])) * 0.01
    channels = {
        name: Channel(np.array(v, dtype=float), unit) for name, (v, unit) in columns.items()
    }
    streams = {"log": Stream(time_s, channels, Clock("time column"))}
    return Recording(streams, Provenance("log.csv", "0" * 64, 1, "csv", "0", "repair"))


def test_a_magnitude_is_the_length_of_a_vector():
    recording = a_recording(
        a_m_s2=([3, math.nan], "m/s**2"), b_m_s2=([4, 1], "m/s**2"), c_m_s2=([12, 1], "m/s**2")
    )
    block = {"size": {"function": "magnitude", "of": ["a", "b", "c"]}}
    made = derived_channels.add(recording, block, "derive").streams["size"].channels
    (name, channel), *_ = made.items()
    assert name.startswith("magnitude")
    assert channel.values[0] == 13
    assert math.isnan(channel.values[1])


def test_components_of_different_units_have_no_magnitude():
    recording = a_recording(a=([3, 1], "m"), b=([4, 1], "rad"))
    with pytest.raises(InputError, match="b is in rad; expected m"):
        derived_channels.add(
            recording, {"size": {"function": "magnitude", "of": ["a", "b"]}}, "derive"
        )


def test_a_low_pass_keeps_what_is_slow_and_takes_what_is_fast_and_delays_nothing():
    time_s = np.arange(2000) / 200
    slow, fast = np.sin(2 * np.pi * 0.5 * time_s), np.sin(2 * np.pi * 40 * time_s)
    found = derived_channels.low_pass(slow + fast, 200, 5)
    np.testing.assert_allclose(found[200:-200], slow[200:-200], atol=2e-3)
    at_cutoff = derived_channels.low_pass(np.sin(2 * np.pi * 5 * time_s), 200, 5)[500:-500]
    assert np.abs(at_cutoff).max() == pytest.approx(0.5, abs=0.01)


def test_a_low_pass_never_filters_across_a_gap():
    values = np.sin(np.arange(200) / 20)
    values[100:105] = np.nan
    values[190] = np.nan  # nine samples are left behind it: too few
    found = derived_channels.low_pass(values, 100, 5)
    np.testing.assert_allclose(found[:100], derived_channels.low_pass(values[:100], 100, 5))
    assert np.isnan(found[100:105]).all()
    assert np.isnan(found[190:]).all()
    assert np.isfinite(found[105:190]).all()


@pytest.mark.parametrize("cutoff_Hz", [50, 80])
def test_a_cutoff_beyond_half_the_rate_is_refused(cutoff_Hz):
    recording = a_recording(a=(np.arange(100.0), "m"))
    block = {"slow": {"function": "low_pass", "of": ["a"], "cutoff_Hz": cutoff_Hz}}
    with pytest.raises(InputError, match="not below half of 100 samples"):
        derived_channels.add(recording, block, "derive")


def test_later_wishes_may_use_earlier_ones():
    recording = a_recording(
        w=(np.ones(50), "1"), x=(np.zeros(50), "1"), y=(np.zeros(50), "1"), z=(np.zeros(50), "1")
    )
    block = {
        "pose": {"function": "yaw_pitch_roll", "of": ["w", "x", "y", "z"], "u_rad": 0.01},
        "slow": {"function": "low_pass", "of": ["pose/yaw"], "cutoff_Hz": 5},
    }
    made = derived_channels.add(recording, block, "derive")
    assert list(made.streams) == ["log", "pose", "slow"]
    assert made.streams["pose"].channels["roll_rad"].u == 0.01
    assert [c.channel for c in made.provenance.conversions][-1] == "slow/yaw_rad"


def test_an_unknown_function_is_refused():
    with pytest.raises(InputError, match="function"):
        derived_channels.add(
            a_recording(a=([1, 2], "m")), {"b": {"function": "wish", "of": ["a"]}}, "derive"
        )


def test_an_unknown_component_is_named():
    block = {"size": {"function": "magnitude", "of": ["a", "nothing"]}}
    with pytest.raises(UnknownName, match="nothing"):
        derived_channels.add(a_recording(a=([1, 2], "m")), block, "derive")


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1), st.floats(0.1, 10))
def test_angles_make_the_rotation_that_they_came_from(yaw, pitch, roll, length):
    turned = Rotation.from_euler("ZYX", (yaw, pitch, roll))
    x, y, z, w = turned.as_quat() * length
    found = derived_channels.yaw_pitch_roll(np.array([[w, x, y, z]]))
    again = Rotation.from_euler("ZYX", [float(part[0]) for part in found])
    np.testing.assert_allclose(again.as_matrix(), turned.as_matrix(), atol=1e-7)


def test_angles_are_counted_on_through_turns_and_gaps():
    yaw = np.linspace(0, 12, 60)
    quaternions = np.column_stack((np.cos(yaw / 2), 0 * yaw, 0 * yaw, np.sin(yaw / 2)))
    quaternions[20:22] = np.nan
    found, pitch, _ = derived_channels.yaw_pitch_roll(quaternions)
    known = np.isfinite(found)
    np.testing.assert_allclose(found[known], yaw[known], atol=1e-12)
    assert np.isnan(pitch[20:22]).all()
