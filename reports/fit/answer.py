"""What a fit of bounces says, in sentences: first what to type into a loop of one's own."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.model_selection import Choice
from simcompare.model.settings import TUNED
from simcompare.notation import sentence

#: significant digits of a number that is typed in; more than its uncertainty knows
_DIGITS = 7


def sentences(found: Mapping[str, Any], choice: Choice) -> list[str]:
    """The answer, and what must be known of it.

    Args:
        found: the record of the fit.
        choice: the closed forms and which was chosen.
    """
    best = choice.best
    said = _typed(found)
    e = best.as_dict().get("restitution")
    if e is not None:
        k = best.names.index("restitution")
        low, high = best.intervals[k]
        said.append(
            f"The restitution is {_digits(e, high - low)}, with 95 % between"
            f" {_digits(low, high - low)} and {_digits(high, high - low)}"
            f" ({bounce_models.model_of(best.model).text};"
            f" impacts at {best.speeds_m_s[0]:.2f} to {best.speeds_m_s[1]:.2f} m/s)."
        )
    form = found["engine_form"]
    if form is not None:
        said.append(
            f"Engines have no such law; they were fitted with {form['text']}, which leaves"
            f" χ² = {form['chi2']:.3g} for {form['count']} numbers."
        )
    said += _shown(found)
    said += [sentence(text) for text in (*choice.words, *found["identifiability"]["words"])]
    said += [sentence(text) for text in best.warnings]
    said.append(found["holdout"]["text"])
    return said


def _typed(found: Mapping[str, Any]) -> list[str]:
    """What to type in, engine by engine."""
    if found["contact"] != TUNED:
        return []
    lines = []
    for source in found["sources"]:
        if source.get("numbers"):
            told = ", ".join(
                f"{row['name']} = {row['value']:.{_DIGITS}g}"
                + ("" if row["unit"] in ("", "1") else f" {row['unit']}")
                for row in source["numbers"]
            )
            lines.append(f"{source['name']}: {told}")
    if not lines:
        return []
    goal, step_ms = found["tuned_to"], 1e3 * found["valid"]["engine_step_s"]
    return [
        f"Type these into a loop with a step of {step_ms:.4g} ms: {'; '.join(lines)}. Then an"
        f" impact at {goal['speed_m_s']:.2f} m/s has on average the restitution"
        f" {_digits(goal['restitution'], 4 * goal['u'])} that was"
        f" {'measured' if goal['u'] else 'given'}."
    ]


def _shown(found: Mapping[str, Any]) -> list[str]:
    """How far engines are from each other, and from a law that they do not have."""
    shown = [s["effective"]["restitution"]["value"] for s in found["sources"] if s["effective"]]
    said = []
    tuned = found["contact"] == TUNED
    if len(shown) > 1:
        spread = (max(shown) - min(shown)) / (sum(shown) / len(shown))
        how = "In their plain loops" if tuned else "Fitted to it"
        said.append(
            f"{how}, {len(shown)} engines show mean restitutions that differ by"
            f" {100 * spread:.3f} %."
        )
    model = bounce_models.model_of(found["closed_form"]["model"])
    if tuned and shown and model.law != "constant":
        rows = [row for source in found["sources"] for row in source.get("impacts", ())]
        worst = max((row["deviation"] for row in rows), key=abs)
        said.append(
            "Engines have one restitution for all speeds; theirs is that of the first impact, and"
            f" at later ones it is up to {100 * abs(worst):.2g} % off."
        )
    return said


def _digits(value: float, width: float) -> str:
    """A number to a hundredth of an interval, at least four decimals."""
    places = 4 if not 0 < width < math.inf else max(4, 2 - math.floor(math.log10(width)))
    return f"{value:.{min(places, 9)}f}"
