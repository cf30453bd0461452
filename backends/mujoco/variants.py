"""Variants of MuJoCo: its integrators and friction cones."""

from __future__ import annotations

from typing import NamedTuple

from simcompare.engine.variants import CENTRED_EFFORTS, HALF_STEP_START, LANDING, Variant


class Choice(NamedTuple):
    """One of MuJoCo's own choices.

    Attributes:
        option: its name in ``<option>``, and in ``model.opt``.
        word: what is written there.
        number: what ``model.opt`` then holds.
        enum: what that is called.
    """

    option: str
    word: str
    number: int
    enum: str


ELLIPTIC = Choice("cone", "elliptic", 1, "mjCONE_ELLIPTIC")
_INTEGRATORS = "MuJoCo documentation, Computation, Numerical integration"
_MEAN = "it takes the damper of an actuator after the step, too, so that no mean is left"
_CONES = "MuJoCo documentation, Computation, Contact; XML reference, option/cone"

VARIANTS = {
    "rk4": Variant(
        "the fourth-order method of Runge and Kutta in place of semi-implicit Euler",
        _INTEGRATORS,
        Choice("integrator", "RK4", 1, "mjINT_RK4"),
        frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS}),
        "they are for velocities half a step away from the positions, and RK4 has none; with them"
        " a restitution of 0.8 became 0.817",
    ),
    "implicit": Variant(
        "all forces that depend on velocities, also Coriolis and gyroscopic ones, are taken with"
        " those after the step",
        _INTEGRATORS,
        Choice("integrator", "implicit", 2, "mjINT_IMPLICIT"),
        frozenset({CENTRED_EFFORTS}),
        _MEAN,
    ),
    "implicitfast": Variant(
        "as implicit, without Coriolis and gyroscopic forces; what is left of a joint is its"
        " damper, which the default takes after the step, too",
        _INTEGRATORS,
        Choice("integrator", "implicitfast", 3, "mjINT_IMPLICITFAST"),
        frozenset({CENTRED_EFFORTS}),
        _MEAN,
    ),
    "pyramidal": Variant(
        "friction is limited by a pyramid, as by default, also where tuned takes a cone",
        _CONES,
        Choice("cone", "pyramidal", 0, "mjCONE_PYRAMIDAL"),
    ),
    "elliptic": Variant(
        "friction is limited by a cone, as in tuned, also where MuJoCo takes a pyramid",
        _CONES,
        ELLIPTIC,
    ),
}
