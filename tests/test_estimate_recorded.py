"""The verb estimate on recordings: channels play the roles, and the recorded truth judges."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import simcompare
from simcompare import cli
from simcompare.errors import InputError
from simcompare.estimation import estimators, recorded
from simcompare.hardware.recordings import registry
from simcompare.model.estimate_plan import RecordedPlan
from simcompare.model.recording import Channel, Clock, Provenance, Recording, Stream

LABYRINTH = "robot_labyrinth_exchanged"
needs_labyrinth = pytest.mark.skipif(
    registry.place(LABYRINTH) is None, reason="the recording is not on this machine"
)


@pytest.fixture(scope="module")
def found():
    return simcompare.estimate("odometry", recording=LABYRINTH)


def rms(result, way):
    one = result.done[0]
    return np.hypot(*(one.error_of(way, state).rms_error for state in ("x_m", "y_m")))


@needs_labyrinth
def test_ranges_mend_the_place_of_a_real_robot(found):
    # dead reckoning strays by 20 cm; the true place itself jumps by 4.4 mm
    assert rms(found, "filtered") < rms(found, "wheels alone") / 2
    assert rms(found, "smoothed") < rms(found, "filtered")
    assert rms(found, "smoothed") < 0.05


@needs_labyrinth
def test_the_true_place_says_that_the_filter_knows_its_error(found):
    assert found.done[0].nees.outcome == "consistent"
    assert "The filter errs as much as it says: NEES" in "\n".join(found.sentences)


@needs_labyrinth
def test_the_bias_of_real_ranges_is_found(found):
    bias = found.done[0].numbers["last_range_bias_m"]
    # seven to ten centimetres, many of its uncertainties: no noise
    assert 0.05 < bias.value < 0.15
    assert bias.value > 5 * bias.u


@needs_labyrinth
def test_without_that_bias_the_true_place_tells_and_the_cure_works_as_it_is_printed(tmp_path):
    without = simcompare.estimate("odometry", recording=LABYRINTH, options={"range_bias": 0})
    assert without.done[0].nees.outcome in ("too sure", "diverged")
    cure = next(one for one in without.sentences if "make it a state: " in one)
    _, *words = cure.partition("state: ")[2].split()
    assert words == ["estimate", "odometry", "--recording", LABYRINTH, "--option", "range_bias=1"]
    cli.register()
    done = CliRunner().invoke(cli.app, [*words, "--json", "--no-report", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert json.loads(done.output)["sources"][0]["nees"]["outcome"] == "consistent"


@needs_labyrinth
def test_a_log_read_as_it_is_wrongly_documented_makes_the_filter_diverge():
    wrong = simcompare.estimate("odometry", recording="robot_labyrinth")
    text = "\n".join(wrong.sentences)
    assert "The filter has diverged" in text
    assert "Many readings of range do not fit the motion: a number of the model, or what" in text


@needs_labyrinth
@pytest.mark.parametrize(
    ("given", "told"),
    [
        (
            {"scenario": "ball"},
            "nothing is estimated of it for ball .prepared: odometry",
        ),
        ({"estimator": "speed_filter"}, "nothing is estimated of it for odometry by speed_filter"),
        ({"sensors": "imu=mpu6050"}, "a recording has sensors of its own"),
        ({"set": {"a": 1}}, "set is of a simulation, and a recording has none"),
        ({"step": "1ms"}, "step is of a simulation, and a recording has none"),
        ({"options": {"track": -1}}, "track_m = -1 is not within"),
    ],
)
def test_what_a_recording_is_not_prepared_for_is_said(given, told):
    arguments = {"scenario": "odometry", "recording": LABYRINTH, **given}
    with pytest.raises(InputError, match=told):
        simcompare.estimate(arguments.pop("scenario"), **arguments)


def recording():
    """Two streams on one clock, the second half a second later."""
    times = np.arange(0.0, 2.0, 0.1)
    rates = {"left_rate_rad_s": Channel(times, "rad/s", u=0.1)}
    ranges = {"range_m": Channel(times + 1, "m", u=np.full(20, 0.2))}
    streams = {
        "wheels": Stream(times, rates, Clock("t", first_s=100.0)),
        "radio": Stream(times, ranges, Clock("t", first_s=100.5)),
    }
    return Recording(streams, Provenance("log", "", 0, "csv", "", "repair"))


def given(signals, **more):
    tree = {"scenario": "s", "estimator": "pose_filter", "signals": signals, **more}
    plan = RecordedPlan.model_validate(tree)
    return recorded.given_of(recording(), plan, estimators.load("pose_filter"), "log")


def test_streams_share_the_clock_of_the_log():
    found = given(
        {"left_rate": {"channel": "left_rate", "scale": 2.0}, "range": {"channel": "range"}},
        start_s=1.0,
        duration_s=0.5,
    )
    rate, far = found.signals["left_rate"], found.signals["range"]
    assert rate.time_s[[0, -1]] == pytest.approx([101.0, 101.5])
    assert rate.values[0] == pytest.approx(2.0)
    assert rate.u == pytest.approx(0.2)
    # what the second stream read at the same time was half a second into it
    assert far.values[0] == pytest.approx(1.5)
    assert far.u == pytest.approx(0.2)


def test_channels_of_several_streams_are_put_in_order_of_time():
    both = {"channel": ["radio/range", "wheels/left_rate"], "scale": 1.5}
    found = given({"range": both}).signals["range"]
    assert len(found.time_s) == 40
    assert np.all(np.diff(found.time_s) >= 0)


def test_every_fault_of_the_channels_is_told():
    with pytest.raises(InputError) as told:
        given(
            {
                "left_rate": {"channel": "left_rte"},
                "right_rate": {"channel": "range"},
                "rnge": {"channel": "range"},
            }
        )
    text = str(told.value)
    for part in (
        "left_rate: no channel is called 'left_rte'",
        "right_rate: range: is in m; expected rate of the right wheel",
        "no role of the estimator is called 'rnge'; did you mean range",
    ):
        assert part in text


def test_a_window_without_samples_is_told():
    with pytest.raises(InputError, match="has 0 samples in this part of the recording"):
        given({"left_rate": {"channel": "left_rate"}}, start_s=50.0)


def told_of(name, **options):
    if registry.place(name) is None:
        pytest.skip(f"{name} is not on this machine")
    found = simcompare.estimate(
        "odometry", recording=name, estimator="odometry", options=options or None
    )
    return [one for one in found.sentences if "suspected" in one]


def test_recordings_that_are_as_they_say_are_not_suspected():
    assert told_of("odometry_plaza") == []
    assert told_of("robot_labyrinth_exchanged") == []


def test_a_heading_that_is_half_a_turn_off_is_suspected_and_the_cure_works():
    (told,) = told_of("odometry_plaza", start_heading_rad=1.0808)
    assert "With the heading turned by half a turn" in told
    assert "Nothing was changed" in told
    name, value = told.split("--option ")[1].rstrip(".").split("=")
    assert told_of("odometry_plaza", **{name: float(value)}) == []


def test_a_track_that_is_half_the_true_one_is_suspected_and_the_cure_works():
    (told,) = told_of("robot_labyrinth_exchanged", track_m=0.0785)
    assert "twice the track, 0.157 m," in told
    assert told.endswith("to try it, add --option track_m=0.157.")


def test_what_was_told_of_a_log_already_is_not_told_twice():
    assert told_of("robot_labyrinth") == []
