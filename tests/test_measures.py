"""Bounces found in heights that are known by construction."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from simcompare.errors import UnknownName
from simcompare.measures import Request, bounces, load
from simcompare.measures import _arcs as arcs
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Trajectory

G = 9.80665
PROBE = Probe(observe="ball.position_m", component=2, offset=-0.1, label="height", unit="m")


def bouncing(e_of, drop, step_s, end_s):
    """Heights of a ball whose k-th bounce has the restitution e_of(k), sampled evenly."""
    t = np.arange(round(end_s / step_s)) * step_s
    height = np.zeros(len(t))
    apex_time, apex, impacts = 0.0, drop, []
    for k in range(1000):
        fall = math.sqrt(2 * apex / G)
        inside = (t >= apex_time - (fall if k else 0)) & (t < apex_time + fall)
        height[inside] = apex - G * (t[inside] - apex_time) ** 2 / 2
        impacts.append(apex_time + fall)
        speed = e_of(k) * G * fall
        if speed < 1e-6 or impacts[-1] > end_s:
            break
        apex_time, apex = impacts[-1] + speed / G, speed**2 / (2 * G)
    return t, height, impacts


def measured(t, height):
    zero = np.zeros(len(t))
    positions = np.column_stack((zero, zero, height + 0.1))
    return bounces.measure(Trajectory("made", t, {"ball.position_m": positions}), Request(PROBE))


@example(e=0.59243152935546, drop=3.0, step_s=0.002)  # an impact just before the record ends
@given(
    e=st.floats(0.4, 0.95),
    drop=st.floats(0.2, 3.0),
    step_s=st.sampled_from([0.0005, 0.001, 0.002]),
)
def test_restitution_and_times_are_found_at_any_phase(e, drop, step_s):
    t, height, impacts = bouncing(lambda _: e, drop, step_s, 3.0)
    found = measured(t, height)
    count = len(found.series["restitution"])
    assert count >= 2
    np.testing.assert_allclose(found.series["restitution"], e, rtol=1e-8)
    times = found.series["impact_time"]
    np.testing.assert_allclose(times, impacts[: len(times)], atol=1e-9)


def test_each_bounce_has_its_own_restitution():
    values = [0.9, 0.5, 0.8, 0.7]
    t, height, _ = bouncing(lambda k: values[k] if k < 4 else 0.0, 1.0, 0.001, 4.0)
    found = measured(t, height)
    np.testing.assert_allclose(found.series["restitution"], values, rtol=1e-8)
    np.testing.assert_allclose(found.series["rebound_height"][0], 0.81, rtol=1e-9)


def test_a_gain_of_energy_is_a_finding():
    t, height, _ = bouncing(lambda k: 1.05 if k == 1 else 0.7, 1.0, 0.001, 3.0)
    assert measured(t, height).values["energy_gain"] == pytest.approx(1.05**2 - 1, rel=1e-6)


def test_a_jump_after_rest_is_a_gain_of_energy():
    t, height, _ = bouncing(lambda _: 0.5, 1.0, 0.001, 3.0)
    height[t > 2.5] = 0.2  # thrown up from rest
    assert measured(t, height).values["energy_gain"] > 1


def test_sticking_is_a_restitution_of_zero_and_said():
    t = np.arange(2000) * 0.001
    height = np.maximum(1.0 - G * t**2 / 2, -0.0003)
    found = measured(t, height)
    assert found.series["restitution"].tolist() == [0.0]
    assert "does not bounce" in found.notes[0]
    assert found.values["penetration"] == pytest.approx(0.0003)
    assert found.values["settling_time"] == pytest.approx(math.sqrt(2 / G), abs=0.002)


def test_resting_above_the_floor_is_no_flight():
    t, height, impacts = bouncing(lambda _: 0.5, 1.0, 0.001, 3.0)
    floating = np.where(t > impacts[4], 0.003, height + 0.003)
    found = measured(t, floating)
    assert found.values["resolved_bounces"] <= 6
    assert np.all(np.diff(found.series["impact_time"]) > 0)


def test_a_record_that_ends_in_flight_has_no_rest():
    t, height, _ = bouncing(lambda _: 0.8, 1.0, 0.001, 1.0)
    found = measured(t, height)
    assert found.values["settling_time"] is None
    assert len(found.series["impact_time"]) == 1


def test_stored_velocities_are_never_used():
    t, height, _ = bouncing(lambda _: 0.8, 1.0, 0.001, 3.0)
    zero = np.zeros(len(t))
    positions = np.column_stack((zero, zero, height + 0.1))
    wrong = np.full((len(t), 3), 1e6)
    signals = {"ball.position_m": positions, "ball.velocity_m_s": wrong}
    found = bounces.measure(Trajectory("made", t, signals), Request(PROBE))
    np.testing.assert_allclose(found.series["restitution"], 0.8, rtol=1e-8)


def test_nothing_is_found_in_a_ball_that_lies_still():
    t = np.arange(100) * 0.01
    assert arcs.find(t, np.zeros(100)) == []
    found = measured(t, np.zeros(100))
    assert len(found.series["impact_time"]) == 0
    assert found.values["energy_gain"] == 0


def test_unknown_measure_and_unknown_signal_are_named():
    with pytest.raises(UnknownName, match="bounces"):
        load("bouncing")
    t = np.arange(10) * 0.1
    empty = Trajectory("made", t, {"cube.position_m": np.zeros((10, 3))})
    with pytest.raises(UnknownName, match=r"cube\.position_m"):
        bounces.measure(empty, Request(PROBE))
