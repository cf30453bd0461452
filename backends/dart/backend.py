"""DART through dartpy: trees of bodies in reduced coordinates, stepped from Python."""

from __future__ import annotations

from simcompare.backends.dart.simulation import DartSimulation
from simcompare.backends.dart.variants import VARIANTS
from simcompare.kit import (
    CENTRED_EFFORTS,
    HALF_STEP_START,
    JOINTS_AND_FORCES,
    LANDING,
    RECOIL,
    SPATIAL_RIGID_BODIES,
    EngineBackend,
    Feature,
    KnownLimit,
    PipPackage,
    Traits,
)


class DartBackend(EngineBackend):
    """DART through the package ``dartpy``."""

    name = "dart"
    simulation = DartSimulation
    script_module = "simcompare.backends.dart.script"
    library = PipPackage(
        "dartpy", "pip install 'simcompare[dart]'", ["dartpy"],
        [("libGL.so.1", "sudo apt-get install libgl1")],
    )  # fmt: skip
    traits = Traits(offset_centres=True, passive="implicit")
    features = SPATIAL_RIGID_BODIES | JOINTS_AND_FORCES | {Feature.RAYS}
    helps = frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS, RECOIL})
    typed_as = "restitutionCoeff"
    snippet = """world.setTimeStep({step_s!r})
ball_shape.getDynamicsAspect().setRestitutionCoeff({0!r})
floor_shape.getDynamicsAspect().setRestitutionCoeff(1.0)  # DART multiplies the two"""
    variants = VARIANTS
    known_limits = (
        KnownLimit(
            "Restitution is 0 by default, on the body and on the floor; both must be set.",
            "DART DynamicsAspect::getRestitutionCoeff; measured",
        ),
        KnownLimit(
            "A bounce that would leave the floor slower than about 0.1 m/s does not happen.",
            "measured; DART ContactConstraint.cpp, DART_BOUNCING_VELOCITY_THRESHOLD",
        ),
        KnownLimit(
            "The bounce speed is taken after gravity has acted: e·(1 + g·dt/v), so small hops at"
            " a long step never die out.",
            "measured: 0.8059 at 4 ms, 0.8015 at 1 ms, 0.8004 at 0.25 ms for 0.8 and 4.4 m/s",
        ),
        KnownLimit(
            "The default collision detector (FCL) approximates cylinders; ODE's does not.",
            "measured: a wheeled robot was 14 % short with FCL, 0.1 % off with ODE",
        ),
        KnownLimit(
            "The default collision detector knows no capsules: it takes a sphere of their radius,"
            " and says so on stderr.",
            "DART FCLCollisionDetector.cpp, createFCLCollisionGeometry; measured: 0.69 m rolled for"
            " 0.97 m",
        ),
        KnownLimit(
            "By default what has rested on something for half a second falls asleep: it is frozen,"
            " contact forces read 0, and a restored state does not know how long it has rested.",
            "DART World::updateRestStates, DeactivationOptions; measured: 0 N from 0.5 s on",
        ),
        KnownLimit(
            "The default solver (Dantzig) limits friction by the normal force as it would be"
            " without friction; the one for Coulomb's cone (NSGS) lets contacts along lines slip.",
            "measured: spinning wheels pushed 4.2 % too much with Dantzig, 0.003 % off with NSGS;"
            " a robot on cylinders left its line by 0.4 m in 1 s with NSGS, by 8 µm with Dantzig; a"
            " spinning box stopped after 2.003 instead of 2.008 rad with NSGS, 1.57 with Dantzig",
        ),
        KnownLimit(
            "Friction of 0.001 and less is none.",
            "DART ContactConstraint.cpp, DART_FRICTION_COEFF_THRESHOLD; measured with 0.0009",
        ),
        KnownLimit(
            "Bodies of one skeleton pass through one another unless it is told otherwise; it is"
            " told so where a scenario says what happens between two that no joint connects.",
            "DART Skeleton::enableSelfCollisionCheck",
        ),
        KnownLimit(
            "Of its collision detectors only its own and Bullet's cast rays. Its own one casts them"
            " here, whichever finds the contacts.",
            "DART CollisionDetector.cpp, raycast; measured: exact to 1e-14 m, Bullet's up to 4 mm"
            " off on a cylinder",
        ),
        KnownLimit(
            "There is no armature: it is part of the child's moment of inertia about the joint's"
            " axis, and assisted gives both bodies the torques that are missing where the parent"
            " turns, a step late. An armature that outweighs its parent is refused.",
            "DART Joint; measured: trees of three tumbling bodies come as close as MuJoCo's, 0.3 mm"
            " in 0.3 s at 1 ms, and errors halve with the step",
        ),
        KnownLimit(
            "Impulses know nothing of a damper of DART's own, which is used by default: Coulomb"
            " friction beside it is 1 + damping·dt/inertia times too strong.",
            "measured: a motor idled at 969 instead of 973 rad/s, for 5 % more friction, at 1 ms",
        ),
    )
    mapping = (
        "restitution of the moving body = e, of the fixed one = 1 (DART multiplies); friction of a"
        " body = the largest of its pairs (DART takes the smaller of two); ODE collision detector;"
        " NSGS solver (tolerance 1e-6) where only single spheres rub, or free boxes on planes;"
        " nothing falls asleep; springs, dampers and Coulomb friction of joints are DART's own."
        " Assisted: impacts in steps of at most 2 µs, so that the bias g·dt/v is below 1e-4 down to"
        " 0.2 m/s; springs and dampers are forces on joints in every step"
    )


BACKEND = DartBackend()
