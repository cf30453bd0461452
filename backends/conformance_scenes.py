"""What the physics checks are made of: a small scene in code, and a judge of what it did."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from simcompare.model import scenes
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import G_M_S2, Part, Parts
from simcompare.model.trajectory import Array, Trajectory

#: time between samples, which is one step of the engine [s]
STEP_S = 0.001

Judge = Callable[[Trajectory], None]


class SignalNotGiven(Exception):
    """The engine says that it does not give a signal, and why."""


@dataclass(frozen=True)
class PhysicsCheck:
    """One scene with a known answer.

    Attributes:
        scenario: the scene.
        judge: raises ``AssertionError`` with a sentence if a trajectory is not what physics says.
    """

    scenario: Scenario
    judge: Judge

    @property
    def name(self) -> str:
        """Name of the check."""
        return self.judge.__name__

    @property
    def sentence(self) -> str:
        """What must be true, in one sentence."""
        return (self.judge.__doc__ or "").splitlines()[0]


def physics(scenario: Scenario) -> Callable[[Judge], PhysicsCheck]:
    """Makes a check of the function below it, which judges a run of this scene."""
    return lambda judge: PhysicsCheck(scenario, judge)


def scene(
    name: str,
    bodies: Parts,
    duration_s: float,
    gravity_m_s2: tuple[float, float, float] = (0.0, 0.0, -G_M_S2),
    **parts: object,
) -> Scenario:
    """A scene at the step of the checks."""
    return scenes.scene(name, bodies, duration_s, STEP_S, gravity_m_s2, **parts)


def ball(mass_kg: float, radius_m: float, **more: object) -> Part:
    """A solid sphere."""
    moment = 0.4 * mass_kg * radius_m**2
    return {
        "mass_kg": mass_kg,
        "inertia_kg_m2": [moment] * 3,
        "shapes": [{"type": "sphere", "radius_m": radius_m}],
        **more,
    }


def box(mass_kg: float, size_m: tuple[float, float, float], **more: object) -> Part:
    """A solid box."""
    return {
        "mass_kg": mass_kg,
        "inertia_kg_m2": box_moments(mass_kg, size_m),
        "shapes": [{"type": "box", "size_m": size_m}],
        **more,
    }


def box_moments(mass_kg: float, size_m: tuple[float, float, float]) -> list[float]:
    """Moments of inertia of a solid box about its own axes [kg·m²]."""
    x, y, z = (edge**2 for edge in size_m)
    return [mass_kg * (y + z) / 12, mass_kg * (x + z) / 12, mass_kg * (x + y) / 12]


def floor() -> Part:
    """Everything below z = 0."""
    return {"fixed": True, "shapes": [{"type": "plane"}]}


def turned(angle_rad: float, axis: tuple[float, float, float] = (0.0, 1.0, 0.0)) -> Array:
    """Quaternion wxyz of a turn about an axis; about y if none is named."""
    direction = np.array(axis) / np.linalg.norm(axis)
    return np.array([math.cos(angle_rad / 2), *(math.sin(angle_rad / 2) * direction)])


def signal(run: Trajectory, name: str) -> Array:
    """A recorded signal.

    Raises:
        SignalNotGiven: the engine says that it does not give it.
    """
    if name in run.lacks:
        raise SignalNotGiven(f"{name} is not given: {run.lacks[name]}")
    assert name in run.signals, f"{name} is not recorded"
    return run.signals[name]


def near(what: str, got: float, wanted: float, tolerance: float, unit: str) -> None:
    """Fails with "``what`` 0.8 m for 0.26 m" where a number is further off than its tolerance."""
    assert abs(got - wanted) <= tolerance, (  # also where it is not a number
        f"{what} {got:.4g} {unit} for {wanted:.4g} {unit} (± {tolerance:.2g})"
    )


def all_near(what: str, got: Array, wanted: Array, tolerance: float, unit: str) -> None:
    """The same for the sample and component that is furthest off."""
    wanted = np.broadcast_to(wanted, got.shape)
    worst = np.unravel_index(np.argmax(np.abs(got - wanted)), got.shape)
    near(what, float(got[worst]), float(wanted[worst]), tolerance, unit)


def orientations_near(what: str, got: Array, wanted: Array, tolerance_rad: float) -> None:
    """The same for the angle between orientations wxyz (n, 4); q and -q are the same one."""
    # the chord between the two, which unlike their product tells small angles
    apart = np.minimum(np.linalg.norm(got - wanted, axis=1), np.linalg.norm(got + wanted, axis=1))
    angles = 4 * np.arcsin(np.minimum(apart / 2, 1.0))
    near(f"{what}: off by", float(angles.max()), 0.0, tolerance_rad, "rad")
