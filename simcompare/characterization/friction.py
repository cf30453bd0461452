"""How a block is held and braked by dry friction; the truth is Coulomb's law."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.characterization.behaviour import (
    Braking,
    BrakingAtSpeed,
    Creep,
    CreepAtLoad,
    Friction,
    FrictionAtStep,
    FrictionBehaviour,
)
from simcompare.characterization.experiment import Experiment, over_steps, scene
from simcompare.characterization.grids import STEPS_S
from simcompare.engine.backend import Backend
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import G_M_S2
from simcompare.model.trajectory import Array, Trajectory

#: the block's edges [m]; it is so low that it does not tip at the largest load
SIZE_M = (0.12, 0.12, 0.03)
#: loads along the plane under which it must stick, as parts of µ·N
LOADS = (0.5, 0.8, 0.95)
#: the load at which creep is looked at over steps
LOAD = 0.8
#: speeds at which it is braked [m/s], that over steps, and masses over which this may scatter [kg]
SPEEDS_M_S, SPEED_M_S, MASSES_KG = (0.1, 0.3, 1.0, 3.0), 1.0, (0.05, 0.5, 5.0)
#: how long a block lies under a load [s]
_LIES_S = 0.4
#: loads between which it is sought where the block lets go, and halvings of what lies between
MAX_LOAD, _HALVINGS = 4.0, 12
#: the block slides on if it gets faster by more than what this part of µ·N too much would do
_SLIDES_PART = 0.005
#: part of the first speed below which a block stands
_STANDS = 0.1
#: fewest steps from which a deceleration is read, and most in which a block stops at once
_MIN_STEPS, _AT_ONCE = 6, 2


@dataclass(frozen=True)
class FrictionQuestion(Experiment[FrictionBehaviour]):
    """How friction holds and brakes at one contact level.

    Attributes:
        friction: Coulomb's coefficient µ [1]; none that an engine has by default.
    """

    kind = FrictionBehaviour
    friction: float = 0.4

    def answer(self, backend: Backend) -> FrictionBehaviour:
        """Where it lets go, how it creeps and brakes, and both over steps."""
        return FrictionBehaviour(
            lets_go_at=self.lets_go_at(backend, self.step_s),
            creep=tuple(
                CreepAtLoad(load=load, **vars(self.creep(backend, self.step_s, load)))
                for load in LOADS
            ),
            braking=tuple(
                BrakingAtSpeed(speed_m_s=speed, **vars(self.braking(backend, self.step_s, speed)))
                for speed in SPEEDS_M_S
            ),
            over_step=over_steps(FrictionAtStep, STEPS_S, lambda dt: self._at_step(backend, dt)),
        )

    def _at_step(self, backend: Backend, step_s: float) -> Friction:
        return Friction(
            lets_go_at=self.lets_go_at(backend, step_s),
            **vars(self.creep(backend, step_s, LOAD)),
            **vars(self.braking(backend, step_s, SPEED_M_S)),
        )

    def scene(
        self, step_s: float, duration_s: float, load: float = 0.0, speed_m_s: float = 0.0,
        mass_kg: float = 0.5,
    ) -> Scenario:  # fmt: skip
        """A block on a plane on which gravity leans, so that it pulls with ``load``·µ·N."""
        lean = math.atan(load * self.friction)
        x, y, z = (edge**2 for edge in SIZE_M)
        block = {
            "mass_kg": mass_kg,
            "inertia_kg_m2": [mass_kg * two / 12 for two in (y + z, x + z, x + y)],
            "position_m": [0, 0, SIZE_M[2] / 2],
            "velocity_m_s": [speed_m_s, 0, 0],
            "shapes": [{"type": "box", "size_m": SIZE_M}],
        }
        floor = {"fixed": True, "shapes": [{"type": "plane"}]}
        gravity = (G_M_S2 * math.sin(lean), 0.0, -G_M_S2 * math.cos(lean))
        contact = {"pair": ["block", "floor"], "friction": self.friction, "restitution": 0}
        bodies = {"floor": floor, "block": block}
        return scene("block", bodies, duration_s, step_s, gravity, contacts=[contact])

    def _lies(self, backend: Backend, step_s: float, load: float) -> Trajectory:
        return self.run(backend, self.scene(step_s, _LIES_S, load))

    def creep(self, backend: Backend, step_s: float, load: float) -> Creep:
        """Creep of a block that should stick, over the second half of the time; how it sinks."""
        found = self._lies(backend, step_s, load)
        along, half = _along(found), len(found.time_s) // 2
        creep = (along[-1] - along[half]) / (found.time_s[-1] - found.time_s[half])
        sinks_m = SIZE_M[2] / 2 - found.signals["block.position_m"][-1, 2]
        return Creep(creep_m_s=float(creep), sinks_m=float(sinks_m))

    def slides(self, backend: Backend, step_s: float, load: float) -> bool:
        """Whether a block that is let go gets faster from the second quarter to the fourth."""
        found = self._lies(backend, step_s, load)
        marks = np.linspace(0, len(found.time_s) - 1, 5).astype(int)
        times = found.time_s[marks]
        speeds = np.diff(_along(found)[marks]) / np.diff(times)
        normal_m_s2 = G_M_S2 * math.cos(math.atan(load * self.friction))
        least = _SLIDES_PART * self.friction * normal_m_s2 * (times[-1] - times[2])
        return bool(speeds[3] - speeds[1] > least)

    def lets_go_at(self, backend: Backend, step_s: float) -> float | None:
        """Load up to which the block sticks [µ·N]; ``None`` if the largest does not move it."""
        low, high = 0.0, MAX_LOAD
        if not self.slides(backend, step_s, high):
            return None
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            if self.slides(backend, step_s, middle):
                high = middle
            else:
                low = middle
        # it is seen to slide only where the load is too large by this
        return max((low + high) / 2 - _SLIDES_PART, 0.0)

    def braking(self, backend: Backend, step_s: float, speed_m_s: float) -> Braking:
        """Deceleration over µ·g: mean and scatter over masses; infinite where it stops at once."""
        found = []
        for mass_kg in MASSES_KG:
            time_s = 0.7 * speed_m_s / (self.friction * G_M_S2)
            slides = self.scene(step_s, time_s, 0.0, speed_m_s, mass_kg)
            found.append(_deceleration(self.run(backend, slides), speed_m_s))
        parts = np.array(found) / (self.friction * G_M_S2)
        moves = bool(np.isfinite(parts).all())
        return Braking(
            braking=float(parts.mean()),
            braking_scatter=float(parts.std()) if moves else math.nan,
            stops_at_once=bool(np.isinf(parts).any()),
        )


def _along(found: Trajectory) -> Array:
    return np.asarray(found.signals["block.position_m"][:, 0])


def _deceleration(found: Trajectory, speed_m_s: float) -> float:
    """From a parabola through the positions up to where it stops [m/s²].

    Infinite where it stops at once, NaN where there are too few steps to read it.
    """
    along, time_s = _along(found), found.time_s
    moves = np.diff(along) > _STANDS * speed_m_s * np.diff(time_s)
    count = len(moves) if moves.all() else int(np.argmin(moves))
    # the first sample is where the start was put, and may not belong to the engine's own steps
    if count < _MIN_STEPS:
        return math.inf if count <= _AT_ONCE and len(moves) >= _MIN_STEPS else math.nan
    return float(-2 * np.polyfit(time_s[1 : count + 1], along[1 : count + 1], 2)[0])
