"""One open scene in an engine: the stepping form, and the recording loop built on it.

An adapter takes one of the bases (``reduced``, ``planar``, ``spatial``), which bring most of its
hooks; what is left for it is to build, step, push, and say what it holds.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from simcompare.engine.drives import checked_inputs, input_values
from simcompare.engine.helped import HelpedSimulation
from simcompare.engine.helps import HELPS
from simcompare.engine.kinematics import add_children
from simcompare.engine.range_sensing import read_through
from simcompare.engine.readings import Readings
from simcompare.engine.sensing import complete
from simcompare.engine.short_turns import note_of_turns, refuse_slowed
from simcompare.engine.stateful import RECENT, Seen
from simcompare.errors import InputError
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory

#: called as controller(time_s, readings) before recorded steps; returns inputs by name
Controller = Callable[[float, Readings], Mapping[str, float]]


class Simulation(HelpedSimulation):
    """An opened scene. Engines implement the small hooks; all else is here or comes with it."""

    # --- the stepping form --------------------------------------------------------------------

    def step(self, inputs: Mapping[str, float] | None = None, count: int = 1) -> None:
        """Advances by recorded steps.

        Args:
            inputs: values of inputs during these steps; those left out have that of their signals
                now. ``None``: all follow their signals.
            count: number of recorded steps, in one native call where the engine has one.

        Raises:
            InputError: values that are not finite numbers, or no mapping.
            UnknownName: an input that the scenario does not have.
        """
        self.ensure_open()
        self._take_steps(checked_inputs(self.scenario, self.time_s, inputs), count)

    def read(self) -> Readings:
        """Every signal now, as a controller sees it.

        Forces are those at the start of the last recorded step, or at its end where an engine tells
        those, and 0 before the first one. What needs an acceleration feels none in the first three
        samples.
        """
        self.ensure_open()
        if not self._recent:
            self._recent.append((self.time_s, self._row_now(), {}))
        recent, views = (*self._recent,), self._views[-1] if self._views else self.ranges()
        return Readings(lambda owner: self._signals_seen(recent, owner) | views)

    def ranges(self) -> dict[str, Array]:
        """What range sensors read now (1, zones²) [m], through the engine's own rays."""
        if not self._range_sensors:
            return {}
        signals = self.motions(np.array([self.row()], dtype=float))
        add_children(self.scenario, signals, 1)
        return {
            f"{name}.range_m": read_through(self.cast_rays, self.scenario, sensor, signals)
            for name, sensor in self._range_sensors.items()
        }

    def _signals_seen(self, recent: Sequence[Seen], owner: str | None) -> dict[str, Array]:
        """Signals of one owner at the last of some samples, ``None``: of all owners."""
        if owner in self._range_sensors:
            return {}
        moves = owner in self._free or owner in self._joints
        if moves:  # held by the engine itself, at that sample
            row = np.array([recent[-1][1]], dtype=float)
            return self.motions(row[:, : row.shape[1] - self._force_columns])
        times = np.array([time for time, _, _ in recent])
        rows = np.array([row for _, row, _ in recent], dtype=float)
        inputs = {
            name: np.array([held.get(name, value) for (_, _, held), value in zip(
                recent, values.tolist(), strict=True)])
            for name, values in input_values(self.scenario, times).items()
        }  # fmt: skip
        return self.signals(rows, times, inputs, lagging=False, owner=owner)

    def _take_steps(
        self, inputs: dict[str, float] | None, count: int
    ) -> Sequence[Sequence[float]] | Array:
        """Some recorded steps with the same inputs, and their rows."""
        if self._drive is not None:
            self._drive.hold(inputs)
        first = self._count + 1
        rows = np.concatenate(blocks) if len(blocks := self._record_all(count)) > 1 else blocks[0]
        self.check()
        for k in range(max(0, count - RECENT), count):
            self._recent.append((self._time_of(first + k), rows[k], inputs or {}))
        return rows

    def _row_now(self) -> Sequence[float]:
        return (*self.row(), *[0.0] * self._force_columns)

    # --- the whole run ------------------------------------------------------------------------

    def run(
        self,
        source: str,
        version: str,
        controller: Controller | None = None,
        every: int = 1,
    ) -> Trajectory:
        """Records the scenario from its start to its end.

        Args:
            source: name of the engine.
            version: its version.
            controller: gives the inputs of each recorded step; without one they follow the
                scenario's signals.
            every: it is asked once in so many recorded steps, and what it gave is held.
        """
        self.ensure_open()
        if self._count:
            raise InputError(
                f"run of {self.scenario.name} in {self.scene.engine}",
                [f"the simulation is at t = {self.time_s:g} s already; open a new one"],
            )
        started = time.perf_counter()
        times = sample_times(self.scenario)
        inputs = input_values(self.scenario, times)
        blocks: list[list[Sequence[float]] | Array] = [[self._row_now()]]
        if self._range_sensors:
            self._views = [self.ranges()]
        if controller is None:
            blocks += self._record_all(len(times) - 1)
        else:
            blocks.append(self._controlled(len(times) - 1, controller, every, inputs))
        if self._force_sensors and not self._forces_at_end:
            # the forces at the last sample are those of a step that begins there
            end = self.save()
            blocks.append(self.record(1))
            self.restore(end)
        self.check()
        rows = np.concatenate([np.asarray(block, dtype=float) for block in blocks])
        stepped = {"step": time.perf_counter() - started}
        signals = self.signals(rows, times, inputs)
        for name in self._views[0] if self._views else ():
            signals[name] = np.concatenate([view[name] for view in self._views])
        self._views = []
        refuse_slowed(self.scene, signals, self.step_s, times)
        self.notes += note_of_turns(self.scene, signals, self.step_s / self.inner_steps)
        return Trajectory(
            source=source,
            time_s=times,
            signals=signals,
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
        if not self._views:
            return self._record_blind(count)
        blocks: list[list[Sequence[float]] | Array] = []
        for _ in range(count):  # rays are cast at every sample
            blocks += self._record_blind(1)
            self._views.append(self.ranges())
        return blocks

    def _record_blind(self, count: int) -> list[list[Sequence[float]] | Array]:
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
        self, count: int, controller: Controller, every: int, inputs: dict[str, Array]
    ) -> list[Sequence[float]]:
        """Steps with a controller in the loop; writes what it gave into the recorded inputs."""
        rows: list[Sequence[float]] = []
        for k in range(0, count, every):
            given = self._asked(controller)
            for name, value in given.items():
                inputs[name][k:] = value
            rows.extend(self._take_steps(given, min(every, count - k)))
        return rows

    def _asked(self, controller: Controller) -> dict[str, float]:
        """What a controller gives now; what it raises goes on as it is, with engine and time."""
        try:
            answer = controller(self.time_s, self.read())
            if answer is None:
                raise InputError(
                    f"inputs at t = {self.time_s:g} s",
                    ["the controller returned nothing; expected a mapping of input -> number"],
                )
            return checked_inputs(self.scenario, self.time_s, answer) or {}
        except Exception as error:
            error.add_note(f"the controller ran on {self.scene.engine} at t = {self.time_s:g} s")
            raise

    def signals(
        self,
        rows: Array,
        time_s: Array,
        inputs: Mapping[str, Array],
        *,
        lagging: bool = True,
        owner: str | None = None,
    ) -> dict[str, Array]:
        """Every signal of a trajectory from the rows of an engine.

        Args:
            rows: what was recorded (n, k), one row more where forces lag.
            time_s: sample times (n,).
            inputs: values of the inputs at these times.
            lagging: whether each row holds the forces of the sample before it, as in a whole run.
            owner: the body, joint, actuator or sensor that is asked for; ``None``: all.
        """
        count = len(time_s)
        width = rows.shape[1] - self._force_columns
        found = self.motions(rows[:count, :width])
        forces = rows[:, width:]
        if lagging and self._force_columns:
            # where they act at a step's start, the step after a sample holds them
            forces = np.vstack((forces[1:2], forces[1:])) if self._forces_at_end else forces[1:]
        column, first = 0, self._first_forces if lagging else None
        for name, sensor in self._force_sensors.items():
            ((part, size),) = sensor.signals.items()
            block = forces[:count, column : column + size].copy()
            if first is not None:
                block[0] = first[column : column + size]
            found[f"{name}.{part}"] = block if size > 1 else block[:, 0].copy()
            column += size
        given = {*self._range_sensors, *(name.partition(".")[0] for name in self.lacks)}
        complete(self.scenario, time_s, found, inputs, owner, given)
        return found


def sample_times(scenario: Scenario) -> Array:
    """Times of all samples of a scenario [s], the start included."""
    count = round(scenario.world.duration_s / scenario.world.step_s)
    return np.asarray(np.arange(count + 1) * scenario.world.step_s, dtype=float)
