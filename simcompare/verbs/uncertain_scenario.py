"""``uncertainty`` of a result of a scenario, by its closed form and by engines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from simcompare import measures
from simcompare.comparison.repeats import repeats_of, sample_step_s
from simcompare.engine import engines
from simcompare.errors import InputError, SimcompareError, UnknownName
from simcompare.model.scenario import Scenario
from simcompare.propagation import closed_form, engine_runs, formulas, inputs, results
from simcompare.propagation.closed_form import ClosedForm
from simcompare.propagation.engine_runs import Runs
from simcompare.propagation.propagated import Asked
from simcompare.propagation.steps import Steps, steps_of
from simcompare.results.records.uncertainty import CLOSED_FORM, FORMULA, Way
from simcompare.running.jobs import FAILED, OK, Job, Outcome
from simcompare.running.runner import Progress, run_jobs
from simcompare.scenarios import catalogue, robot_values
from simcompare.scenarios.robot_values import Taken
from simcompare.verbs.request import UncertaintyRequest
from simcompare.verbs.uncertain import Uncertain
from simcompare.verbs.uncertain_formula import record_of


def of_scenario(
    request: UncertaintyRequest,
    asked: Asked,
    stated: Mapping[str, str | float],
    reasons: Mapping[str, str],
    time_limit_s: float,
    progress: Progress | None,
) -> Uncertain:
    """A result of a scenario, or a formula in its parameters.

    Raises:
        SimcompareError: faults of the arguments or of the scenario, or nothing that can be asked.
    """
    taken = robot_values.taken(catalogue.load(request.scenario), request.robot)
    file, repeats = taken.file, _repeats(request, taken)
    nominal = repeats[len(repeats) // 2]
    known = inputs.of_scenario(file, nominal.parameters, stated, reasons)
    asked = replace(asked, known=known, correlation=inputs.named(asked.correlation, known))
    if request.of is not None and not request.of.strip().isidentifier():
        found = _of_parameters(request, asked, nominal.parameters)
        return replace(found, cautions=taken.left_out)
    form = ClosedForm(file, nominal, results.chosen(nominal, request.of))
    steps = {one.name: steps_of(one, file.parameters[one.name]) for one in known}
    drawn = {} if request.trials is None else engine_runs.draws(asked, request.trials)
    ways = _closed_form(form, asked, steps, progress)
    if request.engine:
        runs = Runs(file, form.of, repeats, steps, drawn)
        ways += _engines(request, runs, asked, time_limit_s, progress)
    if not ways:
        why = "; ".join(nominal.beyond).rstrip(".") or f"{file.name} has none"
        raise InputError("--engine", [f"no closed form: {why}; name an engine, such as all"])
    found = record_of(
        request, asked, known, subject=file.name, of=form.of, ways=tuple(ways),
        unit=measures.results_of(nominal)[form.of],
        beyond=nominal.beyond or closed_form.beyond_near(form, asked),
    )  # fmt: skip
    return replace(found, cautions=taken.left_out)


def _repeats(request: UncertaintyRequest, taken: Taken) -> list[Scenario]:
    """The scenario with numbers, once for each dithered repeat."""
    file = taken.file
    values = {**taken.values, **file.read_settings(request.set or {})}
    step_s = None
    if request.step is not None:
        step_s = sample_step_s(file, values, request.preset, request.step)
    return repeats_of(file, values, request.preset, step_s, request.seeds)


def _closed_form(
    form: ClosedForm, asked: Asked, steps: Steps, progress: Progress | None
) -> list[Way]:
    """The way by the closed form, where there is one that holds."""
    if form.scenario.beyond or not catalogue.has_reference(form.file.path):
        return []
    told = _told(progress, CLOSED_FORM)
    return [Way(CLOSED_FORM, found=closed_form.propagated(form, asked, steps, told))]


def _of_parameters(
    request: UncertaintyRequest, asked: Asked, parameters: Mapping[str, float]
) -> Uncertain:
    """A formula in the parameters of a scenario."""
    formula = formulas.asked_of(request.of or "")
    faults = [
        str(UnknownName("parameter", name, parameters))
        for name in formula.names
        if name not in parameters
    ]
    if request.engine:
        faults.append("an engine calculates no formula; leave out --engine, or name a result")
    if faults:
        raise InputError("--of", faults)
    known = tuple(one for one in asked.known if one.name in formula.names)
    if not known:
        such = formula.names[0]
        raise InputError("--u", [f"nothing in the formula is uncertain; give --u {such}=1%"])
    names = {one.name for one in known}
    pairs = {pair: r for pair, r in asked.correlation.items() if set(pair) <= names}
    asked = replace(asked, known=known, correlation=pairs)
    values = {name: parameters[name] for name in formula.names}
    found = formulas.propagated(formula, values, asked)
    unit = formulas.unit_of_names(formula, values)
    return record_of(
        request, asked, known, subject=formula.text, of="", unit=unit,
        ways=(Way(FORMULA, found=found),),
    )  # fmt: skip


def _engines(
    request: UncertaintyRequest,
    runs: Runs,
    asked: Asked,
    time_limit_s: float,
    progress: Progress | None,
) -> list[Way]:
    chosen = engines.select(request.engine)
    jobs = [job for name in chosen for job in runs.jobs(name, request.contact, None)]
    each = len(jobs) // len(chosen)
    outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    return [
        _way(runs, asked, outcomes[i * each : (i + 1) * each], request.contact)
        for i in range(len(chosen))
    ]


def _way(runs: Runs, asked: Asked, outcomes: Sequence[Outcome], contact: str) -> Way:
    """What one engine tells, or why it does not."""
    job: Job = outcomes[0].job
    bad = next((one for one in outcomes if one.status != OK), None)
    way = Way(job.engine, contact, version=outcomes[0].facts.version, runs=len(outcomes))
    if bad is not None:
        return replace(way, status=bad.status, reason=bad.reason)
    try:
        return replace(way, found=engine_runs.propagated(runs, asked, outcomes))
    except SimcompareError as error:
        return replace(way, status=FAILED, reason=f"{job.engine}: {error}")


def _told(progress: Progress | None, source: str) -> closed_form.Told:
    def told(done: int, total: int) -> None:
        if progress is not None and done % 20 == 0:
            progress(source, done, total)

    return told
