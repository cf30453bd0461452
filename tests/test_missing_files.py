"""What is no file and no name: one sentence that says which of both was meant, and what is near."""

from __future__ import annotations

import json

import pytest

import simcompare
from simcompare.errors import InputError, NoSuchFile, UnknownName, unknown_or_missing

RUN = ("run", "ball", "--engine", "pymunk", "--no-report")
FIT = ("fit", "ball", "--engine", "pymunk", "-r")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("pendulum.csv", "bounces.csv", "map.yaml"):
        (tmp_path / name).write_text("x", encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    ("words", "name", "near"),
    [
        (("import", "pendulm.csv"), "pendulm.csv", "pendulum.csv"),
        (("import", "pendulum.csv", "--map", "maps.yaml"), "maps.yaml", "map.yaml"),
        (("validate", "pendulum", "-r", "Pendulum.CSV"), "Pendulum.CSV", "pendulum.csv"),
        (("validate", "pendulum", "-r", "./pendulm.csv"), "./pendulm.csv", "pendulum.csv"),
        ((*FIT, "bounce.csv"), "bounce.csv", "bounces.csv"),
        (
            (*FIT, "ittf_table_tennis_rebound", "--hold-out", "bounce.csv"),
            "bounce.csv",
            "bounces.csv",
        ),
        ((*RUN, "--against", "bounce.csv"), "bounce.csv", "bounces.csv"),
        ((*RUN, "--contact", "fit.json"), "fit.json", ""),
        (("run", "./sphere.toml"), "./sphere.toml", ""),
        (("export", "ball", "--fit", "fit.json"), "fit.json", ""),
        (("report", "./nowhere"), "nowhere", ""),
        (("report", "nowhere"), "nowhere", ""),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_a_path_that_leads_to_nothing_is_a_missing_file(call, folder, words, name, near):
    code, out, err = call(*words)
    assert (code, out) == (2, "")
    assert f"{name}: there is no such file" in err
    assert f"did you mean {near}?" in err if near else "did you mean" not in err
    assert "known:" not in err


def test_a_folder_that_is_not_there_is_told_as_such(call, folder):
    assert "logs/a.csv: there is no folder logs" in call("import", "logs/a.csv")[2]


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("pendulum", UnknownName), ("mujoco:rk4", UnknownName), ("v1.2", UnknownName),
        ("a b", UnknownName), ("", UnknownName), ("x" * 300, UnknownName),
        ("a.csv", NoSuchFile), ("./a", NoSuchFile), ("a/b", NoSuchFile), ("~/a", NoSuchFile),
        ("x" * 300 + ".csv", NoSuchFile), ("..", UnknownName),
    ],
    ids=lambda value: value[:9] if isinstance(value, str) else "",
)  # fmt: skip
def test_a_name_is_a_path_where_it_can_be_nothing_else(name, kind):
    assert type(unknown_or_missing("recording", name, ("a", "b"))) is kind


def test_a_mistyped_name_of_a_data_set_is_no_missing_file(call):
    _, _, err = call("validate", "pendulum", "-r", "pendulum_free_swin")
    assert "did you mean pendulum_free_swing" in err


def test_what_is_there_and_of_the_wrong_kind_is_told_as_such(call, folder):
    says = "map.yaml: is a file; expected a folder of stored runs"
    assert says in call("runs", "map.yaml")[2]
    (folder / "runs").mkdir()
    says = "runs: is a folder; expected a YAML file"
    assert says in call("import", "pendulum.csv", "--map", "runs")[2]


def test_a_run_json_that_is_not_there_is_told_beside_runs(call, folder):
    (folder / "one").mkdir()
    (folder / "one" / "run.json").write_text("{}", encoding="utf-8")
    assert "simcompare: run.json: there is no such file" in call("report", "run.json")[2]


def test_an_empty_word_is_not_the_current_folder(call, folder):
    for verb in ("run", "runs", "show", "report", "compare"):
        code, _, err = call(verb, "")
        assert (code, err) == (2, "simcompare: '': is empty; give a value, or leave it out\n")
    assert "a scenario folder holds NAME.yaml" in call("run", "/")[2]


@pytest.mark.parametrize("verb", ["run", "show", "report", "load_run", "runs", "compare"])
def test_an_empty_path_is_not_the_current_folder(verb):
    with pytest.raises(InputError, match="='' is empty; expected "):
        getattr(simcompare, verb)("")


def test_a_folder_of_runs_lists_those_inside_the_newest_first(call, tmp_path):
    places = [tmp_path / "runs" / f"2026010{i}-120000-ball" for i in range(1, 8)]
    for place in places:
        place.mkdir(parents=True)
        (place / "run.json").write_text("{}", encoding="utf-8")
    code, _, err = call("report", str(tmp_path / "runs"))
    assert code == 2
    assert "holds 7 stored runs; name one of them, such as the newest" in err
    assert err.splitlines()[1:] == [f"  {place}" for place in places[:1:-1]]


def test_a_folder_without_runs_is_no_run(tmp_path):
    with pytest.raises(InputError, match=r"is not a stored run: it holds no run\.json"):
        simcompare.load_run(tmp_path)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("fit", "is the record of a fit; give {folder}/fit.json"),
        ("run", "is the record of a run, in which nothing was fitted; give the fit.json of"),
        ("validation", "is the record of a validation"),
    ],
)
def test_the_record_of_a_run_is_told_from_a_fit(call, tmp_path, kind, words):
    record = tmp_path / "run.json"
    record.write_text(json.dumps({"kind": kind}), encoding="utf-8")
    for verb in (("export", "ball", "--fit"), (*RUN, "--contact")):
        code, _, err = call(*verb, str(record))
        assert code == 2
        assert words.format(folder=tmp_path) in err


def test_a_folder_without_a_fit_is_told_as_such(call, tmp_path):
    for verb in (("export", "ball", "--fit"), (*RUN, "--contact")):
        assert "is a folder without fit.json" in call(*verb, str(tmp_path))[2]
