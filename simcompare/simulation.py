"""One open scene in an engine: the stepping form, and the recording loop built on it."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from simcompare.audit import AuditRow
from simcompare.drives import Drive, checked_inputs, input_values
from simcompare.errors import InputError, Unsupported
from simcompare.helps import CENTRED_EFFORTS, HALF_STEP_START, HELPS, LANDING
from simcompare.landing import ContactSteps, Landing, approaches
from simcompare.scenario import SENSOR_SIGNALS, Scenario, Sensor
from simcompare.sensing import complete
from simcompare.shapes import Vector
from simcompare.state import compare_start
from simcompare.stateful import StatefulMotion
from simcompare.trajectory import Array, Trajectory

if TYPE_CHECKING:
    from simcompare.settings import Settings

#: what a controller reads: every signal now, a number or a tuple of its components
Readings = Mapping[str, float | tuple[float, ...]]
#: called as controller(time_s, readings) before each recorded step; returns inputs by name
Controller = Callable[[float, Readings], Mapping[str, float]]


class Simulation(StatefulMotion):
    """An opened scene. Engines implement the small hooks; everything else is here.

    Args:
        scenario: the scene.
        audit: what the backend set and read back.
        settings: which of our helps are taken; without them all is as in a plain loop.
        steps: how the engine is stepped through an impact where impacts are landed on.

    Attributes:
        helps: the helps that act in this scene.
        velocity_offset_s: stored velocities belong to the sample's time plus this [s].
    """

    wall_s: Mapping[str, float]

    def __init__(
        self,
        scenario: Scenario,
        audit: Sequence[AuditRow],
        settings: Settings,
        steps: ContactSteps | None = None,
    ) -> None:
        super().__init__(scenario)
        self.settings = settings
        self.tuning: tuple[Mapping[str, Any], ...] = ()
        self.lacks: dict[str, str] = {}
        self.audit = tuple(audit)
        self.notes: tuple[str, ...] = ()
        self.wall_s = {}
        world = scenario.world
        self._force_sensors = {}
        for name, sensor in scenario.sensors.items():
            if sensor.type in ("force", "contact_force"):
                reason = self.reason_lacking(sensor)
                if reason:
                    self.lacks[f"{name}.{SENSOR_SIGNALS[sensor.type][0]}"] = reason
                else:
                    self._force_sensors[name] = sensor
        self._force_columns = sum(SENSOR_SIGNALS[s.type][1] for s in self._force_sensors.values())
        centred = settings.takes(CENTRED_EFFORTS)
        drive = Drive(scenario, world.engine_step_s, self.LEAD, centred)
        self._drive = drive if drive.names else None
        # what only follows the inputs is the same at either instant, unless a step acts at its end
        if centred and (drive.follows or (self.LEAD and (drive.names or self._dragged))):
            self.helps.add(CENTRED_EFFORTS)
        self.substeps = world.substeps
        if steps is not None and settings.takes(LANDING):
            self._prepare_landing(steps)
        if steps is not None and settings.takes(HALF_STEP_START):
            self._prepare_start(steps.stagger)

    @property
    def is_plain(self) -> bool:
        """Whether there is nothing but one free body to record, without forces in each step."""
        return not (
            self._dragged
            or self._joints
            or self._force_sensors
            or self.substeps > 1
            or len(self._bodies) != 1
            or len(self._free) != 1
        )

    def _prepare_landing(self, steps: ContactSteps) -> None:
        pairs, notes = approaches(self.scenario)
        self.notes = tuple(notes)
        if pairs or notes:  # where nothing is landed on, it still brings numbers and steps
            self.helps.add(LANDING)
        if not pairs:
            return
        if self._force_sensors:
            raise Unsupported("forces are not recorded while impacts are landed on")
        if self.substeps > 1:
            raise Unsupported("where impacts are landed on, recorded steps are not divided further")
        self._landing = Landing(pairs, self.scenario.world.step_s, steps)
        self._stagger = steps.stagger
        self.notes += (
            f"a recorded step with an impact in it is divided into {self._landing.parts} parts"
            f" of {self._landing.part_s:.3g} s; flights take whole steps",
        )

    # --- hooks of an engine -------------------------------------------------------------------

    def origin_of(self, body: str) -> Vector:
        """World position of any moving body [m], as the engine itself has it."""
        return self.stored_motion(body)[0]

    def reason_lacking(self, sensor: Sensor) -> str:
        """Why an engine does not give what a force sensor reads, empty where it does."""
        del sensor
        return ""

    def forces(self) -> Sequence[float]:
        """Readings of all force sensors in the last engine step, in the order of the scenario."""
        raise NotImplementedError

    def record(self, count: int) -> list[Sequence[float]] | Array:
        """Takes ``count`` whole recorded steps free of impacts and returns their rows.

        Engines override this with their tightest loop. Where the forces of a step act at its start,
        they are read after the first engine step of each recorded one.
        """
        rows: list[Sequence[float]] = []
        for _ in range(count):
            if not self._force_sensors:
                self.advance(self.substeps)
                rows.append(self.row())
                continue
            self.advance(self.substeps if self.LEAD else 1)
            forces = self.forces()
            if self.substeps > 1 and not self.LEAD:
                self.advance(self.substeps - 1)
            rows.append((*self.row(), *forces))
        return rows

    def check(self) -> None:
        """Raises ``SimulationDiverged`` if the engine has warned of wrong numbers."""
        return

    def close(self) -> None:
        """Releases what the engine holds."""
        return

    def read_back_start(self, engine: str) -> None:
        """Compares the initial motion that the engine holds with the scenario's.

        Raises:
            ReadBackMismatch: they differ; every component that does is named.
        """
        held = {name: self.origin_of(name) for name in self._bodies if name not in self._free}
        compare_start(engine, self.scenario, self.state, held)

    # --- the stepping form --------------------------------------------------------------------

    def step(self, inputs: Mapping[str, float] | None = None) -> None:
        """Advances by one recorded step.

        Args:
            inputs: values of inputs during this step; those left out follow their signals.

        Raises:
            InputError: values that are not finite numbers, or no mapping.
            UnknownName: an input that the scenario does not have.
        """
        self._take_step(checked_inputs(self.scenario, self.time_s, inputs))

    def read(self) -> Readings:
        """Every signal now, as a controller sees it.

        Forces are those at the start of the last recorded step (with a lead: at its end), 0 before
        the first one. What needs an acceleration feels none in the first three samples.
        """
        if not self._recent:
            self._remember(self._row_now(), {})
        times = np.array([time for time, _, _ in self._recent])
        rows = np.array([row for _, row, _ in self._recent], dtype=float)
        inputs = {
            name: np.array([held.get(name, value) for (_, _, held), value in zip(
                self._recent, values.tolist(), strict=True)])
            for name, values in input_values(self.scenario, times).items()
        }  # fmt: skip
        signals = self.signals(rows, times, inputs, lagging=False)
        return {
            name: float(values[-1]) if values.ndim == 1 else tuple(values[-1].tolist())
            for name, values in signals.items()
        }

    def _take_step(self, inputs: dict[str, float] | None) -> Sequence[float]:
        """One recorded step and its row."""
        if self._drive is not None:
            self._drive.hold(inputs)
        if self._landing is None:
            self._stagger_start()
            row: Sequence[float] = self.record(1)[0]
        elif self._landing.free_steps(self) >= 1:
            self.use_step(self._whole_step_s, frozenset())
            self.advance(1)
            row = self.row()
        else:
            self._landing.step(self)
            row = self.row()
        self._count += 1
        self.check()
        self._remember(row, inputs or {})
        return row

    def _row_now(self) -> Sequence[float]:
        return (*self.row(), *[0.0] * self._force_columns)

    def _remember(self, row: Sequence[float], inputs: dict[str, float]) -> None:
        self._recent.append((self.time_s, row, inputs))

    # --- the whole run ------------------------------------------------------------------------

    def run(self, source: str, version: str, controller: Controller | None = None) -> Trajectory:
        """Records the scenario from its start to its end.

        Args:
            source: name of the engine.
            version: its version.
            controller: gives the inputs of each recorded step; without one they follow the
                scenario's signals.
        """
        started = time.perf_counter()
        times = sample_times(self.scenario)
        inputs = input_values(self.scenario, times)
        blocks: list[list[Sequence[float]] | Array] = [[self._row_now()]]
        if controller is None:
            blocks += self._record_all(len(times) - 1)
        else:
            blocks.append(self._controlled(len(times) - 1, controller, inputs))
        if self._force_sensors and not self.LEAD:
            # the forces at the last sample are those of a step that begins there
            end = self.state
            blocks.append(self.record(1))
            self.set_state(end)
        self.check()
        rows = np.concatenate([np.asarray(block, dtype=float) for block in blocks])
        stepped = {"step": time.perf_counter() - started}
        return Trajectory(
            source=source,
            time_s=times,
            signals=self.signals(rows, times, inputs),
            version=version,
            wall_s={**self.wall_s, **stepped},
            audit=self.audit,
            notes=(*self.notes, *(f"{name}: {why}" for name, why in self.lacks.items())),
            helps=tuple(name for name in HELPS if name in self.helps),
            velocity_offset_s=self.velocity_offset_s,
            tuning=self.tuning,
            lacks=self.lacks,
        )

    def _record_all(self, count: int) -> list[list[Sequence[float]] | Array]:
        if self._landing is None:
            self._stagger_start()
            whole = self.record(count)
            self._count += count
            return [whole]
        blocks: list[list[Sequence[float]] | Array] = []
        done = 0
        while done < count:
            free = self._landing.free_steps(self)
            if free:
                taken = min(free, count - done)
                self.use_step(self._whole_step_s, frozenset())
                blocks.append(self.record(taken))
            else:
                taken = 1
                self._landing.step(self)
                blocks.append([self.row()])
            done += taken
        self._count += count
        return blocks

    def _controlled(
        self, count: int, controller: Controller, inputs: dict[str, Array]
    ) -> list[Sequence[float]]:
        """Steps with a controller in the loop; writes what it gave into the recorded inputs."""
        rows = []
        for k in range(count):
            answer = controller(self.time_s, self.read())
            if answer is None:
                raise InputError(
                    f"inputs at t = {self.time_s:g} s",
                    ["the controller returned nothing; expected a mapping of input -> number"],
                )
            given = checked_inputs(self.scenario, self.time_s, answer)
            for name, value in (given or {}).items():
                inputs[name][k:] = value
            rows.append(self._take_step(given))
        return rows

    def signals(
        self, rows: Array, time_s: Array, inputs: Mapping[str, Array], *, lagging: bool = True
    ) -> dict[str, Array]:
        """Every signal of a trajectory from the rows of an engine.

        Args:
            rows: what was recorded (n, k), one row more where forces lag.
            time_s: sample times (n,).
            inputs: values of the inputs at these times.
            lagging: whether each row holds the forces of the sample before it, as in a whole run.
        """
        count = len(time_s)
        width = rows.shape[1] - self._force_columns
        found = self.motions(rows[:count, :width])
        forces = rows[:, width:]
        if lagging and self._force_columns:
            # without a lead the step after a sample holds the forces that act at it
            forces = np.vstack((forces[1:2], forces[1:])) if self.LEAD else forces[1:]
        column = 0
        for name, sensor in self._force_sensors.items():
            part, size = SENSOR_SIGNALS[sensor.type]
            block = forces[:count, column : column + size]
            found[f"{name}.{part}"] = block.copy() if size > 1 else block[:, 0].copy()
            column += size
        complete(self.scenario, time_s, found, inputs)
        return found


def sample_times(scenario: Scenario) -> Array:
    """Times of all samples of a scenario [s], the start included."""
    count = round(scenario.world.duration_s / scenario.world.step_s)
    return np.asarray(np.arange(count + 1) * scenario.world.step_s, dtype=float)
