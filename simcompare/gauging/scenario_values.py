"""Parameters of a scenario, some of them changed, for its closed form."""

from __future__ import annotations

from collections.abc import Mapping

from simcompare.scenarios import catalogue


def of(name: str, **changed: float) -> Mapping[str, float]:
    """Those of the scenario's file, with others in place of some."""
    return catalogue.load(name).resolve(changed).parameters
