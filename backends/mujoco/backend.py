"""MuJoCo, built from an MJCF text; stepped natively wherever no impact is near."""

from __future__ import annotations

import math
import sys
from typing import Any

from simcompare.backends.mujoco.mjcf import SOLIMP, SOLIMP_NAMES
from simcompare.backends.mujoco.simulation import MujocoSimulation
from simcompare.backends.mujoco.variants import VARIANTS
from simcompare.kit import (
    CENTRED_EFFORTS,
    HALF_STEP_START,
    JOINTS_AND_FORCES,
    LANDING,
    SOFT_STEP_S,
    SPATIAL_RIGID_BODIES,
    SPRING,
    EngineBackend,
    Feature,
    KnownLimit,
    OwnValue,
    PipPackage,
    Scene,
    Traits,
)

_SOLIMP = " ".join(map(str, SOLIMP))
#: how hard a contact is, as it comes: text, unit, value, and bounds
_IMPEDANCE = (
    ("How hard the contact is where bodies just touch: 1 is rigid.", "1", 0.9, 0.01, 0.9999),
    ("How hard it is where they overlap by the width or more.", "1", 0.95, 0.01, 0.9999),
    ("The overlap within which the contact grows hard.", "m", 0.001, 1e-5, 0.1),
)


class MujocoBackend(EngineBackend):
    """MuJoCo through the package ``mujoco-core``, or a full one that is older than the split."""

    name = "mujoco"
    script_module = "simcompare.backends.mujoco.script"
    library = PipPackage("mujoco", "pip install 'simcompare[mujoco]'", ["mujoco-core", "mujoco"])
    traits = Traits(
        offset_centres=True, bounces_by=SPRING, passive="both", has_armature=True,
        bounce_step_s=SOFT_STEP_S,
    )  # fmt: skip
    features = SPATIAL_RIGID_BODIES | JOINTS_AND_FORCES | {Feature.RAYS}
    helps = frozenset({LANDING, HALF_STEP_START, CENTRED_EFFORTS})
    typed_as = "solref"
    # one of its two forms; the other one is (-stiffness, -damping)
    spring_values = (
        OwnValue(
            "solref.timeconst", "How slowly the contact's spring and damper act.", "s",
            0.02, 0.002, 5.0, log=True,
        ),
        OwnValue(
            "solref.dampratio", "How much the contact damps: 1 just does not bounce back.", "1",
            1.0, 0.001, 2.0, log=True,
        ),
    )  # fmt: skip
    other_values = tuple(
        OwnValue(name, *one, log=one[1] == "m", tuned=tuned)
        for name, one, tuned in zip(SOLIMP_NAMES, _IMPEDANCE, SOLIMP, strict=True)
    )
    snippet = f"""<option timestep="{{step_s!r}}" cone="elliptic"/>
<contact>
  <pair geom1="sphere" geom2="floor" solref="{{0!r}} {{1!r}}" solimp="{_SOLIMP}"/>
</contact>"""
    variants = VARIANTS
    known_limits = (
        KnownLimit(
            "There is no coefficient of restitution: a contact is a spring and damper, and the"
            " default one is so soft and damped that nothing bounces.",
            "MuJoCo documentation, Modeling, Solver parameters; google-deepmind/mujoco issue 2080",
        ),
        KnownLimit(
            "A stiff contact gains energy if the step is long: above ω·dt ≈ 2 it explodes.",
            "measured: ω = 316 rad/s at 10 ms threw the ball to 7.9 m",
        ),
        KnownLimit(
            "No contact is perfectly inelastic: a restitution of 0 becomes a critically damped"
            " contact of 5 ms, which gives back about a tenth of the speed.",
            "force-clipped dashpot at ζ = 1: e⁻² = 0.135; measured 0.09",
        ),
        KnownLimit(
            "Friction is convex: a sliding body is lifted by its friction, loses contact and hops;"
            " its load swings, and the mean of it depends on the step.",
            "MuJoCo documentation, Computation, Convex contact model; measured: spinning tyres"
            " of a robot carry 0 to 40 N, 1.7 to 1.8 N in the mean for 1.77 N, at steps of 0.25 to"
            " 2 ms; with 0.06 N·m on each it is 12 % too fast",
        ),
        KnownLimit(
            "A body other than a sphere bounces on a softer spring, up to 0.6 mm deep at 1.5 m/s;"
            " one that slips is lifted by its friction during the impact. Newton's law says nothing"
            " of several corners that hit at once: each of them is a spring of its own.",
            "measured: restitutions of 0.3 to 0.8 to 2 %, 0.11 for 0.125; a corner that slips at"
            " 1 m/s with µ = 0.2 goes up 0.07 m/s faster than Newton's and Coulomb's laws say",
        ),
        KnownLimit(
            "Tyres in a curve creep outwards, by about half of speed, rate and the time constant of"
            " the contact multiplied.",
            "measured in a robot's curve: 2.5 mm/s, where that is 2.7 mm/s",
        ),
    )
    mapping = (
        "where it bounces, solref = (-k, -b) as sought at the step, solreffriction = (0.005, 1);"
        " where nothing bounces, solref = (0.005, 1); solimp = 0.9999; elliptic cone."
        " Assisted: k = ω²/(1+ζω·dt), b = 2ζω/(1+ζω·dt), ω = 1e5 rad/s; ζ from the force-clipped"
        " dashpot e = exp(-2ζ·arccos ζ/√(1-ζ²)) (Schwager and Pöschel, Granular Matter 9 (2007)"
        " 465); the divisor allows for the damper acting on a velocity half a step old; ω·dt ="
        " min(0.01, 0.0007/ζ) during an impact, √(1+ζ²) - ζ at rest; in fine steps, where impacts"
        " cannot be landed on, ω = 2000 rad/s/max(1, 2ζ) at 50 µs, friction's damper ω; half of a"
        " joint's damping is its own, taken after the step, and half an actuator's, taken before it"
    )

    def as_typed(self, numbers: tuple[float, ...]) -> tuple[float, ...]:
        """(-stiffness, -damping) as (time constant, damping ratio), which is the same contact."""
        if numbers[0] > 0:
            return numbers
        stiffness, damping = -numbers[0], -numbers[1]
        return 2 / damping, damping / (2 * math.sqrt(stiffness))

    def make(self, engine: Any, scene: Scene) -> MujocoSimulation:
        # MuJoCo would write its warnings into a file where the user works; stderr is kept
        engine.set_mju_user_warning(lambda text: print(f"MuJoCo: {text}", file=sys.stderr))
        return MujocoSimulation(engine, scene)


BACKEND = MujocoBackend()
