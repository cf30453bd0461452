"""A scenario with a task as an environment of Gymnasium, on any engine that can run it."""

from __future__ import annotations

import dataclasses
import importlib
import math
from collections.abc import Mapping
from numbers import Real
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from simcompare.engine import engines
from simcompare.engine.backend import refuse
from simcompare.engine.simulation import Simulation
from simcompare.errors import InputError, UnknownName
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, Settings
from simcompare.scenarios import catalogue

#: numbers that are seen or done (n,); those who learn have them in single precision
Numbers = NDArray[np.float32] | NDArray[np.float64]
#: errors of sensors beyond this leave nothing of what they read
MOST_ERRORS = 1000.0
#: most engine steps in a control step: more take minutes
MOST_SUBSTEPS = 10_000


@dataclasses.dataclass(frozen=True)
class Asked:
    """What an environment was asked to be.

    Attributes:
        scenario: name of a scenario with a task.
        engine: name of the engine.
        contact: contact level.
        sensors: how large the errors of its sensors are: 0 none, 1 those of the data sheets.
        control_Hz: how often it acts; ``None``: as the task says.
        set: parameters that are the same in all episodes.
        step_s: engine step [s]; ``None``: that of the scenario.
    """

    scenario: str
    engine: str
    contact: str = ASSISTED
    sensors: float = 0.0
    control_Hz: float | None = None
    set: Mapping[str, float] = dataclasses.field(default_factory=dict)
    step_s: float | None = None


class Environment(gymnasium.Env[Numbers, Numbers]):  # type: ignore[misc]
    """One robot, or whatever the scenario is about, that acts and learns.

    Every episode is drawn anew from its seed: the scene, the errors of the sensors, and what is not
    well known of the machine. An action is held for a control step, in which the engine steps
    natively; only the signals that the task needs are read.

    Args:
        asked: what it is to be.

    Raises:
        InputError: numbers that make no sense.
        UnknownName: a scenario without a task, an engine or a parameter that does not exist.
        Unsupported: the engine lacks what the scenario needs.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012

    def __init__(self, asked: Asked) -> None:
        self._task = _task_of(asked.scenario)
        self._file, self._backend = catalogue.load(asked.scenario), engines.get(asked.engine)
        self._settings, self._sensors = Settings(asked.contact), asked.sensors
        self._given = dict(asked.set)
        scenario = self._file.resolve(self._given)
        world = scenario.world
        wanted_Hz, step_s = asked.control_Hz, asked.step_s
        self.control_Hz: float = self._task.CONTROL_HZ if wanted_Hz is None else wanted_Hz
        self._step_s = world.engine_step_s if step_s is None else step_s
        self._refuse(asked, world.duration_s)
        refuse(self._backend, _bare(scenario), self._settings)
        self._most = round(self._task.LONGEST_S * self.control_Hz)
        self._substeps = round(1 / (self.control_Hz * self._step_s))
        self.observation_space = gymnasium.spaces.Box(
            -10, 10, (self._task.OBSERVATIONS,), np.float32
        )
        self.action_space = gymnasium.spaces.Box(-1, 1, (self._task.ACTIONS,), np.float32)
        self._simulation: Simulation | None = None
        self._episode: Any = None
        self._taken = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Numbers, dict[str, Any]]:
        """Begins an episode.

        Args:
            seed: of this and, without another one, of all episodes that follow.
            options: ``{"set": {...}}``: parameters of this episode in place of drawn ones; text
                may carry a unit.

        Returns:
            The first observation, and the parameters that were drawn.

        Raises:
            InputError: no seed, options that it does not know, or a scene that cannot be.
        """
        if seed is not None and (type(seed) is not int or seed < 0):
            raise InputError("reset", [f"seed={seed!r:.100}; expected a whole number from 0 on"])
        given = self._given | self._optional({} if options is None else options)
        super().reset(seed=seed)
        self.close()
        drawn = self._task.draw(self.np_random) | given
        scenario = self._scene(drawn)
        self._episode = self._task.Episode(scenario, self._sensors, self.control_Hz, self.np_random)
        self._simulation = self._backend.open(_bare(scenario), self._settings)
        self._taken = 0
        return self._seen(self._simulation), {"parameters": drawn}

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        """Takes a control step: observation, reward, terminated, truncated, and numbers.

        Args:
            action: within -1 and 1; what is beyond is cut off.

        Raises:
            InputError: no action, or no episode has begun.
        """
        if self._simulation is None:
            raise InputError("step", ["no episode has begun; call reset() first"])
        self._simulation.step(self._episode.inputs(self._action(action)))
        self._taken += 1
        seen = self._seen(self._simulation)
        reward, is_over, told = self._episode.judge()
        return seen, reward, is_over, self._taken >= self._most, dict(told)

    def close(self) -> None:
        """Releases the engine."""
        if self._simulation is not None:
            self._simulation.close()
            self._simulation = None

    def _action(self, action: object) -> Numbers:
        """An action as finite numbers (m,)."""
        try:
            given = np.asarray(action, dtype=float)
        except (TypeError, ValueError):
            given = np.array(math.nan)
        if given.shape != self.action_space.shape or not np.isfinite(given).all():
            expected = f"expected {self._task.ACTIONS} finite numbers within -1 and 1"
            raise InputError("action", [f"{action!r:.100}; {expected}"])
        return given

    def _optional(self, options: object) -> dict[str, float]:
        """Parameters that are set for one episode."""
        if not isinstance(options, Mapping) or not options.keys() <= {"set"}:
            expected = 'expected such as {"set": {"name": 1.0}}'
            raise InputError("reset", [f"options={options!r:.100}; {expected}"])
        given = options.get("set", {})
        if not isinstance(given, Mapping):
            raise InputError("reset", [f"options, set: {given!r:.100}; expected names with values"])
        faults = [
            f"options, set: {name!r:.50}: {value!r:.50}; expected a name with text or a number"
            for name, value in given.items()
            if not isinstance(name, str) or isinstance(value, bool | np.bool_)
            or not isinstance(value, str | Real)
        ]  # fmt: skip
        if faults:
            raise InputError("reset", faults)
        return self._file.read_settings(given, "options, set")

    def _seen(self, simulation: Simulation) -> Numbers:
        seen: Numbers = self._episode.observe(simulation.read()).astype(np.float32)
        return seen

    def _scene(self, parameters: Mapping[str, float]) -> Scenario:
        """The scene of an episode: a recorded step is a control step.

        It ends when the task does, long before its own end.
        """
        control_s = self._substeps * self._step_s
        scenario = self._file.resolve(parameters, step_s=control_s)
        world = scenario.world.model_copy(update={"substeps": self._substeps})
        return scenario.model_copy(update={"world": world})

    def _refuse(self, asked: Asked, longest_s: float) -> None:
        faults, step_s, control_Hz = [], self._step_s, self.control_Hz
        if not 0 <= asked.sensors <= MOST_ERRORS:
            faults.append(
                f"sensors = {asked.sensors!r}; expected 0 (ideal), 1 (data sheet) or more, at most"
                f" {MOST_ERRORS:g}"
            )
        if not step_s > 0:
            faults.append(f"step = {step_s:g} s; expected more than 0")
        if not control_Hz * longest_s >= 1:
            faults.append(
                f"control_Hz = {control_Hz:g}; expected at least {1 / longest_s:g}, such as"
                f" {self._task.CONTROL_HZ:g}"
            )
        elif step_s > 0 and not _is_whole(1 / (control_Hz * step_s)):
            most_s = 1 / self._task.CONTROL_HZ
            cure = f"control_Hz = {self._task.CONTROL_HZ:g}"
            if not _is_whole(most_s / step_s):
                cure += f" with step = {most_s / max(1, round(most_s / step_s)):g}"
            faults.append(
                f"control_Hz = {control_Hz:g}: a control step is no whole number of engine"
                f" steps of {step_s:g} s; expected such as {cure}"
            )
        elif step_s > 0 and round(1 / (control_Hz * step_s)) > MOST_SUBSTEPS:
            faults.append(
                f"step = {step_s:g} s; expected at least {1 / (control_Hz * MOST_SUBSTEPS):g} s:"
                f" a control step has at most {MOST_SUBSTEPS} engine steps"
            )
        if faults:
            raise InputError(f"environment of {asked.scenario}", faults)


def _bare(scenario: Scenario) -> Scenario:
    """The scene alone: what its sensors read is the episode's to work out."""
    return scenario.model_copy(update={"sensors": {}})


def _is_whole(parts: float) -> bool:
    return round(parts) >= 1 and abs(parts - round(parts)) <= 1e-6 * parts


def tasks() -> list[str]:
    """Scenarios that have a task."""
    return [name for name, path in catalogue.files().items() if path.with_name("task.py").is_file()]


def _task_of(scenario: str) -> Any:  # noqa: ANN401
    if scenario not in tasks():
        raise UnknownName("scenario with a task", scenario, tasks())
    return importlib.import_module(f"simcompare.scenarios.{scenario}.task")
