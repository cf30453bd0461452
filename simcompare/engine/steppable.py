"""What our helps see of a simulation: enough to step it, to put it somewhere, and to go back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from simcompare.engine.helps.recoil import Motion, Recoil
from simcompare.engine.planar_joints import PlanarMotion
from simcompare.engine.state import State
from simcompare.model.scenario import Scenario


class Retractable(Protocol):
    """A simulation whose steps can be taken back."""

    scenario: Scenario
    recoil: Recoil | None

    @property
    def step_s(self) -> float:
        """The whole engine step [s]."""

    @property
    def index(self) -> int:
        """Engine steps since the start."""

    @property
    def driven(self) -> tuple[str, ...] | None:
        """Joints that are driven; ``None`` for none."""

    @property
    def stagger(self) -> float:
        """Where steps store velocities, seen from the positions [steps]."""

    @property
    def state(self) -> State:
        """The present state as plain values."""

    def advance(self, count: int) -> None:
        """Takes engine steps, with drag and drive in each."""

    def rotor_motions(self) -> list[Motion]:
        """How the bodies with armatures move now."""

    def go_to(self, state: State) -> None:
        """Puts everything into a state of the present instant."""

    def save(self) -> Any:  # noqa: ANN401
        """A token of the present state."""

    def restore(self, saved: Any) -> None:  # noqa: ANN401
        """Goes back to a state that ``save`` gave."""


class Planar(Retractable, Protocol):
    """The same in the plane, where every body has coordinates of its own."""

    def get(self, body: str) -> PlanarMotion:
        """Motion of a moving body."""

    def put(self, body: str, motion: PlanarMotion) -> None:
        """Puts a moving body into a motion."""

    def contact_impulse(self, body: str) -> Sequence[float]:
        """Sum of all impulses [N·s] of contacts on a body in the last engine step."""

    def take_step_that_ends_at(self, index: int, *, last: bool) -> None:
        """Takes the engine step before another one, the last time to stay."""

    def note_rates_before(self) -> None:
        """Tells what drives the joints that the present rates are those of a step before."""
