"""Landing on impacts where a contact is a spring and damper: its numbers, and the steps they need.

Stiffness and damping are per unit of mass, k = ω²/(1+ζω·dt) and b = 2ζω/(1+ζω·dt), with ζ from the
force-clipped dashpot e = exp(-2ζ·arccos ζ/√(1-ζ²)) (Schwager and Pöschel, Granular Matter 9 (2007)
465); the divisor allows for a damper that acts on a velocity half a step old.
"""

from __future__ import annotations

import math

from simcompare.engine.contacts import Springs, bouncing_pairs
from simcompare.engine.dashpot import damping_ratio
from simcompare.engine.helps.landing import ContactSteps, approaches, slips_at_impact
from simcompare.errors import Unsupported
from simcompare.model.scenario import Contact, Scenario

#: √(k/m) of a bouncing contact [rad/s]: it lasts 0.03 ms, far below any step that is recorded
CONTACT_FREQUENCY_RAD_S = 1.0e5
#: the same where impacts are not landed on, so that all steps have to be as short as theirs; less
#: where the damper is strong: an impact of 1.5 m/s is then up to 0.6 mm deep
SOFT_FREQUENCY_RAD_S = 2000.0
#: longest step where impacts are not landed on [s]
SOFT_STEP_S = 5.0e-5
#: largest ω·dt during an impact
IMPACT_PHASE = 0.01
#: largest ζ·ω·dt during an impact: where in a step the damper sets in moves the bounce by this much
IMPACT_DAMPING = 0.0007
#: smallest restitution above 0 that is landed on; below it a drop takes seconds
MIN_RESTITUTION = 0.02


def refuse(engine: str, scenario: Scenario) -> None:
    """Refuses bounces that would need steps far shorter than they last.

    Raises:
        Unsupported: a ball slips during an impact, or a restitution is too small.
    """
    values = [contact.restitution for contact in scenario.contacts if contact.restitution > 0]
    rubs = any(contact.friction > 0 and contact.restitution > 0 for contact in scenario.contacts)
    if rubs and approaches(scenario)[0] and slips_at_impact(scenario):
        raise Unsupported(
            f"{engine}'s friction does not follow an impact that is landed on: a ball that slides"
            " or spins would leave with a wrong speed and spin; use the level tuned"
        )
    if values and min(values) < MIN_RESTITUTION:
        raise Unsupported(
            f"{engine} maps a restitution of 0 or of {MIN_RESTITUTION:g} and more,"
            f" not {min(values):g}: the damper would need too short a step"
        )


def springs_of(scenario: Scenario) -> dict[tuple[str, str], Springs]:
    """Negative stiffness and damping, per unit of mass, of every pair that bounces.

    The second two are those of its friction.
    """
    found, landed = {}, bool(approaches(scenario)[0])
    for contact in bouncing_pairs(scenario):
        zeta, (omega, phase) = damping_ratio(contact.restitution), _spring(contact, landed)
        lag = 1 + zeta * phase
        own = (-(omega**2) / lag, -2 * zeta * omega / lag)
        # slipping ends within an impact, and lifts the body less than the spring's own damper
        found[contact.pair] = (own, own if landed else (-1.0, -omega))
    return found


def _spring(contact: Contact, landed: bool) -> tuple[float, float]:
    """√(k/m) [rad/s] of a contact that bounces, and ω·dt in its impacts."""
    if landed:
        return CONTACT_FREQUENCY_RAD_S, _impact_phase(contact.restitution)
    omega = SOFT_FREQUENCY_RAD_S / max(1.0, 2 * damping_ratio(contact.restitution))
    return omega, omega * SOFT_STEP_S


def _impact_phase(e: float) -> float:
    """ω·dt during an impact with restitution ``e``; shorter steps for stronger dampers."""
    return min(IMPACT_PHASE, IMPACT_DAMPING / damping_ratio(e)) if e > 0 else IMPACT_PHASE


def steps_for(scenario: Scenario, stagger: float) -> ContactSteps:
    """Steps during impacts and at rest, short enough for the most damped pair."""
    if not approaches(scenario)[0]:
        return ContactSteps(stagger, SOFT_STEP_S, frequency_rad_s=SOFT_FREQUENCY_RAD_S)
    values = [contact.restitution for contact in scenario.contacts if contact.restitution > 0]
    zeta = max((damping_ratio(e) for e in values), default=0.0)
    impact = min((_impact_phase(e) for e in values), default=IMPACT_PHASE)
    # half of ω·dt = 2·(√(1+ζ²) - ζ), up to which a resting spring and damper is stable
    rest = math.hypot(1, zeta) - zeta
    return ContactSteps(
        stagger=stagger,
        contact_step_s=impact / CONTACT_FREQUENCY_RAD_S,
        frequency_rad_s=CONTACT_FREQUENCY_RAD_S,
        rest_step_s=rest / CONTACT_FREQUENCY_RAD_S,
        chunk=16,
    )
