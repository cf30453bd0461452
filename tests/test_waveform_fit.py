"""Parameters from signals over time: the truth comes back on every engine; what cannot is told."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
import yaml

from simcompare.engine import engines
from simcompare.errors import InputError, UnknownName
from simcompare.inference.reference_model import model_of
from simcompare.model import recording_store
from simcompare.model.plain import of_plain, plain
from simcompare.model.recording import Channel, Clock, Provenance, Recording, Stream
from simcompare.results.records.fit_waveforms import WaveformFit
from simcompare.scenarios import catalogue
from simcompare.verbs import fit
from tests.present import INSTALLED


def known(value, u):
    return {"value": value, "u": u, "source": "made up so"}


def measured(scenario, values, noise, *, rate_Hz=200.0, seed=0):
    """Channels of a reference with noise, sampled where no engine's step is."""
    model = model_of(catalogue.load(scenario))
    scene = model.file.resolve(values)
    time_s = np.arange(0.0, scene.world.duration_s, 1 / rate_Hz)
    truth = model.truth(scene, time_s)
    generator = np.random.default_rng(seed)
    found = {}
    for probe, u in noise.items():
        wanted = scene.probes[probe]
        signal = truth.signals[wanted.observe]
        signal = signal if wanted.component is None else signal[:, wanted.component]
        signal = signal + wanted.offset + generator.normal(0, u, len(time_s))
        found[probe] = Channel(signal, units_of(probe), u=u)
    return Stream(time_s, found, Clock("device"))


def units_of(name):
    from simcompare import units

    return units.unit_of(name)


def stored(folder, streams):
    about = Provenance("made up", "0" * 64, 0, "test", "0", "strict")
    return str(recording_store.save(Recording(streams, about), folder))


def mapping(folder, scenario, noise, parameters, **more):
    entry = {
        "scenario": scenario,
        "parameters": {name: known(*value) for name, value in parameters.items()},
        "compare": {probe: {"channel": probe} for probe in noise},
        **more,
    }
    path = folder / "plan.yaml"
    path.write_text(yaml.safe_dump({"validate": [entry]}), encoding="utf-8")
    return path


SWING = {"length_m": 0.25, "damping_N_m_s_rad": 4e-4, "friction_N_m": 6e-4, "duration_s": 4.0}
STARTS = {"a": 1.2, "b": 0.9, "c": 0.6, "d": 1.0}
ANGLE = {"angle_rad": 1e-3}


@pytest.fixture(scope="module")
def swings(tmp_path_factory):
    """Four swings of one pendulum; the last is held out."""
    folder = tmp_path_factory.mktemp("swings")
    streams = {
        name: measured("pendulum", {**SWING, "start_angle_rad": start}, ANGLE, seed=i)
        for i, (name, start) in enumerate(STARTS.items())
    }
    start = {
        "start_angle_rad": {"channel": "angle", "over_s": 0.05},
        "start_rate_rad_s": {"channel": "angle", "derivative": 1, "over_s": 0.1},
    }
    plan = mapping(
        folder, "pendulum", ANGLE, {"length_m": (0.24, 0.02), "mass_kg": (0.15, 0.0)},
        start=start, streams=["d"],
        calibrate={"streams": ["a", "b", "c"],
                   "parameters": ["length_m", "damping_N_m_s_rad", "friction_N_m"]},
    )  # fmt: skip
    return stored(folder / "swings", streams), plan


@pytest.fixture(scope="module")
def swing_fit(swings):
    recording, plan = swings
    return fit.fit("pendulum", recordings=[recording], mapping=plan)


def good(run):
    found = [row for row in run.record.fit.sources if row.status == "ok"]
    assert {row.name for row in found} >= set(INSTALLED)
    return found


def near(parameters, truth, times=3.0):
    for name, row in parameters.items():
        assert row.u > 0
        assert abs(row.value - truth[name]) <= times * row.u, name


def test_the_truth_comes_back_within_its_uncertainty_on_every_engine(swing_fit):
    record = swing_fit.record.fit
    near(record.closed_form.parameters, SWING)
    for source in good(swing_fit):
        near(source.parameters, SWING)
        # and is known well: a uselessly large uncertainty would pass as well
        assert source.parameters["length_m"].u < 2e-4 * SWING["length_m"]
        assert source.parameters["damping_N_m_s_rad"].u < 0.1 * SWING["damping_N_m_s_rad"]


def rounded(source, double, single):
    """A bound in u for engines of double, and of single precision (measured: 0.18 there)."""
    return double if engines.get(source.name).traits.precision < 1e-9 else single


def test_engines_show_the_same_with_parameters_of_their_own(swing_fit):
    closed = swing_fit.record.fit.closed_form.parameters
    for source in good(swing_fit):
        for name, row in closed.items():
            effective = source.effective[name].value
            assert abs(effective - row.value) <= rounded(source, 0.05, 0.3) * row.u
        period = source.effective["small_angle_period"]
        assert period.value == pytest.approx(period.measured, rel=2e-4)


def test_another_round_would_change_nothing(swing_fit):
    for source in good(swing_fit):
        for name, change in source.change.items():
            allowed = rounded(source, 0.01, 0.3)
            assert abs(change) <= allowed * source.parameters[name].u, source.name


def test_a_stream_that_was_not_fitted_is_predicted(swing_fit):
    record = swing_fit.record.fit
    assert [case.stream for case in record.measured] == ["a", "b", "c"]
    assert [row.stream for row in record.holdout.streams] == ["d"]
    for source in good(swing_fit):
        (row,) = source.holdout
        # its start is read off it, to a few thousandths, and everything else was fitted elsewhere
        assert 1e-3 * 0.8 < row.rms["angle_rad"] < 6e-3
        scores = {value.measure: value.e_n for value in row.values}
        assert {"small_angle_period", "log_decrement"} <= set(scores)
        assert all(abs(score) < 1.5 for score in scores.values() if score is not None)


def test_the_record_is_plain_and_says_how_far_it_holds(swing_fit):
    record = swing_fit.record.fit
    assert of_plain(WaveformFit, json.loads(json.dumps(plain(record)))) == record
    assert record.by == "waveform"
    assert record.valid.step_s == 0.001
    low, high = record.valid.ranges["angle_rad"]
    assert low == pytest.approx(-1.1, abs=0.1)
    assert high == pytest.approx(1.2, abs=0.05)
    assert np.shape(record.closed_form.correlation) == (3, 3)
    segments = {one.segment for one in swing_fit.trajectories if one.source == "measured"}
    assert segments == {0, 1, 2, 3}


def test_what_was_known_before_is_in_the_uncertainty(tmp_path):
    # friction over mass is all that a swing tells: 10 % of the mass are 10 % of the friction
    truth = {**SWING, "friction_N_m": 0.0, "start_angle_rad": 1.0}
    path = stored(tmp_path / "log", {"a": measured("pendulum", truth, ANGLE)})
    known_ = {"mass_kg": (0.15, 0.015), "start_angle_rad": (1.0, 0.0), "friction_N_m": (0.0, 0.0)}
    plan = mapping(tmp_path, "pendulum", ANGLE, known_)
    run = fit.fit(
        "pendulum", recordings=[path], mapping=plan, engine="mujoco",
        unknowns=["length", "damping"],
    )  # fmt: skip
    row = run.record.fit.closed_form.parameters["damping_N_m_s_rad"]
    assert row.u_known / row.value == pytest.approx(0.1, rel=0.02)
    assert row.u == pytest.approx(np.hypot(row.u_data, row.u_known))
    assert run.record.fit.closed_form.parameters["length_m"].u_known < 1e-6
    said = " ".join(run.record.fit.sentences)
    assert "Most of the uncertainty of the damping comes from that of the mass." in said
    assert "so the fit was not tested" in said


MOTOR = {
    "torque_constant_N_m_A": 0.03, "resistance_Ohm": 2.0, "inertia_kg_m2": 1e-4,
    "friction_N_m": 0.004, "damping_N_m_s_rad": 1e-5, "start_rate_rad_s": 0.0,
}  # fmt: skip


def motor(tmp_path, noise, **given):
    path = stored(tmp_path / "log", {"a": measured("motor_step", {**MOTOR, **given}, noise)})
    known_ = {name: (1.1 * MOTOR[name], 0.3 * MOTOR[name]) for name in list(MOTOR)[:4]}
    return path, mapping(tmp_path, "motor_step", noise, known_)


def test_rate_and_current_tell_every_constant_of_a_motor(tmp_path):
    path, plan = motor(tmp_path, {"rate_rad_s": 0.5, "current_A": 0.01})
    run = fit.fit("motor_step", recordings=[path], mapping=plan)
    record = run.record.fit
    near(record.closed_form.parameters, MOTOR)
    assert len(record.closed_form.names) == 5
    for source in good(run):
        assert source.identifiable
        near(source.parameters, MOTOR)
        assert source.parameters["resistance_Ohm"].u < 0.01 * MOTOR["resistance_Ohm"]


def test_the_rate_alone_does_not_tell_resistance_and_torque_constant(tmp_path):
    path, plan = motor(tmp_path, {"rate_rad_s": 0.5})
    run = fit.fit("motor_step", recordings=[path], mapping=plan, engine="mujoco")
    record = run.record.fit
    assert not record.sources[0].identifiable
    assert "cannot separate" in " ".join(record.sentences) or "nothing in the data" in " ".join(
        record.sentences
    )
    # with the resistance given the others are told
    run = fit.fit(
        "motor_step", recordings=[path], mapping=plan, engine="mujoco",
        set={"resistance": "2ohm", "damping": "1e-5"},
    )  # fmt: skip
    assert run.record.fit.sources[0].identifiable
    near(run.record.fit.sources[0].parameters, MOTOR)


def test_one_voltage_does_not_tell_dry_from_viscous_friction(tmp_path):
    path, plan = motor(tmp_path, {"rate_rad_s": 0.5, "current_A": 0.01}, second_voltage_V=12.0)
    run = fit.fit(
        "motor_step", recordings=[path], mapping=plan, engine="mujoco",
        set={"second_voltage": "12V"},
    )  # fmt: skip
    u = {name: row.u / row.value
         for name, row in run.record.fit.closed_form.parameters.items()}  # fmt: skip
    assert u["torque_constant_N_m_A"] < 0.01
    assert u["damping_N_m_s_rad"] > 0.1


BLOCK = {"friction": 0.3, "start_speed_m_s": 1.5}


def test_friction_comes_back_from_a_sliding_block(tmp_path):
    noise = {"position_m": 3e-4}
    paths = [
        stored(tmp_path / f"log{speed}", {"log": measured(
            "sliding_block", {**BLOCK, "start_speed_m_s": speed}, noise, rate_Hz=240.0)})
        for speed in (1.5, 1.2)
    ]  # fmt: skip
    plan = mapping(tmp_path, "sliding_block", noise, {})
    run = fit.fit("sliding_block", recordings=[paths[0]], mapping=plan)
    near(run.record.fit.closed_form.parameters, BLOCK)
    for source in good(run):
        near(source.parameters, BLOCK)
        assert source.parameters["friction"].u < 0.01 * BLOCK["friction"]
    assert "Nothing was kept back" in run.record.fit.chosen_words[0]


def test_a_recording_of_another_scenario_is_refused(swings):
    recording, plan = swings
    with pytest.raises(InputError, match=r"not prepared for the scenario sliding_block"):
        fit.fit("sliding_block", recordings=[recording], mapping=plan)


def test_an_unknown_parameter_is_refused_with_those_that_exist(swings):
    recording, plan = swings
    with pytest.raises(UnknownName, match=r"length_m"):
        fit.fit("pendulum", recordings=[recording], mapping=plan, unknowns=["lenght"])


def test_a_parameter_that_nothing_tells_is_refused(tmp_path):
    # at rest below the static friction nothing moves, whatever the friction is
    values = {"incline_rad": 0.1, "start_speed_m_s": 0.0}
    noise = {"position_m": 3e-4}
    path = stored(tmp_path / "log", {"log": measured("sliding_block", values, noise)})
    known_ = {"incline_rad": (0.1, 0.0), "start_speed_m_s": (0.0, 0.0)}
    plan = mapping(tmp_path, "sliding_block", noise, known_)
    with pytest.raises(InputError, match="friction changes nothing that was measured"):
        fit.fit("sliding_block", recordings=[path], mapping=plan, unknowns=["friction"])


def test_options_of_bounces_are_refused(swings):
    recording, plan = swings
    with pytest.raises(InputError, match="priors: pendulum is fitted"):
        fit.fit("pendulum", recordings=[recording], mapping=plan, priors={"length_m": (0.2, 0.1)})


def test_nothing_left_to_fit_is_refused(swings):
    recording, plan = swings
    every = {name: str(SWING[name]) for name in ("length_m", "damping_N_m_s_rad", "friction_N_m")}
    with pytest.raises(InputError, match="nothing is left to fit"):
        fit.fit("pendulum", recordings=[recording], mapping=plan, set=every)


def test_an_engine_that_fails_leaves_the_others(swings):
    recording, plan = swings
    run = fit.fit(
        "pendulum", recordings=[recording], mapping=plan, engine="mujoco,pymunk",
        time_limit_s=1e-3,
    )  # fmt: skip
    record = run.record.fit
    assert {row.status for row in record.sources} != {"ok"}
    assert all(row.reason for row in record.sources if row.status != "ok")
    near(record.closed_form.parameters, SWING)


def test_the_command_prints_parameters_and_what_was_held_out(swings, tmp_path, call, monkeypatch):
    recording, plan = swings
    monkeypatch.setenv("COLUMNS", "200")
    words = ["fit", "pendulum", "-r", recording, "--map", str(plan), "--engine", "mujoco"]
    code, out, err = call(*words, "-o", tmp_path / "runs")
    assert code == 0, err
    said = " ".join(out.split())
    assert "length (m)" in said
    assert "Kept back to test the fit: d." in said
    assert "In 1 segment that was not fitted, the engines are off by" in said
    assert "Held out" not in said
    (written,) = (tmp_path / "runs").glob("*/fit.json")
    assert json.loads(written.read_text())["by"] == "waveform"
    page = written.with_name("report.html").read_text(encoding="utf-8")
    assert "What engines then show" in page
    assert "Values of the segments that were held out" in page
    assert "simcompare fit pendulum --engine" in page


def test_json_has_the_record(swings, tmp_path, call):
    recording, plan = swings
    words = ["fit", "pendulum", "-r", recording, "--map", str(plan), "--engine", "mujoco"]
    code, out, err = call(*words, "-o", tmp_path / "runs", "--json", "--no-report")
    assert code == 0, err
    record = json.loads(out)
    assert set(record["sources"][0]["parameters"]) == set(record["closed_form"]["parameters"])
    assert Path(record["run"]).is_dir()


@pytest.mark.skipif(not os.environ.get("SIMCOMPARE_DATA"), reason="SIMCOMPARE_DATA is not set")
def test_the_real_free_swing_gives_its_length_and_shows_that_the_period_drifts():
    run = fit.fit("pendulum", recordings=["pendulum_free_swing"], engine="mujoco")
    record = run.record.fit
    length = record.closed_form.parameters["length_m"]
    assert length.value == pytest.approx(0.15314, abs=3e-5)
    assert length.u < 5e-5
    (source,) = good_of(record)
    assert abs(source.parameters["length_m"].value - length.value) < 1e-5
    # what the README of the scenario says: dry and viscous friction alone are 6 to 25 mrad off
    assert 0.005 < source.holdout[0].rms["angle_rad"] < 0.012
    scores = {v.measure: v.e_n for v in source.holdout[1].values}
    assert scores["small_angle_period"] > 1


def good_of(record):
    return [row for row in record.sources if row.status == "ok"]
