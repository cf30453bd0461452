"""Between a scenario's parameters and the closed form's: which parameter plays which part.

The closed form knows restitution, drop height, gravity and 1/v_t²; a scenario may call them as it
likes and says so under ``fit:``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from simcompare import units
from simcompare.errors import InputError
from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.unknowns import GRAVITY, SPEED
from simcompare.fitting.fitted_scenario import FittedScenario
from simcompare.model.trajectory import Array
from simcompare.model.uncertain import KnownBy
from simcompare.results.records.fit_forms import Prior
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.statistics.stated import stated


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

    def known(
        self, fixed: Mapping[str, float], priors: Mapping[str, Prior]
    ) -> tuple[dict[str, float], dict[str, Prior]]:
        """What is not fitted, and what is known of unknowns: of the user, else of the scene.

        Gravity and drag of the scene are as sure as it says; exact where it says nothing.

        Raises:
            InputError: a gravity is given that the scene cannot have.
        """
        gravity = fixed.get(GRAVITY, priors[GRAVITY].value if GRAVITY in priors else
                            self.gravity_m_s2)  # fmt: skip
        self._check(gravity, "--fix" if GRAVITY in fixed else "--prior")
        stated = {**fixed, **priors}
        held, known = {}, {}
        for name, prior in ((GRAVITY, self._gravity()), (SPEED, self._terminal_speed(gravity))):
            if prior is None or name in stated:
                continue
            if prior.u > 0:
                known[name] = prior
            elif name != GRAVITY or not math.isclose(prior.value, bounce_models.GRAVITY):
                held[name] = prior.value
        return {**held, **fixed}, {**known, **priors}

    def _check(self, gravity: float, option: str) -> None:
        if self.fit.gravity is None and not math.isclose(gravity, self.gravity_m_s2):
            raise InputError(
                option,
                [
                    f"gravity is {gravity:g} m/s², but that of {self.file.name} is"
                    f" {self.gravity_m_s2:g} m/s² and no parameter of it (fit: gravity)"
                ],
            )

    def _gravity(self) -> Prior:
        """That of the scene; engines could not follow another one where it is no parameter."""
        name = self.fit.gravity
        known = None if name is None else self._known_by(name)
        if name is None or known is None:
            return Prior(self.gravity_m_s2, 0.0)
        return Prior(self.gravity_m_s2, self._u(name), known.reason)

    def _terminal_speed(self, gravity_m_s2: float) -> Prior | None:
        """What drag, size, mass and air make of it; ``None`` in vacuum."""
        fit = self.fit
        if fit.drag is None or not self.given[fit.drag] * self._drag_factor > 0:
            return None
        assert fit.radius is not None
        assert fit.mass is not None
        assert fit.air_density is not None
        speed = math.sqrt(gravity_m_s2 / (self.given[fit.drag] * self._drag_factor))
        powers = {fit.drag: -0.5, fit.air_density: -0.5, fit.radius: -1.0, fit.mass: 0.5}
        part = math.hypot(*(p * self._u(name) / self.given[name] for name, p in powers.items()))
        known = self._known_by(fit.drag)
        why = "what is stated of the ball" if known is None else known.reason
        return Prior(speed, part * speed, why)

    def _known_by(self, name: str) -> KnownBy | None:
        said = self.file.uncertainty
        return None if said is None else said.inputs.get(name)

    def _u(self, name: str) -> float:
        """Standard uncertainty that the scenario states of a parameter, 0 where it says nothing."""
        known = self._known_by(name)
        if known is None:
            return 0.0
        return stated(known.u, self.given[name], units.unit_of(name), name).distribution.u

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
