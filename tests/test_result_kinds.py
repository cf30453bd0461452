"""What a fit and a validation show of themselves in Python and in a notebook."""

import re
from pathlib import Path

import pytest
from matplotlib.figure import Figure

import simcompare
from tests import records, validated

MOST_BYTES = 20_000
BALL = Path(__file__).parent.parent / "examples" / "my_ball.csv"


def validation(folder):
    return validated.run_of(validated.make(folder), "fitted")


def fit(folder):
    return simcompare.fit("ball", recordings=[BALL], engine="pymunk", out=folder)


@pytest.fixture(scope="module", params=[validation, fit], ids=lambda make: make.__name__)
def found(request, tmp_path_factory):
    return request.param(tmp_path_factory.mktemp("runs"))


def test_it_shows_what_it_is_a_table_and_a_figure(found):
    html = re.sub(r"base64,[^\"]*", "", found._repr_html_())
    assert f"{found.record.title} – {found.record.kind}" in html
    assert html.count("<img") == html.count("<table") == 1
    assert len(html.encode()) < MOST_BYTES
    assert len(repr(found)) < 2000


def test_its_table_and_figures_are_those_of_the_report(found):
    assert not found.table().empty
    assert isinstance(found.plot(), Figure)
    with pytest.raises(simcompare.SimcompareError, match="no figure of this run is called 'x'"):
        found.plot("x")


def test_its_samples_tell_their_parameters_or_segment(found):
    samples = found.samples()
    assert {"parameters", "segment"} & {*samples}
    assert not samples.empty


def test_a_run_in_which_nothing_was_measured_has_an_empty_table(found):
    empty = records.changed(found, kind="run", sources=(), scores=())
    assert empty.table().empty
