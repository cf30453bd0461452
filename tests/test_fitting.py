"""``simcompare fit``: engines fitted to bounces whose truth is known, because they were made up."""

import json
import shlex

import numpy as np
import pytest

import simcompare
from simcompare.errors import InputError, UnknownName
from simcompare.fitting.bounces import bounce_models
from simcompare.reports.run import remarks
from simcompare.results.fit_file import read

E, HEIGHT_M, U_S = 0.85, 1.0, 1e-4


def stopwatch(path, seed=0, hits=7, e=E, height_m=HEIGHT_M):
    """A log of impact times as a bounce table has them, with their noise."""
    shown = bounce_models.bounces(
        bounce_models.MODELS["constant"],
        {"restitution": e, "drop_height_m": height_m, "release_time_s": 0.0}, hits,
    )  # fmt: skip
    times = shown.impact_s + np.random.default_rng(seed).normal(0, U_S, hits)
    rows = "".join(f"{k},{t:.7f},{U_S}\n" for k, t in enumerate(times, start=1))
    path.write_text(f"# title: made up\nbounce,impact_time_s,u_impact_time_s\n{rows}")
    return path


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    place = tmp_path_factory.mktemp("fit")
    drop = stopwatch(place / "drop.csv")
    held = stopwatch(place / "held.csv", seed=7, height_m=0.7)
    return simcompare.fit("ball", recordings=[drop], hold_out=[held], assist="all", out=place)


def test_every_engine_gets_its_parameter_and_shows_the_measured_restitution(found):
    record = found.record.fit
    ran = [source for source in record.sources if source.status == "ok"]
    assert len(ran) >= 3
    for source in ran:
        parameter = source.parameters["restitution"]
        # the limits asked for: 0.2 %, and 0.3 % for a contact that is a spring
        assert abs(parameter.value / E - 1) < 0.002, source.name
        assert abs(parameter.value - E) < 4 * parameter.u
        assert source.simulations <= 8
    shown = [source.effective["restitution"].value for source in ran]
    assert (max(shown) - min(shown)) / E < 0.001


def test_what_is_left_is_the_noise(found):
    for source in found.record.fit.sources:
        if source.status == "ok":
            assert np.std(source.left_s[0]) < 2 * U_S, source.name


def test_a_held_out_drop_from_another_height_is_predicted(found):
    (row,) = found.record.fit.holdout.drops
    assert abs(row.e_n) <= 1
    for source in found.record.fit.sources:
        if source.status == "ok":
            assert abs(source.holdout[0].e_n) <= 1


def test_without_a_held_out_drop_nothing_was_validated(tmp_path):
    drop = stopwatch(tmp_path / "drop.csv")
    record = simcompare.fit("ball", recordings=[drop], engine="pymunk").record.fit
    assert any("so the fit was not tested" in text for text in record.sentences)


def test_a_fit_is_used_again_and_its_range_is_watched(found):
    place = str(found.folder / "fit.json")
    fitted = read(found.folder / "fit.json")
    again = simcompare.run("ball", engine="pymunk", contact=place, seeds=3)
    score = next(s for s in again.record.scores if s.measure == "restitution" and s.index is None)
    assert score.contact == "fitted"
    assert score.value == pytest.approx(E, rel=1e-3)
    assert again.record.parameters["restitution"] == pytest.approx(fitted.closed["restitution"])
    assert again.record.cautions == ()
    high = simcompare.run("ball", engine="pymunk", contact=place, seeds=1, set={"drop_height": 3})
    (caution,) = high.record.cautions
    assert "the fit saw" in caution
    assert f"Caution: {caution}." in remarks.remarks(high)
    assert not caution.endswith(".")
    with pytest.raises(InputError, match="is a fit of ball, not of robot"):
        simcompare.run("robot", engine="pymunk", contact=place)


def test_an_engine_that_was_not_fitted_is_not_shown_as_fitted(found):
    place = str(found.folder)
    run = simcompare.run("ball", engine="pymunk,mujoco:rk4", contact=f"tuned,{place}", seeds=1)
    told = {(row.name, row.contact): (row.status, row.reason) for row in run.record.sources}
    assert told["mujoco:rk4", "fitted"] == ("unsupported", "mujoco:rk4: not in this fit")
    assert told["mujoco:rk4", "tuned"][0] == told["pymunk", "fitted"][0] == "ok"
    assert run.exit_code == 0
    alone = simcompare.run("ball", engine="mujoco:rk4", contact=place, seeds=1)
    assert alone.exit_code == 2, "an engine of the fit would run"


def test_the_command_to_use_a_fit_again_is_the_scene_that_was_fitted(call, tmp_path):
    drop = str(stopwatch(tmp_path / "drop.csv"))
    out = str(tmp_path / "runs")
    words = ["fit", "ball", "--recording", drop, "--engine", "pymunk", "--no-report", "--out", out]
    _, shown, _ = call(*words)
    (line,) = [one for one in shown.splitlines() if one.startswith("Use it again: simcompare ")]
    again = shlex.split(line)[4:]
    code, text, _ = call(*again, "--no-report", "--seeds", "1", "--out", out, "--json")
    run = json.loads(text)
    assert code == 0
    assert [row["name"] for row in run["sources"]] == ["pymunk"]
    assert run["parameters"]["drop_height_m"] == pytest.approx(HEIGHT_M, rel=1e-2)
    assert not run["cautions"]


def test_a_fit_is_exported(found):
    place = str(found.folder)
    text = simcompare.export("ball", format="sdf", fit=place)
    closed = read(found.folder / "fit.json").closed["restitution"]
    assert f"{closed}" in text


def test_the_command_prints_json_with_the_names_of_the_contract(call, tmp_path):
    drop = stopwatch(tmp_path / "drop.csv")
    code, out, err = call(
        "fit", "ball", "-r", drop, "--engine", "pymunk", "--json", "--no-report",
        "-o", tmp_path / "runs", "--prior", "drop_height=1m:2mm",
    )  # fmt: skip
    assert code == 0, err
    (source,) = json.loads(out)["sources"]
    assert set(source["parameters"]["restitution"]) >= {"value", "u", "interval95", "unit"}
    for name in ("correlation", "effective", "simulations", "wall_s", "identifiable", "holdout"):
        assert name in source


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--prior", "drop_height=1m"], "no uncertainty"),
        (["--prior", "colour=1:2"], "colour"),
        (["--model", "magic"], "bounce model"),
        (["--unknown", "colour"], "colour"),
        (["--hold-out", "nowhere.wav"], "nowhere.wav"),
        (["--assist", "magic"], "no help is called 'magic'"),
        (["--assist", "all,none"], "stands alone"),
        (["--step", "0"], "is not a time above 0"),
        (["--step", "1ns"], "is too short for 4.105 s"),
        (["--step", "3s"], "is too long for 4.105 s; use 420 ns to 41 ms, such as 3ms"),
    ],
)
def test_bad_requests_are_one_clear_sentence(call, tmp_path, words, message):
    drop = stopwatch(tmp_path / "drop.csv")
    code, _, err = call("fit", "ball", "-r", drop, "--engine", "pymunk", "--no-report", *words)
    assert code == 2, err
    assert message in err
    assert "Traceback" not in err


def test_too_few_bounces_are_told(tmp_path):
    with pytest.raises(InputError, match=r"record more|too few|at least|three impacts"):
        simcompare.fit("ball", recordings=[stopwatch(tmp_path / "a.csv", hits=2)], engine="pymunk")


def test_a_scenario_that_cannot_be_fitted_says_so(tmp_path):
    with pytest.raises((InputError, UnknownName), match="fit"):
        simcompare.fit("robot", recordings=[stopwatch(tmp_path / "a.csv")], engine="pymunk")
