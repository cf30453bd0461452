"""Which column of a text table is its time, by names, units and values."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from simcompare.hardware.raw import RawColumn
from simcompare.model.trajectory import Array

_TIME = re.compile(
    r"%?time|t|(?:unix ?)?time ?stamps?(?: ?\(\w*\))?|stamp|date ?/? ?time|date|zeit|temps"
    r"|elapsed(?: time)?|millis|micros"
    r"|ms|us|(?:milli|micro|nano)?sec(?:ond)?s?|time of day|unix ?time|epoch|clock|zeitstempel"
    r"|uhrzeit|(?:mess|pr(?:ü|ue)f|lauf|versuchs)zeit|datum|horodatage|tiempo|tempo",
    re.IGNORECASE,
)
#: what is a time where no column is called one plainly
_ALSO_TIME = re.compile(
    r"(?:.* )?(?:time|timestamp|time stamp|zeit|zeitstempel|temps|elapsed|epoch?|seconds?|secs?"
    r"|millis|micros|tiempo)(?: (?:elapsed|stamp|utc|gmt|local|unix|s|ms|us|ns|nsec|start"
    r"|since start|from start))?",
    re.IGNORECASE,
)
#: names in a table of several runs: "Latest: Time", "Time Run #2", "t #2"
_RUN_WORD = r"(?:run|trial|set|data ?set|series|messung|essai) ?(?:#|no\.? ?|nr\.? ?)?\d+"
_RUN_FIRST = re.compile(
    rf"(?P<run>{_RUN_WORD}|latest|(?:[^:]*[^:\s])(?=: ))[: _-]+(?P<name>\S.*)", re.IGNORECASE
)
_RUN_LAST = re.compile(
    rf"(?P<name>.*?\S)[ _-]+(?P<run>#\d+|[(\[]?{_RUN_WORD}[)\]]?)", re.IGNORECASE
)
#: spans of time that are no clock
_SPANS = re.compile(r"delta|\bd ?t\b|period|delay|duration|rise|response|exposure|step", re.I)
_PERIOD = re.compile(r"(?:\d+ ?[*·]? ?)?T(?:_?\d+)?")
_SECONDS = re.compile(r"(milli|micro|nano)?(?:sec(?:ond)?s?|s)(?: elapsed)?")
_IN_WORDS = {None: "s", "milli": "ms", "micro": "us", "nano": "ns"}
#: units of time in letters of any size: nobody logs siemens against time
_ANY_CASE = {"s": "s", "sec": "s", "ms": "ms", "msec": "ms", "us": "us", "µs": "us", "μs": "us",
             "ns": "ns", "d": "day"}  # fmt: skip


def is_time(name: str) -> bool:
    """Whether a column holds the time, by its name: ``time_s`` as well as ``Time``."""
    return bool(_TIME.fullmatch(_bare(name)))


def may_be_time(name: str) -> bool:
    """Whether a name speaks of a clock, such as ``device_time`` and ``epoc``."""
    return bool(_ALSO_TIME.fullmatch(_bare(name))) and not is_span(name)


def is_span(name: str) -> bool:
    """Whether a name speaks of how long something takes, and not of when it was."""
    return bool(_SPANS.search(_bare(name)) or is_period(name))


def is_period(name: str) -> bool:
    """Whether a name is the letter that physics has for a period, or for several: ``10T``."""
    return bool(_PERIOD.fullmatch(name.strip()))


def _bare(name: str) -> str:
    """A name without its unit and without its number among its like."""
    name = of_run(name)[1].strip(" _").removesuffix("_s")
    return re.sub(r"[_:./]+|(?<=[a-z])(?=[A-Z])", " ", name).strip()


def of_run(name: str) -> tuple[str, str]:
    """The run that a name says it is of, empty where it says none, and the rest of the name."""
    match = _RUN_FIRST.fullmatch(name) or _RUN_LAST.fullmatch(name)
    return (match["run"], match["name"].strip()) if match else ("", name)


def unit_of_time(name: str) -> str:
    """Unit of a column that is called by it ("seconds", ``time_s``), empty otherwise."""
    bare = name.strip().lower().replace("_", " ")
    if bare.endswith(" s") or bare in ("ms", "us", "millis", "micros"):
        return {"ms": "ms", "millis": "ms", "us": "us", "micros": "us"}.get(bare, "s")
    match = _SECONDS.fullmatch(bare) if bare != "s" else None
    return _IN_WORDS[match[1]] if match else ""


def spelled(unit: str) -> str:
    """A unit of time whose letters have the wrong size, as it is meant; empty for another unit."""
    return _ANY_CASE.get(unit.lower(), "")


def same(columns: Sequence[RawColumn]) -> RawColumn | None:
    """The finest of several columns that tell the same time, ``None`` where they do not."""
    seconds = [_seconds(column, columns[0]) for column in columns]
    first = seconds[0]
    span = float(np.ptp(first)) if len(first) else 0.0
    for one in seconds:
        if not span > 0 or not np.isfinite(one).all():
            return None
        if np.max(np.abs(one - first)) > max(_step(one), _step(first)) * 1.01 + 1e-3 * span:
            return None
    distinct = [len(np.unique(one)) for one in seconds]
    return columns[distinct.index(max(distinct))]


def _step(seconds: Array) -> float:
    """Smallest step that is none at all: how finely a clock is read."""
    steps = np.abs(np.diff(seconds))
    return float(np.min(steps[steps > 0], initial=np.inf))


def _seconds(column: RawColumn, other: RawColumn) -> Array:
    """From 0 at the first sample, in the unit, or the power of ten, that fits to another clock."""
    values, reference = (c.values - c.values[0] for c in (column, other))
    if not column.values.size or not 0 < np.ptp(values) < np.inf:
        return np.full(len(values), np.nan)
    ratio = float(np.ptp(reference) / np.ptp(values))
    return np.asarray(values * 10.0 ** round(np.log10(ratio)) if 0 < ratio < np.inf else values)
