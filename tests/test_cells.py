"""Cells of CSV files do not run in a spreadsheet."""

from __future__ import annotations

import csv

import pandas as pd
import pytest

import simcompare
from simcompare.model.cells import cell
from simcompare.results import store
from tests.records import changed, with_source
from tests.test_store import synthetic


@pytest.mark.parametrize(
    "text", ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(1)", "\t=1", "\r=1", "=", "-x"]
)
def test_a_text_like_a_formula_has_an_apostrophe_before_it(text):
    assert cell(text) == f"'{text}"


@pytest.mark.parametrize("value", ["-0.5", "+1e-3", "pymunk", "a=b", "", "+", "-", -0.5, None, 3])
def test_what_is_none_is_left_as_it_is(value):
    assert cell(value) is value


def test_names_in_scores_are_cells(tmp_path):
    run = synthetic()
    scores = tuple(
        type(score)(**{**vars(score), "measure": "=cmd()", "probe": "@x"})
        for score in run.record.scores
    )
    place = store.save(changed(run, scores=scores), tmp_path).folder
    with (place / "scores.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {(row["measure"], row["probe"]) for row in rows} == {("'=cmd()", "'@x")}
    assert float(rows[0]["value"]) == 0.1 + 0.2
    assert store.load(place).record.scores[0].measure == "=cmd()"


def test_names_in_compared_values_are_cells(tmp_path):
    runs = [
        simcompare.run("ball", engine="pymunk", contact="default", seeds=1, set={"drop_height": h})
        for h in (1.0, 2.0)
    ]
    odd = [with_source(run, 0, version="=1+1") for run in runs]
    table = pd.read_csv(simcompare.compare(odd).to_csv(tmp_path / "x.csv"))
    assert set(table["version"].dropna()) == {"'=1+1"}
