"""Between a scenario's parameters and the start of a toss: which parameter plays which part."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.fitting.fitted_scenario import FittedScenario
from simcompare.fitting.tosses.tosses import Start
from simcompare.model.fittable import Fittable
from simcompare.model.scenario import Scenario
from simcompare.model.shapes import Box
from simcompare.scenarios.scenario_file import ScenarioFile

#: a part of a size or of a moment of inertia by which a cube may be none
_ALIKE = 1e-6


@dataclass(frozen=True)
class TossRoles(FittedScenario):
    """A scenario that is fitted by tosses, with the values of its parameters."""

    @property
    def body(self) -> str:
        """The body that is tossed."""
        assert self.fit.body is not None
        return self.fit.body

    @property
    def of_each(self) -> frozenset[str]:
        """Parameters that each toss has for itself."""
        shared = {self.fit.width, self.fit.gravity}
        return frozenset(name for name in self.fit.roles.values() if name not in shared)

    def width_m(self, values: Mapping[str, float]) -> float:
        """Length of the cube's edges, with values that differ."""
        assert self.fit.width is not None
        return {**self.given, **values}[self.fit.width]

    def gravity_m_s2(self, values: Mapping[str, float]) -> float:
        """Acceleration of free fall, with values that differ."""
        assert self.fit.gravity is not None
        return {**self.given, **values}[self.fit.gravity]

    def scenario(
        self, values: Mapping[str, float], start: Start, duration_s: float, step_s: float
    ) -> Scenario:
        """The scene of one toss.

        Args:
            values: parameters that differ.
            start: where the toss starts.
            duration_s: time that is simulated.
            step_s: between samples.
        """
        assert self.fit.duration is not None
        own = {**parameters_of(self.fit, start), self.fit.duration: duration_s}
        return self.file.resolve({**self.given, **values, **own}, step_s=step_s)


def roles_of(file: ScenarioFile, given: Mapping[str, float]) -> TossRoles:
    """The roles of a scenario's parameters.

    Args:
        file: a scenario that is fitted by tosses.
        given: parameters that differ from the file [SI].

    Raises:
        InputError: what is tossed is no cube; starts and errors are those of a cube.
    """
    own = {name: parameter.value for name, parameter in file.parameters.items()}
    roles = TossRoles(file, {**own, **given})
    body = file.resolve(roles.given).bodies[roles.body]
    sizes = [shape.size_m if isinstance(shape, Box) else (0.0,) for shape in body.shapes]
    width_m = roles.width_m({})
    is_cube = len(sizes) == 1 and np.allclose(sizes[0], width_m, rtol=_ALIKE, atol=0)
    faults = [] if is_cube else [f"{roles.body} is no box with edges of {width_m:g} m"]
    inertia = np.array(body.inertia_kg_m2 or (0.0,))[:3]
    if np.ptp(inertia) > _ALIKE * np.abs(inertia).max():
        faults.append(f"the moments of inertia of {roles.body} differ")
    if faults:
        raise InputError(
            file.name, [f"{fault}; only a cube is fitted by tosses" for fault in faults]
        )
    return roles


def parameters_of(fit: Fittable, start: Start) -> dict[str, float]:
    """A start as the scenario's parameters."""
    parts: tuple[tuple[Iterable[str] | None, Iterable[float]], ...] = (
        (fit.start_position, start.position_m),
        (fit.start_orientation, start.orientation_wxyz),
        (fit.start_velocity, start.velocity_m_s),
        (fit.start_rate, start.rate_rad_s),
    )
    return {
        name: float(value)
        for names, held in parts
        for name, value in zip(names or (), held, strict=True)
    }
