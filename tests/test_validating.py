"""Simulations against recordings whose truth is known, because they were made up."""

import json

import numpy as np
import pytest
import yaml

import simcompare
from simcompare.errors import InputError, UnknownName
from simcompare.inference.reference_model import model_of
from simcompare.scenarios import catalogue

LENGTH_M, DAMPING, NOISE_RAD = 0.25, 4e-4, 1e-3


def swing(start_rad: float, length_m: float = LENGTH_M, seed: int = 0) -> tuple:
    """Times and angles of a pendulum, measured with noise."""
    model = model_of(catalogue.load("pendulum"))
    scene = model.file.resolve(
        {"length_m": length_m, "damping_N_m_s_rad": DAMPING, "friction_N_m": 0.0,
         "start_angle_rad": start_rad, "start_rate_rad_s": 0.0, "duration_s": 6.0}
    )  # fmt: skip
    time_s = np.arange(0, 6, 0.005)
    truth = model.truth(scene, time_s)
    probe = scene.probes["angle_rad"]
    angle = truth.signals[probe.observe] + probe.offset
    return time_s, angle + np.random.default_rng(seed).normal(0, NOISE_RAD, len(time_s))


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Two swings, a log each."""
    tmp_path = tmp_path_factory.mktemp("logs")
    streams = {f"s{i}": swing(start, seed=i) for i, start in enumerate((0.9, 0.6))}
    for name, (time_s, angle) in streams.items():
        lines = [f"{t:.4f},{a:.6f}" for t, a in zip(time_s, angle, strict=True)]
        (tmp_path / f"{name}.csv").write_text("t (s),a (rad)\n" + "\n".join(lines) + "\n")
    return tmp_path


def plan(logs, start_rad: float, **more) -> str:
    tree = {
        "channels": {"angle": {"column": "a", "unit": "rad", "u": NOISE_RAD}},
        "validate": [
            {
                "scenario": "pendulum",
                "parameters": {
                    "length_m": {"value": 0.24, "u": 0.01, "source": "a ruler"},
                    "damping_N_m_s_rad": {"value": 3e-4, "u": 2e-4, "source": "a guess"},
                    "friction_N_m": {"value": 0.0, "u": 0.0, "source": "made up so"},
                    "start_angle_rad": {"value": start_rad, "u": 1e-5, "source": "made up so"},
                    "start_rate_rad_s": {"value": 0.0, "u": 1e-5, "source": "made up so"},
                },
                "compare": {"angle_rad": {"channel": "angle"}},
                **more,
            }
        ],
    }
    place = logs / f"map-{len(list(logs.iterdir()))}.yaml"
    place.write_text(yaml.safe_dump(tree))
    return str(place)


FIT = {"calibrate": {"parameters": ["length_m", "damping_N_m_s_rad"]}}


@pytest.fixture(scope="module")
def fitted(logs):
    return simcompare.validate(
        "pendulum", recording=str(logs / "s0.csv"), mapping=plan(logs, 0.9, **FIT), engine="pymunk"
    ).record.validation


def test_a_fit_finds_the_parameters_that_made_the_recording(fitted):
    rows = {row.name: row for row in fitted.parameters}
    for name, true in (("length_m", LENGTH_M), ("damping_N_m_s_rad", DAMPING)):
        assert abs(rows[name].fitted - true) < 3 * rows[name].u_fitted
    assert rows["length_m"].u_fitted < 2e-4 * LENGTH_M


def test_with_the_right_parameters_the_noise_is_all_that_is_left(fitted):
    best = next(row for row in fitted.waveforms if row.parameters == "fitted")
    assert best.rmse == pytest.approx(NOISE_RAD, rel=0.1)
    (gap,) = fitted.gaps
    assert gap.model_form < 0.5 * NOISE_RAD
    assert gap.shares.removed > 0.99
    parts = ("parameter", "cross", "model_form", "numerical", "noise", "excess")
    assert sum(getattr(gap.shares, part) for part in parts) == pytest.approx(1.0)


def test_a_fit_to_the_same_data_is_never_called_a_validation(fitted):
    assert fitted.basis == "same data"
    assert any("this is a fit, not a validation" in text for text in fitted.sentences)
    assert not any("prediction" in text for text in fitted.sentences)
    for row in fitted.values:
        assert row.words != "within the uncertainty"


def test_a_wrong_length_is_seen_as_such(logs):
    found = simcompare.validate(
        "pendulum", recording=str(logs / "s1.csv"), mapping=plan(logs, 0.6), engine="pymunk",
        set={"length": "0.26 m", "damping": DAMPING},
    ).record.validation  # fmt: skip
    assert found.basis == "known before"
    periods = [row for row in found.values if row.measure == "small_angle_period"]
    expected = 2 * np.pi * np.sqrt(0.26 / 9.80665) - 2 * np.pi * np.sqrt(LENGTH_M / 9.80665)
    assert periods[0].error == pytest.approx(expected, rel=0.02)
    assert abs(periods[0].e_n) > 1
    assert periods[0].words == "beyond the uncertainty"


def test_what_is_known_badly_is_in_the_uncertainty(logs):
    """A length known to 4 % explains a period that is 2 % off."""
    found = simcompare.validate(
        "pendulum", recording=str(logs / "s1.csv"), mapping=plan(logs, 0.6), engine="pymunk"
    ).record.validation
    (period,) = [row for row in found.values if row.measure == "small_angle_period"]
    assert period.u_input == pytest.approx(0.5 * 0.01 / 0.24 * period.simulated, rel=0.05)
    assert abs(period.e_n) < 1
    assert period.words == "within the uncertainty"


def test_every_engine_that_can_is_held_against_the_recording(logs, tmp_path):
    run = simcompare.validate(
        "pendulum", recording=str(logs / "s0.csv"), mapping=plan(logs, 0.9, **FIT), out=tmp_path
    )
    ran = [source.name for source in run.record.sources if source.status == "ok"]
    rows = run.record.validation.waveforms
    assert sorted({row.source for row in rows}) == sorted(ran)
    assert len(ran) >= 3
    stored = simcompare.load_run(run.folder)
    assert stored.record.validation == run.record.validation
    assert {one.source for one in stored.trajectories} == {*ran, "measured", "closed form"}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"compare": {"angel_rad": {"channel": "angle"}}}, "angle_rad"),
        ({"compare": {"angle_rad": {"channel": "angel"}}}, "log/angle_rad"),
        ({"inputs": {"torque": {"channel": "angle"}}}, "input of pendulum"),
        ({"streams": ["second"]}, "stream of the recording"),
        ({"window": {"start_s": 100.0}}, "the window begins at 100 s"),
        ({"window": {"duration_s": 0.03}},
         "samples in the window of 0.03 s; expected at least 10; make duration_s of window:"),
        ({"window": {"start_s": 5.97}}, "expected at least 10; make start_s of window: smaller"),
        ({"align": {"by": "correlation", "probe": "angle_rad"}}, "must not be judged"),
        ({"calibrate": {"parameters": ["lenght_m"]}}, "length_m"),
    ],
)  # fmt: skip
def test_a_plan_that_cannot_be_is_told(logs, change, message):
    with pytest.raises((InputError, UnknownName), match=message):
        simcompare.validate(
            "pendulum", recording=str(logs / "s0.csv"), mapping=plan(logs, 0.9, **change),
            engine="pymunk",
        )  # fmt: skip


def test_a_recording_without_a_plan_says_what_to_do(logs):
    with pytest.raises(InputError, match=r"mapping\s+file"):
        simcompare.validate("pendulum", recording=str(logs / "s0.csv"), engine="pymunk")
    with pytest.raises(UnknownName, match="recording"):
        simcompare.validate("pendulum", recording="no_such_thing", engine="pymunk")


def test_a_parameter_that_changes_nothing_cannot_be_fitted(logs):
    with pytest.raises(InputError, match="mass_kg changes nothing"):
        simcompare.validate(
            "pendulum", recording=str(logs / "s0.csv"), engine="pymunk",
            mapping=plan(logs, 0.9, calibrate={"parameters": ["mass_kg"]}),
            set={"damping": 0.0},
        )  # fmt: skip


def test_the_command_prints_json_and_writes_a_report(logs, call):
    code, out, err = call(
        "validate", "pendulum", "-r", logs / "s0.csv", "--map", plan(logs, 0.9),
        "--engine", "pymunk", "--json", "-o", logs / "runs",
    )  # fmt: skip
    assert code == 0, err
    assert json.loads(out)["validation"]["sentences"]
    (report,) = (logs / "runs").glob("*/report.html")
    text = report.read_text(encoding="utf-8")
    for title in ("What the gap is made of", "What is left", "The recording", "Parameters"):
        assert title in text


def test_what_a_fit_makes_up_for_is_no_uncertainty_of_the_prediction(logs):
    """A free swing tells damping over mass only: the mass adds nothing once damping is fitted."""
    tree = yaml.safe_load((logs / plan(logs, 0.9, **FIT).rpartition("/")[2]).read_text())
    tree["validate"][0]["parameters"]["mass_kg"] = {"value": 0.15, "u": 0.03, "source": "a guess"}
    place = logs / "mass.yaml"
    place.write_text(yaml.safe_dump(tree))
    found = simcompare.validate(
        "pendulum", recording=str(logs / "s0.csv"), mapping=str(place), engine="pymunk"
    ).record.validation
    (loss,) = [row for row in found.values if row.measure == "log_decrement"]
    assert loss.budget["mass_kg"] < 0.05 * 0.2 * loss.simulated


def test_a_channel_of_another_unit_is_refused(logs):
    tree = yaml.safe_load((logs / plan(logs, 0.9).rpartition("/")[2]).read_text())
    tree["channels"]["angle"]["unit"] = "mm"
    place = logs / "unit.yaml"
    place.write_text(yaml.safe_dump(tree))
    with pytest.raises(InputError, match="probe angle_rad is in rad, but channel angle in m"):
        simcompare.validate(
            "pendulum", recording=str(logs / "s0.csv"), mapping=str(place), engine="pymunk"
        )


def test_another_log_is_calibrated_on_with_the_same_plan(logs):
    fitted = {**FIT["calibrate"], "recording": str(logs / "s0.csv")}
    tree = yaml.safe_load((logs / plan(logs, 0.9, calibrate=fitted).rpartition("/")[2]).read_text())
    known = tree["validate"][0]["parameters"]
    del known["start_angle_rad"], known["start_rate_rad_s"]
    tree["validate"][0]["start"] = {
        "start_angle_rad": {"channel": "angle", "over_s": 0.1},
        "start_rate_rad_s": {"channel": "angle", "over_s": 0.1, "derivative": 1},
    }
    place = logs / "two.yaml"
    place.write_text(yaml.safe_dump(tree))
    found = simcompare.validate(
        "pendulum", recording=str(logs / "s1.csv"), mapping=str(place), engine="pymunk"
    ).record.validation
    assert found.basis == "held out"
    (length,) = [row for row in found.parameters if row.name == "length_m"]
    assert abs(length.fitted - LENGTH_M) < 3 * length.u_fitted
    assert length.u_fitted < 1e-3 * LENGTH_M
    again = simcompare.validate(
        "pendulum", recording=str(logs / "s0.csv"), mapping=str(place), engine="pymunk"
    ).record.validation
    assert again.basis == "same data"
