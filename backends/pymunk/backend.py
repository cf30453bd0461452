"""pymunk (Chipmunk), two-dimensional: the scenario's x-z plane is its x-y plane."""

from __future__ import annotations

from simcompare.backends.pymunk.simulation import PymunkSimulation
from simcompare.backends.pymunk.space import SLOP_M
from simcompare.backends.pymunk.variants import VARIANTS
from simcompare.kit import (
    CENTRED_EFFORTS,
    HALF_STEP_START,
    JOINTS_AND_FORCES,
    LANDING,
    RAYS,
    REACTIONS,
    RECOIL,
    EngineBackend,
    Feature,
    KnownLimit,
    OwnValue,
    PipPackage,
    Traits,
)

#: longest step during an impact [s]; a longer one at rest would multiply the remembered impulse and
#: throw the body up
CONTACT_STEP_S = 4.0e-6
#: Chipmunk's own, (1 - 0.1)^60 in single precision
BIAS = 0.0017970074436457143


class PymunkBackend(EngineBackend):
    """Chipmunk through the package ``pymunk``; planar scenarios only."""

    name = "pymunk"
    simulation = PymunkSimulation
    script_module = "simcompare.backends.pymunk.script"
    library = PipPackage("pymunk", "pip install 'simcompare[pymunk]'", ["pymunk"])
    traits = Traits(
        positions_first=True, wrong_reactions=frozenset({"magnitude"}),
        contact_step_s=CONTACT_STEP_S, rest_step_s=CONTACT_STEP_S,
    )  # fmt: skip
    features = JOINTS_AND_FORCES | {
        Feature.FREE_BODY, Feature.PLANE, Feature.SPHERE, Feature.BOX,
        Feature.RESTITUTION, Feature.FRICTION, Feature.DRAG,
    }  # fmt: skip
    helps = frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS, RECOIL, REACTIONS, RAYS})
    typed_as = "elasticity"
    other_values = (
        OwnValue(
            "collision_slop", "How deep bodies may overlap before they are pushed apart.", "m",
            0.1, 1e-9, 0.2, log=True, tuned=SLOP_M,
        ),
        OwnValue(
            "collision_bias", "The part of an overlap that is left after a second.", "1",
            BIAS, 1e-6, 1.0, log=True, tuned=BIAS,
        ),
    )  # fmt: skip
    snippet = f"""space.collision_slop = {SLOP_M}
ball_shape.elasticity, floor_shape.elasticity = {{0!r}}, 1.0  # Chipmunk multiplies the two
space.step({{step_s!r}})  # in every step"""
    variants = VARIANTS
    known_limits = (
        KnownLimit(
            "Two-dimensional: it runs scenarios whose motion stays in the x-z plane.",
            "pymunk documentation, Overview",
        ),
        KnownLimit(
            "Elasticity is 0 by default, and overlaps up to 0.1 m are left alone: a small ball"
            " dropped with the defaults sinks into the floor.",
            "pymunk documentation, Space.collision_slop; measured",
        ),
        KnownLimit(
            "Impulses remembered between steps are scaled by the ratio of the steps; a step that"
            " changes while bodies touch adds or removes momentum.",
            "Chipmunk cpSpaceStep.c; measured",
        ),
        KnownLimit(
            "There is no half space: a plane is a bar 2 km long and 1 m thick. A slider reaches"
            " 1 km to either side.",
            "pymunk documentation, Segment, GrooveJoint",
        ),
        KnownLimit(
            "Joints are constraints that are solved one after the other, 10 times by default: that"
            " leaves gaps where a heavy body hangs on a light one, and where gaps are closed at"
            " once such bodies run away.",
            "Chipmunk cpSpaceStep.c; measured: a double pendulum of 10 g and 1 kg, error_bias = 0",
        ),
        KnownLimit(
            "Joints give way, and by default are drawn together by less than a hundredth in a step"
            " of 1 ms.",
            "pymunk documentation, Constraint.error_bias; measured: a pendulum of 0.3 m at 8 rad/s"
            " is 0.7 mm too long",
        ),
        KnownLimit(
            "A groove joint whose parts lie askew to its bodies' centres lets its point leave the"
            " groove, the more the faster it slides.",
            "Chipmunk cpGrooveJoint.c, grooveConstrain; measured: 16 mm at 1 m/s",
        ),
        KnownLimit(
            "Joints have no armature: it is added to the child's moment of inertia, and assisted"
            " gives both bodies the torques that are missing where the parent turns, a step late."
            " One that outweighs its parent is refused, and a slider cannot have one.",
            "pymunk documentation, Constraint; measured: errors halve with the step",
        ),
        KnownLimit(
            "A joint tells only the magnitude of its impulse: the force through it is taken from"
            " the change of momentum of all that it carries.",
            "pymunk documentation, Constraint.impulse",
        ),
    )
    mapping = (
        "elasticity of the moving body = e, of the fixed one = 1 (pymunk multiplies);"
        " collision_slop = 1e-9 m, by which planes are raised; joints: error_bias = 0, so that a"
        " gap is closed in the next step, in as many iterations as leave 1e-6 of an error (by the"
        " spectral radius of Gauss and Seidel's matrix, bodies as drawn); a slider's groove passes"
        " through the centre of mass of one body, beside that of the other. Assisted: impacts in"
        " steps of at most 4 µs; efforts"
        " and drag are those at the end of a step, where they act; the first velocities are set"
        " half a step after the start, where the engine holds them"
    )


BACKEND = PymunkBackend()
