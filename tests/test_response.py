"""Frequency responses and tilts found in signals that are known by construction."""

import functools
import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from simcompare.measures import Measured, Request, _transfer, response, sweep_response, tilt
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Trajectory

READ = Probe(observe="spring.position_m", component=None, label="deflection", unit="m")
BASE = Probe(observe="slide.position_m", component=None, label="base", unit="m")
DWELL_S, STEP_S = 0.25, 0.0005


def made(base, read, step_s=STEP_S):
    signals = {"slide.position_m": np.asarray(base), "spring.position_m": np.asarray(read)}
    return Trajectory("made", np.arange(len(base)) * step_s, signals)


def dwelt(trajectory, dwells, **options):
    wanted = {
        "dwell_s": DWELL_S, "settle_s": 0.05, "dwells": dwells, "gain": 1.0,
        "judged_up_to_Hz": 1000.0, **options,
    }  # fmt: skip
    return response.measure(trajectory, Request(READ, {"base": BASE}, wanted))


def shaken(frequencies, ratios, *, phase=0.3, disturb=lambda t: 0.0, step_s=STEP_S):
    """A base that moves by one sine after another, with offset and drift, and what reads it."""
    count = round(DWELL_S / step_s)
    base, read = [], []
    for k, (frequency, ratio) in enumerate(zip(frequencies, ratios, strict=True)):
        t = np.arange(count) * step_s
        omega = 2 * math.pi * frequency
        base.append(0.01 * np.cos(omega * t + phase) / omega**2 + 0.1 * k - 0.02 * t + disturb(t))
        wave = ratio * np.exp(1j * (omega * t + phase + math.pi))
        read.append(0.01 * wave.real + 0.3 - 0.1 * t + disturb(t))
    return made(np.concatenate(base), np.concatenate(read), step_s)


def series_of(found):
    return [found.series[name] for name in ("frequency", "amplitude", "phase")]


@settings(max_examples=30)
@given(
    periods=st.lists(st.integers(1, 60), min_size=1, max_size=4),
    size=st.floats(0.01, 5),
    angle=st.floats(-3.1, 3.1),
    phase=st.floats(-3.1, 3.1),
)
def test_amplitude_and_phase_are_found_beside_offset_and_drift(periods, size, angle, phase):
    ratio = size * np.exp(1j * angle)
    frequencies = [p / DWELL_S for p in periods]
    found = dwelt(shaken(frequencies, [ratio] * len(periods), phase=phase), len(periods))
    frequency, amplitude, lag = series_of(found)
    np.testing.assert_allclose(frequency, sorted(frequencies))
    np.testing.assert_allclose(amplitude, size, rtol=1e-6)
    turned = np.radians(lag) - angle
    np.testing.assert_allclose(np.exp(1j * turned), 1, atol=1e-6)


def test_each_dwell_has_its_own_ratio_and_the_lowest_frequency_comes_first():
    trajectory = shaken([40.0, 8.0, 160.0], [0.7 * np.exp(-1.5j), 1.0, 0.06 * np.exp(-2.8j)])
    frequency, amplitude, phase = series_of(dwelt(trajectory, 3))
    np.testing.assert_allclose(frequency, [8, 40, 160])
    np.testing.assert_allclose(amplitude, [1, 0.7, 0.06], rtol=1e-7)
    np.testing.assert_allclose(phase, np.degrees([0, -1.5, -2.8]), atol=1e-5)


def test_gain_turns_the_probe_into_a_reading_with_its_sign():
    trajectory = shaken([20.0], [0.5])
    _, amplitude, phase = series_of(dwelt(trajectory, 1, gain=-4.0))
    assert amplitude[0] == pytest.approx(2)
    assert abs(phase[0]) == pytest.approx(180)


def test_what_has_died_out_before_the_settling_ends_does_not_matter():
    # a step response that falls to 1e-13 of the base within 50 ms
    trajectory = shaken([20.0], [1.0], disturb=lambda t: 0.01 * np.exp(-500 * t))
    _, amplitude, _ = series_of(dwelt(trajectory, 1))
    assert amplitude[0] == pytest.approx(1, rel=1e-6)
    _, amplitude, _ = series_of(dwelt(trajectory, 1, settle_s=0.001))
    assert abs(amplitude[0] - 1) > 1e-4


@pytest.mark.parametrize("step_s", [0.0005, 0.002, 0.0007])
def test_the_time_between_samples_does_not_matter(step_s):
    omega = 2 * math.pi * 20
    t = np.arange(round(DWELL_S / step_s) + 1) * step_s
    found = dwelt(made(-np.cos(omega * t) / omega**2, 0.9 * np.cos(omega * t - 0.4), step_s), 1)
    _, amplitude, phase = series_of(found)
    assert amplitude[0] == pytest.approx(0.9, rel=1e-9)
    assert phase[0] == pytest.approx(math.degrees(-0.4), abs=1e-6)


def test_fine_steps_take_little_memory_and_change_no_bit(monkeypatch):
    time_s = np.arange(4000) * 5e-5
    shaking, frequencies_Hz = np.sin(300 * time_s) + time_s, np.arange(1, 301) * 5.0
    tracemalloc.start()
    left = response._left(time_s, shaking, frequencies_Hz)
    _, most_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # all at once, the waves alone are 19 MB
    assert most_bytes < 8 * 4000 * 300
    monkeypatch.setattr(response, "_AT_ONCE", 4000 * 300)
    np.testing.assert_array_equal(response._left(time_s, shaking, frequencies_Hz), left)


@pytest.mark.parametrize("tremble", [0.0, 1e-17])
def test_a_base_that_stands_still_gives_no_response(tremble):
    still = tremble * np.sin(np.arange(1000.0))
    found = dwelt(made(still, 1000 * still), 2)
    assert found.notes
    assert len(found.series["frequency"]) == 0
    assert found.values["cutoff_frequency"] is None
    truth = dwelt(shaken([20.0, 40.0], [1.0, 0.5]), 2)
    judged = response.against(found, truth)
    assert judged["amplitude_error"] == (None, 0.0)
    assert judged["phase_error"] == (None, 0.0)


def test_a_record_that_ends_early_gives_the_dwells_that_it_holds():
    found = dwelt(shaken([20.0, 40.0], [1.0, 0.5]), 5)
    np.testing.assert_allclose(found.series["frequency"], [20, 40])


def test_errors_are_the_largest_among_the_judged_frequencies():
    truth = dwelt(shaken([4.0, 20.0, 80.0], [1.0, 0.9, 0.3]), 3, judged_up_to_Hz=20.0)
    ours = dwelt(
        shaken([4.0, 20.0, 80.0], [1.01, 0.9 * np.exp(-0.01j), 0.5]), 3, judged_up_to_Hz=20.0
    )
    judged = response.against(ours, truth)
    assert judged["amplitude_error"][0] == pytest.approx(0.01, rel=1e-5)
    assert judged["phase_error"][0] == pytest.approx(math.degrees(0.01), rel=1e-5)
    assert judged["judged_frequencies"] == (2, 2)


def test_other_frequencies_than_the_true_ones_are_no_answer():
    truth = dwelt(shaken([4.0, 20.0], [1.0, 0.9]), 2)
    ours = dwelt(shaken([4.0, 24.0], [1.0, 0.9]), 2)
    assert response.against(ours, truth)["amplitude_error"] == (None, 0.0)


@given(lag=st.floats(-269.9, 89.9))
def test_phases_do_not_jump_at_half_a_turn(lag):
    found = _transfer.phase_of(np.array([np.exp(1j * math.radians(lag))]))
    assert found[0] == pytest.approx(lag, abs=1e-9)


def test_phase_errors_are_taken_the_short_way_round():
    def at(phase):
        one = np.array([1.0])
        return _transfer.as_measured(one, np.exp(1j * np.radians(np.array([phase]))), 10.0)

    assert _transfer.against(at(89.0), at(-269.0))["phase_error"][0] == pytest.approx(2)


@settings(max_examples=60)
@given(
    damping=st.floats(0.05, 3),
    ratios=st.lists(st.floats(0.05, 6), min_size=3, max_size=12, unique_by=lambda r: round(r, 2)),
)
def test_the_cutoff_of_a_second_order_sensor_is_that_of_its_closed_form(damping, ratios):
    ratio = np.sort(ratios)
    amplitude = np.abs(1 / (1 - ratio**2 + 2j * damping * ratio))
    spread = 1 - 2 * damping**2
    exact = math.sqrt(spread + math.sqrt(spread**2 + 1))
    found = _transfer.cutoff(40 * ratio, amplitude)
    if not ratio[0] < exact < ratio[-1]:
        assert found is None
    elif min(abs(ratio - exact)) > 1e-9:
        # 1e-9 for rounding where frequencies lie close together
        assert found == pytest.approx(40 * exact, rel=1e-9)


def test_the_cutoff_lies_between_its_frequencies_whatever_the_sensor():
    generator = np.random.default_rng(0)
    for _ in range(300):
        # drawn from few values, so that some come twice
        frequency = np.sort(generator.integers(1, 12, generator.integers(2, 8))).astype(float)
        amplitude = np.maximum(generator.uniform(-0.2, 1.3, len(frequency)), 0)
        found = _transfer.cutoff(frequency, amplitude)
        below = np.flatnonzero(amplitude < _transfer.CUTOFF)
        if len(below) == 0 or below[0] == 0:
            assert found is None
        else:
            # the interval's own width, for rounding
            low, high = frequency[below[0] - 1 : below[0] + 1]
            assert low * (1 - 1e-12) <= found <= high * (1 + 1e-12)


def test_a_response_that_never_falls_or_begins_below_has_no_cutoff():
    frequency = np.array([1.0, 3.0, 10.0, 30.0])
    assert _transfer.cutoff(frequency, np.ones(4)) is None
    assert _transfer.cutoff(frequency, np.full(4, 0.1)) is None
    assert _transfer.cutoff(np.empty(0), np.empty(0)) is None


def test_a_cutoff_that_the_truth_has_not_is_not_judged():
    truth = _transfer.as_measured(np.array([1.0]), np.array([1 + 0j]), 10.0)
    assert isinstance(truth, Measured)
    assert "cutoff_frequency" not in _transfer.against(truth, truth)


# --- a sweep ------------------------------------------------------------------------------------


def swept(trajectory, **options):
    wanted = {
        "first_Hz": 4.0, "last_Hz": 80.0, "count": 15, "taper_s": 0.3, "gain": 1.0,
        "judged_up_to_Hz": 20.0, **options,
    }  # fmt: skip
    return sweep_response.measure(trajectory, Request(READ, {"base": BASE}, wanted))


def acceleration(t):
    """A sweep from 1 to 160 Hz in 2.5 s that begins smoothly, and 0 before."""
    t = np.maximum(t, 0)
    growth = math.log(160) / 2.5
    begins = -np.expm1(-((t / 0.1) ** 4))
    return 5 * begins * np.cos(2 * math.pi * np.expm1(growth * t) / growth)


@functools.cache
def swept_base():
    """Times, and the position of a base with that acceleration, from rest at 2 m."""
    t = np.arange(5001) * STEP_S
    solved = solve_ivp(
        lambda t, y: [y[1], acceleration(t)], (0, t[-1]), (0, 0), "DOP853",
        t_eval=t, rtol=1e-12, atol=1e-14, max_step=0.002,
    )  # fmt: skip
    return t, solved.y[0] + 2


@pytest.mark.parametrize("delay_s", [0.0, 0.001, 0.0037])
def test_a_sweep_finds_a_delay_exactly(delay_s):
    t, base = swept_base()
    assert abs(base[-1] - base[0]) > 0.05  # it drifts, which must not matter
    found = swept(made(base, 0.5 * acceleration(t - delay_s)), gain=-3.0)
    frequency, amplitude, phase = series_of(found)
    np.testing.assert_allclose(frequency, np.geomspace(4, 80, 15))
    late = np.exp(-2j * math.pi * frequency * delay_s)
    ratio = amplitude * np.exp(1j * np.radians(phase)) / (-1.5 * late)
    np.testing.assert_allclose(ratio[:10], 1, atol=1e-6)
    # the last ones lie near the frequencies at which the record fades
    np.testing.assert_allclose(ratio, 1, atol=2e-3)


def test_an_end_cut_off_would_leak_into_all_frequencies():
    t, base = swept_base()
    hard = swept(made(base, acceleration(t - 0.0037)), taper_s=0.002)
    assert np.abs(hard.series["amplitude"] - 1).max() > 1e-2


def test_a_sweep_of_a_base_that_stands_still_gives_no_response():
    found = swept(made(1e-17 * np.sin(np.arange(5001.0)), np.ones(5001)))
    assert found.notes
    assert len(found.series["frequency"]) == 0


# --- tilt ---------------------------------------------------------------------------------------


def tilt_of(forward, left, up):
    probes = [
        Probe(observe="cell.force_N", component=i, label=label, unit="N")
        for i, label in enumerate(("forward", "left", "up"))
    ]
    force = np.column_stack((forward, left, up)).astype(float)
    trajectory = Trajectory("made", np.arange(len(force)) * 0.1, {"cell.force_N": force})
    return tilt.measure(trajectory, Request(probes[0], {"left": probes[1], "up": probes[2]})).values


@given(pitch=st.floats(-1.5, 1.5), roll=st.floats(-3.1, 3.1), scale=st.floats(1e-3, 1e3))
def test_pitch_and_roll_are_found_whatever_the_scale(pitch, roll, scale):
    cosine = math.cos(pitch)
    reading = (-math.sin(pitch), math.sin(roll) * cosine, math.cos(roll) * cosine)
    found = tilt_of(*([scale * value] * 3 for value in reading))
    assert found["pitch"] == pytest.approx(pitch, abs=1e-9)
    assert found["roll"] == pytest.approx(roll, abs=1e-9)


def test_tilt_takes_the_mean_of_what_trembles():
    found = tilt_of([-0.4, -0.6, -0.5], [0, 0, 0], [0.5, 0.4, 0.6])
    assert found["pitch"] == pytest.approx(math.pi / 4)


def test_no_reading_has_no_tilt():
    assert tilt_of([0, 0], [0, 0], [0, 0]) == {"pitch": None, "roll": None}
