"""Dead reckoning on two wheels: where a robot is that only knows how far its wheels have rolled.

Between two samples both wheels keep their ratio of speeds, so the way is an arc. With Δs_L and Δs_R
rolled, track W, Δψ = (Δs_R - Δs_L)/W and Δs = (Δs_L + Δs_R)/2, the robot goes on by the chord
Δs·sin(Δψ/2)/(Δψ/2) in the direction ψ + Δψ/2. That is exact, however far the samples are apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array


@dataclass(frozen=True)
class Arcs:
    """The arcs between n samples, n - 1 of each.

    Attributes:
        way_m: lengths Δs.
        turn_rad: turns Δψ, to the left.
        chord_m: distances of the ends, below 0 backwards.
        direction_rad: directions of the chords.
    """

    way_m: Array
    turn_rad: Array
    chord_m: Array
    direction_rad: Array


def arcs(left_m: Array, right_m: Array, track_m: float, heading_rad: float = 0.0) -> Arcs:
    """What the robot drives between samples of how far its wheels have rolled, (n,) each.

    Args:
        left_m: way of the left wheel since any start [m].
        right_m: way of the right wheel [m].
        track_m: distance of the wheels.
        heading_rad: at the first sample.
    """
    left, right = np.diff(left_m), np.diff(right_m)
    way, turn = (left + right) / 2, (right - left) / track_m
    headings = heading_rad + np.concatenate(([0.0], np.cumsum(turn)))
    # numpy's sinc is that of pi times its argument
    chord = way * np.sinc(turn / (2 * np.pi))
    return Arcs(way, turn, chord, headings[:-1] + turn / 2)


def poses(driven: Arcs, start: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Array:
    """x, y and heading at all samples (n, 3), from the arcs between them and the first pose."""
    steps = np.column_stack(
        (
            driven.chord_m * np.cos(driven.direction_rad),
            driven.chord_m * np.sin(driven.direction_rad),
            driven.turn_rad,
        )
    )
    return np.asarray(start + np.vstack((np.zeros(3), np.cumsum(steps, axis=0))), dtype=float)
