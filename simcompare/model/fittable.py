"""What of a scenario can be fitted, and which of its parameters play which part in that."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Literal

from pydantic import Field, model_validator

from simcompare import units
from simcompare.errors import UnknownName
from simcompare.model.frozen import Frozen

BOUNCES, WAVEFORM, TOSSES = "bounces", "waveform", "tosses"
#: kind of fit -> part of a parameter in it -> its unit; several where it has several components
ROLES: Mapping[str, Mapping[str, str | tuple[str, ...]]] = {
    BOUNCES: {
        "restitution": "1", "height": "m", "radius": "m", "mass": "kg", "gravity": "m/s**2",
        "drag": "1", "air_density": "kg/m**3",
    },
    WAVEFORM: {},
    TOSSES: {
        "width": "m", "gravity": "m/s**2", "duration": "s", "start_position": ("m",) * 3,
        "start_orientation": ("1",) * 4, "start_velocity": ("m/s",) * 3,
        "start_rate": ("rad/s",) * 3,
    },
}  # fmt: skip
#: those of bounces without which nothing can be fitted, and those that drag needs
NEEDED, FOR_DRAG = ("restitution", "height"), ("radius", "mass", "air_density")
Three = tuple[str, str, str]
Four = tuple[str, str, str, str]


class Grid(Frozen):
    """Where a parameter is sought on a grid that is made finer.

    Attributes:
        spacing: of the first grid, whose middle is the parameter's own value.
        min: smallest value that is tried.
        max: largest value that is tried.
        usual: whether it is sought where the user names no unknowns.
    """

    spacing: float = Field(gt=0)
    min: float
    max: float
    usual: bool = True

    @model_validator(mode="after")
    def _has_room(self) -> Grid:
        if not self.max - self.min > self.spacing:
            raise ValueError(
                f"{self.min:g} … {self.max:g} has no room for a spacing of {self.spacing:g}"
            )
        return self


class Fittable(Frozen):
    """What of a scenario can be fitted to a measurement, and how.

    By bounces and by tosses, each role is the name of the scenario's parameter that plays it; a
    scene that lacks one of bounces leaves it out.

    Attributes:
        by: "bounces" (impact times, rebound heights, height against time), "waveform" (a probe
            against a recorded channel) or "tosses" (poses of a box that is tossed on the plane
            z = 0, again and again).
        parameters: parameters that a measurement may tell.
        restitution: Newton's coefficient; needed by bounces.
        height: of the body's lowest point above the floor at release [m]; needed by bounces.
        radius: of the body, for its drag [m].
        mass: of the body, for its drag [kg].
        gravity: acceleration of free fall; of bounces, that of the world holds without it [m/s²].
        drag: coefficient of quadratic drag; without it the scene has none.
        air_density: of the air, for the drag [kg/m³].
        body: name of the body that is tossed, a cube.
        width: of its edges [m].
        duration: time that is simulated [s].
        start_position: of its centre at the start: x, y, z [m].
        start_orientation: quaternion from its own frame to the world's: w, x, y, z.
        start_velocity: of its centre: x, y, z [m/s].
        start_rate: about its own axes: x, y, z [rad/s].
        grids: by tosses, parameter -> where it is sought.
    """

    by: Literal["bounces", "waveform", "tosses"]
    parameters: tuple[str, ...] = Field(min_length=1)
    restitution: str | None = None
    height: str | None = None
    radius: str | None = None
    mass: str | None = None
    gravity: str | None = None
    drag: str | None = None
    air_density: str | None = None
    body: str | None = None
    width: str | None = None
    duration: str | None = None
    start_position: Three | None = None
    start_orientation: Four | None = None
    start_velocity: Three | None = None
    start_rate: Three | None = None
    grids: Mapping[str, Grid] = Field(default_factory=dict)

    @property
    def roles(self) -> dict[str, str]:
        """Role -> parameter, as far as they are given; components as ``start_position.0``."""
        found = {}
        for role in {role: None for known in ROLES.values() for role in known}:
            given = getattr(self, role)
            if isinstance(given, str):
                found[role] = given
            elif given is not None:
                found.update({f"{role}.{i}": name for i, name in enumerate(given)})
        return found

    def faults(
        self, parameters: Mapping[str, object], bodies: Collection[str] = ()
    ) -> dict[str, str]:
        """Everything that is wrong with the names, as place -> sentence."""
        found = {
            f"parameters.{number}": str(UnknownName("parameter", name, parameters))
            for number, name in enumerate(self.parameters) if name not in parameters
        }  # fmt: skip
        for role, name in self.roles.items():
            sentence = self._fault(role, name, parameters)
            if sentence:
                found[role] = sentence
        needed = {*NEEDED, *(FOR_DRAG if self.drag is not None else ())}
        needed = needed if self.by == BOUNCES else set(ROLES[self.by])
        for role, unit in ROLES[self.by].items():
            if role in needed and getattr(self, role) is None:
                found[role] = self._missing(role, unit)
        return {**found, **self._faults_of_tosses(bodies)}

    def _missing(self, role: str, unit: str | tuple[str, ...]) -> str:
        why = "drag" if self.by == BOUNCES and role not in NEEDED else f"by: {self.by}"
        names = "a parameter's name" if isinstance(unit, str) else f"{len(unit)} parameters' names"
        symbol = units.symbol(unit if isinstance(unit, str) else unit[0])
        held = "" if symbol == "1" else f" in {symbol}"
        return f"is missing and needed for {why}; expected {names}{held}"

    def _fault(self, role: str, name: str, parameters: Collection[str]) -> str:
        kind, _, number = role.partition(".")
        if kind not in ROLES[self.by]:
            others = " and ".join(by for by, known in ROLES.items() if kind in known)
            return f"{name!r} is named, but only fits by: {others} have this; leave it out"
        if name not in parameters:
            return str(UnknownName("parameter", name, parameters))
        known = ROLES[self.by][kind]
        unit = known if isinstance(known, str) else known[int(number)]
        held, wanted = (units.symbol(one) for one in (units.unit_of(name), unit))
        if held not in ("1", wanted):  # a name without a unit is SI
            expected = "a number without a unit" if wanted == "1" else f"a parameter in {wanted}"
            return f"{name!r} is in {held}; expected {expected}"
        first = next(other for other, taken in self.roles.items() if taken == name)
        return "" if first == role else f"{name!r} is the {first} already; expected another one"

    def _faults_of_tosses(self, bodies: Collection[str]) -> dict[str, str]:
        """What is wrong with the body and the grids, which only tosses have."""
        if self.by != TOSSES:
            return {
                place: f"is given, but only fits by: {TOSSES} have this; leave it out"
                for place, given in (("body", self.body), ("grids", self.grids)) if given
            }  # fmt: skip
        found = {}
        if self.body is None:
            found["body"] = f"is missing and needed for by: {TOSSES}; expected a body's name"
        elif self.body not in bodies:
            found["body"] = str(UnknownName("body", self.body, bodies))
        for name in self.grids:
            if name not in self.parameters:
                found[f"grids.{name}"] = "is none of fit.parameters; expected one of them"
        for number, name in enumerate(self.parameters):
            if name in self.roles.values():
                found[f"parameters.{number}"] = f"{name!r} is known of each toss; leave it out"
            elif name not in self.grids:
                found[f"parameters.{number}"] = f"{name!r} has no grid; say where under grids:"
        return found
