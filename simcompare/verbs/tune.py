"""The verb ``tune``: what to type into each engine for a restitution, and the other way round."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from simcompare import units
from simcompare.arguments import checked
from simcompare.comparison.repeats import sample_step_s
from simcompare.engine import engines
from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.engine.calibration.engine_drops import MIN_GRAVITY_M_S2
from simcompare.engine.calibration.plan import drop_plans
from simcompare.errors import EngineBroken, EngineMissing, InputError
from simcompare.model.settings import COEFFICIENTS, TUNED
from simcompare.running.jobs import OK, UNSUPPORTED, Inquiry
from simcompare.running.runner import TIME_LIMIT_S, Progress, run_jobs
from simcompare.scenarios import catalogue
from simcompare.tuning.request import Request
from simcompare.tuning.statement import Statement
from simcompare.tuning.statements import StatementQuestion
from simcompare.tuning.typed_numbers import check_numbers
from simcompare.verbs import tune_arguments
from simcompare.verbs.notebook_line import with_line
from simcompare.verbs.tuning import TuneResult, Tuning

#: impact speeds and step where none are given
SPEEDS_M_S, STEP_S = (0.5, 4.0), 0.001
#: masses and radii of a ball that engines can be expected to take
MASSES_KG, RADII_M = (1e-6, 1e6), (1e-4, 1e2)
#: contact levels in which numbers can be typed in
LEVELS = (COEFFICIENTS, TUNED)


@checked
@with_line
def tune(
    scenario: str | Path | None = None,
    *,
    engine: str | Sequence[str] = "all",
    restitution: str | float | None = None,
    speed: str | float | Sequence[float] | None = None,
    step: str | float | None = None,
    mass: str | float | None = None,
    radius: str | float | None = None,
    within: str | float = 0.01,
    scatter: str | float | None = None,
    depth: str | float | None = None,
    numbers: Sequence[float] = (),
    contact: str | None = None,
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Tuning:
    """Finds what to type into engines for a restitution, or the restitution of what is typed in.

    ::

        found = simcompare.tune(restitution=0.8, speed="0.5..4", step="2ms")
        found.plot()  # restitution over the speed of the impact
        print(found[0].snippet)  # lines to copy

    Args:
        scenario: name, folder or file: its restitutions, bodies, gravity and speeds of impact.
        engine: ``"all"``, names with commas or a list of names.
        restitution: Newton's coefficient, in place of a scenario.
        speed: of the impact, "2" or "0.5..4" in m/s, also with a unit; a pair from Python.
        step: the engine's step, "1ms" or in seconds.
        mass: of the body.
        radius: of the body, a sphere.
        within: part of the restitution by which its mean may be off where the numbers hold.
        scatter: largest standard deviation over the phases of the step, as part of the restitution:
            then the stiffest contact within it is sought.
        depth: largest penetration: then the contact that scatters least within it is sought.
        numbers: what one engine is given for a restitution, which is asked for then.
        contact: contact level of all else: "tuned", or "coefficients", the engine as it comes;
            ``None``: both for numbers that are given, else tuned.
        set: parameters of the scenario that differ from its file.
        preset: its named set of parameters, applied first.
        time_limit_s: longest time for one engine [s].
        progress: called as ``progress(engine, done, total)``.

    Returns:
        One answer for every engine and restitution.

    Raises:
        SimcompareError: faults of the arguments.
    """
    chosen = engines.select(engines.listed(engine))
    scenario = None if scenario is None else str(scenario)
    goal = _Goal(scenario, restitution, tuple(numbers), contact, chosen)
    if numbers:
        check_numbers(chosen[0], goal.numbers, "--numbers")
    if scenario is None:
        goal.refuse_for_scenario(set, preset)
        plans = [_Question(_request(restitution, mass, radius, step))]
    else:
        goal.refuse_for_drop(mass, radius)
        plans = list(_of_scenario(scenario, set or {}, preset, step))
    speeds_m_s = None if speed is None else tune_arguments.speeds_m_s(speed)
    limits = (
        tune_arguments.part(within, "--within"),
        None if scatter is None else tune_arguments.part(scatter, "--scatter"),
        None if depth is None else tune_arguments.above_0(depth, "m", "--depth"),
    )
    questions = []
    for plan in plans:
        lowest, highest = speeds_m_s or (plan.request.lowest_m_s, plan.request.highest_m_s)
        request = replace(
            plan.request, lowest_m_s=lowest, highest_m_s=highest, within=limits[0],
            scatter_part=limits[1], depth_m=limits[2], numbers=tuple(numbers),
        )  # fmt: skip
        for level in goal.levels:
            questions.append(replace(plan, request=replace(request, level=level)))
    return Tuning(_answered(chosen, questions, time_limit_s, progress))


@dataclass(frozen=True)
class _Question:
    """A request, for which pairs of a scenario it is, and in what it is unlike it."""

    request: Request
    about: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Goal:
    """What is to be found, refused where it contradicts itself."""

    scenario: str | None
    restitution: str | float | None
    numbers: tuple[float, ...]
    contact: str | None
    engines: Sequence[str]

    @property
    def levels(self) -> tuple[str, ...]:
        """Contact levels of all else."""
        if self.contact is None:
            return LEVELS if self.numbers else (TUNED,)
        return (self.contact,)

    def __post_init__(self) -> None:
        if self.contact is not None and self.contact not in LEVELS:
            raise InputError("--contact", [f"{self.contact}: expected {' or '.join(LEVELS)}"])
        if self.numbers and len(self.engines) != 1:
            raise InputError("--numbers", ["are those of one engine; give --engine NAME"])
        given = [self.scenario is not None, self.restitution is not None, bool(self.numbers)]
        if sum(given) == 1:
            return
        wanted = (
            "a scenario, --restitution 0.8, or an engine's own numbers: --engine NAME --numbers A,B"
        )
        fault = f"expected {wanted}" if not any(given) else f"expected one of these: {wanted}"
        raise InputError("tune", [fault])

    @staticmethod
    def refuse_for_scenario(settings: Mapping[str, object] | None, preset: str | None) -> None:
        given = [name for name, value in (("--set", settings), ("--preset", preset)) if value]
        if given:
            raise InputError("tune", [f"{name} is for a scenario; name one" for name in given])

    @staticmethod
    def refuse_for_drop(mass: object, radius: object) -> None:
        given = [n for n, value in (("--mass", mass), ("--radius", radius)) if value is not None]
        if given:
            cure = "the scenario has its own; change it with --set"
            raise InputError("tune", [f"{name}: {cure}" for name in given])


def _request(
    restitution: str | float | None,
    mass: str | float | None,
    radius: str | float | None,
    step: str | float | None,
) -> Request:
    wanted = None if restitution is None else units.to_si(restitution, "1", "--restitution")
    if wanted is not None and not 0 < wanted <= 1:
        raise InputError("--restitution", [f"{restitution}: expected a number above 0, up to 1"])
    request = Request(wanted, *SPEEDS_M_S, STEP_S if step is None else tune_arguments.step_s(step))
    if mass is not None:
        request = replace(request, mass_kg=tune_arguments.between(mass, "kg", "--mass", MASSES_KG))
    if radius is not None:
        request = replace(
            request, size_m=2 * tune_arguments.between(radius, "m", "--radius", RADII_M)
        )
    return request


def _of_scenario(
    scenario: str, settings: Mapping[str, str | float], preset: str | None, step: str | float | None
) -> Iterable[_Question]:
    """A request for each restitution of a scenario, with its pairs and notes."""
    file = catalogue.load(scenario)
    values = file.read_settings(settings)
    step_s = None if step is None else sample_step_s(file, values, preset, step)
    plans = drop_plans(file.resolve(values, preset=preset, step_s=step_s))
    if not plans:
        raise InputError(scenario, ["nothing in it has a restitution above 0, so nothing is tuned"])
    for plan in plans:
        gravity, notes = plan.gravity_m_s2, plan.notes
        if gravity < MIN_GRAVITY_M_S2:
            gravity = MIN_GRAVITY_M_S2
            notes = (*notes, f"nothing pulls them together; drops are made at {gravity:g} m/s²")
        yield _Question(
            Request(
                plan.restitution, plan.speed_m_s, plan.speed_m_s, plan.step_s, plan.mass_kg,
                plan.size_m, gravity,
            ),
            ", ".join("-".join(pair) for pair in plan.pairs),
            notes,
        )  # fmt: skip


def _answered(
    chosen: Sequence[str],
    questions: Sequence[_Question],
    time_limit_s: float,
    progress: Progress | None,
) -> list[TuneResult]:
    """Answers from the cache, and from engines where it has none."""
    rows: dict[tuple[str, int], TuneResult] = {}
    inquiries, places = [], []
    for name in chosen:
        for i, question in enumerate(questions):
            row = _from_cache(name, question)
            if row is not None:
                rows[name, i] = row
                continue
            inquiries.append(Inquiry(name, StatementQuestion(question.request)))
            places.append((name, i))
    replies = run_jobs(inquiries, time_limit_s=time_limit_s, progress=progress)
    for reply, (name, i) in zip(replies, places, strict=True):
        rows[name, i] = _result(
            questions[i], name, reply.version, reply.status, reply.reason, reply.value
        )
    return [rows[name, i] for i in range(len(questions)) for name in chosen]


def _from_cache(name: str, question: _Question) -> TuneResult | None:
    try:
        backend = engines.get(name)
        version = backend.version()
        statement = StatementQuestion(question.request).known(backend)
    except (EngineMissing, EngineBroken):  # the row says so
        return None
    except CannotCalibrate as error:
        return _result(question, name, version, UNSUPPORTED, str(error))
    if statement is None:
        return None
    return _result(question, name, version, OK, None, statement)


def _result(
    question: _Question,
    name: str,
    version: str | None,
    status: str,
    reason: str | None = None,
    statement: Statement | None = None,
) -> TuneResult:
    snippet = "" if statement is None else _snippet(name, question.request, statement)
    return TuneResult(
        name, version, question.request, status, reason, statement, snippet, question.about,
        question.notes,
    )  # fmt: skip


def _snippet(name: str, request: Request, statement: Statement) -> str:
    """The lines to copy, where the engine has some for all that is set."""
    template = getattr(engines.get(name), "snippet", "") if request.level == TUNED else ""
    typed = {one.parameter: one.value for one in statement.typed}
    return str(template).format(*statement.numbers, step_s=request.step_s, typed=typed)
