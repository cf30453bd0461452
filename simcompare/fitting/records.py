"""What fit.json says, as plain values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from simcompare.fitting import bounce_models, other_estimates, pictures
from simcompare.fitting.bootstrap import parametric
from simcompare.fitting.choose import Choice
from simcompare.fitting.engine_fit import EngineFit, as_dict, scenario_values
from simcompare.fitting.identifiability import identifiability
from simcompare.fitting.impacts import Impacts
from simcompare.fitting.likelihood import Fit

#: version of what fit.json holds
FORMAT = 1


def of_fit(
    scenario: str,
    choice: Choice,
    start: Fit,
    engines: Sequence[EngineFit],
    predicted: Mapping[str, Any],
    drops: tuple[Sequence[Impacts], Sequence[Impacts]],
    given: Mapping[str, float],
    step_s: float,
) -> dict[str, Any]:
    """The whole record of a fit.

    Args:
        scenario: its name.
        choice: the closed forms and which was chosen.
        start: the closed form that engines were fitted with.
        engines: what each engine must be given.
        predicted: the held-out drops.
        drops: those that were fitted, and those that were held out.
        given: further parameters of the scenario.
        step_s: time between samples of the engines.
    """
    known = identifiability(choice.best)
    sources = []
    for one in engines:
        row = as_dict(one)
        row["left"] = [] if one.fit is None else pictures.left_of(one.fit, one.shown)
        row["identifiable"] = not any(direction.weak for direction in known.directions)
        row["holdout"] = [
            {"source": drop["source"], **drop["engines"][one.engine]}
            for drop in predicted["drops"]
            if one.engine in drop.get("engines", {})
        ]
        sources.append(row)
    found: dict[str, Any] = {
        "format": FORMAT,
        "scenario": scenario,
        "given": dict(given),
        "measured": [drop.to_dict() for drop in drops[0]],
        "told": [sentence for drop in drops[0] for sentence in drop.told()],
        "held_out": [drop.to_dict() for drop in drops[1]],
        "closed_form": choice.best.to_dict(),
        "choice": choice.to_dict(),
        "bootstrap": parametric(choice.best).to_dict(),
        "identifiability": known.to_dict(),
        "left": pictures.left_of(choice.best),
        "law": pictures.law_of(choice.best),
        "ratios": pictures.measured_ratios(choice.best),
        "profiles": pictures.profiles_of(choice.best),
        "engine_form": None if start.model == choice.best.model else start.to_dict(),
        "engine_model": start.model,
        "engine_model_text": bounce_models.model_of(start.model).text,
        "sources": sources,
        "run_with": {
            "closed": _scene_values(start, given),
            "engines": {
                one.engine: _scene_values(one.fit, given) for one in engines if one.fit is not None
            },
        },
        "holdout": dict(predicted),
        "other_estimates": other_estimates.of_drops(drops[0], choice.best),
        "valid": {
            "speed_m_s": list(choice.best.speeds_m_s),
            "step_s": step_s,
        },
    }
    found["sentences"] = _sentences(found, choice)
    return found


def _scene_values(fit: Fit, given: Mapping[str, float]) -> dict[str, float]:
    """Parameters of the scenario that a fit says, drag and fixed values included."""
    values = scenario_values(fit.problem, fit.x, 0, given)
    return {name: value for name, value in values.items() if name != "drop_height_m"}


def _sentences(found: Mapping[str, Any], choice: Choice) -> list[str]:
    best = choice.best
    e = best.as_dict().get("restitution")
    said = []
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
    shown = [s["effective"]["restitution"]["value"] for s in found["sources"] if s["effective"]]
    if len(shown) > 1:
        spread = (max(shown) - min(shown)) / (sum(shown) / len(shown))
        said.append(
            f"Fitted to it, {len(shown)} engines show restitutions that differ by"
            f" {100 * spread:.3f} %."
        )
    said += [_sentence(text) for text in (*choice.words, *found["identifiability"]["words"])]
    said += [_sentence(text) for text in best.warnings]
    said.append(found["holdout"]["text"])
    return said


def _digits(value: float, width: float) -> str:
    """A number to a hundredth of an interval, at least four decimals."""
    places = 4 if not 0 < width < math.inf else max(4, 2 - math.floor(math.log10(width)))
    return f"{value:.{min(places, 9)}f}"


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".")
