"""Sensors of a scenario, as plain frozen values; all are ideal, errors are added afterwards."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, PositiveFloat, model_validator

from simcompare.model.sensor_errors import ERRORS, SensorErrors
from simcompare.model.shapes import Pose

#: of one signal: a range sensor of 8 times 8 zones
MOST_COMPONENTS = 64
#: where to go on from a range sensor that is ideal
REAL_ZONES = "ask for a real one where it is read, as in simcompare run NAME --sensor eye=vl53l5cx"


class Sensor(Pose):
    """An ideal sensor; error models are applied afterwards, not in the engine.

    ``force`` reads, from the engine itself, the force that the parent of a joint exerts on its
    child, in the child's frame: divided by the child's mass it is a specific force, +g at rest.
    ``contact_force`` reads the engine's normal force between a pair of bodies.
    ``time_of_flight`` looks along its x axis, through the engine's own rays, one in the middle of
    each zone, and reads how far along this axis other bodies are, or its reach where there is none;
    zones are counted along rows from the left, rows from the top, as the sensor sees them. The
    others follow from the recorded motion, the same way for every source: ``accelerometer``
    (specific force at the sensor's place, in its frame), ``gyroscope`` (rate in its frame),
    ``barometer`` (standard atmosphere at its height), ``encoder`` (whole marks that have passed),
    ``imu`` (accelerometer and gyroscope of one chip).
    """

    type: Literal[
        "force", "contact_force", "accelerometer", "gyroscope", "imu", "barometer", "encoder",
        "time_of_flight",
    ]  # fmt: skip
    body: str | None = None
    joint: str | None = None
    pair: tuple[str, str] | None = None
    marks: Annotated[int, Field(ge=1)] | None = Field(None, description="marks in one turn")
    zones: Literal[4, 8] | None = Field(None, description="in a row, and rows, of a range sensor")
    geometry: Literal["equal_angle", "rectilinear"] | None = Field(
        None, description="how a range sensor's 45° are divided: into equal angles (the usual one),"
        " or equally in a plane before it",
    )  # fmt: skip
    reach_m: PositiveFloat | None = Field(
        None, description="of a range sensor along its axis; 4 m where left out"
    )
    errors: SensorErrors | None = Field(None, description=ERRORS)

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> Sensor:
        place = _PLACES.get(self.type, "body")
        for key in ("body", "joint", "pair"):
            if (getattr(self, key) is not None) != (key == place):
                raise ValueError(f"a sensor of type {self.type} needs a {place}, and only that")
        if (self.marks is not None) != (self.type == "encoder"):
            raise ValueError("marks are what an encoder needs, and no other sensor")
        if (self.zones is not None) != (self.type == "time_of_flight"):
            raise ValueError("zones, 4 or 8, are what a time_of_flight needs, and no other sensor")
        if self.zones is None and (self.geometry or self.reach_m):
            raise ValueError("geometry and reach_m are of a time_of_flight, and of no other sensor")
        if self.zones is not None and self.errors is not None:
            raise ValueError(f"a time_of_flight takes no errors; {REAL_ZONES}")
        if place != "body" and (any(self.position_m) or any(self.orientation_wxyz[1:])):
            raise ValueError(f"a sensor of type {self.type} has no pose of its own")
        if self.pair is not None and self.pair[0] == self.pair[1]:
            raise ValueError(f"{self.pair[0]} cannot touch itself")
        return self

    @property
    def signals(self) -> dict[str, int]:
        """What it records -> number of components."""
        return {"range_m": self.zones**2} if self.zones else dict(_SIGNALS[self.type])


_PLACES = {"encoder": "joint", "force": "joint", "contact_force": "pair"}
_SIGNALS = {
    "force": {"force_N": 3},
    "contact_force": {"normal_force_N": 1},
    "accelerometer": {"specific_force_m_s2": 3},
    "gyroscope": {"rate_rad_s": 3},
    "imu": {"specific_force_m_s2": 3, "rate_rad_s": 3},
    "barometer": {"pressure_Pa": 1},
    "encoder": {"marks": 1},
}
