"""A scenario that is fitted, whatever by, with the values of its parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from simcompare.model.fittable import Fittable
from simcompare.scenarios.scenario_file import ScenarioFile


@dataclass(frozen=True)
class FittedScenario:
    """What the roles of all kinds of fits begin with.

    Attributes:
        file: the scenario.
        given: every parameter's value [SI].
    """

    file: ScenarioFile
    given: Mapping[str, float]

    @property
    def fit(self) -> Fittable:
        """What the scenario says under ``fit:``."""
        assert self.file.fit is not None
        return self.file.fit
