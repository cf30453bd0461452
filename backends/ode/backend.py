"""ODE, the Open Dynamics Engine, through the functions of its shared library."""

from __future__ import annotations

import functools
from typing import Any

from simcompare.backends.ode.declarations import DECLARATIONS
from simcompare.backends.ode.simulation import OdeSimulation
from simcompare.backends.ode.variants import VARIANTS
from simcompare.kit import (
    CENTRED_EFFORTS,
    HALF_STEP_START,
    JOINTS_AND_FORCES,
    LANDING,
    RECOIL,
    SPATIAL_RIGID_BODIES,
    EngineBackend,
    EngineBroken,
    Feature,
    KnownLimit,
    OwnValue,
    SharedLibrary,
    Traits,
)


class OdeBackend(EngineBackend):
    """ODE through its shared library."""

    name = "ode"
    simulation = OdeSimulation
    library = SharedLibrary("ode", "sudo apt-get install libode8", ["libode.so.8"], DECLARATIONS)
    # bounces have no threshold: what rests must not be taken for what falls by half a long step
    traits = Traits(rest_step_s=1.0e-5)
    features = SPATIAL_RIGID_BODIES | JOINTS_AND_FORCES | {Feature.RAYS}
    helps = frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS, RECOIL})
    typed_as = "bounce"
    other_values = (
        OwnValue(
            "bounce_vel", "Impacts that are slower do not bounce.", "m/s", 0.0, 0.0, 5.0, tuned=0.0
        ),
    )
    snippet = """dWorldSetERP(world, {typed[dWorldSetERP]});
dWorldSetCFM(world, {typed[dWorldSetCFM]});
dWorldSetContactMaxCorrectingVel(world, {typed[dWorldSetContactMaxCorrectingVel]});
contact.surface.mode = dContactBounce | dContactApprox1 | dContactSoft;
contact.surface.bounce = {0!r};
contact.surface.bounce_vel = 0;
contact.surface.soft_erp = {typed[surface.soft_erp]};
contact.surface.soft_cfm = {typed[surface.soft_cfm]};  /* by the step and the lighter mass */
dWorldStep(world, {step_s!r});  /* in every step */"""
    variants = VARIANTS
    known_limits = (
        KnownLimit(
            "Who calls ODE must say how every contact behaves. With no more than must be said, mode"
            " 0 and an endless mu, nothing bounces and nothing slips.",
            "ODE manual, Contact: dSurfaceParameters",
        ),
        KnownLimit(
            "The coefficient mu is a force unless mode dContactApprox1 is set.",
            "ODE manual, Joint Types and Functions: Contact",
        ),
        KnownLimit(
            "What has sunk into something is pushed out again, as fast as a part (ERP) of the depth"
            " in one step: a body that should lie hops.",
            "measured: a ball that must not bounce, dropped from 1 m, hops 34 mm by default (ERP"
            " 0.2, 1 ms), 0.6 m with ERP 0.8, and not at all where it is pushed out with g·dt",
        ),
        KnownLimit(
            "A bounce begins at the depth in which a step finds the body, so slow impacts lose too"
            " much, and scatter with the phase of the step.",
            "measured for 0.8 at 1 ms: 0.7997(3) at 4.4 m/s, 0.796(4) at 0.3 m/s, 0.77(2) at 0.05"
            " m/s",
        ),
        KnownLimit(
            "Friction is limited along each of two axes, not in their plane: slipping askew to them"
            " is braked up to √2 times too much, and turns towards them. Tuned turns the axes to"
            " where each point slips; what sticks still holds up to √2 times too well askew.",
            "ODE manual, Contact: fdir1; measured: a block sliding at 45° stopped after 90 mm for"
            " 127 mm",
        ),
        KnownLimit(
            "Friction is limited by the normal forces as they would be without friction: tyres that"
            " spin push too much where that shifts the load.",
            "ODE manual, dContactApprox1; measured: a slip of 0.704 for 0.771; dWorldQuickStep is"
            " right in 1,000 iterations, but in 100 it turns the robot out of its line",
        ),
        KnownLimit(
            "Boxes touch at up to four points, whose forces cannot be told apart: ODE's solver then"
            " fails in some steps and leaves forces out. A run tells where that happened.",
            "measured: with ODE's own CFM a box slid 1.07 m for 1.31 m down a slope; ten"
            " boxes fell over where a surface layer was set (dWorldSetContactSurfaceLayer)",
        ),
        KnownLimit(
            "How much constraints give way (CFM, 1e-10) is a velocity for a force, so that heavy"
            " bodies meet soft ones.",
            "measured: a restitution of 0.7993 up to 100 kg, 0.7975 at 10 t, 0.63 at 1,000 t",
        ),
        KnownLimit(
            "By default a step turns a body by 2·atan(ω·dt/2); tuned has ODE turn it by ω·dt.",
            "ODE manual, dBodySetFiniteRotationMode; measured at 380 rad/s: 1.2 % less in steps of"
            " 1 ms, 4.4 % in steps of 2 ms",
        ),
        KnownLimit(
            "A body that tumbles loses energy: gyroscopic torques are those at the end of a step.",
            "ODE step.cpp (Lacoursière 2006); measured at 10 rad/s about the middle axis: 2.4 % in"
            " 4 s at 1 ms, 0.5 % at 0.25 ms",
        ),
        KnownLimit(
            "A joint learns from the gap that a step leaves that its bodies go round: in the first"
            " steps, forces through joints lack what bends the paths of bodies.",
            "measured on three bodies that tumble, at 0.5 ms: 77 % of the force were missing in the"
            " first step, 6 % in the third, 0.05 % from the sixth on",
        ),
        KnownLimit(
            "Joints have no springs and dampers: these are torques and forces of the loop, with the"
            " rate before a step, also by default. Too stiff for a step, they run away.",
            "ODE manual, Joint Types and Functions; measured: a motor with a flywheel was 0.75 rad"
            " of 600 ahead at 2 ms",
        ),
        KnownLimit(
            "There is no armature: it is part of the child's moment of inertia about the joint's"
            " axis, and assisted gives both bodies the torques that are missing where the parent"
            " turns, a step late. An armature that outweighs its parent is refused.",
            "ODE manual, Joint Types and Functions; measured: a robot's caster bears 1.619 N for"
            " 1.6215 N with these torques, 1.681 N without",
        ),
        KnownLimit(
            "Centres of mass are at the origins of bodies; others are refused.",
            "ODE manual, dBodySetMass",
        ),
        KnownLimit(
            "Where numbers overflow, ODE ends the whole process; runs that come near are stopped.",
            "ODE odemath.h, dNormalize4; measured",
        ),
        KnownLimit(
            "The library does not tell its version; what is shown is the number of its file.",
            "ODE 0.16.2 of Debian 12 is libode.so.8.0.2",
        ),
    )
    mapping = (
        "each pair that may touch: surface.bounce = e, bounce_vel = 0, surface.mu = friction with"
        " dContactApprox1 and, where it slips, fdir1 along the slip; soft_erp 0.2, soft_cfm = slip1"
        " = slip2 = 1e-5·dt/mass of the lighter body; depth is corrected with at most g·dt; joints:"
        " ERP 0.8, CFM 1e-7·dt/mass of the heaviest body, friction = dParamFMax of a motor that"
        " holds still; finite rotations; dWorldStep, not dWorldQuickStep. By default: mode 0,"
        " mu = dInfinity; coefficients: dContactBounce and dContactApprox1, all else ODE's own."
        " Assisted: impacts in steps of at most 2 µs, with soft_cfm = 1e-9·dt/mass; springs and"
        " dampers with the rate at the instant of the positions"
    )

    def load(self) -> Any:
        return _prepared(super().load())


@functools.cache
def _prepared(engine: Any) -> tuple[Any, ...]:
    """The opened library, once it is ready, with its messages and who listens to them.

    ODE would print a message for each step in which its solver fails.

    Raises:
        EngineBroken: it is a build in single precision.
    """
    (ffi, lib), heard = engine, []
    if not lib.dCheckConfiguration(b"ODE_double_precision"):
        raise EngineBroken("ode: this build of its library computes in single precision")
    lib.dInitODE2(0)
    # ODE does not keep it alive; the text and its arguments are not looked at
    listener = ffi.callback("dMessageFunction", lambda number, *_: heard.append(number))
    lib.dSetMessageHandler(listener)
    return ffi, lib, heard, listener


BACKEND = OdeBackend()
