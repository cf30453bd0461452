"""What fit.json says of a fit of bounces; its sentences are written by its report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from simcompare import units
from simcompare.fitting.bounces import bounce_models, model_selection, plot_data, ratios
from simcompare.fitting.bounces.assisted_fit import AssistedFit
from simcompare.fitting.bounces.averaging import Averaged, alone
from simcompare.fitting.bounces.bootstrap import parametric
from simcompare.fitting.bounces.budget import budgets
from simcompare.fitting.bounces.deviations import Deviation
from simcompare.fitting.bounces.engine_fit import EngineFit, TunedFit
from simcompare.fitting.bounces.identifiability import identifiability
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import COVERAGE, Fit
from simcompare.fitting.bounces.one_number import OneNumber
from simcompare.fitting.bounces.roles import Roles
from simcompare.fitting.bounces.tuning_goal import TuningGoal
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array
from simcompare.model.tuning import TuningRow
from simcompare.results.records.fit_bounces import BouncesFit, Drop, Valid
from simcompare.results.records.fit_engines import (
    BouncesEngine,
    EffectiveValue,
    FirstContact,
    OneRestitution,
    RunWith,
    Shown,
    Target,
    Tuned,
)
from simcompare.results.records.fit_forms import (
    AtSpeed,
    Bootstrap,
    Candidate,
    Choice,
    Form,
    Repeats,
    Unknown,
)
from simcompare.results.records.fit_holdout import Holdout, SourceHoldout
from simcompare.results.records.fit_parts import CLOSED_FORM, ENGINE, EngineParameter, Known, Value

#: how an interval came about
AVERAGED, TRUNCATED = "averaged", "truncated"


@dataclass(frozen=True)
class Made:
    """How engines were fitted.

    Attributes:
        contact: level: "tuned" or "assisted".
        assist: our helps that were asked for: "none", "all" or names with commas.
        goal: what engines were tuned to.
        scene: the leading drop.
    """

    contact: str
    assist: str
    goal: TuningGoal | None
    scene: Scenario


def of_fit(
    roles: Roles,
    choice: model_selection.Choice,
    told: Averaged,
    plain: OneNumber,
    engines: Sequence[EngineFit],
    predicted: Holdout,
    drops: tuple[Sequence[Impacts], Sequence[Impacts]],
    made: Made,
) -> BouncesFit:
    """The whole record of a fit, without its sentences.

    Args:
        roles: the scenario.
        choice: the closed forms and which was chosen.
        told: what they say together.
        plain: the closed form with the one restitution that engines have.
        engines: what each engine must be given.
        predicted: the held-out drops.
        drops: those that were fitted, and those that were held out.
        made: how engines were fitted.
    """
    best = choice.best
    known = identifiability(best)
    form = form_of(best, told)
    sources = tuple(_source(one, form, predicted, not known.is_weak) for one in engines)
    return BouncesFit(
        scenario=roles.file.name, contact=made.contact, assist=made.assist,
        settings=dict(roles.given),
        measured=tuple(map(drop_of, drops[0])), held_out=tuple(map(drop_of, drops[1])),
        closed_form=form, choice=choice_of(choice), bootstrap=_bootstrap(best),
        identifiability=Known(**vars(known)), residuals=plot_data.residuals(best),
        law=plot_data.law_of(best, told), ratios=plot_data.measured_ratios(best),
        profiles=plot_data.profiles_of(best),
        one_number=_one_number(best, plain),
        tuned_to=_target(made.goal), tuned_mean=_tuned_mean(sources),
        u_tuned_mean=_u_tuned_mean(sources, told), sources=sources,
        run_with=_run_with(roles, plain.fit, engines), holdout=predicted,
        budgets=budgets(choice, told),
        other_estimates=tuple(ratios.of_drops(drops[0])),
        valid=Valid(
            best.speeds_m_s, made.scene.world.step_s, made.scene.world.engine_step_s
        ),
    )  # fmt: skip


def drop_of(impacts: Impacts) -> Drop:
    """What the record says of one drop."""
    return Drop(
        impacts.kind, impacts.source, impacts.numbers, _row(impacts.times_s), _row(impacts.u_s),
        impacts.height_numbers, _row(impacts.heights_m), _row(impacts.u_heights_m),
        0 if impacts.track is None else len(impacts.track.time_s),
        impacts.dropped, impacts.missed, impacts.notes, impacts.interval_numbers,
        _row(impacts.intervals_s), _row(impacts.u_intervals_s),
    )  # fmt: skip


def _row(values: Array) -> tuple[float, ...]:
    return tuple(np.ravel(values).tolist())


def _rows(values: Array) -> tuple[tuple[float, ...], ...]:
    return tuple(map(_row, values))


def form_of(fit: Fit, told: Averaged | None = None) -> Form:
    """What the record says of a closed form.

    Args:
        fit: of the closed form.
        told: what all closed forms say together; ``None`` for this one alone.
    """
    told = told or alone(fit)
    slow, fast = (AtSpeed(speed, *told.restitution_at(speed)) for speed in fit.speeds_m_s)
    own = dict(_unknowns(fit))
    return Form(
        model=fit.model, text=bounce_models.model_of(fit.model).text,
        parameters=own if told.is_normal else _averaged(fit, told, own),
        alone={} if told.is_normal else own,
        covariance=_rows(fit.covariance),
        correlation=_rows(fit.correlation), fixed=dict(fit.problem.fixed),
        priors=dict(fit.problem.priors), pulls=dict(fit.pulls), chi2=fit.chi2, dof=fit.dof,
        s2=fit.s2, count=fit.count, effective_unknowns=fit.effective, rms=dict(fit.rms),
        restitution=(slow, fast), at_bound=fit.at_bound, u_known=fit.problem.u_known,
        scattered=fit.is_scattered, assumed=fit.assumed,
    )  # fmt: skip


def _averaged(fit: Fit, told: Averaged, own: Mapping[str, Unknown]) -> dict[str, Unknown]:
    """The unknowns of a closed form as all closed forms together have them."""
    found = dict(own)
    how = AVERAGED if len(told.shares) > 1 else TRUNCATED
    for name in fit.found:
        one = told.unknown(name)
        found[name] = replace(
            own[name], value=one.value, u=one.u, low=one.low, high=one.high, interval=how
        )
    return found


def _unknowns(fit: Fit) -> Iterator[tuple[str, Unknown]]:
    for name, value, u, (low, high), how in zip(
        fit.names, fit.values.tolist(), fit.u.tolist(), fit.intervals, fit.how, strict=True
    ):
        profile = fit.profiles.get(name)
        yield name, Unknown(
            value=value, u=u, low=low, high=high, interval=how,
            open_low=profile is not None and profile.open_low,
            open_high=profile is not None and profile.open_high,
        )  # fmt: skip


def choice_of(choice: model_selection.Choice) -> Choice:
    """What the record says of all closed forms."""
    rows = []
    for one in choice.candidates:
        model, fit = bounce_models.model_of(one.model), one.fit
        values = zip(fit.names, fit.values.tolist(), fit.u.tolist(), strict=True)
        rows.append(
            Candidate(
                model=one.model, text=model.text, law=model.law, drag=model.drag,
                unknowns=one.unknowns, chi2=one.chi2, aic=one.aic, bic=one.bic,
                delta=one.delta, weight=one.weight,
                parameters={name: Value(value, u) for name, value, u in values},
            )
        )  # fmt: skip
    found = Choice(
        chosen=rows[0].model, scatter=choice.scatter, dof=choice.dof,
        refused=dict(choice.refused), candidates=tuple(rows),
    )  # fmt: skip
    rivals = {one.model for one in found.rivals}
    fits = [one.fit for one in choice.candidates if one.model in rivals]
    return replace(found, disagree=any(_apart(choice.best, fit) for fit in fits))


def _apart(one: Fit, other: Fit) -> bool:
    """Whether the 95 % intervals of two restitutions have nothing in common at an end."""
    for speed in one.speeds_m_s:
        (ours, u), (theirs, v) = one.restitution_at(speed), other.restitution_at(speed)
        if abs(ours - theirs) > COVERAGE * (u + v):
            return True
    return False


def _bootstrap(best: Fit) -> Bootstrap:
    found = parametric(best)
    columns = (found.names, *(c.tolist() for c in (found.u, found.low, found.high, found.bias)))
    rows = {name: Repeats(*row) for name, *row in zip(*columns, strict=True)}
    return Bootstrap("parametric", len(found.draws), found.failed, found.seed, rows)


def _source(one: EngineFit, form: Form, predicted: Holdout, identifiable: bool) -> BouncesEngine:
    """What the record says of one engine."""
    found: dict[str, Any] = {}
    if one.fit is not None and one.effective is not None:
        value, u_engine = one.effective
        found = {
            "parameters": _parameters(one.fit, form, one),
            "correlation": _rows(one.fit.correlation),
            "effective": {"restitution": EffectiveValue(value, one.u_effective, u_engine, "1")},
            "native": one.native,
            "shown": tuple(map(_shown, one.shown)),
        }
        # an impact in a plain loop is late by its contact, which is stated and is no residual
        if isinstance(one, AssistedFit):
            found["left_s"] = one.residuals_s
            found["residuals"] = plot_data.residuals(one.fit, one.shown)
        if isinstance(one, TunedFit):
            found |= _plain_loop(one)
    return BouncesEngine(
        name=one.engine, version=one.version, contact=one.contact, status=one.status,
        reason=one.reason, simulations=one.simulations, wall_s=one.wall_s,
        identifiable=identifiable,
        holdout=tuple(
            SourceHoldout(source=drop.source, **vars(drop.engines[one.engine]))
            for drop in predicted.drops if one.engine in drop.engines
        ),
        **found,
    )  # fmt: skip


def _one_number(best: Fit, plain: OneNumber) -> OneRestitution | None:
    if best.problem.model.law == "constant" or not plain.misfit:
        return None
    at = plain.fit.names.index("restitution")
    return OneRestitution(
        float(plain.fit.values[at]), float(plain.fit.u[at]), plain.misfit, plain.most
    )


def _parameters(fit: Fit, form: Form, one: EngineFit) -> dict[str, EngineParameter]:
    """Unknown -> value, uncertainty and interval, and whose it is."""
    found = {}
    for name, row in _unknowns(fit):
        is_own = name == "restitution"
        if name in fit.assumed:
            continue
        told = row if is_own else form.parameters[name]
        found[name] = EngineParameter(
            value=told.value, u=told.u, interval95=(told.low, told.high),
            unit=units.unit_of(name.partition("[")[0]), u_num=one.u_num.get(name, 0.0),
            whose=ENGINE if is_own else CLOSED_FORM, misfit=one.misfit if is_own else 0.0,
        )  # fmt: skip
    return found


def _shown(one: Deviation) -> Shown:
    return Shown(*map(_row, (
        one.times_s, one.restitution, one.u_restitution, one.late_s, one.scatter_s
    )))  # fmt: skip


def _plain_loop(one: TunedFit) -> dict[str, Any]:
    at = one.tuning[0].at[:1] if one.tuning else ()
    contact_s, delay_s = (at[0].contact_s, at[0].delay_s) if at else (None, None)
    return {
        "step_s": one.step_s, "numbers": one.numbers, "impacts": one.impacts,
        "contact_of_first_impact": FirstContact(one.penetration_m, contact_s, delay_s),
        "phases": one.phases, "tuning": one.tuning,
    }  # fmt: skip


def _target(goal: TuningGoal | None) -> Target | None:
    return None if goal is None else Target(goal.restitution, goal.u, goal.speed_m_s)


def _tuned_mean(sources: Sequence[BouncesEngine]) -> float | None:
    """The closed form's mean restitution over the impacts that an engine resolves most of."""
    most = max((source.impacts for source in sources), key=len, default=())
    return sum(row.closed_form for row in most) / len(most) if most else None


def _u_tuned_mean(sources: Sequence[BouncesEngine], told: Averaged) -> float | None:
    """Its standard uncertainty; the impacts share their errors, so theirs is not divided."""
    most = max((source.impacts for source in sources), key=len, default=())
    return sum(told.restitution_at(row.speed_m_s)[1] for row in most) / len(most) if most else None


def _run_with(roles: Roles, start: Fit, engines: Sequence[EngineFit]) -> RunWith:
    """With what a run repeats the fit: parameters of the scenario, and engines' own numbers."""

    def values(one: Fit) -> dict[str, float]:
        found = roles.values(one.problem.values(one.x, 0))
        return {name: value for name, value in found.items() if name != roles.height}

    assisted = {
        one.engine: values(one.fit)
        for one in engines
        if isinstance(one, AssistedFit) and one.fit is not None
    }
    numbers = {
        one.engine: tuple(map(_tuned, one.tuning))
        for one in engines
        if isinstance(one, TunedFit) and one.fit is not None
    }
    return RunWith(values(start), assisted, numbers)


def _tuned(row: TuningRow) -> Tuned:
    return Tuned(row.pairs, row.restitution, row.numbers, row.size_m, row.gravity_m_s2)
