"""Forces on a two-wheeled robot that drives straight ahead: at rest, rolling, or wheels spinning.

Body m_b with its centre b behind the axle at height h, two wheels m_w of radius r and inertia J,
all together m; a sliding caster L behind the axle. Each wheel gets the torque τ, the body its
reaction. With F the traction of both tyres, N_d their load and N_c that of the caster:

    m·a = F - μ_c·N_c          2(J + J_a)·α = 2τ - F·r          N_d + N_c = m·g
    L·N_c = b·m_b·g + (m_b·h + 2m_w·r)·a + 2J·α

The last is the balance of moments about the tyres' contacts. J_a is the rotor's inertia as the axle
feels it (the armature): its reaction acts on the body, so it does not shift the load. Rolling
closes the set with a = r·α, sliding with F = μ·N_d.
Source: Newton and Euler for each body; the tests hold all of it against an integration of the three
bodies with their joints and contacts as constraints, which knows none of these formulas.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError


@dataclass(frozen=True)
class Forces:
    """What a torque makes of the robot at one instant.

    Attributes:
        acceleration_m_s2: of the robot. spin_rad_s2: of its wheels. caster_N: load of the caster.
    """

    acceleration_m_s2: float
    spin_rad_s2: float
    caster_N: float

    def change_to(self, end: Forces, over: float = 1.0) -> Forces:
        """What it takes to become others, for one unit of what changes by ``over`` meanwhile."""
        return Forces(
            (end.acceleration_m_s2 - self.acceleration_m_s2) / over,
            (end.spin_rad_s2 - self.spin_rad_s2) / over,
            (end.caster_N - self.caster_N) / over,
        )


@dataclass(frozen=True)
class Straight:
    """The robot as far as driving straight ahead needs it, all SI.

    Attributes:
        body_mass_kg: m_b. wheel_mass_kg: m_w of each. radius_m: r. height_m: h. behind_m: b.
        caster_m: L. tyre_friction: μ. caster_friction: μ_c. gravity_m_s2: g. armature_kg_m2: J_a
        of each wheel's drive.
    """

    body_mass_kg: float
    wheel_mass_kg: float
    radius_m: float
    height_m: float
    behind_m: float
    caster_m: float
    tyre_friction: float
    caster_friction: float
    gravity_m_s2: float
    armature_kg_m2: float = 0.0

    @classmethod
    def of(cls, parameters: Mapping[str, float], armature_kg_m2: float = 0.0) -> Straight:
        """The robot of a scenario's parameters."""
        return cls(
            body_mass_kg=parameters["body_mass_kg"],
            wheel_mass_kg=parameters["wheel_mass_kg"],
            radius_m=parameters["wheel_radius_m"],
            height_m=parameters["center_height_m"],
            behind_m=parameters["center_behind_m"],
            caster_m=parameters["caster_behind_m"],
            tyre_friction=parameters["tyre_friction"],
            caster_friction=parameters["caster_friction"],
            gravity_m_s2=parameters["gravity_m_s2"],
            armature_kg_m2=armature_kg_m2,
        )

    @property
    def mass_kg(self) -> float:
        """The whole mass m = m_b + 2·m_w."""
        return self.body_mass_kg + 2 * self.wheel_mass_kg

    @property
    def wheel_inertia_kg_m2(self) -> float:
        """J = m_w·r²/2, a wheel about its axle."""
        return self.wheel_mass_kg * self.radius_m**2 / 2

    @property
    def start_torque(self) -> float:
        """Torque of each wheel up to which the caster's friction holds the robot [N·m]."""
        return self.caster_friction * self._static_load * self.radius_m / 2

    @property
    def slip_torque(self) -> float:
        """Torque of each wheel above which the tyres slide [N·m]: traction F there is μ·N_d."""
        friction = self.tyre_friction + self.caster_friction
        weight = self.mass_kg * self.gravity_m_s2
        a = (self.tyre_friction * weight - friction * self._static_load) / (
            self.mass_kg + friction * self._load_rolling_kg
        )
        traction = self.mass_kg * a + self.caster_friction * (
            self._static_load + self._load_rolling_kg * a
        )
        inertia = self.wheel_inertia_kg_m2 + self.armature_kg_m2
        return inertia * a / self.radius_m + traction * self.radius_m / 2

    def forces(self, torque_N_m: float) -> Forces:
        """What happens to the robot from rest, or once it moves, under a torque on each wheel."""
        if torque_N_m <= self.start_torque:
            return Forces(0.0, 0.0, self._static_load)
        if torque_N_m <= self.slip_torque:
            return self.rolling(torque_N_m)
        return self.sliding(torque_N_m)

    def rolling(self, torque_N_m: float) -> Forces:
        """The robot with wheels that roll."""
        r = self.radius_m
        resistance = self.caster_friction * self._static_load
        inertia = self.wheel_inertia_kg_m2 + self.armature_kg_m2
        felt_mass = self.mass_kg + 2 * inertia / r**2 + self.caster_friction * self._load_rolling_kg
        a = (2 * torque_N_m / r - resistance) / felt_mass
        return Forces(a, a / r, self._static_load + self._load_rolling_kg * a)

    def sliding(self, torque_N_m: float) -> Forces:
        """The robot with wheels that turn faster than they roll; three linear equations.

        Raises:
            InputError: the tyres are too weak to pull the caster along.
        """
        r, length, friction = self.radius_m, self.caster_m, self.tyre_friction
        inertia, m = self.wheel_inertia_kg_m2, self.mass_kg
        weight = m * self.gravity_m_s2
        # unknown: a, α, N_c; F = μ·(m·g - N_c)
        rows = [
            [m, 0.0, friction + self.caster_friction],
            [0.0, 2 * (inertia + self.armature_kg_m2), -friction * r],
            [-self._load_kg_m, -2 * inertia, length],
        ]
        right = [
            friction * weight,
            2 * torque_N_m - friction * weight * r,
            self._static_load * length,
        ]
        a, spin, caster = np.linalg.solve(rows, right).tolist()
        if a <= 0:
            fault = f"the tyres spin on the spot at {torque_N_m:g} N·m: the caster holds the robot"
            raise InputError("parameters of the robot", [fault])
        return Forces(a, spin, caster)

    @property
    def _static_load(self) -> float:
        return self.behind_m * self.body_mass_kg * self.gravity_m_s2 / self.caster_m

    @property
    def _load_kg_m(self) -> float:
        """m_b·h + 2·m_w·r: moment about the contacts for one unit of acceleration."""
        return self.body_mass_kg * self.height_m + 2 * self.wheel_mass_kg * self.radius_m

    @property
    def _load_rolling_kg(self) -> float:
        """What the caster's load grows by for one unit of acceleration while the wheels roll."""
        spinning = 2 * self.wheel_inertia_kg_m2 / self.radius_m
        return (self._load_kg_m + spinning) / self.caster_m
