"""The verb ``tune``: what to type into each engine for a restitution, and the other way round."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from simcompare import units
from simcompare.compare.repeats import one_step_s, sample_step_s
from simcompare.engine import engines
from simcompare.engine.backend import Backend
from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.engine.calibration.engine_drops import MIN_GRAVITY_M_S2
from simcompare.engine.calibration.plan import drop_plans
from simcompare.errors import EngineBroken, EngineMissing, InputError
from simcompare.model.settings import COEFFICIENTS, TUNED
from simcompare.running.jobs import OK, UNSUPPORTED, Inquiry, Reply
from simcompare.running.runner import TIME_LIMIT_S, Progress, run_jobs
from simcompare.scenarios import catalogue
from simcompare.tuning.question import StatementQuestion
from simcompare.tuning.request import Request
from simcompare.tuning.statement import Statement
from simcompare.tuning.typed_numbers import check_numbers

#: impact speeds and step where none are given
SPEEDS_M_S, STEP_S = (0.5, 4.0), 0.001
#: steps that make sense for something that bounces [s]
MIN_STEP_S, MAX_STEP_S = 1e-6, 0.1
#: masses and radii of a ball that engines can be expected to take
MASSES_KG, RADII_M = (1e-6, 1e6), (1e-4, 1e2)
#: contact levels in which numbers can be typed in
LEVELS = (COEFFICIENTS, TUNED)


@dataclass(frozen=True)
class TuneResult:
    """One engine's answer to one request.

    Attributes:
        engine: its name.
        version: its version, ``None`` where it is not installed.
        request: what was asked.
        status: "ok", "unsupported", "missing" or "failed".
        reason: one sentence where the status is not "ok"; the nearest that can be had is in it.
        statement: what to type in, and what it does; ``None`` where the status is not "ok".
        snippet: lines to copy into a loop of one's own; empty where only the settings are known.
        about: which pairs of a scenario it is for.
        notes: in what the drop stands for something else than the scene.
    """

    engine: str
    version: str | None
    request: Request
    status: str
    reason: str | None = None
    statement: Statement | None = None
    snippet: str = ""
    about: str = ""
    notes: tuple[str, ...] = ()


def tune(
    scenario: str | None = None,
    *,
    engine: str = "all",
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
) -> list[TuneResult]:
    """Finds what to type into engines for a restitution, or the restitution of what is typed in.

    Args:
        scenario: name, folder or file: its restitutions, bodies, gravity and speeds of impact.
        engine: ``"all"`` or names with commas.
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
    chosen = engines.select(engine)
    asked = _Asked(scenario, restitution, tuple(numbers), contact, chosen)
    if numbers:
        check_numbers(chosen[0], asked.numbers, "--numbers")
    if scenario is None:
        asked.refuse_for_scenario(set, preset)
        plans = [_Question(_request(restitution, mass, radius, step))]
    else:
        asked.refuse_for_drop(mass, radius)
        plans = list(_of_scenario(scenario, set or {}, preset, step))
    speeds_m_s = None if speed is None else _speeds_m_s(speed)
    limits = (
        _part(within, "--within"),
        None if scatter is None else _part(scatter, "--scatter"),
        None if depth is None else _above_0(depth, "m", "--depth"),
    )
    questions = []
    for plan in plans:
        lowest, highest = speeds_m_s or (plan.request.lowest_m_s, plan.request.highest_m_s)
        request = replace(
            plan.request, lowest_m_s=lowest, highest_m_s=highest, within=limits[0],
            scatter_part=limits[1], depth_m=limits[2], numbers=tuple(numbers),
        )  # fmt: skip
        for level in asked.levels:
            questions.append(replace(plan, request=replace(request, level=level)))
    return _answered(chosen, questions, time_limit_s, progress)


@dataclass(frozen=True)
class _Question:
    """A request, for which pairs of a scenario it is, and in what it is unlike it."""

    request: Request
    about: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Asked:
    """What was given, to be refused where it contradicts itself."""

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
    def refuse_for_scenario(settings: Mapping[str, Any] | None, preset: str | None) -> None:
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
    request = Request(wanted, *SPEEDS_M_S, STEP_S if step is None else _step_s(step))
    if mass is not None:
        request = replace(request, mass_kg=_between(mass, "kg", "--mass", MASSES_KG))
    if radius is not None:
        request = replace(request, size_m=2 * _between(radius, "m", "--radius", RADII_M))
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


def _speeds_m_s(speed: str | float | Sequence[float]) -> tuple[float, float]:
    """The lowest and the highest impact speed."""
    parts: list[str | float]
    if isinstance(speed, str):
        parts = [*speed.split("..")]
    else:
        parts = [float(speed)] if isinstance(speed, (int, float)) else [*speed]
    if not 1 <= len(parts) <= 2 or any(isinstance(p, str) and not p.strip() for p in parts):
        raise InputError("--speed", [f"{speed}: expected one speed, or a range such as 1..2m/s"])
    unit = _unit_of(parts[-1])
    values = [_above_0(_with_unit(part, unit), "m/s", "--speed") for part in parts]
    if values[0] > values[-1]:
        raise InputError("--speed", [f"{speed}: the first speed is above the second"])
    return values[0], values[-1]


def _unit_of(text: str | float) -> str:
    return "" if not isinstance(text, str) else text.strip().lstrip("+-0123456789.eE").strip()


def _with_unit(text: str | float, unit: str) -> str | float:
    """A part of a range, in the unit that stands behind the other: ``50..400cm/s``."""
    return f"{text}{unit}" if isinstance(text, str) and not _unit_of(text) else text


def _step_s(step: str | float) -> float:
    found = one_step_s(step)
    if not MIN_STEP_S <= found <= MAX_STEP_S:
        wanted = f"expected {MIN_STEP_S:g} s to {MAX_STEP_S:g} s, such as 2ms"
        raise InputError("--step", [f"{step} is {found:g} s; {wanted}"])
    return found


def _above_0(value: str | float, unit: str, where: str) -> float:
    found = units.to_si(value, unit, where)
    if not found > 0:
        raise InputError(where, [f"{value}: expected a number above 0 in {units.symbol(unit)}"])
    return found


def _between(value: str | float, unit: str, where: str, limits: tuple[float, float]) -> float:
    found = _above_0(value, unit, where)
    if not limits[0] <= found <= limits[1]:
        low, high = (f"{limit:g} {unit}" for limit in limits)
        raise InputError(where, [f"{value}: expected {low} to {high}"])
    return found


def _part(value: str | float, where: str) -> float:
    found = units.to_si(value, "1", where)
    if not 0 < found < 1:
        raise InputError(where, [f"{value}: expected a part between 0 and 1, such as 0.01 or 1%"])
    return found


def _answered(
    chosen: Sequence[str],
    questions: Sequence[_Question],
    time_limit_s: float,
    progress: Progress | None,
) -> list[TuneResult]:
    """Answers from the cache, and from engines where it has none."""
    rows: dict[tuple[str, int], TuneResult] = {}
    open_ones = []
    for name in chosen:
        for i, question in enumerate(questions):
            row = _from_cache(name, question.request)
            if row is None:
                open_ones.append((Inquiry(name, StatementQuestion(question.request)), i))
            else:
                rows[name, i] = replace(row, about=question.about, notes=question.notes)
    jobs = [job for job, _ in open_ones]
    answers = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    for found, (job, i) in zip(answers, open_ones, strict=True):
        row, question = _row(found, questions[i].request), questions[i]
        rows[job.engine, i] = replace(row, about=question.about, notes=question.notes)
    return [rows[name, i] for i in range(len(questions)) for name in chosen]


def _from_cache(name: str, request: Request) -> TuneResult | None:
    try:
        backend = engines.get(name)
        version = backend.version()
        statement = StatementQuestion(request).known(backend)
    except (EngineMissing, EngineBroken):  # the row says so
        return None
    except CannotCalibrate as error:
        return TuneResult(name, version, request, UNSUPPORTED, str(error))
    if statement is None:
        return None
    return _with_snippet(backend, TuneResult(name, version, request, OK, None, statement))


def _row(found: Reply[Statement], request: Request) -> TuneResult:
    row = TuneResult(
        found.job.engine, found.version, request, found.status, found.reason, found.value
    )
    if found.status != OK:
        return row
    return _with_snippet(engines.get(found.job.engine), row)


def _with_snippet(backend: Backend, row: TuneResult) -> TuneResult:
    """The row with the lines to copy, where the engine has some for all that is set."""
    found, request = row.statement, row.request
    template = getattr(backend, "snippet", "") if request.level == TUNED else ""
    if found is None or not template:
        return row
    typed = {one.parameter: one.value for one in found.typed}
    snippet = template.format(*found.numbers, step_s=request.step_s, typed=typed)
    return replace(row, snippet=snippet)
