"""What acts on joints: motors, springs, dampers and friction, as one law for each joint.

Engines differ in what they offer here, so every backend gets the same law: an effort that is linear
in inputs, coordinate and rate, and beside it the Coulomb friction and the armature, which engines
solve themselves. The linear part is applied at the instant of the positions, to second order in
the step. Taking the rate as it is stored, half a step away, would be wrong to first order: the time
constant T of a motor by h/2T, and a resonance by ζ·ω·h.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simcompare.errors import InputError, UnknownName, Unsupported
from simcompare.model.scenario import DcMotor, Joint, Scenario
from simcompare.model.trajectory import Array


@dataclass(frozen=True)
class JointLaw:
    """effort = Σ gain·input - stiffness·(q - rest) - damping·q̇, with friction and armature.

    Attributes:
        gains: effort [N·m or N] for one unit of each input.
        stiffness: [N·m/rad or N/m].
        rest: where the spring is relaxed [rad or m].
        damping: viscous, the back-EMF of motors included [N·m·s/rad or N·s/m].
        friction: Coulomb [N·m or N].
        armature: reflected inertia [kg·m² or kg].
    """

    gains: Mapping[str, float] = field(default_factory=dict)
    stiffness: float = 0.0
    rest: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    armature: float = 0.0

    @property
    def is_driven(self) -> bool:
        """Whether an effort has to be given to the engine."""
        return bool(self.gains or self.stiffness or self.damping)


def laws_of(scenario: Scenario) -> dict[str, JointLaw]:
    """The law of every movable joint, in the order of the file."""
    return {name: _law(scenario, name, joint) for name, joint in scenario.movable_joints().items()}


def _law(scenario: Scenario, name: str, joint: Joint) -> JointLaw:
    gains: dict[str, float] = {}
    damping, friction, armature = joint.damping, joint.friction, joint.armature
    for actuator in scenario.actuators.values():
        if actuator.joint != name:
            continue
        if isinstance(actuator, DcMotor):
            ratio, share = actuator.gear_ratio, actuator.efficiency
            k, resistance = actuator.torque_constant_N_m_A, actuator.resistance_Ohm
            gain = share * ratio * k / resistance
            damping += share * ratio**2 * (k**2 / resistance + actuator.rotor_damping_N_m_s_rad)
            friction += share * ratio * actuator.rotor_friction_N_m
            armature += share * ratio**2 * actuator.rotor_inertia_kg_m2
        else:
            gain = actuator.gear
        gains[actuator.input] = gains.get(actuator.input, 0.0) + gain
    return JointLaw(gains, joint.stiffness, joint.rest, damping, friction, armature)


def input_values(scenario: Scenario, time_s: Array) -> dict[str, Array]:
    """Values of every input at the given times (n,)."""
    return {
        name: np.asarray(signal.at(time_s), dtype=float) for name, signal in scenario.inputs.items()
    }


def checked_inputs(
    scenario: Scenario, time_s: float, given: Mapping[str, float] | None
) -> dict[str, float] | None:
    """Values of all inputs at a time: those that are given, the others from their signals.

    Raises:
        InputError: a value that is not one finite number (all of them are named), or no mapping.
        UnknownName: an input that the scenario does not have.
    """
    if given is None:
        return None
    where = f"inputs at t = {time_s:g} s"
    if not isinstance(given, Mapping):
        kind = type(given).__name__
        raise InputError(where, [f"found a {kind}; expected a mapping of input -> number"])
    left_out = scenario.inputs.keys() - given.keys()
    now = input_values(scenario, np.array([time_s])) if left_out else {}
    values = {name: float(v[0]) for name, v in now.items()}
    faults = []
    for name, value in given.items():
        if name not in scenario.inputs:
            raise UnknownName(f"input of {scenario.name}", str(name), scenario.inputs)
        try:
            if isinstance(value, str | bool):
                raise TypeError
            values[name] = float(value)
        except OverflowError:
            faults.append(f"{name} is beyond the largest number, 1.8e308")
            continue
        except (TypeError, ValueError):
            faults.append(f"{name} = {value!r} is not one number")
            continue
        if not math.isfinite(values[name]):
            faults.append(f"{name} = {value!r} is not a finite number")
    if faults:
        raise InputError(where, faults)
    return values


def open_loop(laws: Mapping[str, JointLaw], inputs: Mapping[str, Array], count: int) -> Array:
    """The part of the efforts that follows the inputs, one row a time: (count, joints)."""
    efforts = np.zeros((count, len(laws)))
    for j, law in enumerate(laws.values()):
        for name, gain in law.gains.items():
            efforts[:, j] += gain * inputs[name]
    return efforts


#: longest step in J/D of a damper, where estimated rates are still stable (1 by theory)
STABLE_DAMPING = 0.9
#: longest step in √(J/k) of a spring (2 by theory, without a damper)
STABLE_SPRING = 1.5


def felt_inertia(scenario: Scenario, name: str) -> float:
    """Least inertia that a joint's effort can meet [kg·m² or kg]: of child and parent alone.

    They move against each other, so it is the product over the sum of both; further bodies that
    they carry, or hang on, only add to it. Turning is taken about the axis through each centre of
    mass, which the distance to the axis also only adds to.
    """
    joint = scenario.joints[name]
    shares = []
    for body in (scenario.bodies[joint.parent], scenario.bodies[joint.child]):
        if body.fixed:
            continue
        assert body.mass_kg is not None
        assert body.inertia_kg_m2 is not None
        shares.append(body.mass_kg if joint.type == "slider" else min(body.inertia_kg_m2))
    return 1 / sum(1 / share for share in shares)


class Drive:
    """Efforts on the driven joints of one simulation, engine step by engine step.

    Args:
        scenario: the scene.
        step_s: engine step [s].
        lead: steps between the positions that an engine holds before a step, and those at which the
            step's forces act: 0, 1 where positions are advanced before velocities, and nearly half
            of one where the engine divides a step into many, in all of which they act.
        exact: whether rates are brought to the instant of the positions; else they are taken as
            they are stored, as a plain loop would.
        given: what is given as an effort on each joint; the rest is the engine's own.
    """

    #: efforts are computed for so many steps at once
    _BLOCK = 4096

    def __init__(
        self,
        scenario: Scenario,
        step_s: float,
        lead: float,
        exact: bool,
        given: Mapping[str, JointLaw] | None = None,
    ) -> None:
        laws = {name: law for name, law in laws_of(scenario).items() if law.is_driven}
        self.names = tuple(laws)
        self.laws = laws if given is None else {name: given[name] for name in laws}
        self._scenario, self._step_s, self._lead, self._exact = scenario, step_s, lead, exact
        #: whether efforts follow the motion, and not the inputs alone
        self.follows = any(law.stiffness or law.damping for law in self.laws.values())
        self._linear = [(law.stiffness, law.rest, law.damping) for law in self.laws.values()]
        self.rates_before: list[float] | None = None
        #: efforts of the last step
        self.given: list[float] = []
        self._index, self._first = 0, 0
        self._rows: list[list[float]] = []
        self._held: list[float] | None = None
        self._unchecked = exact

    def _refuse_stiffness(self) -> None:
        """Springs and dampers too stiff for the step; explicit efforts would grow without end.

        Raises:
            Unsupported: one is; names the longest step that would do.
        """
        self._unchecked = False
        for name, law in self.laws.items():
            inertia = felt_inertia(self._scenario, name) + law.armature
            longest_s = min(
                STABLE_DAMPING * inertia / law.damping if law.damping else math.inf,
                STABLE_SPRING * math.sqrt(inertia / law.stiffness) if law.stiffness else math.inf,
            )
            if self._step_s > longest_s:
                raise Unsupported(
                    f"the spring or damper of {name} is too stiff for engine steps of"
                    f" {self._step_s:g} s, where it is an effort of its own; use a step of"
                    f" {longest_s:.2g} s or less"
                )

    @property
    def index(self) -> int:
        """The next engine step."""
        return self._index

    def hold(self, inputs: Mapping[str, float] | None) -> None:
        """Gives all inputs fixed values until the next call; ``None``: the scenario's signals."""
        self._held = None
        if inputs is not None:
            self._held = [
                sum(gain * inputs[name] for name, gain in law.gains.items())
                for law in self.laws.values()
            ]

    def steady(self, count: int) -> list[float] | None:
        """Efforts that stay the same in the next ``count`` engine steps; moves on by as many.

        ``None``, and no step further, where they follow the motion or the scenario's signals.
        """
        if self.follows or self._held is None:
            return None
        self._index += count
        self.given = self._held
        return self._held

    def go_to(self, index: int, rates_before: Sequence[float] | None) -> None:
        """Continues from an engine step, with the rates that were stored one step before it."""
        self._index = index
        self.rates_before = None if rates_before is None else list(rates_before)

    def rows(self, count: int) -> Array:
        """Open-loop efforts of the next ``count`` engine steps (count, joints); moves on."""
        if self._held is not None:
            found = np.repeat([self._held], count, axis=0)
        else:
            found = self._scheduled(self._index, count)
        self._index += count
        return found

    def efforts(self, positions: Sequence[float], rates: Sequence[float]) -> list[float]:
        """Efforts on the driven joints during the next engine step; moves on by one step.

        Args:
            positions: coordinates as the engine holds them before the step.
            rates: rates as it stores them; neither is looked at unless the efforts follow them.
        """
        if not self.follows:
            self.given = self._next_row()
            return self.given
        if self._unchecked:
            self._refuse_stiffness()
        open_efforts = self._next_row()
        before = self.rates_before if self._exact and self.rates_before is not None else rates
        self.rates_before = list(rates)
        lead_s = self._lead * self._step_s if self._exact else 0.0
        self.given = [
            effort - k * (q + lead_s * v - rest) - d * (v + 0.5 * (v - was))
            for effort, (k, rest, d), q, v, was in zip(
                open_efforts, self._linear, positions, rates, before, strict=True
            )
        ]
        return self.given

    def _next_row(self) -> list[float]:
        self._index += 1
        if self._held is not None:
            return self._held
        place = self._index - 1 - self._first
        if not 0 <= place < len(self._rows):
            self._first, place = self._index - 1, 0
            self._rows = self._scheduled(self._first, self._BLOCK).tolist()
        return self._rows[place]

    def _scheduled(self, first: int, count: int) -> Array:
        lead = self._lead if self._exact else 0
        times = np.asarray((np.arange(first, first + count) + lead) * self._step_s, dtype=float)
        return open_loop(self.laws, input_values(self._scenario, times), count)
