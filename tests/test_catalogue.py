"""Scenarios are found by name, by path, and in folders that a user names."""

from __future__ import annotations

import os

import numpy as np
import pytest

from simcompare.errors import InputError, SimcompareError, UnknownName
from simcompare.scenarios import catalogue, trust


def test_the_ball_is_there_with_one_line():
    assert "ball" in catalogue.names()
    assert dict(catalogue.summaries())["ball"].startswith("Bouncing ball: Does the ball")


def test_a_scenario_is_found_by_folder_and_by_file(fall, monkeypatch):
    assert catalogue.find(str(fall)) == fall / "fall.yaml"
    assert catalogue.find(str(fall / "fall.yaml")) == fall / "fall.yaml"
    monkeypatch.chdir(fall)
    assert catalogue.load(".").name == "fall"


def test_a_folder_in_the_variable_is_searched(fall, monkeypatch, tmp_path):
    empty = tmp_path / "empty"
    empty.mkdir()
    monkeypatch.setenv("SIMCOMPARE_SCENARIOS", os.pathsep.join([str(empty), str(fall.parent)]))
    assert "fall" in catalogue.names()
    assert "ball" in catalogue.names()
    assert catalogue.load("fall").name == "fall"
    assert ("fall", "Free fall: Does it fall as Galilei said?") in catalogue.summaries()


def test_a_users_scenario_does_not_change_what_a_project_name_means(fall, monkeypatch):
    own = fall.parent / "ball"
    fall.rename(own)
    (own / "fall.yaml").rename(own / "ball.yaml")
    monkeypatch.setenv("SIMCOMPARE_SCENARIOS", str(own.parent))
    assert catalogue.find("ball") != own / "ball.yaml"
    assert catalogue.find(str(own)) == own / "ball.yaml", "its path still means itself"


def test_a_file_that_is_not_named_as_its_folder_is_no_scenario(fall, monkeypatch):
    (fall / "notes.yaml").write_text("a: 1\n")
    monkeypatch.setenv("SIMCOMPARE_SCENARIOS", str(fall.parent))
    assert "notes" not in catalogue.names()


def test_a_folder_that_does_not_exist_is_told(monkeypatch, tmp_path):
    monkeypatch.setenv("SIMCOMPARE_SCENARIOS", str(tmp_path / "nope"))
    with pytest.raises(SimcompareError, match="nope"):
        catalogue.find("fall")


@pytest.mark.parametrize("kind", ["folder", "broken link"])
def test_a_thing_that_is_no_file_spoils_no_list(fall, monkeypatch, kind):
    odd = fall.parent / "odd"
    odd.mkdir()
    if kind == "folder":
        (odd / "odd.yaml").mkdir()
    else:
        (odd / "odd.yaml").symlink_to("nowhere")
    monkeypatch.setenv("SIMCOMPARE_SCENARIOS", str(fall.parent))
    assert "fall" in dict(catalogue.summaries())


def test_an_unknown_name_names_the_nearest():
    with pytest.raises(UnknownName, match="no scenario is called 'bal'; did you mean ball"):
        catalogue.find("bal")


def test_a_very_long_name_is_unknown_too():
    with pytest.raises(UnknownName):
        catalogue.find("x" * 5000)


def test_a_folder_without_its_file_says_what_it_must_hold(tmp_path):
    with pytest.raises(InputError, match=rf"{tmp_path.name}\.yaml"):
        catalogue.find(str(tmp_path))


def test_the_reference_beside_a_file_is_loaded(fall):
    reference = catalogue.reference_of(fall / "fall.yaml")
    assert reference is not None
    height = reference({"height_m": 1.0}, np.array([0.0, 0.2]), {})["ball.position_m"][:, 2]
    assert height == pytest.approx([1.0, 1.0 - 9.80665 * 0.02])


def test_no_reference_is_no_fault(fall):
    (fall / "reference.py").unlink()
    assert catalogue.reference_of(fall / "fall.yaml") is None


def calculated(fall):
    """What a reference tells at two times."""
    trust.allow(fall / "reference.py")
    reference = catalogue.reference_of(fall / "fall.yaml")
    assert reference is not None
    return reference({}, np.array([0.0, 1.0]), {})


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("def reference(:\n", "SyntaxError"),
        ("import no_such_module\n", "no_such_module"),
        ("1 / 0\n", "ZeroDivisionError"),
        ("x = 1\n", "no function reference"),
        ("reference = 3\n", "no function reference"),
        ("raise SystemExit('bye')\n", "bye"),
    ],
)
def test_a_broken_reference_is_one_clear_error(fall, code, expected):
    (fall / "reference.py").write_text(code)
    with pytest.raises(InputError, match=expected) as error:
        calculated(fall)
    assert error.value.where.endswith("reference.py")


def test_a_reference_may_hold_dataclasses(fall):
    (fall / "reference.py").write_text(
        "from __future__ import annotations\nfrom dataclasses import dataclass\n"
        "@dataclass\nclass A:\n    x: int\ndef reference(p, t):\n    return {}\n"
    )
    assert calculated(fall) == {}
