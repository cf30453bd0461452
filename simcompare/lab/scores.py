"""How near each source came: to the truth, or to the bounces that were recorded."""

from __future__ import annotations

from typing import Any

from simcompare.comparison.comparison import FAIL, PASS
from simcompare.lab.numbers import shortened
from simcompare.reports.run import runs
from simcompare.reports.run.lead import lead_of
from simcompare.results.run import Run


def of_truth(result: Run) -> list[dict[str, Any]]:
    """The leading measure of every source that has one, beside its truth."""
    lead = lead_of(result)
    if lead is None:
        return []
    found = []
    for level in runs.modes(result):
        for name in runs.ran(result, level):
            score = runs.score_of(result, name, level, lead.measure)
            if score is None:
                continue
            ok = {PASS: True, FAIL: False}.get(score.verdict)
            text = runs.value_words(result, score)
            found.append({
                "source": name, "level": level, "measure": lead.words, "unit": lead.unit,
                "value": shortened(score.value), "truth": shortened(score.truth), "text": text,
                **({} if ok is None else {"ok": ok}),
            })  # fmt: skip
    return found
