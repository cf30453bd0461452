"""Names of signals that sensors read: ``imu``, ``imu.rate_rad_s`` or ``imu.rate_rad_s.z``."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare import units
from simcompare.errors import UnknownName
from simcompare.model.trajectory import Array

_AXES = "xyz"
#: components of a quaternion, the most of what is no picture
_MOST = 4


def is_zones(width: int) -> bool:
    """Whether a signal of so many components is that of a range sensor of many zones."""
    return width > _MOST


def owner_of(signal: str) -> str:
    """Whose signal it is: "imu" of "imu.rate_rad_s.z"."""
    return signal.partition(".")[0]


def part_of(signal: str) -> str:
    """What is read: "rate_rad_s" of "imu.rate_rad_s.z"."""
    return _parted(signal)[0].partition(".")[2]


def unit_of(signal: str) -> str:
    """SI unit of a signal, as pint writes it."""
    return units.unit_of(_parted(signal)[0])


def axis_of(signal: str) -> str:
    """Its component, "x", "y" or "z"; empty where it is the whole signal."""
    return _parted(signal)[1]


def values_of(signals: Mapping[str, Array], signal: str) -> Array | None:
    """Values of a signal or of one component; ``None`` where a source does not give it."""
    name, axis = _parted(signal)
    values = signals.get(name)
    return values if values is None or not axis else values[:, _AXES.index(axis)]


def chosen(name: str, known: Mapping[str, int], whose: str) -> dict[str, int]:
    """The signals that a name means -> number of components.

    Args:
        name: owner, signal, or one component of a signal.
        known: every signal -> number of components.
        whose: of what they are, for the message.

    Raises:
        UnknownName: there are none of that name, or it has no such component.
    """
    signal, axis = _parted(name)
    if axis and known.get(signal) == len(_AXES):
        return {name: 1}
    readable = {
        key: width for key, width in known.items() if width in (1, len(_AXES)) or is_zones(width)
    }
    found = {key: n for key, n in readable.items() if name in (key, owner_of(key))}
    if not found:
        owners = dict.fromkeys(owner_of(key) for key in readable)
        raise UnknownName(f"sensor or signal of {whose}", name, [*owners, *readable] if
                          "." in name else owners)  # fmt: skip
    return found


def widths(signals: Mapping[str, Array]) -> dict[str, int]:
    """Number of components of each signal."""
    return {name: int(np.shape(values)[1]) if values.ndim > 1 else 1
            for name, values in signals.items()}  # fmt: skip


def _parted(signal: str) -> tuple[str, str]:
    """Signal and component."""
    name, _, last = signal.rpartition(".")
    return (name, last) if last in _AXES and "." in name else (signal, "")
