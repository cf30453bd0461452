"""State of a simulation: what brings it back, and how it begins."""

from __future__ import annotations

from abc import abstractmethod
from collections import deque
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from simcompare.drives import Drive
from simcompare.free_motion import FreeMotion
from simcompare.helps import HALF_STEP_START
from simcompare.kinematics import add_children
from simcompare.landing import Landing, starts_in_flight
from simcompare.pairs import touching_pairs
from simcompare.scenario import MOVABLE, Scenario
from simcompare.state import BodyState, State, half_a_step_back
from simcompare.trajectory import BODY_SIGNALS, Array

#: recorded steps from which rates are taken for a controller's readings
RECENT = 5


class StatefulMotion(FreeMotion):
    """The part of a simulation that knows its state.

    Args:
        scenario: the scene.

    Attributes:
        helps: our helps that act in this scene.
        velocity_offset_s: stored velocities belong to the sample's time plus this [s].
    """

    #: 1 where the engine advances positions before velocities, so that the forces of a step act
    #: at its end; 0 where they act at its start
    LEAD: ClassVar[int] = 0

    substeps: int

    def __init__(self, scenario: Scenario) -> None:
        super().__init__(scenario)
        self.helps: set[str] = set()
        self.velocity_offset_s = 0.0
        self._joints = scenario.movable_joints()
        self._count = 0
        self._drive: Drive | None = None
        self._landing: Landing | None = None
        self._whole_step_s = scenario.world.engine_step_s
        self._recent: deque[tuple[float, Sequence[float], dict[str, float]]] = deque(maxlen=RECENT)

    @property
    def time_s(self) -> float:
        """Time since the scenario's start [s]."""
        return self._count * self.scenario.world.step_s

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

    @property
    def state(self) -> State:
        """The present state; ``set_state`` brings it back."""
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
            self.time_s, bodies, self._engine_step_s, joints, None if before is None else (*before,)
        )

    def set_state(self, state: State) -> None:
        """Puts all moving bodies into a state that ``state`` returned."""
        for name in self._free:
            self.place(name, state.bodies[name])
        for name, (position, rate) in state.joints.items():
            self.place_joint(name, position, rate)
        self._count = round(state.time_s / self.scenario.world.step_s)
        if self._drive is not None:
            self._drive.go_to(self._count * self.substeps, state.rates_before)
        self._engine_step_s = state.velocity_step_s
        self.set_engine_step(state.velocity_step_s or self._whole_step_s)
        self._recent.clear()

    def _prepare_start(self, stagger: float) -> None:
        """Has the velocities moved from the start to where steps store them.

        The scenario's initial velocities are not staggered: they belong to a step of length zero.
        """
        flies = not touching_pairs(self.scenario) or starts_in_flight(self.scenario)
        if self._landing is not None or (flies and not self.LEAD):
            self._engine_step_s, self._stagger = 0.0, stagger
            self.helps.add(HALF_STEP_START)
            self.velocity_offset_s = stagger * self._whole_step_s

    def _stagger_start(self) -> None:
        """Moves the velocities from the start to half a step before it, where steps store them.

        Else all motion runs ahead by half a step of the first acceleration. The engine itself tells
        how large that is, by a step that is taken back. Where bodies may touch at the start, it is
        left as it is: an engine may find the contact only in its second step, and moving backwards
        there turns friction round.
        """
        if self._engine_step_s or self.LEAD:
            return
        start = self.state
        self.advance(1)
        after = self.state
        names = self._drive.names if self._drive is not None else None
        seen = list(self._recent)
        self.set_state(half_a_step_back(start, after, self._whole_step_s, names))
        self._recent.extend(seen)
