"""How near each source came to the bounces that were recorded."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from simcompare.lab.numbers import shortened
from simcompare.lab.translation import filled
from simcompare.reports.run import runs
from simcompare.results.run import Run

_BOUNCES = "{misfit} mm from your ball; restitution {value}"
_STAYS = "{misfit} mm from your ball; it does not bounce"
#: from here on three digits would be written with a power of ten
_PLAIN = 999.5


def of_recording(
    result: Run, drop: Mapping[str, Any], language: str = "en"
) -> list[dict[str, Any]]:
    """How far the flights of every source are from the recorded ones, in millimetres of height.

    A bounce that a source does not make counts with its whole height.

    Args:
        result: the run.
        drop: what was recorded, as ``recordings.drop`` has it.
        language: of the page.
    """
    heights = {one["bounce"]: one["value"] for one in drop["heights_m"]}
    if not heights:
        return []
    found = []
    for level in runs.modes(result):
        for name in runs.ran(result, level):
            made = by_bounce(result, name, level, "rebound_height")
            off = [made.get(bounce, 0.0) - height for bounce, height in heights.items()]
            misfit_mm = 1e3 * math.sqrt(sum(one * one for one in off) / len(off))
            whole = runs.score_of(result, name, level, "restitution")
            value = None if whole is None else whole.value
            found.append({
                "source": name, "level": level, "misfit_mm": shortened(misfit_mm),
                "value": shortened(value), "truth": drop["middle"],
                "text": filled(
                    _BOUNCES if value else _STAYS, language, misfit=_short(misfit_mm),
                    value=f"{value or 0.0:.3f}",
                ),
            })  # fmt: skip
    return found


def _short(value: float) -> str:
    """Three digits, and never a power of ten: 2830, not 2.83e+03."""
    return f"{value:.3g}" if value < _PLAIN else f"{value:.0f}"


def by_bounce(result: Run, name: str, level: str, measure: str) -> dict[int, float]:
    """What a source has of each bounce, the first is 1."""
    return {
        score.index: score.value
        for score in result.record.scores
        if (score.source, score.contact, score.measure) == (name, level, measure)
        and score.index is not None
        and score.value is not None
    }
