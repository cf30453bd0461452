"""What the lab says of a recording, and what it fits to it."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys

import numpy as np
import pytest
import yaml

from simcompare.errors import InputError
from simcompare.lab import faults, recordings
from simcompare.lab.envelope import envelope
from simcompare.lab.refusals import say
from simcompare.lab.work import perform
from tests.lab_sounds import ball, music, silence, speech, together, write

pytest.importorskip("soundfile")
HEIGHT_M, RESTITUTION, RADIUS_M = 0.4, 0.8, 0.02


def came(folder, sound, **more):
    return recordings.received(write(folder / "source.wav", sound, **more), "sound")


@pytest.mark.parametrize("subtype", ["PCM_16", "FLOAT"])
def test_ball_is_heard_with_its_impacts_and_restitution(tmp_path, subtype) -> None:
    found = came(tmp_path, ball(HEIGHT_M, RESTITUTION), subtype=subtype)
    assert found["rate_hz"] == 48000
    assert found["notes"] == []
    assert len(found["impacts"]) == 8
    assert all(0 < one["u_s"] < 1e-3 for one in found["impacts"])
    # clicks whose beginning is known to a hundredth of a millisecond, flights of 0.1 to 0.5 s
    assert found["drop"]["middle"] == pytest.approx(RESTITUTION, rel=1e-3)
    assert found["drop"]["drop_height_m"] == pytest.approx(HEIGHT_M, rel=4e-3)
    assert found["drop"]["begin_s"] == pytest.approx(0.2, abs=2e-3)
    assert len(found["wave"]["t"]) <= 2000
    json.dumps(found, allow_nan=False)


@pytest.mark.parametrize(
    ("sound", "said"),
    [
        (silence(), "This is silence"),
        (speech(), "No impact of a ball is heard"),
        (music(), "is there music, a voice or a second ball"),
        (ball(count=1), "1 impact was found"),
        (together(ball(seed=1), ball(0.3, 0.65, seed=2)), "a second ball"),
        (np.clip(20 * ball(), -1, 1), "The sound is clipped"),
    ],
)
def test_what_is_wrong_with_a_sound_is_told(tmp_path, sound, said) -> None:
    found = came(tmp_path, sound)
    assert said in " ".join(found["notes"])


def test_silence_and_speech_have_no_drop(tmp_path) -> None:
    assert "drop" not in came(tmp_path, silence())
    assert "drop" not in came(tmp_path, speech())


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"OggS" + bytes(100), "is a compressed sound"),
        (b"\x00\x00\x00\x20ftypM4A " + bytes(100), "is a compressed sound"),
        (b"#!/bin/sh\nrm -rf /\n" * 9, "is no sound that is read here"),
        (b"RIFF\x00\x01\x00\x00WAVEjunk" * 9, "cannot be read as a sound recording"),
        (b"", "is no sound that is read here"),
    ],
)
def test_file_that_is_no_sound_is_refused_with_a_cure(tmp_path, content, said) -> None:
    path = tmp_path / "source.wav"
    path.write_bytes(content)
    with pytest.raises(InputError, match=said):
        recordings.received(path, "sound")


def test_a_sound_that_is_no_number_is_refused(tmp_path) -> None:
    sound = ball()
    sound[::7] = np.inf
    with pytest.raises(InputError, match="holds no sound that is a number throughout"):
        came(tmp_path, sound, subtype="FLOAT")


@pytest.mark.parametrize(
    ("where", "fault", "said"),
    [
        ("/g/source.csv", "is of no known format; name it (a, b): simcompare import x --as F", "is"
         " of no known format"),
        ("/g/source.csv", "line 1 of /g/source.csv: 0. Write it into map.yaml, and add --map m.",
         "line 1 of drop.csv: 0."),
        ("/g/source.csv", "no column is a time (columns: a). where no unit is known, unit: 1 keeps"
         " a plain number: {time: {rate_Hz: 100}}", "no column is a time (columns: a)."),
        ("source.mp4", "has 1 picture; film a second", "drop.csv: has 1 picture; film a second"),
        ("ball, --set", "no parameter is called x", "no parameter is called x"),
        ("ball", "add --map", "ball: add --map"),
    ],
)  # fmt: skip
def test_faults_are_told_without_places_and_advice_for_a_terminal(where, fault, said) -> None:
    path = f"/g/source.{'mp4' if 'mp4' in where else 'csv'}"
    request = {"folder": "/g", "path": path, "name": "drop.csv"}
    first, *rest = faults.told(InputError(where, [fault]), request)
    assert first == said
    is_cut = any(one in fault for one in ("simcompare", "map.yaml", "rate_Hz"))
    assert [one.partition(",")[0] for one in rest] == ["Send a sound as WAV or FLAC"] * is_cut


@pytest.mark.parametrize("where", ["source.csv", "track.csv"])
def test_faults_of_a_fit_do_not_speak_of_the_labs_own_files(where) -> None:
    fault = "the measured numbers tell nothing of restitution"
    assert faults.told(InputError(where, [fault]), {"folder": "/g", "recording": "0a"}) == (fault,)


def test_of_very_many_faults_the_first_are_told() -> None:
    told = faults.told(InputError("x", ["is wrong"] * 5000), {})
    assert told == ("x: is wrong",) * 20 + ("… and 4980 more",)


def test_table_of_intervals_is_a_drop_too(tmp_path) -> None:
    path = tmp_path / "source.csv"
    path.write_text("Time interval (s)\n0.5\n0.4\n0.32\n0.256\n")
    found = recordings.received(path, "table")
    assert found["drop"]["middle"] == pytest.approx(0.8)


def test_waveform_is_thinned_out_without_losing_a_click() -> None:
    values = np.zeros(100_000)
    values[77_777] = 0.9
    found = envelope(np.arange(100_000) / 48000, values)
    assert len(found["t"]) == 2000
    assert max(found["high"]) == 0.9
    assert min(found["low"]) == 0.0


@pytest.fixture(scope="module")
def group(tmp_path_factory):
    folder = tmp_path_factory.mktemp("group")
    place = folder / "recordings" / "0a"
    place.mkdir(parents=True)
    path = write(place / "source.wav", ball(HEIGHT_M, RESTITUTION))
    told = perform("recording", {"path": str(path), "kind": "sound"})
    (place / "recording.json").write_text(json.dumps(told))
    return folder


def asked(group, job: str, **more):
    return {
        "folder": str(group), "id": job, "scenario": "ball", "recording": "0a",
        "engines": ["pymunk", "box2d"], **more,
    }  # fmt: skip


@pytest.fixture(scope="module")
def fitted(group):
    return perform("fit", asked(group, "f1", contact={"pymunk": {"elasticity": 0.5}}))


def test_fit_gives_every_engine_its_own_values(group, fitted) -> None:
    json.dumps(fitted, allow_nan=False)
    assert fitted["restitution"]["value"] == pytest.approx(RESTITUTION, rel=1e-3)
    values = {one["name"]: one["values"] for one in fitted["engines"]}
    # what is typed in differs a little from the restitution, as engines take it
    assert values["pymunk"]["elasticity"] == pytest.approx(RESTITUTION, abs=0.01)
    assert values["box2d"]["restitution"] == pytest.approx(RESTITUTION, abs=0.05)
    assert fitted["files"] == ["ball-values-f1.yaml"]
    # the sliders take the ball's own height, so that what is run next can be held against it
    assert fitted["parameters"]["drop_height_m"] == pytest.approx(HEIGHT_M, rel=4e-3)
    assert "table" not in fitted
    stored = (group / "files" / fitted["files"][0]).read_text()
    assert yaml.safe_load(stored)["engines"]["box2d"] == pytest.approx(values["box2d"])
    assert (group / "fits" / "f1" / "fit.json").is_file()


def test_fit_tells_how_far_the_students_hand_was(fitted) -> None:
    (row,) = fitted["student"]
    assert (row["engine"], row["name"], row["yours"]) == ("pymunk", "elasticity", 0.5)
    misfit = {(one["source"], one["level"]): one["misfit_mm"] for one in fitted["scores"]}
    assert misfit["pymunk", "fitted"] < misfit["pymunk", "by hand"] < misfit["pymunk", "default"]
    levels = [one["level"] for one in fitted["bounces"]["engines"]]
    assert levels == ["default", "default", "fitted", "fitted", "by hand"]


def test_commands_in_the_file_of_values_work_when_they_are_pasted(group, fitted, tmp_path) -> None:
    lines = (group / "files" / fitted["files"][0]).read_text().splitlines()
    (command,) = [line for line in lines if "--engine box2d" in line]
    words = [sys.executable, "-m", *shlex.split(command.removeprefix("# ")), "--out", str(tmp_path)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    (row,) = [line for line in done.stdout.splitlines() if line.startswith("box2d")]
    # the mean of all bounces, of which the last are of few steps
    found = [float(one.partition("(")[0]) for one in re.findall(r"0\.\d+", row)]
    assert found[-1] == pytest.approx(RESTITUTION, abs=0.02)


def test_impact_that_was_struck_out_is_not_fitted(group) -> None:
    less = perform("fit", asked(group, "f2", struck=[7, 6], engines=["pymunk"]))
    assert less["drop"]["count"] == 6
    with pytest.raises(InputError, match="there is no impact 100"):
        perform("fit", asked(group, "f3", struck=[99]))


def test_run_beside_a_recording_is_scored_against_it(group) -> None:
    found = perform("run", asked(group, "r1", contact={"pymunk": {"elasticity": 0.5}}, levels=[],
                                 parameters={"drop_height_m": HEIGHT_M}))  # fmt: skip
    (score,) = found["scores"]
    assert score["truth"] == pytest.approx(RESTITUTION, rel=1e-3)
    assert score["misfit_mm"] > 10
    assert "from your ball" in score["text"]


@pytest.mark.parametrize("name", ["../0a", "1b", "", 7, "/etc"])
def test_recording_that_is_none_is_refused(group, name) -> None:
    with pytest.raises(InputError):
        perform("fit", asked(group, "f4") | {"recording": name})


def test_script_of_a_fit_bounces_like_the_ball(group, fitted) -> None:
    (group / "results" / "f1").mkdir(parents=True, exist_ok=True)
    hand = {"pymunk": {"elasticity": 0.5}}
    found = perform("script", asked(group, "s1", result="f1", contact=hand))
    assert found["files"] == ["ball-pymunk-s1.py"]
    assert found["missing"] == [say("en", "no_script", engine="box2d")]
    script = group / "files" / "ball-pymunk-s1.py"
    elasticity = fitted["engines"][0]["values"]["elasticity"]
    assert f"ball_shape.elasticity = {elasticity!r}\n" in script.read_text()
    # the program by itself: from as high as the ball fell, back up as the ball did
    said = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    first = said.stdout.partition("each impact: ")[2].split()[0]
    assert float(first) == pytest.approx(RESTITUTION, abs=2e-3)
    with np.load(script.with_name("ball-pymunk-s1_motion.npz")) as motion:
        height_m = motion["ball.position_m"][0, 2] - RADIUS_M
    assert height_m == pytest.approx(HEIGHT_M, rel=5e-3)


def test_script_of_the_students_own_values(group) -> None:
    more = {"engine": "pymunk", "contact": {"pymunk": {"elasticity": 0.5}}}
    perform("script", asked(group, "s2", **more))
    assert "ball_shape.elasticity = 0.5\n" in (group / "files" / "ball-pymunk-s2.py").read_text()


def test_report_of_a_fit_and_of_a_run_is_a_page(group, fitted) -> None:
    assert fitted["files"]
    place = group / "results" / "r7"
    place.mkdir(parents=True, exist_ok=True)
    then = {"scenario": "ball", "engines": ["pymunk"], "levels": ["default"]}
    (place / "result.json").write_text(json.dumps({"kind": "run", "request": then}))
    (group / "results" / "f1").mkdir(parents=True, exist_ok=True)
    for result in ("f1", "r7"):
        (name,) = perform("report", asked(group, "p1", result=result))["files"]
        assert "<html" in (group / "files" / name).read_text()[:200]


def test_report_needs_a_result(group) -> None:
    with pytest.raises(InputError, match="run or fit first"):
        perform("report", asked(group, "p2"))
    with pytest.raises(InputError, match="there is none"):
        perform("report", asked(group, "p2", result="zz"))
