"""The verb ``characterize``: how engines behave in small experiments with a known answer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from simcompare.arguments import checked
from simcompare.characterization.behaviour import Behaviour
from simcompare.characterization.bounce import BounceQuestion
from simcompare.characterization.experiment import Experiment
from simcompare.characterization.force import ForceQuestion
from simcompare.characterization.friction import FrictionQuestion
from simcompare.characterization.joint import JointQuestion
from simcompare.comparison.repeats import one_step_s, step_found, step_wanted
from simcompare.engine import engines
from simcompare.errors import BackendError, InputError
from simcompare.model.settings import CONTACT_LEVELS
from simcompare.reports.characterization import findings
from simcompare.results import result_file, store
from simcompare.results.records.characterization import Trial
from simcompare.results.run_record import now, software
from simcompare.running.jobs import MISSING, Inquiry, Reply
from simcompare.running.runner import TIME_LIMIT_S, Progress, check_time_limit, run_jobs
from simcompare.verbs.characterized import Characterized
from simcompare.verbs.levels import chosen_names
from simcompare.verbs.notebook_line import with_line

#: experiment -> the question that is asked at a contact level and a step
EXPERIMENTS: Mapping[str, Callable[[str, float], Experiment[Any]]] = {
    "bounce": BounceQuestion,
    "friction": FrictionQuestion,
    "joint": JointQuestion,
    "force": ForceQuestion,
}
#: steps between which the experiments can be read [s]
MIN_STEP_S, MAX_STEP_S = 0.1e-3, 10e-3
FILE = "characterization.json"


@checked
@with_line
def characterize(
    experiments: str | Sequence[str] = "all",
    *,
    engine: str | Sequence[str] = "all",
    contact: str | Sequence[str] = CONTACT_LEVELS,
    step: str | float = "1ms",
    out: str | Path | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Characterized:
    """Shows how engines behave in small experiments with a known answer.

    ::

        found = simcompare.characterize("bounce,friction", engine="mujoco,ode")
        found.table("friction")
        found.plot()

    Bounces of a sphere, friction of a block, a hinge with damper and spring, and the forces that an
    engine tells, over speeds, loads and steps. What was found once is kept in the user's cache.

    Args:
        experiments: "all", or some of bounce, friction, joint and force.
        engine: "all", names with commas or a list of names.
        contact: contact levels.
        step: the engine's step, such as "1ms"; a number is in seconds. Each experiment is also
            looked at over steps from 0.25 to 8 ms.
        out: folder for the folder of the results; nothing is stored where ``None``.
        time_limit_s: longest time for one experiment at one level on one engine [s].
        progress: called as ``progress(engine, done, total)``.

    Returns:
        What was found, and the folder in which it is stored.

    Raises:
        UnknownName: no such experiment, engine or contact level.
        InputError: a step that makes no sense.
        EngineMissing: none of the engines is installed.
        OutputError: the folder cannot be written to.
    """
    engine = engines.listed(engine)
    names = chosen_names("experiment", experiments, EXPERIMENTS)
    levels = chosen_names("contact level", contact, CONTACT_LEVELS)
    step_s = _step_s(step)
    jobs = [
        Inquiry(one, EXPERIMENTS[name](level, step_s), f"{name} {level}")
        for one in engines.select(engine)
        for name in names
        for level in levels
    ]
    check_time_limit(time_limit_s)
    if out is not None:
        store.check_writable(Path(out))
    replies = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    _refuse_nothing(replies)
    answers = tuple(map(_trial, replies))
    result = Characterized(
        created=now(),
        step_s=step_s, experiments=tuple(names), contact=tuple(levels), engines_asked=engine,
        sentences=tuple(findings.sentences(answers, step_s)), answers=answers, software=software(),
    )  # fmt: skip
    return result if out is None else result_file.save(result, Path(out), "characterization", FILE)


def _step_s(step: str | float) -> float:
    step_s = one_step_s(step)
    if not MIN_STEP_S <= step_s <= MAX_STEP_S:
        wrong = "no step at which the experiments can be read"
        use = step_wanted(step_s, MIN_STEP_S, MAX_STEP_S, "1ms")
        raise InputError("--step", [f"{step_found(step, step_s)} is {wrong}; {use}"])
    return step_s


def _refuse_nothing(replies: Sequence[Reply[Behaviour]]) -> None:
    """Raises the first reason where no engine is there at all."""
    if all(reply.status == MISSING for reply in replies):
        reasons = dict.fromkeys(str(reply.reason) for reply in replies)
        raise BackendError("\n".join(reasons))


def _trial(reply: Reply[Behaviour]) -> Trial:
    name, level = reply.job.about.split()
    return Trial(
        reply.job.engine, reply.version, name, level, reply.status, reply.reason, reply.value
    )
