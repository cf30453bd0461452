"""What was measured in the rows of a table, with the uncertainties of its comparison."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.results.records.tabled import CLOSED_FORM
from simcompare.statistics.budget import coverage_factor
from simcompare.validation.tabled.experiments import SCATTER, Basis, Experiment, u_of
from simcompare.validation.tabled.simulated import ClosedForm, Values
from simcompare.validation.tabled.vocabulary import Entry


@dataclass(frozen=True)
class Rows:
    """All experiments in which a result was measured, as arrays.

    Attributes:
        entry: the result.
        found: the experiments.
        measured: means (n,).
        own: standard uncertainty of each alone: of the measurement and of what its row sets (n,).
        common: input that is the same in all rows -> change of the result by its u (n,).
        of_columns: the same of inputs that stand in a column.
        u_measured: of the measurement alone (n,).
        degrees_of_freedom: behind that.
        by_scatter: whether all rows together tell it.
    """

    entry: Entry
    found: Sequence[Experiment]
    measured: Array
    own: Array
    common: Mapping[str, Array]
    of_columns: Mapping[str, Array]
    u_measured: Array
    degrees_of_freedom: float
    by_scatter: bool

    @property
    def u_input(self) -> Array:
        """Of the simulated value by all inputs (n,)."""
        squares = self.own**2 - self.u_measured**2
        return np.sqrt(squares + sum((c**2 for c in self.common.values()), np.zeros(1)))

    def k(self, of_measurement: float, whole: float) -> float:
        """Coverage factor for 95 %, by the formula of Welch and Satterthwaite.

        Args:
            of_measurement: part of a variance that the scatter of measurements makes.
            whole: the variance.
        """
        degrees = self.degrees_of_freedom * (whole / of_measurement) ** 2
        return coverage_factor(degrees if of_measurement > 0 else math.inf)


def rows_of(
    entry: Entry,
    found: Sequence[Experiment],
    basis: Basis,
    form: ClosedForm,
    closed: Sequence[Values],
    values: Mapping[str, Sequence[float | None]],
) -> Rows:
    """A result in all experiments, with its uncertainties.

    Args:
        entry: the result.
        found: the experiments in which it was measured.
        basis: where the uncertainty of the measurement comes from.
        form: the closed form.
        closed: what it gives for each experiment.
        values: source -> what it gives for each experiment.
    """
    measured = np.array([one.readings[entry.name].mean for one in found])
    degrees = basis.degrees_of_freedom
    if basis.kind == SCATTER:
        counts = np.array([len(one.readings[entry.name].values) for one in found])
        u = _about(measured, _standard(values), basis.least) / np.sqrt(counts)
        degrees = max(len(found) - 1, 1)
    else:
        u = np.array([u_of(one.readings[entry.name], basis) for one in found])
    common: dict[str, Array] = {}
    of_columns: dict[str, Array] = {}
    effects = [
        {} if before[entry.name] is None else form.effects(one, before)
        for one, before in zip(found, closed, strict=True)
    ]
    for name in dict.fromkeys(name for row in effects for name in row):
        change = np.array([row.get(name, {}).get(entry.name, 0.0) for row in effects])
        (of_columns if name in found[0].set else common)[name] = change
    own = np.sqrt(u**2 + sum((change**2 for change in of_columns.values()), np.zeros(1)))
    return Rows(
        entry, found, measured, own, common, of_columns, u, degrees, basis.kind == SCATTER
    )  # fmt: skip


def _standard(values: Mapping[str, Sequence[float | None]]) -> Array:
    """What the rows are held against to see their scatter: the closed form, else all engines."""
    rows = np.array([[math.nan if one is None else one for one in row] for row in values.values()])
    if CLOSED_FORM in values and np.isfinite(rows[0]).all():
        return np.asarray(rows[0])
    good = rows[np.isfinite(rows).all(axis=1)]
    return np.asarray(good.mean(axis=0)) if len(good) else np.full(rows.shape[1], math.nan)


def _about(measured: Array, standard: Array, least: float) -> float:
    """Scatter of the rows about a multiple of what they are held against."""
    if not np.isfinite(standard).all() or not (standard @ standard):
        return max(float(measured.std(ddof=1)), least)
    left = measured - standard * (standard @ measured) / (standard @ standard)
    return max(math.sqrt(float(left @ left) / max(len(left) - 1, 1)), least)
