"""What the recording of a real pendulum tells: its period, its friction, and what they rest on."""

import math
import os
from pathlib import Path

import numpy as np
import pytest

from simcompare.hardware.recordings import registry
from simcompare.inference import plan as plans
from simcompare.inference import sources
from simcompare.measures import Request, _swings, swing_decay, swing_period
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue

FILE = "pendulum_free_swing/{}PendulumDataForParameterEstimation.mat"
REQUEST = Request(
    Probe(observe="angle", component=None, label="Angle", unit="rad"),
    {},
    {"level": 0.0, "band": 0.02},
)
#: small-angle period that is published with the file, and its scatter from swing to swing [s]
PUBLISHED_S, SCATTER_S = 0.7843, 0.0006


def pieces(which):
    """Time and states of all pieces, in their order; angles from hanging."""
    folder = os.environ.get("SIMCOMPARE_DATA")
    if not folder or not (Path(folder) / FILE.format(which)).is_file():
        pytest.skip("SIMCOMPARE_DATA names no folder with the recording pendulum_free_swing")
    from scipy.io import loadmat

    found = loadmat(Path(folder) / FILE.format(which))
    cells = [
        (np.asarray(t, dtype=float).ravel(), np.array(y, dtype=float))
        for part in ("id", "vad")
        for t, y in zip(found[f"Time_{part}"].ravel(), found[f"Y_{part}"].ravel(), strict=True)
    ]
    for _, states in cells:
        states[: len(states) // 2] -= math.pi
    return cells


def whole():
    cells = pieces("Single")
    return np.concatenate([t for t, _ in cells]), np.concatenate([y[0] for _, y in cells])


def measured(function, time_s, angle):
    return function.measure(Trajectory("log", time_s, {"angle": angle}), REQUEST)


def test_the_small_angle_period_agrees_with_the_published_one():
    found = measured(swing_period, *whole())
    assert len(found.series["period"]) == 131
    value = found.values["small_angle_period"]
    assert value == pytest.approx(0.78495, abs=0.00005)
    assert found.values["period_scatter"] < SCATTER_S / 2
    # E_n with the scatters as standard uncertainties, k = 2
    combined = 2 * math.hypot(SCATTER_S, found.values["period_scatter"])
    assert abs(value - PUBLISHED_S) <= combined


def test_the_published_period_is_corrected_by_the_amplitude_at_the_beginning():
    # the larger of two amplitudes lengthens too much: that is the difference of 0.6 ms
    swings = _swings.find(*whole(), 0.0, 0.02)
    up = np.flatnonzero(swings.upward[:-2])
    period = swings.passage_s[up + 2] - swings.passage_s[up]
    small = period / _swings.lengthening(swings.amplitude[up])
    assert len(small) == 66
    assert small.mean() == pytest.approx(PUBLISHED_S, abs=0.00005)
    assert small.std(ddof=1) == pytest.approx(SCATTER_S, abs=0.00005)


def test_all_pieces_have_the_same_length_to_a_thousandth_and_small_swings_are_quicker():
    found = [
        measured(swing_period, t, y[0]).values["small_angle_period"] for t, y in pieces("Single")
    ]
    assert np.ptp(found) / np.mean(found) < 0.001
    # below 0.5 rad the period becomes shorter, which no constant friction explains
    assert found[5] < found[4] < found[3]


def test_the_loss_of_a_swing_shows_dry_friction_and_drag_of_the_air():
    found = measured(swing_decay, *whole())
    size, loss = found.series["mean_amplitude"], found.series["amplitude_loss_each"]
    small, middle, large = (
        float(loss[(size > a) & (size < b)].mean()) for a, b in ((0.3, 0.4), (0.4, 0.5), (1.2, 1.7))
    )
    assert small == pytest.approx(middle, rel=0.1)  # dry: the same angle each swing
    # viscous friction alone would take three times as much off swings three times as large
    assert large / small == pytest.approx(2.8, abs=0.4)


def test_both_angles_of_the_double_pendulum_count_from_the_vertical():
    # energy may only fall; with the second angle against the first arm it would jump about
    inertia, weight = (0.005648, 0.003145, 0.002775), (0.33304, 0.15761)
    smooth = np.linalg.pinv(np.vander(np.arange(-8, 9) * 1e-3, 6, increasing=True))[1]
    jumps = {}
    for name, relative in (("absolute", 0.0), ("relative", 1.0)):
        found = []
        for _, states in pieces("Double")[:12]:
            first = states[0]
            second = states[1] + relative * first
            rates = [np.convolve(a, smooth[::-1], "same")[10:-10] for a in (first, second)]
            a, b = first[10:-10], second[10:-10]
            energy = inertia[0] * rates[0] ** 2 / 2 + inertia[1] * rates[1] ** 2 / 2
            energy += inertia[2] * rates[0] * rates[1] * np.cos(a - b)
            energy -= weight[0] * np.cos(a) + weight[1] * np.cos(b)
            t = np.arange(len(energy))
            found.append(np.std(energy - np.polyval(np.polyfit(t, energy, 1), t)))
        jumps[name] = float(np.mean(found))
    assert jumps["absolute"] < jumps["relative"] / 10


@pytest.mark.parametrize("scenario", ["pendulum", "pendulum_double"])
def test_the_data_set_names_what_the_scenario_has(scenario):
    name = f"{scenario}_free_swing"
    plan = plans.choose(plans.Entries(registry.get(name).validation, name), scenario)
    assert plans.faults(plan, catalogue.load(scenario).resolve()) == {}
    assert plan.calibrate is not None
    assert not set(plan.calibrate.streams) & set(plan.streams), "judged where it was fitted"


def test_the_recording_is_imported_with_its_angles_from_hanging():
    cells = pieces("Single")
    recording = sources.find("pendulum_free_swing").recording
    assert list(recording.streams) == ["id.0", "id.1", "id.2", "id.3", "vad.0", "vad.1"]
    for (_, states), stream in zip(cells, recording.streams.values(), strict=True):
        np.testing.assert_allclose(stream.channels["angle_rad"].values, states[0], atol=1e-12)
        np.testing.assert_allclose(stream.channels["angle_rate_rad_s"].values, states[1])
