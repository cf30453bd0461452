"""Which forces an engine gives, at rest and in motion; the truth is Newton's second law."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.characterization.behaviour import ForceBehaviour, ForceReading, Forces, ForcesAtStep
from simcompare.characterization.experiment import Experiment, over_steps, scene
from simcompare.characterization.friction import FrictionQuestion
from simcompare.characterization.grids import STEPS_S
from simcompare.engine.backend import Backend
from simcompare.errors import BackendError, Unsupported
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import G_M_S2
from simcompare.model.trajectory import Array

#: mass of the block, of the base that is moved, and of what is welded to it [kg]
_BLOCK_KG, _BASE_KG, _WELDED_KG = 0.5, 1.0, 0.1
#: constant acceleration, and amplitude [m/s²] and frequency [Hz] of the shaking
_PUSHED_M_S2, _FREQUENCY_HZ = 2.0, 10.0
#: how long it is watched, and from when on it is read: contacts settle first [s]
_LASTS_S, _SETTLES_S = 1.8, 0.2
#: speed of the block that slides [m/s]; it does not stop while it is watched
_SLIDES_M_S, _FRICTION = 4.0, 0.2
#: parts into which a signal is divided to see how sure its mean is
_BLOCKS = 10
#: what is asked, with its name
CASES = {
    "contact_rest": "block at rest",
    "contact_slides": "block that slides",
    "weld_rest": "weld at rest",
    "weld_pushed": "weld under a steady push",
    "weld_shaken": "weld shaken at 10 Hz",
}


@dataclass(frozen=True)
class ForceQuestion(Experiment[ForceBehaviour]):
    """Which forces an engine gives at one contact level."""

    kind = ForceBehaviour

    def answer(self, backend: Backend) -> ForceBehaviour:
        """Each case at the step, and over steps."""
        return ForceBehaviour(
            **vars(self._at_step(backend, self.step_s)),
            over_step=over_steps(ForcesAtStep, STEPS_S, lambda dt: self._at_step(backend, dt)),
        )

    def _at_step(self, backend: Backend, step_s: float) -> Forces:
        """Per case the force over its truth and its jitter; or the reason why there is none."""
        cases: dict[str, ForceReading] = {}
        lacks: dict[str, str] = {}
        for name in CASES:
            try:
                cases[name] = self._case(backend, step_s, name)
            except BackendError as error:
                lacks[name] = str(error)
        if not cases:
            raise Unsupported(next(iter(lacks.values())))
        return Forces(cases=cases, lacks=lacks)

    def _case(self, backend: Backend, step_s: float, name: str) -> ForceReading:
        found = self.run(backend, scene_of(name, step_s))
        signal = "cell.normal_force_N" if name.startswith("contact") else "cell.force_N"
        if signal in found.lacks:
            raise Unsupported(found.lacks[signal])
        settled = found.time_s >= _SETTLES_S
        force = found.signals[signal][settled]
        if name == "weld_shaken":
            return of_sine(found.time_s[settled], force[:, 0], _WELDED_KG * _PUSHED_M_S2)
        if name == "weld_pushed":
            return of_level(force[:, 0], _WELDED_KG * _PUSHED_M_S2)
        if name == "weld_rest":
            return of_level(force[:, 2], _WELDED_KG * G_M_S2)
        return of_level(force, _BLOCK_KG * G_M_S2)


def scene_of(case: str, step_s: float) -> Scenario:
    """The scene of one case."""
    if case.startswith("contact"):
        speed = _SLIDES_M_S if case == "contact_slides" else 0.0
        made = FrictionQuestion("", step_s, _FRICTION).scene(
            step_s, _LASTS_S, 0.0, speed, _BLOCK_KG
        )
        sensor = {"cell": {"type": "contact_force", "pair": ["block", "floor"]}}
        return Scenario.model_validate({**made.model_dump(by_alias=True), "sensors": sensor})
    return _welded(case, step_s)


def _welded(case: str, step_s: float) -> Scenario:
    """A mass on a base that slides on a rail: nothing acts on it, a steady push, or a shaker."""
    amplitude = _PUSHED_M_S2 * (_BASE_KG + _WELDED_KG)
    inputs = {
        "weld_rest": {"signal": "constant", "value": 0.0},
        "weld_pushed": {"signal": "constant", "value": amplitude},
        "weld_shaken": {"signal": "sine", "amplitude": amplitude, "frequency_Hz": _FREQUENCY_HZ},
    }
    bodies = {
        "rail": {"fixed": True},
        "base": {"mass_kg": _BASE_KG, "inertia_kg_m2": [1e-3] * 3},
        "mass": {"mass_kg": _WELDED_KG, "inertia_kg_m2": [1e-5] * 3},
    }
    return scene(
        "welded", bodies, _LASTS_S, step_s, (0.0, 0.0, -G_M_S2),
        joints={
            "slide": {"type": "slider", "parent": "rail", "child": "base", "axis": [1, 0, 0]},
            "weld": {"type": "fixed", "parent": "base", "child": "mass"},
        },
        inputs={"push": inputs[case]},
        actuators={"motor": {"type": "force", "joint": "slide", "input": "push"}},
        sensors={"cell": {"type": "force", "joint": "weld"}},
    )  # fmt: skip


def of_level(force: Array, truth: float) -> ForceReading:
    """Mean over the truth, and the standard deviation about it as jitter."""
    jitter = float(force.std()) / truth
    return ForceReading(float(force.mean()) / truth, jitter, _of_mean(force) / truth)


def of_sine(time_s: Array, force: Array, truth: float) -> ForceReading:
    """Amplitude over the truth; what is no sine of that frequency is jitter."""
    turn = 2 * math.pi * _FREQUENCY_HZ * time_s
    waves = np.column_stack((np.sin(turn), np.cos(turn), np.ones(len(turn))))
    parts, *_ = np.linalg.lstsq(waves, force, rcond=None)
    rest = force - waves @ parts
    amplitude = float(math.hypot(*parts[:2]))
    jitter = float(rest.std()) / truth
    return ForceReading(amplitude / truth, jitter, _of_mean(rest) / truth)


def _of_mean(force: Array) -> float:
    """Standard uncertainty of the mean of a signal whose neighbours depend on each other."""
    means = [part.mean() for part in np.array_split(force, _BLOCKS)]
    return float(np.std(means, ddof=1)) / math.sqrt(_BLOCKS)
