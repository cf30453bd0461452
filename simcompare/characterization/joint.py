"""How a hinge with damper, armature and spring moves; the truth is the closed form."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.characterization.behaviour import Hinge, HingeAtStep, JointBehaviour
from simcompare.characterization.experiment import Experiment, over_steps, scene
from simcompare.characterization.grids import STEPS_S
from simcompare.engine.backend import Backend
from simcompare.errors import BackendError
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import joint, pushed
from simcompare.model.trajectory import Array

#: moment of inertia and armature [kg·m²]; torque of the motor [N·m]
_INERTIA, _ARMATURE, _TORQUE = 1e-3, 1.5e-3, 0.05
#: rate at which what is damped dies away, d/J [1/s], and how long it is watched [s]
DECAY, _WATCHED_S = 10.0, 0.2
#: natural frequency of the spring [rad/s], damping ratio, and how long it is watched [s]
OMEGA, ZETA, _SWINGS_S = 40.0, 0.1, 0.6
_START_RAD_S = 8.0
#: phase of the swing between two samples from which its poles are read [rad]
_APART = 0.4


@dataclass(frozen=True)
class JointQuestion(Experiment[JointBehaviour]):
    """How a hinge moves at one contact level."""

    kind = JointBehaviour

    def answer(self, backend: Backend) -> JointBehaviour:
        """Each quantity at the step, and over steps."""
        return JointBehaviour(
            **vars(self._at_step(backend, self.step_s)),
            over_step=over_steps(HingeAtStep, STEPS_S, lambda dt: self._at_step(backend, dt)),
        )

    def _at_step(self, backend: Backend, step_s: float) -> Hinge:
        """Each quantity over its truth; where an engine has not what it needs, the reason."""
        looks: dict[str, Callable[[], dict[str, float]]] = {
            "damping": lambda: {"damping": self.decay(backend, step_s, 0.0)},
            "damping_with_armature": lambda: {
                "damping_with_armature": self.decay(backend, step_s, _ARMATURE)
            },
            "inertia": lambda: {"inertia": self.inertia(backend, step_s)},
            "spring": lambda: self.swing(backend, step_s),
        }
        parts: dict[str, float] = {}
        errors: dict[str, BackendError] = {}
        for name, look in looks.items():
            try:
                parts |= look()
            except BackendError as error:
                errors[name] = error
        if len(errors) == len(looks):
            raise errors["damping"]  # nothing at all: the engine's own sentence says why
        lacks = {name: str(error) for name, error in errors.items()}
        return Hinge(**parts, lacks=lacks)

    def decay(self, backend: Backend, step_s: float, armature: float) -> float:
        """Rate at which a spin dies away, over d/(J + armature)."""
        whole = _INERTIA + armature
        hinge = {"damping": DECAY * whole, "rate": _START_RAD_S}
        made = hinge_scene(step_s, _WATCHED_S, hinge, armature)
        rate = self._signal(backend, made, "rate_rad_s")
        return decay_rate(rate, step_s) / DECAY

    def inertia(self, backend: Backend, step_s: float) -> float:
        """Torque over acceleration, over J + armature."""
        made = hinge_scene(step_s, _WATCHED_S, {}, _ARMATURE, **pushed("hinge", _TORQUE))
        angle = self._signal(backend, made, "angle_rad")
        time_s = np.arange(len(angle)) * step_s
        change = 2 * float(np.polyfit(time_s, angle, 2)[0])
        return _TORQUE / change / (_INERTIA + _ARMATURE) if change else math.inf

    def swing(self, backend: Backend, step_s: float) -> dict[str, float]:
        """Natural frequency and damping ratio of a sprung hinge, over their truths."""
        hinge = {
            "stiffness": _INERTIA * OMEGA**2,
            "damping": 2 * ZETA * OMEGA * _INERTIA,
            "rate": _START_RAD_S,
        }
        made = hinge_scene(step_s, _SWINGS_S, hinge, 0.0)
        omega, zeta = swing_of(self._signal(backend, made, "angle_rad"), step_s)
        return {"frequency": omega / OMEGA, "damping_ratio": zeta / ZETA}

    def _signal(self, backend: Backend, made: Scenario, part: str) -> Array:
        return np.asarray(self.run(backend, made).signals[f"hinge.{part}"])


def hinge_scene(
    step_s: float, duration_s: float, hinge: Mapping[str, float], armature: float, **parts: object
) -> Scenario:
    """A body that turns about its centre on a fixed frame, without gravity."""
    body = {"mass_kg": 0.5, "inertia_kg_m2": [6e-4, _INERTIA, 6e-4]}
    bodies = {"frame": {"fixed": True}, "body": body}
    own = {**hinge, "armature": armature} if armature else hinge
    joints = {"hinge": joint("hinge", "body", (0, 1, 0), **own)}
    return scene("hinge", bodies, duration_s, step_s, (0.0, 0.0, 0.0), joints=joints, **parts)


def decay_rate(rate: Array, step_s: float) -> float:
    """How fast a rate dies away [1/s]; infinite where it is gone at once or changes its sign."""
    if not (rate[1:] > 0).all():
        return math.inf
    # the first sample is where the start was put, and may not belong to the engine's own steps
    time_s = np.arange(1, len(rate)) * step_s
    return float(-np.polyfit(time_s, np.log(rate[1:]), 1)[0])


def swing_of(angle: Array, step_s: float) -> tuple[float, float]:
    """Natural frequency [rad/s] and damping ratio of a swing about 0, from its two poles.

    A linear step of any engine gives x[k+2] = a·x[k+1] + b·x[k]; a and b are fitted.
    """
    apart = max(1, round(_APART / (OMEGA * step_s)))
    x = angle[1:]
    if not np.isfinite(x).all() or np.ptp(x) == 0:
        return math.nan, math.nan
    before = np.column_stack((x[apart:-apart], x[: -2 * apart]))
    (a, b), *_ = np.linalg.lstsq(before, x[2 * apart :], rcond=None)
    pole = (a + cmath.sqrt(a * a + 4 * b)) / 2
    if pole == 0:
        return math.nan, math.nan
    log = cmath.log(pole) / (apart * step_s)
    return abs(log), -log.real / abs(log)
