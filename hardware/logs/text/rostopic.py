"""Tables of ``rostopic echo -p``: their clock and their covariances."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from simcompare.hardware.conditioning.words import times
from simcompare.hardware.raw import RawColumn, RawLog, RawStream
from simcompare.model.recording import WARNING, Repair
from simcompare.model.trajectory import Array

_COVARIANCE = re.compile(r"(.*?)_?covariance(\d+)")


def is_echo(names: Sequence[str]) -> bool:
    """Whether the header is one of ``rostopic echo -p``."""
    return bool(names) and names[0] == "%time" and any(n.startswith("field.") for n in names)


def finish(log: RawLog) -> None:
    """Takes the stamps of the messages as time and the covariances as uncertainties."""
    stream = log.streams[0]
    names = [column.name for column in stream.columns]
    stamp = stream.column("field.header.stamp") if "field.header.stamp" in names else None
    wrong = _wrong(stamp.values) if stamp is not None else ""
    written = stream.column("%time").values
    if stream.time == "field.header.stamp" and wrong and not _wrong(written):
        text = f"{wrong}; the time at which the bag was written was taken"
        log.repairs.append(Repair("header_stamp", WARNING, text, "log", "field.header.stamp"))
        stream.time = "%time"
        stream.clock = type(stream.clock)("column %time", stream.clock.start)
    _use_covariances(stream, log)
    for name in ("%time", "field.header.stamp", "field.header.seq"):
        if name in [c.name for c in stream.columns] and name != stream.time:
            stream.columns.remove(stream.column(name))
            log.ignored[name] = "is not the clock that was taken"


def _wrong(stamps: Array) -> str:
    """What makes the stamps of messages no clock, empty where they are one."""
    if not np.any(stamps):
        return "all header stamps are alike"
    back = int(np.sum(np.diff(stamps) < 0))
    return f"the header stamps go back {times(back)}" if back else ""


def nested(names: Sequence[tuple[str, str]], hollow: Sequence[int]) -> list[tuple[str, str]]:
    """Names of a bag as CSV, where empty columns name the messages whose fields follow."""
    path: list[str] = []
    made = []
    for k, (name, unit) in enumerate(names):
        plain = name.partition(" #")[0]
        if k in hollow:
            path = [*path, plain] if k - 1 in hollow else [plain]
        made.append((name if k in hollow else ".".join([*path, plain]), unit))
    return made


def _use_covariances(stream: RawStream, log: RawLog) -> None:
    """The diagonal of a covariance gives standard uncertainties; -1 says that a field is absent."""
    matrices: dict[str, list[RawColumn]] = {}
    for column in list(stream.columns):
        match = _COVARIANCE.fullmatch(column.name)
        if match:
            matrices.setdefault(match[1].rstrip("."), []).append(column)
            stream.columns.remove(column)
            log.ignored[column.name] = "is a covariance; its diagonal gives the uncertainties"
    for base, columns in matrices.items():
        size = round(len(columns) ** 0.5)
        fields = [c for c in stream.columns if c.name.startswith(f"{base}.")]
        if columns[0].values[0] == -1:
            for column in fields:
                stream.columns.remove(column)
                log.ignored[column.name] = "the message says that it was not measured (-1)"
            continue
        if len(fields) != size:  # a quaternion has four numbers but three angles
            continue
        for i, column in enumerate(fields):
            variances = columns[i * (size + 1)].values
            if np.all(variances > 0):
                same = bool(np.all(variances == variances[0]))
                column.u = float(np.sqrt(variances[0])) if same else np.sqrt(variances)
