"""What of a scenario can be fitted, and which of its parameters play which part in that."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from simcompare import units
from simcompare.errors import UnknownName

BOUNCES, WAVEFORM = "bounces", "waveform"
#: part of a parameter in a fit of bounces -> its unit
ROLES = {
    "restitution": "1", "height": "m", "radius": "m", "mass": "kg", "gravity": "m/s**2",
    "drag": "1", "air_density": "kg/m**3",
}  # fmt: skip
#: those without which nothing can be fitted, and those that drag needs
NEEDED, FOR_DRAG = ("restitution", "height"), ("radius", "mass", "air_density")


class Fittable(BaseModel):
    """What of a scenario can be fitted to a measurement, and how.

    By bounces, each role is the name of the scenario's parameter that plays it; a scene that lacks
    one leaves it out.

    Attributes:
        by: "bounces" (impact times, rebound heights, height against time) or "waveform" (a probe
            against a recorded channel).
        parameters: parameters that a measurement may tell.
        restitution: Newton's coefficient; needed by bounces.
        height: of the body's lowest point above the floor at release [m]; needed by bounces.
        radius: of the body, for its drag [m].
        mass: of the body, for its drag [kg].
        gravity: acceleration of free fall; without it that of the world holds [m/s²].
        drag: coefficient of quadratic drag; without it the scene has none.
        air_density: of the air, for the drag [kg/m³].
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    by: Literal["bounces", "waveform"]
    parameters: tuple[str, ...] = Field(min_length=1)
    restitution: str | None = None
    height: str | None = None
    radius: str | None = None
    mass: str | None = None
    gravity: str | None = None
    drag: str | None = None
    air_density: str | None = None

    @property
    def roles(self) -> dict[str, str]:
        """Role -> parameter, as far as they are given."""
        parameters = {role: getattr(self, role) for role in ROLES}
        return {role: name for role, name in parameters.items() if name is not None}

    def faults(self, parameters: Collection[str]) -> dict[str, str]:
        """Everything that is wrong with the names, as place -> sentence."""
        found = {
            f"parameters.{number}": str(UnknownName("parameter", name, parameters))
            for number, name in enumerate(self.parameters) if name not in parameters
        }  # fmt: skip
        if self.by == WAVEFORM:
            return {**found, **{role: f"{name!r} is named, but only fits by: {BOUNCES} have this;"
                                " leave it out" for role, name in self.roles.items()}}  # fmt: skip
        for role, name in self.roles.items():
            sentence = self._fault(role, name, parameters)
            if sentence:
                found[role] = sentence
        needed = {*NEEDED, *(FOR_DRAG if self.drag is not None else ())}
        for role in ROLES:
            if role in needed - set(self.roles):
                why = f" by: {BOUNCES}" if role in NEEDED else " drag"
                unit = "" if ROLES[role] == "1" else f" in {units.symbol(ROLES[role])}"
                found[role] = f"is missing and needed for{why}; expected a parameter's name{unit}"
        return found

    def _fault(self, role: str, name: str, parameters: Collection[str]) -> str:
        if name not in parameters:
            return str(UnknownName("parameter", name, parameters))
        held, wanted = (units.symbol(unit) for unit in (units.unit_of(name), ROLES[role]))
        if held not in ("1", wanted):  # a name without a unit is SI
            expected = "a number without a unit" if wanted == "1" else f"a parameter in {wanted}"
            return f"{name!r} is in {held}; expected {expected}"
        first = next(other for other, known in self.roles.items() if known == name)
        return "" if first == role else f"{name!r} is the {first} already; expected another one"
