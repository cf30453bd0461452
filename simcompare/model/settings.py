"""How a scenario is run: the contact level, our helps, and an engine's own numbers."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.model.scenario import Contact

#: contact levels: the engine as it is first met; with the scenario's coefficients; with everything
#: that the scenario states typed in, in a plain loop; the same with our helps
DEFAULT, COEFFICIENTS, TUNED, ASSISTED = "default", "coefficients", "tuned", "assisted"
CONTACT_LEVELS = (DEFAULT, COEFFICIENTS, TUNED, ASSISTED)
#: how a run calls engines with contact values that the user typed in
BY_HAND = "by hand"
#: those in which an engine is shown, and not judged: nobody gave it all of the scenario's physics
SHOWN_LEVELS = (DEFAULT, COEFFICIENTS)
#: what stands for a pair's restitution in an engine
COEFFICIENT, SPRING = "coefficient", "spring"
#: names that levels once had, still accepted
OLD_LEVELS = {"mapped": ASSISTED}


@dataclass(frozen=True)
class DropPlan:
    """One drop of a sphere on a fixed plane, which stands for the pairs of one restitution.

    Attributes:
        pairs: names of the bodies of each pair.
        restitution: Newton's coefficient that is wanted.
        speed_m_s: of the first impact.
        mass_kg: of the body that moves, the lighter one of two.
        size_m: its smallest size.
        gravity_m_s2: along the normal of the contact; 0 where both bodies fall alike.
        step_s: the engine's step.
        notes: in what the drop stands for something else than the scene.
    """

    pairs: tuple[tuple[str, str], ...]
    restitution: float
    speed_m_s: float
    mass_kg: float
    size_m: float
    gravity_m_s2: float
    step_s: float
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class PairNumbers:
    """An engine's own numbers for the restitution of a pair.

    Attributes:
        pair: names of the two bodies.
        values: one coefficient; or the two numbers of a spring and damper, as they are typed in.
    """

    pair: tuple[str, str]
    values: tuple[float, ...]


@dataclass(frozen=True)
class Settings:
    """How a scenario is run.

    Attributes:
        contact: contact level: the engine's own "default"; the scenario's "coefficients" of
            restitution and friction (also of joints) in an engine that is else as it comes;
            "tuned", with all that the scenario states typed in, in a plain loop of one fixed step;
            or "assisted", the same with our helps.
        seed: seed of every random number in the run.
        helps: the helps of "assisted"; ``None``: all that the engine takes.
        numbers: what stands for the restitution of each pair where impacts are not landed on;
            a pair without numbers has the scenario's coefficient.
        drops: impacts for which such numbers are sought; ``None``: the first ones of the scene.
        own: what somebody typed in of the engine's other values for a contact, by their names.
    """

    contact: str = ASSISTED
    seed: int = 0
    helps: frozenset[str] | None = None
    numbers: tuple[PairNumbers, ...] = ()
    drops: tuple[DropPlan, ...] | None = None
    own: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "contact", OLD_LEVELS.get(self.contact, self.contact))

    def gives(self, level: str) -> bool:
        """Whether all that a level gives is given to the engine."""
        known = CONTACT_LEVELS
        return self.contact in known and known.index(self.contact) >= known.index(level)

    def takes(self, help_name: str) -> bool:
        """Whether one of our helps is taken."""
        return self.contact == ASSISTED and (self.helps is None or help_name in self.helps)

    def helps_with(self, help_name: str) -> frozenset[str] | None:
        """The helps of these settings, and one more."""
        return None if self.helps is None else self.helps | {help_name}

    def typed(self, name: str, otherwise: float) -> float:
        """One of the engine's other values for a contact: as typed in, or what it is otherwise."""
        return dict(self.own).get(name, otherwise)

    def numbers_of(self, contact: Contact) -> tuple[float, ...]:
        """The engine's numbers for a pair; the scenario's coefficient where there are none."""
        for known in self.numbers:
            if frozenset(known.pair) == frozenset(contact.pair):
                return known.values
        return (contact.restitution,)
