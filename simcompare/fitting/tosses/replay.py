"""A toss replayed in an engine: it starts where its own flight says."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from simcompare.engine.backend import Backend
from simcompare.errors import InputError
from simcompare.fitting.tosses.roles import TossRoles
from simcompare.fitting.tosses.tosses import Errors, Toss, errors, start_of
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, Settings

ALL_HELPS = Settings(ASSISTED)
#: longest step of a replay [s]
STEP_S = 5.0e-4
#: part of the time between samples by which it may vary
_EVEN = 1e-6


class Replayed(NamedTuple):
    """How far a replay is off, and the wall time of it [s]."""

    errors: Errors
    wall_s: float


@dataclass(frozen=True)
class Replay:
    """One toss in one engine, with some parameters; what the engine's process is asked.

    Attributes:
        roles: the scenario.
        toss: what is replayed.
        values: parameters that differ from what is given.
        settings: contact level.
        step_s: longest step; the recorded step is a whole part of the time between samples, so
            that nothing is interpolated.
    """

    kind: ClassVar[type[Any]] = Replayed
    roles: TossRoles
    toss: Toss
    values: Mapping[str, float]
    settings: Settings = ALL_HELPS
    step_s: float = STEP_S

    @property
    def parts(self) -> int:
        """Steps between two samples."""
        return math.ceil(spacing_s(self.toss) / self.step_s - 1e-9)

    def scenario(self) -> Scenario:
        """The scene of this toss."""
        roles = self.roles
        start = start_of(self.toss, roles.width_m(self.values), roles.gravity_m_s2(self.values))
        step_s = spacing_s(self.toss) / self.parts
        return roles.scenario(self.values, start, float(self.toss.time_s[-1]), step_s)

    def __call__(self, backend: Backend) -> Replayed:
        """How far the engine is off."""
        found = backend.simulate(self.scenario(), self.settings)
        rows = slice(0, self.parts * len(self.toss.time_s), self.parts)
        body = self.roles.body
        off = errors(
            self.toss, found.signals[f"{body}.position_m"][rows],
            found.signals[f"{body}.orientation_wxyz"][rows], self.roles.width_m(self.values),
        )  # fmt: skip
        return Replayed(off, found.wall_s.get("build", 0.0) + found.wall_s.get("step", 0.0))


def spacing_s(toss: Toss) -> float:
    """Time between samples.

    Raises:
        InputError: it varies.
    """
    gaps = np.diff(toss.time_s)
    spacing = float(gaps.mean())
    if np.abs(gaps - spacing).max() > _EVEN * spacing:
        raise InputError(toss.name, ["its samples are not evenly spaced"])
    return spacing
