"""What sensors read: each term of the error model by itself, against what it must do."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from simcompare.errors import InputError
from simcompare.hardware.sensors import low_pass, noise
from simcompare.hardware.sensors.device import perfect
from simcompare.hardware.sensors.error_model import measured, measured_by
from simcompare.statistics import allan_terms
from simcompare.statistics.streams import stream

TIME = np.arange(1001) * 0.001
#: three different slow waves
WAVES = np.sin(np.outer(TIME, [3.0, 5.0, 7.0]) + np.arange(3))
NONE = np.zeros((len(TIME), 3))


def three(**terms):
    return replace(perfect("imu", 3), **terms)


def read(device, ideal=WAVES, seed=1, **manner):
    return measured(device, TIME[: len(ideal)], ideal, stream(seed), **manner)


# --- systematic terms -----------------------------------------------------------------------------


def test_a_perfect_sensor_reads_the_signal():
    found = read(three())
    assert found.measured == pytest.approx(WAVES, abs=1e-15)
    assert found.ideal == pytest.approx(WAVES, abs=1e-15)
    assert not found.saturated.any()
    assert found.time_s == pytest.approx(TIME)


def test_sensitivity_offset_and_temperature_act_as_written():
    S = np.array([[1.01, 0.002, 0.0], [0.0, 0.98, -0.01], [0.003, 0.0, 1.0]])
    offset, drift, gain = np.array([0.1, -0.2, 0.3]), np.array([0.01, 0.0, -0.02]), np.full(3, 1e-3)
    device = three(
        sensitivity=S, offset=offset, offset_per_K=drift, sensitivity_per_K=gain, temperature_C=35.0
    )
    expected = 1.01 * WAVES @ S.T + offset + 10 * drift
    assert read(device).measured == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("poles", [2, 3, 4])
def test_a_slow_low_pass_of_several_poles_keeps_what_does_not_change(poles):
    still = np.full((len(TIME), 3), 9.81)
    # a hundred millionth: rounding of poles that lie 6e-4 from 1
    found = low_pass.smoothed(still, 0.001, 0.1, poles)
    assert found == pytest.approx(still, rel=1e-8)


def test_non_linearity_bends_by_its_part_of_full_scale_and_no_more():
    ramp = np.linspace(-4.0, 4.0, 1001)
    device = replace(perfect("cell", 1), nonlinearity=np.array([0.01]), full_scale=5.0)
    error = read(device, ramp).measured - ramp
    assert np.abs(error).max() == pytest.approx(0.05, rel=1e-4)
    assert error[np.argmin(np.abs(ramp - 2.5))] == pytest.approx(-0.05, rel=1e-4)
    # far beyond the range it must not turn the reading round
    far = read(device, np.full(1001, 500.0))
    assert np.all(far.measured == 5.0)
    assert far.saturated.all()


def test_a_sensor_turned_in_its_box_reads_the_turned_axes():
    quarter = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # about z: its x axis is the box's y
    found = read(three(mounting_wxyz=quarter)).measured
    assert found[:, 0] == pytest.approx(WAVES[:, 1], abs=1e-12)
    assert found[:, 1] == pytest.approx(-WAVES[:, 0], abs=1e-12)


def test_counts_are_rounded_half_to_even_and_cut_off_at_the_range():
    device = replace(perfect("counter", 1), resolution=1.0, full_scale=3.0)
    found = measured(device, TIME[:6], np.array([0.5, 1.5, 2.5, -0.5, 3.4, -9.0]), stream(1))
    assert found.measured.tolist() == [0.0, 2.0, 2.0, 0.0, 3.0, -3.0]
    assert found.saturated.tolist() == [False, False, False, False, True, True]


# --- time -----------------------------------------------------------------------------------------


def test_the_low_pass_halves_the_power_at_its_bandwidth():
    fine_s = np.arange(40_001) * 1e-4
    for poles in (1, 2, 3, 4):
        device = replace(perfect("slow", 1), bandwidth_Hz=20.0, poles=poles)
        wave = np.sin(2 * math.pi * 20.0 * fine_s)
        found = measured(device, fine_s, wave, stream(1)).measured
        assert np.abs(found[20_000:]).max() == pytest.approx(math.sqrt(0.5), rel=1e-4)


def test_samples_come_at_the_device_own_clock():
    slow = read(three(rate_Hz=100.0, rate_error=0.05))
    assert slow.time_s == pytest.approx(np.arange(106) / 105.0, abs=1e-12)
    assert slow.ideal[:, 0] == pytest.approx(np.interp(slow.time_s, TIME, WAVES[:, 0]))
    assert slow.measured == pytest.approx(slow.ideal)


def test_a_late_sample_is_an_older_one():
    ramp = 3.0 * TIME
    late = read(replace(perfect("late", 1), latency_s=0.1), ramp)
    assert late.measured[200:] == pytest.approx(ramp[200:] - 0.3, abs=1e-12)


def test_jitter_moves_the_instants():
    ramp = 3.0 * TIME
    shaken = read(replace(perfect("shaken", 1), jitter_s=0.0005), ramp)
    # 1001 draws: five times the 2.2 % of their standard deviation
    assert np.std(shaken.measured - ramp) == pytest.approx(0.0015, rel=0.11)


def test_a_counter_keeps_its_count_between_samples():
    marks = np.floor(TIME * 10)
    found = read(replace(perfect("encoder", 1), rate_Hz=333.0), marks, held=True)
    assert set(found.measured) <= set(marks)


def test_a_coarse_signal_is_said():
    (note,) = read(three(rate_Hz=8000.0)).notes
    assert "8000 times a second" in note
    assert "1000 values a second" in note
    assert read(three(rate_Hz=1000.0)).notes == ()


# --- noise ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("poles", [1, 2, 3, 4])
@pytest.mark.parametrize("bandwidth_Hz", [500.0, 260.0, 44.0, 5.0])
def test_filtered_noise_has_the_noise_bandwidth(poles, bandwidth_Hz):
    b, a = low_pass.noise_filter(0.001, bandwidth_Hz, poles)
    impulse = np.zeros(20_000)
    impulse[0] = 1.0
    h = signal.lfilter(b, a, impulse)
    rms = math.sqrt(500.0 * np.sum(h**2))  # density 1 at 1 kHz
    wanted = math.sqrt(low_pass.noise_bandwidth(bandwidth_Hz, poles, 1000.0))
    # 1e-4 where the filter is so slow that the bilinear one is taken
    assert rms == pytest.approx(wanted, rel=1e-4)
    # the density of the output at low frequencies is that which was stated
    assert np.sum(h) == pytest.approx(1.0, abs=1e-9)


def test_noise_behind_a_filter_of_half_the_rate_is_white():
    """Nothing folds back: a chip's own filter is a digital one."""
    for bandwidth_Hz in (50.0, 32.0, math.inf):  # one pole of 32 Hz has a noise bandwidth of 50 Hz
        assert low_pass.noise_bandwidth(bandwidth_Hz, 1, 100.0) == 50.0
        b, a = low_pass.noise_filter(0.01, bandwidth_Hz, 1)
        assert (b.tolist(), a.tolist()) == ([1.0], [1.0])


def test_noise_bandwidths_of_butterworth_filters():
    shares = [low_pass.noise_bandwidth(1.0, poles) for poles in (1, 2, 3, 4)]
    assert shares == pytest.approx([1.5708, 1.1107, 1.0472, 1.0262], abs=5e-5)


@pytest.mark.parametrize("poles", [1, 2, 4])
def test_filtered_noise_is_steady_from_its_first_sample(poles):
    drawn = noise.white(np.ones((40_000, 1)), np.full(40_000, 0.01), 3, stream(1), 40.0, poles)
    # 40,000 draws: five times 1/√80,000
    rms = math.sqrt(low_pass.noise_bandwidth(40.0, poles, 100.0))
    assert drawn.std(axis=0).ravel() == pytest.approx(np.full(3, rms), rel=0.018)


def test_the_mpu6050_at_44_hertz():
    """400 µg/√Hz behind one pole of 44 Hz: 3.33 mg rms, where the maker states 400·√(1.57·44)."""
    device = replace(
        perfect("mpu", 1), noise_density=np.array([400e-6]), bandwidth_Hz=44.0, rate_Hz=1000.0
    )
    found = measured(device, np.array([0.0, 300.0]), np.zeros(2), stream(1)).measured
    # about 300·44·π/2 independent numbers: five times their 0.35 %
    assert found.std() == pytest.approx(3.33e-3, rel=0.02)


@pytest.mark.parametrize(
    ("term", "name", "expected"),
    [
        ("noise_density", "N", math.sqrt(0.5)),
        ("bias_instability", "B", 1.0),
        ("random_walk", "K", 1.0),
    ],
)
def test_each_noise_is_found_again_by_its_allan_deviation(term, name, expected):
    device = replace(perfect("imu", 1), **{term: np.ones(1)}, rate_Hz=20.0)
    found = measured(device, np.array([0.0, 1000.0]), np.zeros(2), stream(2)).measured
    terms = allan_terms.fitted(found, 20.0)
    # 20,000 samples: its own u is below 0.7 %, so that 4 % are five times that
    assert terms[name].value == pytest.approx(expected, rel=0.04)
    assert 5 * terms[name].u < 0.04 * expected
    assert [one for one in "NBK" if terms[one].seen] == [name]


def test_all_noises_together_are_found_again():
    terms = {"noise_density": 0.1, "bias_instability": 0.05, "random_walk": 0.02}
    arrays = {name: np.array([size]) for name, size in terms.items()}
    device = replace(perfect("imu", 1), **arrays, rate_Hz=20.0)
    found = measured(device, np.array([0.0, 4000.0]), np.zeros(2), stream(2)).measured
    fit = allan_terms.fitted(found, 20.0)
    for name, expected in (("N", 0.1 / math.sqrt(2)), ("B", 0.05), ("K", 0.02)):
        assert abs(fit[name].value - expected) < 3 * fit[name].u
        assert fit[name].u < 0.25 * expected


def test_bias_instability_has_a_flat_allan_deviation_from_first_to_last():
    devices = [replace(perfect("imu", 1), bias_instability=np.ones(1), rate_Hz=1.0)] * 3000
    found = measured_by(devices, np.array([0.0, 255.0]), np.zeros(2), stream(3)).measured[..., 0]
    for size in (8, 32, 64):
        means = found.reshape(3000, -1, size).mean(axis=2)
        deviation = math.sqrt(np.mean(np.diff(means, axis=1) ** 2) / 2)
        # 9,000 differences, of which neighbours share a mean: five times their 1 %
        assert deviation == pytest.approx(math.sqrt(2 * math.log(2) / math.pi), rel=0.05)
    # as uncertain at the first sample as at the last
    assert found[:, 0].std() == pytest.approx(found[:, -1].std(), rel=0.1)


def test_noise_that_grows_with_the_reading():
    ranges = np.repeat([1.0, 4.0], 500)
    device = replace(perfect("range", 1), noise_per_reading=np.array([0.01]))
    error = read(device, ranges).measured - ranges
    # 500 draws: five times the 3.2 % of their standard deviation
    assert error[:500].std() == pytest.approx(0.01, rel=0.16)
    assert error[500:].std() == pytest.approx(0.04, rel=0.16)


def test_the_same_stream_gives_the_same_noise():
    device = three(noise_density=np.ones(3), bias_instability=np.ones(3))
    first, again, other = (read(device, seed=seed).measured for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.allclose(first, other)


# --- many devices ---------------------------------------------------------------------------------


def test_many_devices_are_each_as_if_alone():
    devices = [
        three(
            offset=np.array([o, 0.0, -o]), sensitivity=(1 + o) * np.eye(3), rate_Hz=200.0,
            rate_error=o / 10, bandwidth_Hz=50.0, full_scale=1.2, mounting_wxyz=(0.8, 0.0, o, 0.6),
        )
        for o in (0.0, 0.1, 0.2)
    ]  # fmt: skip
    together = measured_by(devices, TIME, WAVES, stream(1))
    for i, device in enumerate(devices):
        alone = read(device)
        count = together.time_s.shape[1]
        assert together.time_s[i] == pytest.approx(alone.time_s[:count])
        assert together.measured[i] == pytest.approx(alone.measured[:count], abs=1e-12)
        assert np.array_equal(together.saturated[i], alone.saturated[:count])


def test_noise_of_devices_is_independent():
    found = measured_by([three(noise_density=np.ones(3))] * 300, TIME, NONE, stream(1)).measured
    rows = found.transpose(0, 2, 1).reshape(900, -1)
    between = np.corrcoef(rows)[np.triu_indices(900, 1)]
    # correlation of 1001 independent numbers: 1/√1001 = 0.032
    assert between.std() == pytest.approx(0.0316, rel=0.02)


# --- what cannot be -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("terms", "said"),
    [
        ({"rate_Hz": 100.0, "bandwidth_Hz": 51.0}, "above Nyquist's 50 Hz, half of its rate"),
        ({"bandwidth_Hz": 501.0}, "above Nyquist's 500 Hz, half of the rate of the signal"),
        ({"noise_density": np.array([1.0, -1.0, 1.0])}, "noise_density is -1; expected 0 or more"),
        ({"jitter_s": -1.0}, "jitter_s is -1"),
        ({"jitter_s": 0.001}, "jitter 0.001 s would let samples change places; expected at most"),
        ({"temperature_C": -400.0}, "temperature -400 °C; expected -100 to 250"),
        ({"rate_error": -1.0}, "rate_error is -1; expected more than -1"),
        (
            {"bandwidth_Hz": 0.05, "poles": 2},
            "bandwidth 0.05 Hz is too low to be calculated at 1000",
        ),
        ({"poles": 5}, "5 poles; expected 1 to 4"),
        ({"nonlinearity": np.ones(3)}, "give full_scale"),
        ({"rate_Hz": 1e9}, "1e+09 samples; expected at most 5e+07 in all"),
        ({"rate_Hz": 0.5}, "it samples 0.5 times a second and the signal lasts 1 s: one sample"),
    ],
)
def test_impossible_devices_are_refused(terms, said):
    with pytest.raises(InputError, match="sensor imu") as error:
        read(three(**terms))
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("terms", "said"),
    [
        ({"random_walk": np.array([0.0, 0.0, -2.0])}, "random_walk is -2; expected 0 or more"),
        ({"nonlinearity": np.ones(3)}, "give full_scale"),
        ({"rate_Hz": 100.0}, "devices differ in axes, rate, bandwidth"),
    ],
)
def test_one_impossible_device_of_many_is_refused(terms, said):
    with pytest.raises(InputError, match=said):
        measured_by([three(), three(), three(**terms)], TIME, WAVES, stream(1))


def test_half_of_the_rate_is_a_possible_bandwidth():
    assert len(read(three(rate_Hz=100.0, bandwidth_Hz=50.0)).measured) == 101


def test_all_faults_at_once():
    with pytest.raises(InputError, match="3 faults"):
        read(three(rate_Hz=-1.0, poles=0), WAVES[:, 0])
