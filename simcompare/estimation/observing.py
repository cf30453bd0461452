"""What a name under ``estimate:`` stands for: a probe, a signal, or one component of a signal."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare import units
from simcompare.errors import UnknownName
from simcompare.model.scenario import Scenario

_LETTERS = {3: "xyz", 4: "wxyz"}
#: an orientation may stand for the heading, its angle about the vertical
ORIENTATION = "orientation_wxyz"


@dataclass(frozen=True)
class Observed:
    """Where values come from.

    Attributes:
        signal: such as ``imu.specific_force_m_s2``.
        component: one of it, ``None`` for all.
        offset: is added.
        components: how many there are.
        unit: SI unit.
    """

    signal: str
    component: int | None
    offset: float
    components: int
    unit: str

    @property
    def owner(self) -> str:
        """Body, joint, actuator or sensor."""
        return self.signal.partition(".")[0]

    @property
    def part(self) -> str:
        """The signal without its owner."""
        return self.signal.partition(".")[2]


def observed(name: str, scenario: Scenario) -> Observed:
    """What a name stands for: ``speed_m_s``, ``imu.rate_rad_s`` or ``imu.rate_rad_s.z``.

    One of the many zones of a range sensor is told by its number, ``range.range_m.27``, from 0 on.

    Raises:
        UnknownName: no probe and no signal is called so.
    """
    if name in scenario.probes:
        probe = scenario.probes[name]
        unit = units.unit_of(probe.observe.partition(".")[2])
        return Observed(probe.observe, probe.component, probe.offset, 1, unit)
    whole, _, letter = name.rpartition(".")
    components = _components(name, scenario)
    if components is not None:
        unit = units.unit_of(name.partition(".")[2])
        return Observed(name, None, 0.0, components, unit)
    count = _components(whole, scenario) or 1
    letters = _LETTERS.get(count, "")
    if letter.isdecimal() and int(letter) < count:
        return Observed(whole, int(letter), 0.0, 1, units.unit_of(whole.partition(".")[2]))
    if len(letter) == 1 and letter in letters:
        unit = units.unit_of(whole.partition(".")[2])
        return Observed(whole, letters.index(letter), 0.0, 1, unit)
    raise UnknownName("probe or signal", name, [*scenario.probes, *scenario.signals()])


def _components(signal: str, scenario: Scenario) -> int | None:
    """How many a signal has; ``None`` where there is none of that name."""
    owner, _, part = signal.partition(".")
    owners = (scenario.bodies, scenario.joints, scenario.actuators, scenario.sensors)
    if not any(owner in named for named in owners):
        return None
    return scenario.signals_of(owner).get(part)
