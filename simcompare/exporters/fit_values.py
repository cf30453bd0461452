"""The parameters of a fit, as a format or a script of an engine takes them."""

from __future__ import annotations

from pathlib import Path

from simcompare.results import fit_file
from simcompare.results.fit_file import FitFile
from simcompare.scenarios.scenario_file import ScenarioFile


def read(fit: str) -> FitFile:
    """The fit that is meant by a file, or by the folder that it lies in."""
    return fit_file.read(fit_file.find(fit) or Path(fit))


def fitted(file: ScenarioFile, fit: str | None, engine: str) -> dict[str, float]:
    """Parameters of a fit, those of an engine among them; none without a fit."""
    if fit is None:
        return {}
    found = read(fit)
    return {**found.base(file), **(found.of_engine(engine, file) or {})}
