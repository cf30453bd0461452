"""How numbers and sentences are written."""

from __future__ import annotations

import pytest

from simcompare import notation


@pytest.mark.parametrize(
    ("text", "told"),
    [("length of a swing", "Length of a swing"), ("a ball", "A ball"), ("u: known", "u: known")],
)
def test_a_sentence_begins_with_a_capital_and_a_symbol_stays(text, told):
    assert notation.capital(text) == told
