"""What fit.json says, as plain values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from simcompare.fitting.bounces import bounce_models, other_estimates, plot_data
from simcompare.fitting.bounces.assisted_fit import AssistedFit
from simcompare.fitting.bounces.bootstrap import parametric
from simcompare.fitting.bounces.engine_fit import EngineFit
from simcompare.fitting.bounces.identifiability import identifiability
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.model_selection import Choice
from simcompare.fitting.bounces.roles import Roles
from simcompare.fitting.bounces.tuned_fit import TunedFit
from simcompare.fitting.bounces.wanted import Wanted
from simcompare.model.scenario import Scenario
from simcompare.reports.fit import answer

#: version of what fit.json holds
FORMAT = 2


@dataclass(frozen=True)
class Made:
    """How engines were fitted.

    Attributes:
        contact: level: "tuned" or "assisted".
        assist: our helps that were asked for: "none", "all" or names with commas.
        wanted: what tuned engines were asked for.
        scene: the leading drop.
    """

    contact: str
    assist: str
    wanted: Wanted | None
    scene: Scenario


def of_fit(
    roles: Roles,
    choice: Choice,
    start: Fit,
    engines: Sequence[EngineFit],
    predicted: Mapping[str, Any],
    drops: tuple[Sequence[Impacts], Sequence[Impacts]],
    made: Made,
) -> dict[str, Any]:
    """The whole record of a fit.

    Args:
        roles: the scenario.
        choice: the closed forms and which was chosen.
        start: the closed form that engines were fitted with.
        engines: what each engine must be given.
        predicted: the held-out drops.
        drops: those that were fitted, and those that were held out.
        made: how engines were fitted.
    """
    known = identifiability(choice.best)
    sources = []
    for one in engines:
        row = one.to_dict()
        # an impact in a plain loop is late by its contact, which is told and is no residual
        assisted = isinstance(one, AssistedFit) and one.fit is not None
        row["left"] = plot_data.left_of(one.fit, one.shown) if assisted and one.fit else []
        row["identifiable"] = not any(direction.weak for direction in known.directions)
        row["holdout"] = [
            {"source": drop["source"], **drop["engines"][one.engine]}
            for drop in predicted["drops"]
            if one.engine in drop.get("engines", {})
        ]
        sources.append(row)
    found: dict[str, Any] = {
        "format": FORMAT,
        "scenario": roles.file.name,
        "contact": made.contact,
        "assist": made.assist,
        "given": dict(roles.given),
        "measured": [drop.to_dict() for drop in drops[0]],
        "told": [sentence for drop in drops[0] for sentence in drop.told()],
        "held_out": [drop.to_dict() for drop in drops[1]],
        "closed_form": choice.best.to_dict(),
        "choice": choice.to_dict(),
        "bootstrap": parametric(choice.best).to_dict(),
        "identifiability": known.to_dict(),
        "left": plot_data.left_of(choice.best),
        "law": plot_data.law_of(choice.best),
        "ratios": plot_data.measured_ratios(choice.best),
        "profiles": plot_data.profiles_of(choice.best),
        "engine_form": None if start.model == choice.best.model else start.to_dict(),
        "engine_model": start.model,
        "engine_model_text": bounce_models.model_of(start.model).text,
        "tuned_to": _tuned_to(made.wanted),
        "tuned_mean": _tuned_mean(sources),
        "sources": sources,
        "run_with": _run_with(roles, start, engines, made),
        "holdout": dict(predicted),
        "other_estimates": other_estimates.of_drops(drops[0], choice.best),
        "valid": {
            "speed_m_s": list(choice.best.speeds_m_s),
            "step_s": made.scene.world.step_s,
            "engine_step_s": made.scene.world.engine_step_s,
        },
    }
    found["sentences"] = answer.sentences(found, choice)
    return found


def _tuned_to(wanted: Wanted | None) -> dict[str, Any] | None:
    if wanted is None:
        return None
    return {"restitution": wanted.restitution, "u": wanted.u, "speed_m_s": wanted.speed_m_s}


def _tuned_mean(sources: Sequence[Mapping[str, Any]]) -> float | None:
    """The closed form's mean restitution over the impacts that an engine resolves most of."""
    most = max((source.get("impacts", ()) for source in sources), key=len, default=())
    return sum(row["closed_form"] for row in most) / len(most) if most else None


def _run_with(roles: Roles, start: Fit, engines: Sequence[EngineFit], made: Made) -> dict[str, Any]:
    """With what a run repeats the fit: parameters of the scenario, and engines' own numbers."""

    def values(one: Fit) -> dict[str, float]:
        closed = dict(one.problem.values(one.x, 0))
        if made.wanted is not None:
            closed["restitution"] = made.wanted.restitution
        found = roles.values(closed)
        return {name: value for name, value in found.items() if name != roles.height}

    assisted = {
        one.engine: values(one.fit)
        for one in engines
        if isinstance(one, AssistedFit) and one.fit is not None
    }
    numbers = {
        one.engine: [
            {"pairs": [list(pair) for pair in row.pairs], "restitution": row.restitution,
             "values": list(row.numbers), "size_m": row.size_m, "gravity_m_s2": row.gravity_m_s2}
            for row in one.tuning
        ]
        for one in engines
        if isinstance(one, TunedFit) and one.fit is not None
    }  # fmt: skip
    return {"closed": values(start), "engines": assisted, "numbers": numbers}
