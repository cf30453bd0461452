"""Rapier through the package ``rapier3d``: in space, in single precision, joints by impulses."""

from __future__ import annotations

import math

from simcompare.backends.rapier.simulation import RapierSimulation
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


class RapierBackend(EngineBackend):
    """Rapier through the package ``rapier3d``."""

    name = "rapier"
    simulation = RapierSimulation
    library = PipPackage("rapier3d", "pip install 'simcompare[rapier]'", ["rapier3d"])
    traits = Traits(precision=1e-6, turn_made=lambda turn: 2 * math.atan(turn / 2))
    features = SPATIAL_RIGID_BODIES | JOINTS_AND_FORCES | {Feature.RAYS}
    helps = frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS, RECOIL})
    typed_as = "restitution"
    snippet = """parameters = world.integration_parameters
parameters.dt = {step_s!r}
parameters.num_solver_iterations = {typed[num_solver_iterations]:.0f}
parameters.num_internal_pgs_iterations = {typed[num_internal_pgs_iterations]:.0f}
parameters.num_internal_stabilization_iterations = 0
parameters.contact_clustering = parameters.contact_recycling = False
parameters.normalized_prediction_distance = {typed[normalized_prediction_distance]}
parameters.normalized_max_linear_velocity = {typed[normalized_max_linear_velocity]}
parameters.contact_softness = parameters.static_contact_softness = rapier3d.SpringCoefficients(
    {typed[contact_softness.natural_frequency]}, {typed[contact_softness.damping_ratio]}
)
multiply = {{"restitution_combine_rule": rapier3d.CoefficientCombineRule.MULTIPLY}}
on_ball = {{"restitution": {0!r}, **multiply}}  # arguments of the ball's Collider.new
on_floor = {{"restitution": 1.0, **multiply}}  # and of the floor's
of_ball = {{"can_sleep": False, "allow_fast_rotation": True}}  # of RigidBody.dynamic"""
    known_limits = (
        KnownLimit(
            "Single precision: accelerations and forces scatter by some hundredths of a m/s² at"
            " 1 ms, and more with shorter steps; gravity at 150 m/s is 0.2 % off.",
            "rapier3d's f32 build; measured: a pendulum of 0.15 m, 0.02 m/s²; the force through a"
            " hinge by 0.6 % of the weight, its mean by 0.02 %; through two askew hinges at 0.5 ms"
            " by 0.1 to 0.4 N along each axis, of 1 to 14 N, its mean by 2 mN",
        ),
        KnownLimit(
            "A body on a hinge without friction gains speed.",
            "measured: from 10 rad/s in 20 s at 1 ms to 10.017 when tuned, 10.061 by default",
        ),
        KnownLimit(
            "Restitution is 0 and friction 0.5 by default, and of two bodies the mean is taken: 0.8"
            " on a floor of which nothing is said becomes 0.4.",
            "Rapier CoefficientCombineRule; measured: a rebound of 0.16 m from 1 m",
        ),
        KnownLimit(
            "A step, or each of the parts into which Rapier divides it, turns a body by"
            " 2·atan(ω·h/2) in place of ω·h; a run tells of it.",
            "Rapier integrate_linearized; measured: at 380 rad/s and 2 ms 4.5 % too little, so the"
            " angle of a motor is 18 rad short; 0.02 rad at 0.1 ms",
        ),
        KnownLimit(
            "By default nothing turns further than 45° in a step, or moves faster than 400 m/s.",
            "Rapier changelog, 0.35.0; measured: 785 rad/s at 1 ms",
        ),
        KnownLimit(
            "Contacts are soft by default: small wheels sink in, and a robot gets too fast.",
            "Rapier IntegrationParameters::static_contact_softness; measured: 0.5 mm under a wheel"
            " of 65 mm, 0.65 % of the acceleration",
        ),
        KnownLimit(
            "After each part of a step speeds are solved for once more, without what closes gaps."
            " That takes energy from joints; without it a pendulum keeps its swing.",
            "Rapier num_internal_stabilization_iterations; measured: a pendulum that starts level"
            " loses 28 mrad in 4 s by default, 106 with one part, 0.1 without",
        ),
        KnownLimit(
            "A bounce happens at the end of a step, with the speed at its start, so small hops are"
            " too low.",
            "Rapier changelog, 0.35.0, issue 974; measured: 0.798 for 0.8 at 3 m/s and 1 ms, 0.79"
            " as the mean of 17 bounces",
        ),
        KnownLimit(
            "Friction at an impact comes before the bounce: it gets at most 1/(1 + e) of what"
            " Coulomb's law gives it, and less where the impact falls into the last part of a step,"
            " which in a scene with joints is every one.",
            "Rapier apply_restitution; measured for e = 0.8: 56 %, and between 7 and 56 % in one of"
            " four impacts",
        ),
        KnownLimit(
            "Coulomb friction at every point of a contact (FrictionModel.COULOMB) brakes a box too"
            " little. The default brakes at the middle of a contact, and its spin apart from that.",
            "measured: a box slid 0.438 m in place of 0.382; 0.382 with the default",
        ),
        KnownLimit(
            "A joint's impulses are told along axes each of which is freed from those before it,"
            " and of the last part of a step; they are no forces before that is undone.",
            "Rapier JointConstraintHelper::finalize_constraints; measured: 0.18 of 0.68 N",
        ),
        KnownLimit(
            "Joints take no torques: efforts act on both bodies. Springs and dampers, which Rapier"
            " has as motors, are efforts too.",
            "Rapier ImpulseJoint, RigidBody::add_torque",
        ),
        KnownLimit(
            "There is no armature: it is part of the child's moment of inertia about the joint's"
            " axis, and assisted gives both bodies the torques that are missing where the parent"
            " turns, a step late. An armature that outweighs its parent is refused.",
            "Rapier ImpulseJoint; only multibody joints have it",
        ),
        KnownLimit(
            "By default what has been at rest for half a second falls asleep, and a state that is"
            " set does not know how long it has been, nor which impulses it had.",
            "Rapier RigidBodyActivation; measured: a robot goes on 40 µm beside its way",
        ),
        KnownLimit(
            "A body whose numbers overflow is put back and taken out of the world without a word;"
            " here the run fails.",
            "Rapier PhysicsWorld::quarantine; measured",
        ),
    )
    mapping = (
        "restitution and friction of a moving body = those of its pairs, of a fixed one = 1, with"
        " the rule MULTIPLY, or those that give all pairs with MIN or MAX; Coulomb friction of a"
        " joint = a motor that stops it at once, with the friction as its largest force. Tuned:"
        " contacts that are critically damped, at one turn in a step, looked for within 1 m,"
        " neither clustered nor recycled; 50 inner iterations and no stabilization; with joints one"
        " solver iteration in place of 4, so that forces act as in other engines; nothing sleeps,"
        " and speeds have no limit; no gyroscopic torques, which would only be rounding, where all"
        " moments are equal. Assisted: impacts in steps of at most 2 µs; springs, dampers and"
        " motors act with the rate at the instant of the positions"
    )


BACKEND = RapierBackend()
