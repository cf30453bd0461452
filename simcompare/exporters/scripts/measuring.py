"""The measuring part of a script: what probes see, and what follows from recorded motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from simcompare.engine.drives import input_values
from simcompare.engine.scripting.efforts import MAX_PIECES
from simcompare.engine.scripting.text import number, unused
from simcompare.engine.sensing import LAPSE_K_M, PRESSURE_EXPONENT, SEA_LEVEL_K, SEA_LEVEL_PA
from simcompare.engine.simulation import sample_times
from simcompare.measures import Measured
from simcompare.model.rotations import conjugate
from simcompare.model.scenario import DcMotor, Measure, Scenario
from simcompare.model.trajectory import Array

_TURNED = (
    "def turned(q, v):",
    '    """Vectors v turned by quaternions q (w, x, y, z)."""',
    "    return v + 2 * np.cross(q[:, 1:], np.cross(q[:, 1:], v) + q[:, :1] * v)",
)
_FELT = (
    "def specific_force(name, offset=(0, 0, 0)):",
    '    """What an accelerometer in a body\'s frame reads: acceleration less gravity."""',
    '    q = motion[f"{name}.orientation_wxyz"]',
    '    p = motion[f"{name}.position_m"] + turned(q, np.tile(offset, (len(q), 1)))',
    "    a = (p[2:] - 2 * p[1:-1] + p[:-2]) / t[1] ** 2",
    "    a = np.vstack((3 * a[0] - 3 * a[1] + a[2], a, 3 * a[-1] - 3 * a[-2] + a[-3]))",
    "    return turned(q * (1, -1, -1, -1), a - {gravity})",
)
_GYRO = (
    "def gyroscope(name):",
    '    """Rate in a body\'s frame, from how it turns between samples."""',
    '    q = motion[f"{name}.orientation_wxyz"]',
    "    a, b = q[:-1], q[1:] * np.sign(np.sum(q[:-1] * q[1:], axis=1, keepdims=True))",
    "    u = a[:, :1] * b[:, 1:] - b[:, :1] * a[:, 1:] - np.cross(a[:, 1:], b[:, 1:])",
    "    size = np.maximum(np.linalg.norm(u, axis=1, keepdims=True), 1e-300)",
    "    r = u * 2 * np.arctan2(size, np.sum(a * b, axis=1, keepdims=True)) / size / t[1]",
    "    inner = (r[:-1] + r[1:]) / 2",
    "    return np.vstack((1.5 * r[0] - 0.5 * r[1], inner, 1.5 * r[-1] - 0.5 * r[-2]))",
)


@dataclass(frozen=True)
class Truth:
    """What a measure finds in the closed form, at phase 0 and 1; ``None`` where there is none."""

    first: Measured | None
    last: Measured | None = None


@dataclass
class Measuring:
    """Collects the lines that measure.

    Attributes:
        scenario: the scene at phase 0.
        lines: statements, in order.
        functions: functions that they need.
        stored: arrays for the file of inputs.
        taken: names in use.
        recorded: signals that are in ``motion``.
        wanted: values that the next measure is to give, under its own names.
        prints: lines that print more than one number.
    """

    scenario: Scenario
    taken: set[str]
    recorded: frozenset[str]
    lines: list[str] = field(default_factory=list)
    functions: dict[str, tuple[str, ...]] = field(default_factory=dict)
    stored: dict[str, Array] = field(default_factory=dict)
    wanted: frozenset[str] = frozenset()
    prints: list[str] = field(default_factory=list)
    _probes: dict[str, str] = field(default_factory=dict)
    _signals: dict[str, str] = field(default_factory=dict)

    def probe(self, name: str, wanted: str | None = None) -> str:
        """The variable that holds what a probe sees; ``wanted`` is what it is best called."""
        if name not in self._probes:
            probe = self.scenario.probes[name]
            text, width = self.signal(probe.observe)
            if probe.component is not None and width > 1:
                text += f"[:, {probe.component}]"
            if probe.offset:
                text += f" {'-' if probe.offset < 0 else '+'} {number(abs(probe.offset))}"
            variable = wanted or unused(name, self.taken)
            self.taken.add(variable)
            self.lines.append(f"{variable} = {text}")
            self._probes[name] = variable
        return self._probes[name]

    def signal(self, name: str) -> tuple[str, int]:
        """Source of a signal, and how many components it has."""
        owner, _, part = name.partition(".")
        if name in self.recorded:
            widths = {"orientation_wxyz": 4, "velocity_m_s": 3, "position_m": 3, "rate_rad_s": 3}
            wide = owner in self.scenario.bodies or (
                part == "force_N" and owner in self.scenario.sensors
            )
            return f'motion["{name}"]', (widths.get(part, 3) if wide else 1)
        if owner in self.scenario.actuators:
            return self._actuator(owner, part), 1
        sensor = self.scenario.sensors[owner]
        return self._sensor(owner, part), sensor.signals[part]

    def store(self, name: str, values: Array) -> str:
        """Puts an array into the file of inputs; returns what reads it."""
        key = unused(name, set(self.stored))
        self.stored[key] = values
        return f'inputs["{key}"]'

    def function(self, name: str, lines: tuple[str, ...]) -> None:
        """Adds a function that the lines need, once."""
        self.functions.setdefault(name, lines)

    def _input(self, name: str) -> str:
        values = input_values(self.scenario, sample_times(self.scenario))[name]
        if (values == values[0]).all():
            return number(float(values[0]))
        edges = (np.flatnonzero(np.diff(values)) + 1).tolist()
        if len(edges) < MAX_PIECES:
            lengths = np.diff([0, *edges, len(values)]).tolist()
            return f"np.repeat({_list(values[[0, *edges]])}, {lengths})"
        return self.store(f"{name}_at_samples", values)

    def _actuator(self, name: str, part: str) -> str:
        actuator = self.scenario.actuators[name]
        given = self._input(actuator.input)
        if not isinstance(actuator, DcMotor):
            return f"{number(actuator.gear)} * {given} * np.ones(len(t))"
        if part == "voltage_V":
            return f"{given} * np.ones(len(t))"
        rate = f'np.gradient(motion["{actuator.joint}.angle_rad"], t, edge_order=2)'
        back = number(actuator.torque_constant_N_m_A * actuator.gear_ratio)
        current = f"({given} - {back} * {rate}) / {number(actuator.resistance_Ohm)}"
        if part == "current_A":
            return current
        gain = actuator.efficiency * actuator.gear_ratio * actuator.torque_constant_N_m_A
        return f"{number(gain)} * {current}"

    def _sensor(self, name: str, part: str) -> str:
        signal = f"{name}.{part}"
        if signal in self._signals:
            return self._signals[signal]
        sensor = self.scenario.sensors[name]
        body = sensor.body or ""
        match part:
            case "pressure_Pa":
                exponent, lapse = number(PRESSURE_EXPONENT), number(LAPSE_K_M / SEA_LEVEL_K)
                self.function("turned", _TURNED)
                height = f'motion["{body}.position_m"]'
                if any(sensor.position_m):
                    offset = f"np.tile({_tuple(sensor.position_m)}, (len(t), 1))"
                    height = f'({height} + turned(motion["{body}.orientation_wxyz"], {offset}))'
                else:
                    self.functions.pop("turned", None)
                text = f"{number(SEA_LEVEL_PA)} * (1 - {lapse} * {height}[:, 2]) ** {exponent}"
            case "specific_force_m_s2":
                self.function("turned", _TURNED)
                gravity = _tuple(self.scenario.world.gravity_m_s2)
                self.function("felt", tuple(line.replace("{gravity}", gravity) for line in _FELT))
                offset = f", {_tuple(sensor.position_m)}" if any(sensor.position_m) else ""
                text = self._in_frame(f'specific_force("{body}"{offset})', sensor.orientation_wxyz)
            case "rate_rad_s":
                self.function("turned", _TURNED)
                self.function("gyroscope", _GYRO)
                text = self._in_frame(f'gyroscope("{body}")', sensor.orientation_wxyz)
            case _:
                marks = f"{sensor.marks} / (2 * np.pi)"
                text = f'np.floor(motion["{sensor.joint}.angle_rad"] * {marks} + 1e-9)'
        variable = unused(name, self.taken)
        self.taken.add(variable)
        self.lines.append(f"{variable} = {text}")
        self._signals[signal] = variable
        return variable

    def _in_frame(self, text: str, orientation: Any) -> str:  # noqa: ANN401
        if tuple(orientation) == (1.0, 0.0, 0.0, 0.0):
            return text
        back = conjugate(np.array([orientation]))[0].tolist()
        return f"turned(np.tile({_tuple(back)}, (len(t), 1)), {text})"


#: lines of a measure; returns name -> source of its value, under the function's own names
Snippet = Callable[[Measuring, Measure, Truth], Mapping[str, str]]


def _list(values: Array) -> str:
    return f"[{', '.join(number(value) for value in values.tolist())}]"


def _tuple(values: Any) -> str:  # noqa: ANN401
    return f"({', '.join(number(value) for value in values)})"
