"""What is asked of contact levels: which run, with which helps, and which are judged."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare.engine import engines
from simcompare.engine.assist import chosen
from simcompare.engine.helps import HELPS, known
from simcompare.errors import InputError, UnknownName, unknown_or_missing
from simcompare.model.settings import ASSISTED, BY_HAND, CONTACT_LEVELS, OLD_LEVELS, TUNED
from simcompare.running.jobs import UNSUPPORTED, Job, Outcome

if TYPE_CHECKING:
    from simcompare.results.fit_file import FitFile
    from simcompare.scenarios.scenario_file import ScenarioFile


def names(listed: str | Sequence[str]) -> tuple[str, ...]:
    """Names of levels or helps, from a list or a text with commas."""
    return tuple(
        part.strip() for part in (listed.split(",") if isinstance(listed, str) else listed)
    )


def chosen_names(kind: str, asked: str | Sequence[str], known: Iterable[str]) -> list[str]:
    """Names out of a text with commas or a list, each once; all of them for "all".

    Raises:
        UnknownName: one of them does not exist, or there is none.
    """
    wanted, known = [OLD_LEVELS.get(name, name) for name in names(asked)], list(known)
    if "all" in wanted:
        return known
    for name in wanted or [""]:
        if name not in known:
            raise UnknownName(kind, name, known)
    return list(dict.fromkeys(wanted))


def chosen_levels(
    contact: str | Sequence[str], *, by_hand: bool = False
) -> tuple[list[str], FitFile | None]:
    """Contact levels, and the fit where one of them is a file.

    Args:
        contact: what was asked for.
        by_hand: whether engines were given values of their own, which then run as well.
    """
    asked = [OLD_LEVELS.get(level, level) for level in names(contact)]
    if not by_hand:
        return _chosen_levels(asked)
    modes, fit = _chosen_levels([level for level in asked if level != BY_HAND])
    return [*modes, BY_HAND], fit


def _chosen_levels(asked: Sequence[str]) -> tuple[list[str], FitFile | None]:
    if BY_HAND in asked:
        fault = f"{BY_HAND} needs values of an engine, such as --own pymunk.elasticity=0.9"
        raise InputError("--contact", [fault])
    if set(asked) <= set(CONTACT_LEVELS):
        return list(dict.fromkeys(asked)), None
    from simcompare.results import fit_file

    modes, fit = [], None
    for mode in asked:
        path = None if mode in CONTACT_LEVELS else fit_file.find(mode)
        if path is not None:
            if fit is not None:
                raise InputError("--contact", [f"{mode} is a second fit; a run takes one"])
            fit = fit_file.read(path)
            modes.append(fit_file.FITTED)
        elif mode in CONTACT_LEVELS:
            modes.append(mode)
        elif Path(mode).is_dir():
            raise InputError("--contact", [f"{mode} is a folder without {fit_file.FILE}"])
        else:
            raise unknown_or_missing("contact level or fit", mode, CONTACT_LEVELS)
    return list(dict.fromkeys(modes)), fit


def not_in_fit(jobs: Sequence[Job], fit: FitFile, file: ScenarioFile) -> list[Outcome]:
    """Jobs that ask for fitted numbers of an engine that was not fitted, refused unrun."""
    fitted = [job for job in jobs if job.mode not in (*CONTACT_LEVELS, BY_HAND)]
    without = {job.engine for job in fitted if fit.of_engine(job.engine, file) is None}
    # no step makes it possible, but another choice of the user does
    return [
        Outcome(job, UNSUPPORTED, f"{job.engine}: not in this fit", longest_step_s=math.inf)
        for job in fitted if job.engine in without
    ]  # fmt: skip


def chosen_helps(assist: str | Sequence[str], engine: str) -> frozenset[str] | None:
    """The helps that were asked for; ``None``: all that an engine takes.

    Raises:
        InputError: an engine that was named takes one of them not; says which it takes.
    """
    helps = chosen(assist)
    if helps == frozenset(HELPS):
        return None
    faults = []
    for name in [] if engine == "all" else engines.select(engine):
        takes: frozenset[str] = getattr(engines.get(name), "helps", frozenset())
        if helps - takes:
            faults.append(
                f"{name} takes no {known(helps - takes)}; it takes {known(takes) or 'none'}"
            )
    if faults:
        raise InputError("--assist", faults)
    return helps


def check_used(
    levels: Sequence[str], helps: frozenset[str] | None, judge: str | Sequence[str]
) -> None:
    """Refuses options that would do nothing.

    Raises:
        InputError: helps without a level that takes them, or a level to judge that is not run.
    """
    if helps is not None and ASSISTED not in levels:
        raise InputError("--assist", [f"is for the level {ASSISTED}; name it in --contact"])
    if TUNED in names(judge) and not {TUNED, "fitted"} & {*levels}:
        raise InputError("--judge", [f"{TUNED} is not among the levels that run; see --contact"])


def judged_levels(judge: str | Sequence[str], fit: FitFile | None) -> list[str]:
    """Levels whose failures count; those of a fit for a plain loop where "tuned" does."""
    named = names(judge)
    for level in named:
        if level not in (TUNED, ASSISTED):
            raise UnknownName("level that is judged", level, (TUNED, ASSISTED))
    plain = fit is not None and fit.contact == TUNED and TUNED not in named
    return sorted({*named, ASSISTED, *(() if plain else ("fitted",))})
