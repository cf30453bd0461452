"""State of a simulation: what brings it back, for people as plain values and exactly as a token."""

from __future__ import annotations

from abc import abstractmethod
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.engine.drives import Drive
from simcompare.engine.free_motion import FreeMotion
from simcompare.engine.helps.landing import Landing
from simcompare.engine.helps.recoil import Recoil
from simcompare.engine.kinematics import add_children
from simcompare.engine.scene import Scene
from simcompare.engine.state import BodyState, State
from simcompare.errors import InputError
from simcompare.model.scenario import MOVABLE
from simcompare.model.trajectory import BODY_SIGNALS, Array

#: recorded steps from which rates are taken for a controller's readings
RECENT = 5
#: time [s], row and held inputs of a recorded sample
Seen = tuple[float, Sequence[float], dict[str, float]]


@dataclass(frozen=True)
class Saved:
    """A token that ``restore`` takes back exactly; of use to the simulation that gave it only.

    Attributes:
        scene: what it is a state of.
        snapshot: what the engine itself remembers, in a form of its own.
        count: recorded steps since the start.
        step_s: engine step to which stored velocities belong [s].
        drive: next step and rates before of what drives the joints.
        recoil: motions and accelerations of armatures.
        recent: the last samples, from which a controller's readings take rates.
    """

    scene: Scene
    snapshot: object
    count: int
    step_s: float
    drive: tuple[int, tuple[float, ...] | None] | None
    recoil: object
    recent: Sequence[Seen]


class StatefulMotion(FreeMotion):
    """The part of a simulation that knows its state.

    Args:
        scene: what was built.

    Attributes:
        helps: our helps that act in this scene.
        velocity_offset_s: stored velocities belong to the sample's time plus this [s].
        recoil: what gives armatures their recoil, ``None`` where nothing does.
    """

    substeps: int

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self.helps: set[str] = set(scene.helps)
        self.velocity_offset_s = 0.0
        self.recoil: Recoil | None = None
        self._joints = self.scenario.movable_joints()
        self._count = 0
        self._is_closed = False
        self._drive: Drive | None = None
        self._landing: Landing | None = None
        self._whole_step_s = self.scenario.world.engine_step_s
        self._recent: deque[Seen] = deque(maxlen=RECENT)
        self._views: list[dict[str, Array]] = []  # what range sensors read at each sample of a run

    def release(self) -> None:
        """Releases what the engine holds."""
        return

    def close(self) -> None:
        """Releases what the engine holds; the simulation is of no use any more."""
        if not self._is_closed:
            self._is_closed = True
            self.release()

    def ensure_open(self) -> None:
        """Raises ``InputError`` where the simulation was closed: an engine may die of its use."""
        if self._is_closed:
            raise InputError(
                f"simulation of {self.scenario.name} in {self.scene.engine}",
                ["it was closed; open a new one"],
            )

    @property
    def time_s(self) -> float:
        """Time since the scenario's start [s]."""
        return self._time_of(self._count)

    def _time_of(self, count: int) -> float:
        return count * self.scenario.world.step_s

    @property
    def step_s(self) -> float:
        """The whole engine step [s]."""
        return self._whole_step_s

    @property
    def index(self) -> int:
        """Engine steps since the start."""
        return self._count * self.substeps

    @property
    def driven(self) -> tuple[str, ...] | None:
        """Joints that are driven; ``None`` for none."""
        return None if self._drive is None else self._drive.names

    @property
    def follows(self) -> bool:
        """Whether efforts that are given follow the motion, and not the inputs alone."""
        return self._drive is not None and self._drive.follows

    @abstractmethod
    def place(self, body: str, state: BodyState) -> None:
        """Puts a free body into a state."""

    @abstractmethod
    def row(self) -> Sequence[float]:
        """All motion that is recorded now, in the engine's own layout and as cheap as possible."""

    @abstractmethod
    def motions(self, rows: Array) -> dict[str, Array]:
        """Turns rows (n, k) of the engine's layout into signals.

        They are those of the free bodies, and coordinate and rate of the joints.
        """

    def place_joint(self, joint: str, position: float, rate: float) -> None:
        """Puts a joint to a coordinate and a stored rate; after all free bodies were placed."""
        raise NotImplementedError

    def forget(self) -> None:
        """Has the engine forget what it remembers of steps before, such as impulses."""
        return

    def forget_placed(self) -> None:
        """The same for what an engine can forget only once everything was placed anew."""
        return

    def snapshot(self) -> object:
        """What brings the engine back exactly, in a form of its own."""
        raise NotImplementedError

    def take_back(self, snapshot: object) -> None:
        """Brings the engine back to what ``snapshot`` returned."""
        raise NotImplementedError

    @property
    def state(self) -> State:
        """The present state as plain values; ``set_state`` begins anew from them."""
        self.ensure_open()
        signals = self.motions(np.array([self.row()], dtype=float))
        add_children(self.scenario, signals, 1)
        bodies = {
            name: BodyState(
                *(tuple(signals[f"{name}.{part}"][0].tolist()) for part in BODY_SIGNALS)
            )
            for name in self._bodies
        }
        joints = {}
        for name, joint in self._joints.items():
            position, rate = (float(signals[f"{name}.{p}"][0]) for p in MOVABLE[joint.type])
            joints[name] = (position, rate)
        before = self._drive.rates_before if self._drive is not None else None
        return State(
            self.time_s, bodies, self._engine_step_s, joints,
            None if before is None else (*before,),
            None if self.recoil is None else (self.recoil.before, self.recoil.felt),
        )  # fmt: skip

    def set_state(self, state: State) -> None:
        """Puts everything into a state; what an engine remembers beside it is forgotten."""
        self.ensure_open()
        self.forget()
        for name in self._free:
            self.place(name, state.bodies[name])
        for name, (position, rate) in state.joints.items():
            self.place_joint(name, position, rate)
        self.forget_placed()
        self._count = round(state.time_s / self.scenario.world.step_s)
        if self._drive is not None:
            self._drive.go_to(self.index, state.rates_before)
        self._engine_step_s = state.velocity_step_s
        self.set_engine_step(state.velocity_step_s or self._whole_step_s)
        self._recent.clear()
        if self.recoil is not None:
            self.recoil.before, self.recoil.felt = state.recoil or (None, None)

    def go_to(self, state: State) -> None:
        """The same for the present instant: a controller goes on to read what it has seen."""
        seen = list(self._recent)
        self.set_state(state)
        self._recent.extend(seen)

    def save(self) -> Saved:
        """A token of the present state, from which ``restore`` goes on bit for bit."""
        self.ensure_open()
        drive, recoil = self._drive, self.recoil
        before = None if drive is None or drive.rates_before is None else (*drive.rates_before,)
        return Saved(
            self.scene,
            self.snapshot(),
            self._count,
            self._engine_step_s,
            None if drive is None else (drive.index, before),
            None if recoil is None else (recoil.before, recoil.felt),
            (*self._recent,),
        )

    def restore(self, saved: Saved) -> None:
        """Goes back to a state that ``save`` gave.

        Raises:
            InputError: the token is of another engine or another scene.
        """
        self.ensure_open()
        theirs, ours = saved.scene, self.scene
        if theirs is not ours and (theirs.engine, theirs.scenario) != (ours.engine, ours.scenario):
            raise InputError(
                "restore",
                [f"the token is of {theirs.scenario.name} in {theirs.engine}, and this simulation"
                 f" of {ours.scenario.name} in {ours.engine}"],
            )  # fmt: skip
        self.set_engine_step(saved.step_s or self._whole_step_s)
        self.take_back(saved.snapshot)
        self._count, self._engine_step_s = saved.count, saved.step_s
        if self._drive is not None and saved.drive is not None:
            self._drive.go_to(*saved.drive)
        if self.recoil is not None:
            self.recoil.before, self.recoil.felt = saved.recoil  # type: ignore[misc]
        self._recent.clear()
        self._recent.extend(saved.recent)
