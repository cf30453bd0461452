"""Bullet 3 through PyBullet in DIRECT mode: trees of bodies in reduced coordinates."""

from __future__ import annotations

import sys

from simcompare.backends.pybullet.simulation import PybulletSimulation
from simcompare.backends.pybullet.variants import VARIANTS
from simcompare.kit import (
    HELPS,
    JOINTS_AND_FORCES,
    SPATIAL_RIGID_BODIES,
    EngineBackend,
    Feature,
    KnownLimit,
    OwnValue,
    PipPackage,
    Rims,
    Traits,
)

#: it has wheels for Python 3.11 and older only; elsewhere pip builds it, for about ten minutes
_COMPILER = f"sudo apt-get install g++ python3.{sys.version_info[1]}-dev && "


class PybulletBackend(EngineBackend):
    """Bullet 3 through the package ``pybullet``."""

    name = "pybullet"
    simulation = PybulletSimulation
    library = PipPackage(
        "pybullet",
        f"{'' if sys.version_info < (3, 12) else _COMPILER}pip install 'simcompare[pybullet]'",
        ["pybullet"],
    )
    traits = Traits(
        most_shapes=1,
        wrong_reactions=frozenset({"twice", "stale"}),
        rims=Rims(),
        # at 0 contacts that do not bounce would alternate
        contact_gap_m=1.0e-5,
        # without error reduction a body rests up to g·dt² deep
        rest_step_s=2.5e-4,
        # what a body is in too deep after an impact, up to v·dt, it stays
        bounce_step_s=1.0e-4,
    )
    features = SPATIAL_RIGID_BODIES | JOINTS_AND_FORCES | {Feature.RAYS}
    helps = frozenset(HELPS)
    variants = VARIANTS
    script_module = "simcompare.backends.pybullet.script"
    typed_as = "restitution"
    other_values = (
        OwnValue(
            "restitutionVelocityThreshold", "Impacts that are slower do not bounce.", "m/s",
            0.2, 0.0, 5.0, tuned=0.0,
        ),
        OwnValue(
            "contactERP", "The part of an overlap that a step takes away.", "1",
            0.2, 0.0, 1.0, tuned=0.0,
        ),
        OwnValue(
            "contactSlop", "How deep bodies may overlap before they are pressed apart.", "m",
            1e-5, 0.0, 0.02, tuned=0.0,
        ),
    )  # fmt: skip
    snippet = """pybullet.setTimeStep({step_s!r})
pybullet.setPhysicsEngineParameter(
    erp=0, contactERP=0, contactSlop=0, restitutionVelocityThreshold=0
)
for body, restitution in ((ball, {0!r}), (floor, 1.0)):  # Bullet multiplies the two
    pybullet.changeDynamics(body, -1, restitution=restitution)
    pybullet.changeDynamics(
        body, -1, linearDamping=0, angularDamping=0, contactProcessingThreshold=0
    )"""
    known_limits = (
        KnownLimit(
            "Restitution is 0 by default, and bodies lose 4 % of their speed a second to damping.",
            "Bullet Physics SDK, btMultiBody; PyBullet Quickstart Guide, changeDynamics",
        ),
        KnownLimit(
            "With a restitution set and all else left alone, the bounce depends on where in the"
            " step the impact falls: 0.42 to 0.85 for 0.8, as contacts act that are still apart.",
            "measured over the impact phase; bulletphysics/bullet3 issues 1530, 3094",
        ),
        KnownLimit(
            "A contact slop of 10 µm, on by default, swallows the bounce at steps below 0.1 ms.",
            "measured: e = 0.5 gave 0.21 at 20 µs until contactSlop was set to 0",
        ),
        KnownLimit(
            "Bodies in reduced coordinates bounce with e·(1 + g·dt/v); bodies in maximal"
            " coordinates do not, but then neither restitution nor friction can be read back.",
            "measured; getDynamicsInfo returns the defaults for them whatever was set",
        ),
        KnownLimit(
            "Damping, contact thresholds and solver parameters have setters and no getters.",
            "PyBullet Quickstart Guide, getDynamicsInfo, getPhysicsEngineParameters",
        ),
        KnownLimit(
            "By default a motor holds every joint at rest, with up to 1 N·m·s or N·s in each step;"
            " a robot does not move until that is switched off.",
            "PyBullet Quickstart Guide, setJointMotorControl2; measured: acceleration 0.0000",
        ),
        KnownLimit(
            "No coordinate gets faster than 100 m/s or rad/s until maxJointVelocity is raised.",
            "bulletphysics/bullet3, btMultiBody.h, m_maxCoordinateVelocity; measured",
        ),
        KnownLimit(
            "A cylinder touches a plane at one point at a time, at an end that rounding picks, so"
            " that a robot on such wheels turns by itself; assisted takes the two rims instead.",
            "measured: turned by 1.8 rad within a metre; 1e-6 rad with rims",
        ),
        KnownLimit(
            "Corners of a box on a plane are found one in each step, so that a box that lands flat"
            " turns; assisted takes a box of 1 km for a plane that only boxes touch. What has sunk"
            " in during a bounce stays in, up to speed times step, 0.1 ms.",
            "measured: e = 0.5 gave 0.485 flat and 0.443 on an edge, and turned; 0.4996 on a box",
        ),
        KnownLimit(
            "Reaction forces take Coriolis and gyroscopic terms in twice, so they are wrong in free"
            " bodies that turn and where joints move on moving bodies; assisted takes them off.",
            "bulletphysics/bullet3 issues 2966, 4451, pull request 4583; measured: 12 m/s² too much"
            " on a robot at 2 m/s, 1e-10 m/s² when taken off",
        ),
        KnownLimit(
            "Rays meet all shapes but planes by an iteration that stops some millimetres beside"
            " them where it meets them aslant.",
            "Bullet btSubsimplexConvexCast; measured on shapes of 0.1 m: up to 8 mm where the ray"
            " only grazes, 1.4 mm within 50° of the normal, half of them within 0.1 mm",
        ),
        KnownLimit(
            "There is no armature: it is added to the child's moment of inertia about the hinge,"
            " and assisted gives both bodies the torques that are missing where the parent turns, a"
            " step late. One that outweighs its parent is refused, and a slider cannot have one.",
            "PyBullet Quickstart Guide, changeDynamics; measured: trees of three tumbling bodies"
            " come as close as MuJoCo's, 0.3 mm in 0.3 s at 1 ms, and errors halve with the step",
        ),
        KnownLimit(
            "A saved state has lost its points of contact once the engine had to forget others,"
            " which it does where bodies are put into a plain state, or back to where nothing"
            " touched; both rims that stand for a cylinder get the points of one.",
            "bulletphysics/bullet3, btMultiBodyWorldImporter.cpp, syncContactManifolds; measured:"
            " 2e-6 after 10 steps of two boxes, 1e-5 N after 52 of a robot on rims; else exact",
        ),
        KnownLimit(
            "Bodies that joints hold together do not touch each other by default.",
            "PyBullet Quickstart Guide, loadURDF, URDF_USE_SELF_COLLISION",
        ),
    )
    mapping = (
        "restitution of the moving body = e, of the fixed one = 1 (Bullet multiplies);"
        " contactProcessingThreshold = 0, or 10 µm where nothing bounces, contactSlop = 0,"
        " erp = contactERP = 0 where something bounces, restitutionVelocityThreshold = 0,"
        " damping = 0; with joints: motors off, Coulomb friction as a motor towards rest of that"
        " strength, springs, dampers and drives as efforts, sweeps until they change 1e-12 m/s."
        " Assisted: impacts in steps of at most 2 µs, of 0.1 ms where they are not landed on;"
        " planes under boxes as a large box; cylinders on planes as their two rims, between which a"
        " globalCFM shares the load"
    )


BACKEND = PybulletBackend()
