"""Box2D 3, two-dimensional: the scenario's x-z plane is its x-y plane."""

from __future__ import annotations

from simcompare.backends.box2d.simulation import Box2dSimulation
from simcompare.backends.box2d.variants import VARIANTS
from simcompare.backends.box2d.world import MADE_WITH, SET_AFTER
from simcompare.kit import (
    CENTRED_EFFORTS,
    HALF_STEP_START,
    JOINTS_AND_FORCES,
    LANDING,
    RAYS,
    RECOIL,
    EngineBackend,
    Feature,
    KnownLimit,
    OwnValue,
    PipPackage,
    Traits,
)


class Box2dBackend(EngineBackend):
    """Box2D 3 through the package ``pyb2d3``; planar scenarios only."""

    name = "box2d"
    simulation = Box2dSimulation
    library = PipPackage("pyb2d3", "pip install 'simcompare[box2d]'", ["pyb2d3"])
    traits = Traits(precision=1e-6, most_turn_rad=0.785, foresees_contacts=True)
    features = (JOINTS_AND_FORCES - {Feature.CONTACT_FORCE}) | {
        Feature.FREE_BODY, Feature.PLANE, Feature.SPHERE, Feature.BOX,
        Feature.RESTITUTION, Feature.FRICTION, Feature.DRAG,
    }  # fmt: skip
    helps = frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS, RECOIL, RAYS})
    typed_as = "restitution"
    other_values = (
        OwnValue(
            "restitution_threshold", "Impacts that are slower do not bounce.", "m/s",
            1.0, 0.0, 5.0, tuned=SET_AFTER["restitution_threshold"],
        ),
        OwnValue(
            "contact_hertz", "How hard bodies that overlap are pressed apart.", "Hz",
            30.0, 1.0, 240.0, log=True, tuned=MADE_WITH["contact_hertz"],
        ),
    )  # fmt: skip
    snippet = """world = pyb2d3.World(
    gravity=gravity, contact_hertz={typed[World.contact_hertz]},
    maximum_linear_speed={typed[World.maximum_linear_speed]},
)
world.restitution_threshold, world.sleeping_enabled = 0.0, False
material = pyb2d3.surface_material(restitution={0!r})  # of both shapes: Box2D takes the larger
definition = pyb2d3.shape_def(material=material)  # for create_shapes of ball and floor
world.step({step_s!r}, {typed[World.step(sub_step_count)]:.0f})  # in every step"""
    variants = VARIANTS
    known_limits = (
        KnownLimit(
            "Two-dimensional: it runs scenarios whose motion stays in the x-z plane.",
            "Box2D documentation, Overview",
        ),
        KnownLimit(
            "Single precision: 1 m from the origin a place is known to 60 nm, what moves less in a"
            " step stands still, accelerations that are taken from places are noisy, and a speed"
            " grows by whole units of its last place in each substep.",
            "Box2D documentation, FAQ; measured at 1 ms: 0.02 m/s², gravity to 2 parts in 10⁴ at"
            " 4 m/s, forces to 3 parts in 10⁴",
        ),
        KnownLimit(
            "By default impacts slower than 1 m/s do not bounce, and what is slow for half a second"
            " falls asleep; a body without a shape does so while it turns.",
            "Box2D documentation, b2WorldDef::restitutionThreshold, b2BodyDef::enableSleep;"
            " measured",
        ),
        KnownLimit(
            "A bounce takes the speed at which its step begins and happens at the end of it, up to"
            " a substep above the floor: it loses g·dt/2v of its speed.",
            "Box2D contact_solver.c, b2ApplyRestitution; measured at 1 ms for 0.8: 0.800 at"
            " 4.4 m/s, 0.795 at 1 m/s, 0.78 at 0.2 m/s",
        ),
        KnownLimit(
            "Contacts are springs: by default a body at rest sinks in by 0.1 mm, and a wheel of"
            " 30 mm rolls as far as if it slipped by 0.7 %.",
            "Box2D documentation, b2WorldDef::contactHertz; measured",
        ),
        KnownLimit(
            "Joints are springs of 60 Hz that are overdamped, and pyb2d3 gives no way to make"
            " hinges and sliders stiffer: by default a double pendulum of 10 g and 1 kg loses half"
            " its energy in 2 s, and sliders remain so at every level.",
            "Box2D constants.h, B2_JOINT_CONSTRAINT_HERTZ; b2Joint_SetConstraintTuning is not"
            " bound; measured",
        ),
        KnownLimit(
            "Joints and contacts begin without impulses and give way at first, also where a run is"
            " brought back to a state: Box2D does not give its impulses away, so a new world is"
            " built then, also for a run that is saved and goes on.",
            "Box2D documentation, b2World; measured: links of 0.3 m that motors hold move by"
            " 17 µrad, with the defaults by 1 mrad",
        ),
        KnownLimit(
            "A body turns by atan(ω·h) in a substep of length h, so that its angle falls short by"
            " (ω·h)²/3, and by π/4 in a step at most.",
            "Box2D math_functions.h, b2IntegrateRotation; constants.h, B2_MAX_ROTATION; measured:"
            " 0.6 % at 380 rad/s, 2 ms and 4 substeps",
        ),
        KnownLimit(
            "What is given to a step acts in all of its substeps, so it comes half a step late;"
            " forces through joints are those of the last substep.",
            "Box2D solver.c, b2IntegrateVelocitiesTask; joint.c, b2Joint_GetConstraintForce;"
            " measured",
        ),
        KnownLimit(
            "Contact forces are not given.",
            "pyb2d3 0.11.1, export_box2d_wrapper_structs.cpp: b2Body_GetContactData is not bound",
        ),
        KnownLimit(
            "Joints have no armature: it is added to the child's moment of inertia, and assisted"
            " gives both bodies the torques that are missing where the parent turns, a step late."
            " One that outweighs its parent is refused, and a slider cannot have one.",
            "Box2D documentation, b2RevoluteJointDef; measured: errors halve with the step",
        ),
        KnownLimit(
            "There is no half space: a plane is a box 200 m long and 1 m thick.",
            "Box2D documentation, Shapes",
        ),
        KnownLimit(
            "At most 128 simulations can be open at a time.",
            "Box2D constants.h, B2_MAX_WORLDS",
        ),
    )
    mapping = (
        "restitution of every body = the smallest of its pairs (Box2D takes the larger of two);"
        " friction of the moving body = mu², of the fixed one = 1 (it takes the root of the"
        " product); restitution_threshold = 0, no sleeping, no limit of speed; contact_hertz = 240,"
        " with which a body at rest sinks in by micrometres; at least 8 substeps (the documentation"
        " takes 4; slow bounces lose half as much), and so many that no body turns by more than"
        " 0.03 rad in one, as far as its start and its motors tell; a plane is a box that lies"
        " upside down, as distances are taken from its first corner. Only welds have a stiffness in"
        " pyb2d3: it is 500 Hz, with a damping ratio of 40; a hinge is a weld without its angular"
        " spring, with a ratio of 3, and its dry friction a motor joint; a weld is anchored in the"
        " middle between both centres of mass. Assisted: impacts in steps of at most 2 µs; efforts"
        " and drag are those in the middle of a step; the first velocities are set half a substep"
        " before the start, where the engine holds them"
    )


BACKEND = Box2dBackend()
