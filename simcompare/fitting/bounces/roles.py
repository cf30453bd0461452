"""Between a scenario's parameters and the closed form's: which parameter plays which part.

The closed form knows restitution, drop height, gravity and 1/v_t²; a scenario may call them as it
likes and says so under ``fit:``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from simcompare.errors import InputError
from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.unknowns import SPEED
from simcompare.fitting.fitted_scenario import FittedScenario
from simcompare.model.trajectory import Array
from simcompare.scenarios.scenario_file import ScenarioFile


@dataclass(frozen=True)
class Roles(FittedScenario):
    """A scenario that bounces, with the values of all its parameters.

    Attributes:
        file: the scenario.
        given: every parameter's value [SI].
        gravity_m_s2: magnitude of free fall.
    """

    gravity_m_s2: float

    @property
    def restitution(self) -> str:
        """The parameter that is Newton's coefficient."""
        assert self.fit.restitution is not None
        return self.fit.restitution

    @property
    def height(self) -> str:
        """The parameter that is the drop height."""
        assert self.fit.height is not None
        return self.fit.height

    @property
    def has_drag(self) -> bool:
        """Whether the scene can have drag."""
        return self.fit.drag is not None

    @property
    def fitted(self) -> dict[str, str]:
        """Parameter -> what the closed form calls it, of those that a measurement tells."""
        found = {self.restitution: "restitution", self.height: "drop_height_m"}
        return found if self.fit.gravity is None else {**found, self.fit.gravity: "gravity_m_s2"}

    def known(self, fixed: Mapping[str, float]) -> dict[str, float]:
        """What is not fitted: the scene's drag and gravity, and what the user fixes besides.

        Raises:
            InputError: a gravity is fixed that the scene cannot have.
        """
        gravity = fixed.get("gravity_m_s2", self.gravity_m_s2)
        if self.fit.gravity is None and not math.isclose(gravity, self.gravity_m_s2):
            raise InputError(
                "--fix",
                [
                    f"gravity is {gravity:g} m/s², but that of {self.file.name} is"
                    f" {self.gravity_m_s2:g} m/s² and no parameter of it (fit: gravity)"
                ],
            )
        found = {}
        if not math.isclose(gravity, bounce_models.GRAVITY):
            found["gravity_m_s2"] = gravity
        coefficient = self.given[self.fit.drag] if self.fit.drag is not None else 0.0
        if coefficient > 0:
            found[SPEED] = math.sqrt(gravity / (coefficient * self._drag_factor))
        return {**found, **fixed}

    def values(self, closed: Mapping[str, Array | float]) -> dict[str, float]:
        """Parameters of the scenario for those of the closed form.

        Args:
            closed: values by the closed form's names; drag as ``drag_k`` or a terminal speed.
        """
        whole = {**bounce_models.DEFAULTS, **closed}
        bounds = self.file.parameters[self.restitution]
        restitution = min(max(float(whole["restitution"]), bounds.min), bounds.max)
        found = {**self.given, self.restitution: restitution,
                 self.height: float(whole["drop_height_m"])}  # fmt: skip
        gravity = float(whole["gravity_m_s2"])
        if self.fit.gravity is not None:
            found[self.fit.gravity] = gravity
        k = float(bounce_models.drag_of(whole))
        if k > 0 and self.fit.drag is not None:  # k = 1/v_t² = ρ·C·A/(2·m·g)
            found[self.fit.drag] = k * gravity / self._drag_factor
        return found

    @property
    def _drag_factor(self) -> float:
        """ρ·A/(2·m), by which a coefficient becomes g/v_t² [1/m]."""
        fit = self.fit
        assert fit.radius is not None
        assert fit.mass is not None
        assert fit.air_density is not None
        area_m2 = math.pi * self.given[fit.radius] ** 2
        return self.given[fit.air_density] * area_m2 / (2 * self.given[fit.mass])


def roles_of(file: ScenarioFile, given: Mapping[str, float]) -> Roles:
    """The roles of a scenario's parameters.

    Args:
        file: a scenario that is fitted by bounces.
        given: every parameter's value [SI].
    """
    name = None if file.fit is None else file.fit.gravity
    gravity = file.resolve(given).world.gravity_m_s2
    return Roles(file, dict(given), given[name] if name is not None else math.hypot(*gravity))
