"""Which parameters say where a scenario starts, and the probe that each can be read off."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

from simcompare import units
from simcompare.model.scenario import Probe

_PREFIX = "start_"
#: a start is read off so many samples, and at least so long [s]
_SAMPLES, _LEAST_S = 8, 0.05


@dataclass(frozen=True)
class Start:
    """Where the start of one parameter can be read.

    Attributes:
        probe: the probe whose channel it is read off.
        derivative: 0 the value of the probe, 1 its rate of change.
    """

    probe: str
    derivative: int


def starts_of(
    parameters: Iterable[str], probes: Mapping[str, Probe], usable: Collection[str]
) -> dict[str, Start]:
    """The parameters that say where probes start, as ``start_angle_rad`` does for ``angle_rad``.

    A rate is rather read off the quantity itself: that was measured more often than its rate.

    Args:
        parameters: names of the scenario's parameters.
        probes: what the scenario observes.
        usable: the probes that a channel may have measured.
    """
    begun = [name for name in parameters if name.startswith(_PREFIX)]
    direct = {name: probe for name in begun for probe in probes if _bare(probe) == _bare(name)}
    found = {}
    for name in begun:
        of_unit = {p for n, p in direct.items() if f"{units.unit_of(n)}/s" == units.unit_of(name)}
        if len(of_unit) == 1 and of_unit <= set(usable):
            found[name] = Start(of_unit.pop(), 1)
        elif direct.get(name) in usable:
            found[name] = Start(direct[name], 0)
    return found


def over_s(step_s: float) -> float:
    """For how long a start is read off a channel [s].

    Args:
        step_s: time between its samples [s].
    """
    return max(_LEAST_S, _SAMPLES * step_s)


def _bare(name: str) -> str:
    """A name without what says that it is a start, and without its unit."""
    return name.removeprefix(_PREFIX).removesuffix(units.suffix_of(name))
