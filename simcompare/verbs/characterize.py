"""The verb ``characterize``: how engines behave in small experiments with a known answer."""

from __future__ import annotations

import datetime
import json
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from simcompare import notation
from simcompare.characterization.bounce import BounceQuestion
from simcompare.characterization.force import ForceQuestion
from simcompare.characterization.friction import FrictionQuestion
from simcompare.characterization.joint import JointQuestion
from simcompare.characterization.result import Characterization
from simcompare.compare.repeats import one_step_s
from simcompare.engine import engines
from simcompare.engine.library import installed_version
from simcompare.errors import BackendError, InputError, OutputError, UnknownName
from simcompare.model.settings import CONTACT_LEVELS, OLD_LEVELS
from simcompare.reports.characterization import findings
from simcompare.running.jobs import MISSING, OK, Inquiry, Reply
from simcompare.running.runner import TIME_LIMIT_S, Progress, check_time_limit, run_jobs

#: experiment -> the question that is asked at a contact level and a step
EXPERIMENTS: Mapping[str, Callable[[str, float], Callable[[Any], dict[str, Any]]]] = {
    "bounce": BounceQuestion,
    "friction": FrictionQuestion,
    "joint": JointQuestion,
    "force": ForceQuestion,
}
#: steps between which the experiments can be read [s]
SHORTEST_S, LONGEST_S = 0.1e-3, 10e-3
FILE, FORMAT = "characterization.json", 1


def characterize(
    experiments: str | Sequence[str] = "all",
    *,
    engine: str = "all",
    contact: str | Sequence[str] = CONTACT_LEVELS,
    step: str | float = "1ms",
    out: str | Path | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Characterization:
    """Shows how engines behave in small experiments with a known answer.

    Bounces of a sphere, friction of a block, a hinge with damper and spring, and the forces that an
    engine tells, over speeds, loads and steps. What was found once is kept in the user's cache.

    Args:
        experiments: "all", or some of bounce, friction, joint and force.
        engine: "all", or names with commas.
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
    names = _chosen("experiment", experiments, EXPERIMENTS)
    levels = _chosen("contact level", contact, CONTACT_LEVELS)
    step_s = _step_s(step)
    jobs = [
        Inquiry(one, EXPERIMENTS[name](level, step_s), f"{name} {level}")
        for one in engines.select(engine)
        for name in names
        for level in levels
    ]
    check_time_limit(time_limit_s)
    folder = None if out is None else _place(Path(out))
    try:
        answers = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
        _refuse_nothing(answers)
    except BaseException:
        if folder is not None:
            folder.rmdir()
        raise
    record = _record(answers, names, levels, step_s, engine)
    result = Characterization(record)
    return result if folder is None else _saved(result, folder)


def _chosen(
    kind: str, asked: str | Sequence[str], known: Sequence[str] | Mapping[str, Any]
) -> list[str]:
    """Names out of a text with commas or a list, each once.

    Raises:
        UnknownName: one of them does not exist, or there is none.
    """
    words = asked.split(",") if isinstance(asked, str) else asked
    names = [OLD_LEVELS.get(word.strip(), word.strip()) for word in words]
    if "all" in names:
        return list(known)
    for name in names or [""]:
        if name not in known:
            raise UnknownName(kind, name, known)
    return list(dict.fromkeys(names))


def _step_s(step: str | float) -> float:
    step_s = one_step_s(step)
    if not SHORTEST_S <= step_s <= LONGEST_S:
        raise InputError(
            "--step",
            [
                f"{step_s:g} s is not a step at which the experiments can be read; use"
                f" {1e3 * SHORTEST_S:g} ms to {1e3 * LONGEST_S:g} ms"
            ],
        )
    return step_s


def _refuse_nothing(answers: Sequence[Reply]) -> None:
    """Raises the first reason where no engine is there at all."""
    if all(answer.status == MISSING for answer in answers):
        reasons = dict.fromkeys(str(answer.reason) for answer in answers)
        raise BackendError("\n".join(reasons))


def _record(
    answers: Sequence[Reply], names: list[str], levels: list[str], step_s: float, asked: str
) -> dict[str, Any]:
    found = [_plain(answer) for answer in answers]
    return {
        "format": FORMAT,
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "title": "How engines behave",
        "question": "What does each engine make of a bounce, of friction, of a joint and of a"
        " force, at which step and speed?",
        "step_s": step_s,
        "experiments": names,
        "contact": levels,
        "engines_asked": asked,
        "sentences": findings.sentences(found, step_s),
        "answers": found,
        "software": {
            "simcompare": installed_version("simcompare"),
            "python": platform.python_version(),
            "numpy": installed_version("numpy"),
        },
    }


def _plain(answer: Reply) -> dict[str, Any]:
    """An answer as plain values, numbers that are not finite as ``None``."""
    name, level = answer.job.about.split()
    return {
        "engine": answer.job.engine,
        "version": answer.version,
        "experiment": name,
        "contact": level,
        "status": answer.status,
        "reason": answer.reason,
        "found": notation.finite(answer.value) if answer.status == OK else None,
    }


def _place(folder: Path) -> Path:
    """A new folder for the results, made before anything is asked."""
    stamp = datetime.datetime.now(datetime.UTC).strftime("%Y%m%d-%H%M%S")
    base, number = f"{stamp}-characterization", 1
    while True:
        place = folder / (base if number == 1 else f"{base}-{number}")
        try:
            place.mkdir(parents=True)
        except FileExistsError:
            number += 1
            if not folder.is_dir():
                raise _not_writable(folder, "is no folder") from None
        except OSError as error:
            raise _not_writable(folder, error.strerror or str(error)) from None
        else:
            return place


def _saved(result: Characterization, place: Path) -> Characterization:
    record = {**result.record, "folder": str(place)}
    text = json.dumps(record, indent=1, ensure_ascii=False, allow_nan=False)
    try:
        (place / FILE).write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        raise _not_writable(place, error.strerror or str(error)) from None
    return replace(result, record=record, folder=place)


def _not_writable(folder: Path, why: str) -> OutputError:
    return OutputError(f"--out {folder}: cannot be written to ({why}); choose another folder")
