"""Variants of DART: its collision detectors and its solvers for contacts."""

from __future__ import annotations

from simcompare.engine.variants import Variant

DETECTOR, SOLVER = "collision", "constraint"
_DETECTORS = "DART documentation, dart::collision::CollisionDetector"
_SOLVERS = "DART documentation, dart::constraint::BoxedLcpSolver, NsgsFrictionSolver"

#: what is set: the module of dartpy in which it is, and its class
VARIANTS = {
    "fcl": Variant(
        "contacts are found by FCL, as by default, also where tuned takes ODE",
        _DETECTORS,
        (DETECTOR, "FCLCollisionDetector"),
    ),
    "ode": Variant(
        "contacts are found by ODE's detector, as in tuned, also where DART takes FCL",
        _DETECTORS,
        (DETECTOR, "OdeCollisionDetector"),
    ),
    "bullet": Variant(
        "contacts are found by Bullet's detector",
        _DETECTORS,
        (DETECTOR, "BulletCollisionDetector"),
    ),
    "dart": Variant(
        "contacts are found by DART's own detector",
        _DETECTORS,
        (DETECTOR, "DARTCollisionDetector"),
    ),
    "dantzig": Variant(
        "contacts are solved by Dantzig's method, as by default, also where tuned takes NSGS",
        _SOLVERS,
        (SOLVER, "DantzigBoxedLcpSolver"),
    ),
    "nsgs": Variant(
        "contacts are solved by nonsmooth Gauss-Seidel sweeps to 1e-6, also where tuned takes"
        " Dantzig's method",
        _SOLVERS,
        (SOLVER, "NsgsFrictionSolver"),
    ),
}
