"""Which tosses are fitted and which are predicted, and what is sought."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.fitting.tosses.replay import spacing_s
from simcompare.fitting.tosses.roles import TossRoles
from simcompare.fitting.tosses.tosses import (
    MIN_IN_FLIGHT,
    Toss,
    combined,
    split,
    witnesses,
)
from simcompare.inference import sources
from simcompare.inference.sources import Source
from simcompare.model.fittable import Grid
from simcompare.model.recording import Recording, Stream
from simcompare.results.records.fit_tosses import Witness

#: channels that a recording of tosses has
POSITION, ORIENTATION = ("x_m", "y_m", "z_m"), ("q_w", "q_x", "q_y", "q_z")
#: tosses that are fitted where none are held out by name, and the seed by which they are drawn
FITTED, SEED = 60, 1
#: fewest tosses that are fitted
MIN_FITTED = 4
#: faults of a kind that are named
_NAMED = 3


@dataclass(frozen=True)
class Setup:
    """What is fitted.

    Attributes:
        grids: parameter -> where it is sought.
        fitted: tosses that are fitted.
        held: tosses that are predicted.
        scale: measured lengths over true ones, by which all tosses were divided.
        witnesses: what tells the scale of the recording as measured; none where nothing does.
        told: what the reader must know of this choice.
    """

    grids: Mapping[str, Grid]
    fitted: tuple[Toss, ...]
    held: tuple[Toss, ...]
    scale: float
    witnesses: tuple[Witness, ...]
    told: tuple[str, ...]


def prepare(
    roles: TossRoles,
    recordings: Sequence[str],
    hold_out: Sequence[str],
    *,
    unknowns: Sequence[str],
    given: Mapping[str, float],
    scale: float = 1.0,
    mapping: str | Path | None = None,
) -> Setup:
    """Reads the recordings and chooses what is fitted.

    Args:
        roles: the scenario.
        recordings: logs, stored recordings, or public data sets that are fitted.
        hold_out: the same, which are only predicted; where there are none, tosses of the former
            are drawn, and the others predicted.
        unknowns: what is sought; what is usually sought, where empty.
        given: parameters that the user sets; they are not sought.
        scale: measured lengths over true ones.
        mapping: mapping file for the logs.

    Raises:
        InputError: every fault of the request or of a recording.
    """
    grids = _grids(roles, unknowns, given)
    _check_once(recordings, hold_out)
    told: list[str] = []
    every = _tosses(recordings, mapping, told)
    held = _tosses(hold_out, mapping, told)
    count = len(every) if hold_out else min(FITTED, len(every) // 2)
    if count < MIN_FITTED:
        least = MIN_FITTED if hold_out else 2 * MIN_FITTED
        there = "1 toss" if len(every) == 1 else f"{len(every)} tosses"
        more = "" if hold_out else f", or {MIN_FITTED} and others by --hold-out"
        raise InputError("--recording", [f"{there} can be used; expected at least {least}{more}"])
    names = ", ".join(recordings)
    if hold_out:
        told.insert(0, f"Fitted to the {count} tosses of {names}; the {len(held)} of"
                    f" {', '.join(hold_out)} are predicted.")  # fmt: skip
    else:
        chosen, held = split(every, count, len(every) - count, SEED)
        told.insert(0, f"Fitted to {count} of the {len(every)} tosses of {names}, drawn by chance"
                    f" with the seed {SEED}; the other {len(held)} are predicted.")  # fmt: skip
    found = _witnesses(every, roles)
    fitted = every if hold_out else chosen
    return Setup(
        grids, tuple(toss.scaled(scale) for toss in fitted),
        tuple(toss.scaled(scale) for toss in held), scale, found, tuple(told),
    )  # fmt: skip


def _grids(
    roles: TossRoles, unknowns: Sequence[str], given: Mapping[str, float]
) -> dict[str, Grid]:
    fit = roles.fit
    wanted = [name for name in fit.parameters if fit.grids[name].usual]
    if unknowns:
        known = {text: units.find_name(text, fit.parameters) for text in unknowns}
        for text, name in known.items():
            if name is None:
                kind = f"parameter of {roles.file.name} that can be fitted"
                raise UnknownName(kind, text, fit.parameters)
        wanted = [name for name in known.values() if name is not None]
    of_each = [name for name in given if name in roles.of_each]
    if of_each:
        faults = [f"{name} is read off each toss; leave it out" for name in of_each]
        raise InputError("--set", faults)
    names = [name for name in dict.fromkeys(wanted) if name not in given]
    if not names:
        fault = f"nothing is left to fit: {', '.join(dict.fromkeys(wanted))} are given"
        raise InputError(roles.file.name, [f"{fault} with --set, --fix or --preset; leave one out"])
    return {name: fit.grids[name] for name in names}


def _check_once(recordings: Sequence[str], hold_out: Sequence[str]) -> None:
    names = [*recordings, *hold_out]
    places = [Path(name).resolve() for name in names]
    twice = {name for name, place in zip(names, places, strict=True) if places.count(place) > 1}
    if twice:
        faults = [f"{n} is given twice; what was seen predicts nothing new" for n in sorted(twice)]
        raise InputError("--recording, --hold-out", faults)


def _tosses(names: Sequence[str], mapping: str | Path | None, told: list[str]) -> list[Toss]:
    """Tosses of recordings that can be used; adds those that cannot to what is told."""
    found: list[Toss] = []
    for source in [sources.find(name, mapping=mapping) for name in names]:
        own, rejected = of_recording(source.recording, source.name)
        if rejected:
            told.append(f"Left out of {source.name}: {'; '.join(_grouped(rejected))}.")
        found += [_named(toss, source) if len(names) > 1 else toss for toss in own]
    return found


def _named(toss: Toss, source: Source) -> Toss:
    return replace(toss, name=f"{source.name}: {toss.name}")


def of_recording(recording: Recording, name: str = "") -> tuple[list[Toss], dict[str, list[str]]]:
    """All tosses of a recording that can be used, and why others cannot: reason -> streams.

    Raises:
        InputError: none can be used.
    """
    found: list[Toss] = []
    rejected: dict[str, list[str]] = {}
    for stream_name, stream in recording.streams.items():
        fault, toss = _read(stream_name, stream)
        if toss is None:
            rejected.setdefault(fault, []).append(stream_name)
        else:
            found.append(toss)
    if not found:
        faults = _grouped(rejected) or ["holds no stream"]
        cure = (
            f"; expected the poses of each toss as {', '.join((*POSITION, *ORIENTATION))}, evenly"
            " spaced; a mapping file (--map) says which columns they are"
        )
        raise InputError(name or recording.provenance.file, [fault + cure for fault in faults])
    return found, rejected


def _read(name: str, stream: Stream) -> tuple[str, Toss | None]:
    """A toss, or what is wrong with it."""
    wanted = (*POSITION, *ORIENTATION)
    missing = [channel for channel in wanted if channel not in stream.channels]
    if missing:
        return f"no channel {', '.join(missing)}", None
    values = np.column_stack([stream.channels[channel].values for channel in wanted])
    turn = values[:, 3:]
    length = np.linalg.norm(turn, axis=1, keepdims=True)
    if not np.isfinite(values).all() or not length.all():
        return "poses are missing", None
    if len(values) < 2 * MIN_IN_FLIGHT:
        return f"fewer than {2 * MIN_IN_FLIGHT} samples", None
    time_s = np.asarray(stream.time_s) - stream.time_s[0]
    toss = Toss(name, time_s, values[:, :3], turn / length)
    try:
        spacing_s(toss)
    except InputError:
        return "samples are not evenly spaced", None
    return "", toss


def _grouped(rejected: Mapping[str, Sequence[str]]) -> list[str]:
    """One text for each reason."""
    texts = []
    for reason, names in rejected.items():
        more = len(names) - _NAMED
        shown = ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")
        texts.append(f"{shown}: {reason}")
    return texts


def _witnesses(tosses: Sequence[Toss], roles: TossRoles) -> tuple[Witness, ...]:
    """What tells the scale, both together last; none where too few tosses fly or rest."""
    try:
        found = witnesses(tosses, roles.width_m({}), roles.gravity_m_s2({}))
    except InputError:
        return ()
    return (*found, combined(found))
