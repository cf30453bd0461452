"""What the jobs of the lab do, without a server."""

from __future__ import annotations

import json

import pytest

from simcompare.errors import InputError, SimcompareError, UnknownName
from simcompare.lab.work import perform

BALL = {"scenario": "ball", "engines": ["pymunk", "mujoco"], "levels": ["default"]}


@pytest.fixture(scope="module")
def ran():
    contact = {"pymunk": {"elasticity": 0.7}}
    parameters = {"drop_height_m": 0.3}
    return perform("run", {**BALL, "contact": contact, "parameters": parameters})


def test_scenarios_are_those_of_the_catalogue() -> None:
    found = perform("scenarios", {})["scenarios"]
    assert {"name", "title", "question"} == set(found[0])
    assert "ball" in [one["name"] for one in found]


def test_facts_have_bounds_and_the_own_values_of_engines() -> None:
    found = perform("scenario", {"name": "ball", "language": "de"})
    height = next(one for one in found["parameters"] if one["name"] == "drop_height_m")
    assert (height["value"], height["min"], height["max"], height["unit"]) == (1.0, 0.01, 20.0, "m")
    contact = {one["name"]: one["contact"] for one in found["engines"]}
    for values in contact.values():
        assert all(one["min"] <= one["value"] <= one["max"] for one in values)
    assert [one["name"] for one in contact["pymunk"]][:2] == ["elasticity", "collision_slop"]
    assert [one["log"] for one in contact["mujoco"]][:2] == [True, True]
    assert found["presets"][0]["set"]["restitution"] == 0.88
    assert found["can_fit"]


def test_scenario_in_which_nothing_bounces_has_no_values_for_a_bounce() -> None:
    found = perform("scenario", {"name": "pendulum"})
    assert not any(one["contact"] for one in found["engines"])
    assert not found["can_fit"]


def test_run_has_all_that_a_page_draws(ran) -> None:
    json.dumps(ran, allow_nan=False)
    lines = [(one["source"], one["level"]) for one in ran["curves"]]
    assert lines == [
        ("closed form", ""), ("pymunk", "default"), ("mujoco", "default"), ("pymunk", "by hand"),
    ]  # fmt: skip
    for one in ran["curves"]:
        assert len(one["t"]) == len(one["y"]) <= 1000
        assert one["y"][0] == pytest.approx(0.3, abs=1e-3)
    assert ran["y_label"] == "Height of the ball's lowest point (m)"
    assert len(ran["replay"]["actors"]) == 4
    assert ran["table"]["head"] == ["engine", "default", "by hand"]
    assert "by hand" in ran["sentence"]


def test_scores_stand_beside_the_truth(ran) -> None:
    by_hand = next(one for one in ran["scores"] if one["level"] == "by hand")
    assert by_hand["truth"] == pytest.approx(0.8)
    # what was typed, by one phase of the step
    assert by_hand["value"] == pytest.approx(0.7, abs=0.03)
    assert by_hand["ok"] is False


def test_engine_that_cannot_is_told_and_the_others_run() -> None:
    found = perform("run", {**BALL, "scenario": "robot"})
    assert any("pymunk" in sentence for sentence in found["missing"])
    assert any(one["source"] == "mujoco" for one in found["curves"])


@pytest.mark.parametrize(
    "request_",
    [
        {},
        {"scenario": "../../etc/passwd"},
        {"scenario": "/work"},
        {**BALL, "levels": ["/tmp/fit.json"]},
        {**BALL, "levels": []},
        {**BALL, "engines": ["os.system"]},
        {**BALL, "engines": "mujoco"},
        {**BALL, "parameters": {"drop_height_m": float("inf")}},
        {**BALL, "parameters": {"drop_height_m": "1; import os"}},
        {**BALL, "parameters": {"drop_height_m": True}},
        {**BALL, "parameters": {"drop_height_m": 1e9}},
        {**BALL, "parameters": ["drop_height_m"]},
        {**BALL, "contact": {"pymunk": 0.7}},
        {**BALL, "contact": {"pymunk": {"elasticity": 7}}},
        {**BALL, "parameters": {f"p{i}": 1.0 for i in range(1001)}},
    ],
)
def test_nothing_that_a_page_sends_is_believed(request_) -> None:
    with pytest.raises(SimcompareError):
        perform("run", request_)


def test_unknown_kind_is_refused() -> None:
    with pytest.raises(UnknownName):
        perform("shell", {})


def test_all_is_refused_in_sentences() -> None:
    with pytest.raises(InputError, match="choose a level"):
        perform("run", {**BALL, "levels": []})


def test_parts_of_a_request_that_nobody_reads_are_all_refused() -> None:
    with pytest.raises(InputError, match="is not known; known: scenario") as caught:
        perform("run", {**BALL, "parameter": {}, "<b>": 1})
    assert len(caught.value.faults) == 2
