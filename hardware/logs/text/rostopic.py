"""Tables of ``rostopic echo -p``: what the fields of the common messages mean."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import numpy as np

from simcompare.hardware.raw import RawColumn, RawLog, RawStream
from simcompare.model.recording import WARNING, Repair

#: ends of fields and their units
_UNITS = (
    (r"linear_acceleration\.[xyz]|accel\.linear\.[xyz]", "m/s^2"),
    (r"angular_velocity\.[xyz]|angular\.[xyz]", "rad/s"),
    (r"linear\.[xyz]", "m/s"),
    (r"position\.[xyz]|translation\.[xyz]|point\.[xyz]", "m"),
    (r"orientation\.[xyzw]|rotation\.[xyzw]", "1"),
    (r"field\.(range|min_range|max_range)", "m"),
    (r"field\.magnetic_field\.[xyz]", "tesla"),
    (r"field\.fluid_pressure", "Pa"),
    (r"header\.seq|radiation_type|status", "1"),
    (r"%time|header\.stamp", "ns"),
    (r"force\.[xyz]", "N"),
    (r"torque\.[xyz]", "N*m"),
    (r"field\.temperature", "degC"),
    (r"field\.(voltage|cell_voltage\d+)", "V"),
    (r"field\.current", "A"),
    (r"field\.(charge|capacity|design_capacity)", "A*h"),
    (r"field\.(percentage|present|relative_humidity|power_supply_\w+)", "1"),
    (r"field\.(latitude|longitude)", "deg"),
    (r"field\.altitude", "m"),
    (r"field_of_view", "rad"),
)
_COVARIANCE = re.compile(r"(.*?)_?covariance(\d+)")


def is_echo(names: Sequence[str]) -> bool:
    """Whether the header is one of ``rostopic echo -p``."""
    return bool(names) and names[0] == "%time" and any(n.startswith("field.") for n in names)


def named(names: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Names with the units that the messages define."""
    pairs = []
    for name, unit in names:
        fitting = (u for pattern, u in _UNITS if re.search(rf"(?:{pattern})$", name))
        pairs.append((name, unit or next(fitting, "")))
    return pairs


def finish(log: RawLog) -> None:
    """Takes the stamps of the messages as time and the covariances as uncertainties."""
    stream = log.streams[0]
    names = [column.name for column in stream.columns]
    stamp = stream.column("field.header.stamp") if "field.header.stamp" in names else None
    if stream.time == "field.header.stamp" and stamp is not None and not np.any(stamp.values):
        text = "all header stamps are alike; the time at which the bag was written was taken"
        log.repairs.append(Repair("header_stamp", WARNING, text, "log", "field.header.stamp"))
        stream.time = "%time"
        stream.clock = type(stream.clock)("column %time", stream.clock.start)
    _use_covariances(stream, log)
    for column in stream.columns:
        if "linear_acceleration" in column.name:
            column.kind = "specific_force"
    for name in ("%time", "field.header.stamp", "field.header.seq"):
        if name in [c.name for c in stream.columns] and name != stream.time:
            stream.columns.remove(stream.column(name))
            log.ignored[name] = "is not the clock that was taken"


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
