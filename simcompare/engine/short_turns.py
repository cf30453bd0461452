"""Turns that an engine makes too small, as one does that follows a tangent for a whole step.

Others slow down what turns too fast; then the motion is wrong, and the run is no run.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.engine.scene import Scene
from simcompare.errors import SimulationDiverged
from simcompare.model.settings import TUNED
from simcompare.model.trajectory import Array

#: part of a turn that may be missing without a word
UNTOLD = 1e-4


def refuse_slowed(scene: Scene, signals: Mapping[str, Array], step_s: float, time_s: Array) -> None:
    """Stops a run in which a body turns as fast as its engine lets it.

    Args:
        scene: the scene, whose traits say how fast that is.
        signals: motion of the bodies.
        step_s: the engine's step [s].
        time_s: times of the samples (n,).

    Raises:
        SimulationDiverged: one does; where a level gives less than everything it is only shown.
    """
    most_rad = scene.traits.most_turn_rad
    if most_rad is None or not scene.gives(TUNED):
        return
    for name, rates in _rates(scene, signals).items():
        slowed = np.flatnonzero(rates * step_s > 0.999 * most_rad)
        if len(slowed):
            raise SimulationDiverged(
                f"{name} turned by {most_rad:g} rad in a step by t = {time_s[slowed[0]]:g} s,"
                f" as far as {scene.engine} lets it; try a smaller --step"
            )


def note_of_turns(scene: Scene, signals: Mapping[str, Array], step_s: float) -> tuple[str, ...]:
    """What a run has to tell of the body that turned fastest; nothing where its turns are right.

    Args:
        scene: the scene, whose traits say what becomes of a turn.
        signals: motion of all bodies.
        step_s: the engine's step, or the inner steps into which it divides one [s].
    """
    made = scene.traits.turn_made
    fastest = {name: float(rates.max()) for name, rates in _rates(scene, signals).items()}
    if made is None or not any(fastest.values()):
        return ()
    name = max(fastest, key=lambda body: fastest[body])
    turn = fastest[name] * step_s
    missing = 1 - made(turn) / turn
    if missing < UNTOLD:
        return ()
    return (
        f"{name} turns by up to {turn:.2g} rad in a step, which {scene.engine} makes"
        f" {100 * missing:.2g} % too small; a shorter --step helps",
    )


def _rates(scene: Scene, signals: Mapping[str, Array]) -> dict[str, Array]:
    """How fast the bodies turn (n,) [rad/s], of which the motion is there."""
    return {
        name: np.linalg.norm(signals[f"{name}.rate_rad_s"], axis=1)
        for name in scene.scenario.moving_bodies()
        if f"{name}.rate_rad_s" in signals
    }
