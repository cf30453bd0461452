"""Tables of a fit: engines, closed forms, what the data can tell, hold-out, what was measured."""

from __future__ import annotations

import math
from collections.abc import Mapping

from simcompare import glossary
from simcompare.reports.fit import engine_words, fits
from simcompare.reports.fit.fits import CLOSED, RESTITUTION
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table, scale_of
from simcompare.reports.validation import validations
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_forms import Unknown
from simcompare.results.records.fit_holdout import EngineHoldout, HeldOutDrop
from simcompare.results.records.fit_parts import ENGINE, EngineParameter
from simcompare.results.records.fit_waveforms import WaveParameter
from simcompare.results.run import Run

#: criteria above this are written as powers of ten
_LARGE = 1e4


def engines(run: Run) -> Table:
    """What each engine must be given and what it then shows, the closed form first."""
    rows = [(CLOSED, *_closed_words(fits.bounces(run)), "–", "–", "–")]
    for source in fits.engines(run):
        given = source.parameters.get(RESTITUTION)
        rows.append((
            source.name, fits.value_words(given), fits.interval_words(given),
            fits.value_words(source.effective.get(RESTITUTION)), str(source.simulations),
            numbers.plain(source.wall_s, 2),
        ))  # fmt: skip
    columns = (
        Column("Source", text=True), Column("Restitution to give ± u"),
        Column("95 % interval", text=True), Column("Effective ± u"), Column("Simulations"),
        Column("Time (s)"),
    )  # fmt: skip
    note = (
        "Effective: what the engine then shows. Its u holds the measurement, the phase of the step,"
        " and how the engine's restitution changes from impact to impact."
    )
    note = " ".join((*engine_words.one_number(fits.bounces(run)), note))
    return Table("Restitution of each engine", columns, (Group("", tuple(rows)),), note)


def _closed_words(found: BouncesFit) -> tuple[str, str]:
    """The closed form's restitution, the one number of engines where it depends on the speed."""
    one = found.one_number
    if one is not None:
        return numbers.with_u(one.value, one.u), "–"
    row = found.closed_form.parameters.get(RESTITUTION)
    return fits.value_words(row), fits.interval_words(row)


def parameters(run: Run) -> Table:
    """All unknowns of all engines, and of the closed form."""
    closed = _found(run)
    groups = []
    for name in closed:
        rows = [(CLOSED, fits.value_words(closed[name], name),
                 fits.interval_words(closed[name]), "–")]  # fmt: skip
        for source in fits.fitted(run):
            row = source.parameters.get(name)
            if row is not None and row.whose == ENGINE:
                own = numbers.plain(_u_engine(row), 2)
                words = fits.value_words(row, name), fits.interval_words(row)
                rows.append((source.name, *words, own))
        groups.append(Group(fits.with_unit(name), tuple(rows)))
    columns = (Column("Source", text=True), Column("Value ± u"),
               Column("95 % interval", text=True), Column("u from the engine"))  # fmt: skip
    note = "Where no engine is named, all of them are given what the closed form has."
    if fits.EXPONENT in closed:
        note += f" {glossary.legend([fits.EXPONENT])[0]}."
    return Table("All unknowns", columns, tuple(groups), note, folded=True)


def _u_engine(row: EngineParameter) -> float | None:
    """The engine's part of an uncertainty: its scatter, and what it lacks."""
    return None if row.u_num is None else math.hypot(row.u_num, row.misfit)


def _found(run: Run) -> Mapping[str, Unknown | WaveParameter]:
    """What was fitted, without what was only assumed."""
    record = fits.record(run)
    if isinstance(record, BouncesFit):
        return record.closed_form.found
    return record.closed_form.parameters


def failed(run: Run) -> Table | None:
    """Engines that could not be fitted, and why."""
    rows = tuple(
        (row.name, row.status, row.reason or "no reason is known") for row in fits.failed(run)
    )
    if not rows:
        return None
    columns = (Column("Engine", text=True), Column("Status", text=True), Column("Why", text=True))
    return Table("Could not be fitted", columns, (Group("", rows),))


def native(run: Run) -> Table | None:
    """Contact values that the engines held in the last simulation."""
    groups = []
    for source in fits.engines(run):
        rows = tuple(
            (row.engine_parameter, numbers.plain(row.set_value),
             numbers.plain(row.read_value), "" if row.unit == "1" else row.unit,
             row.note or "")
            for row in source.native
        )  # fmt: skip
        if rows:
            groups.append(Group(f"{source.name} {source.version or ''}".strip(), rows))
    if not groups:
        return None
    columns = (Column("Engine's parameter", text=True), Column("Set"), Column("Held"),
               Column("Unit", text=True), Column("Note", text=True))  # fmt: skip
    note = "Those of the last simulation, whose restitution may differ in the last digits."
    return Table("Contact values that each engine held", columns, tuple(groups), note, folded=True)


def forms(run: Run) -> Table:
    """The candidates with their criteria."""
    choice = fits.bounces(run).choice
    rows = []
    for row in choice.candidates:
        found = row.parameters.get(RESTITUTION)
        rows.append((
            row.text, numbers.plain(row.unknowns, 3), _criterion(row.chi2),
            _criterion(row.aic), _criterion(row.delta), _criterion(row.bic),
            f"{row.weight:.2f}", fits.value_words(found),
        ))  # fmt: skip
    columns = (
        Column("Closed form", text=True), Column("k"), Column("χ²"),
        Column("AIC"), Column("ΔAIC"), Column("BIC"), Column("Weight"),
        Column("Restitution ± u"),
    )  # fmt: skip
    misfit = "ν·ln(χ²/ν)" if choice.dof else "χ²"
    note = f"k: unknowns that the data determine. AIC = {misfit} + 2k, BIC = {misfit} + k·ln n."
    if choice.dof:
        note += (
            f" χ² is divided by {numbers.plain(choice.scatter, 3)}, the scatter of the richest"
            f" form, which has ν = {choice.dof} degrees of freedom."
        )
    note += " With a law that depends on speed, the restitution is that at 4 m/s."
    return Table("Closed forms", columns, (Group("", tuple(rows)),), note)


def _criterion(value: float | None) -> str:
    """A criterion; beyond ten thousand nobody looks at its digits."""
    if value is None or abs(value) >= _LARGE:
        return numbers.plain(value, 3)
    return f"{value:.1f}".replace("-", "−")


def refused(run: Run) -> Table | None:
    """Closed forms that could not be fitted."""
    rows = tuple(fits.bounces(run).choice.refused.items())
    if not rows:
        return None
    columns = (Column("Closed form", text=True), Column("Why", text=True))
    return Table("Could not be fitted", columns, (Group("", rows),))


def directions(run: Run) -> Table:
    """Singular values and the combinations that they belong to."""
    known = fits.record(run).identifiability
    largest = max((row.singular_value for row in known.directions), default=0.0)
    rows = []
    for row in known.directions:
        value = row.singular_value
        rows.append((numbers.plain(value, 3), numbers.plain(largest / value, 3) if value else "∞",
                     _moves(row.moves), "no" if row.weak else "yes"))  # fmt: skip
    columns = (Column("Singular value"), Column("Largest over it"),
               Column("Change that moves the data by one standard deviation", text=True),
               Column("Determined", text=True))  # fmt: skip
    note = "Of the residuals' Jacobian with columns of length one; priors are left out."
    return Table("Combinations of unknowns, best known first", columns, (Group("", tuple(rows)),),
                 note)  # fmt: skip


def _moves(moves: Mapping[str, float]) -> str:
    parts = []
    for name, move in moves.items():
        unit = "" if fits.unit(name) == "1" else f" {fits.unit(name)}"
        sign = "+" if move > 0 else ""
        parts.append(f"{fits.title(name)} {sign}{numbers.plain(move, 2)}{unit}")
    return ", ".join(parts) or "every unknown, by less than its own u"


def bootstrap(run: Run) -> Table:
    """Intervals of the closed form beside those of simulated repeats."""
    found = fits.bounces(run)
    boot, closed = found.bootstrap, found.closed_form.own
    rows = []
    for name in found.closed_form.found:
        row = boot.parameters[name]
        rows.append((
            fits.with_unit(name), fits.value_words(closed[name], name),
            fits.interval_words(closed[name]), closed[name].interval,
            fits.interval_words(row), numbers.plain(row.bias, 2),
        ))  # fmt: skip
    columns = (
        Column("Unknown", text=True), Column("Value ± u"), Column("95 % interval", text=True),
        Column("from", text=True), Column("of repeats", text=True), Column("Bias"),
    )  # fmt: skip
    note = f"Repeats: {boot.draws} fits to simulated data with the same noise."
    note += f" {boot.failed} more did not converge." if boot.failed else ""
    return Table(
        "The unknowns of the chosen closed form alone", columns, (Group("", tuple(rows)),), note
    )


def holdout(run: Run) -> Table | None:
    """Each held-out drop beside the fit."""
    drops = fits.bounces(run).holdout.drops
    if not drops:
        return None
    groups = []
    for drop in drops:
        own = numbers.with_u(drop.restitution, drop.u_restitution)
        rows = [(CLOSED, numbers.with_u(drop.fitted, drop.u_fitted), own, _e_n(drop))]
        rows += [
            (
                name,
                numbers.with_u(row.restitution, row.u),
                numbers.with_u(row.held, row.u_held) if row.held else own,
                _e_n(row),
            )
            for name, row in drop.engines.items()
        ]
        groups.append(
            Group(f"{validations.short(str(drop.source))}, {_residuals(drop)}", tuple(rows))
        )
    columns = (Column("Source", text=True), Column("Fitted, effective ± u"),
               Column("Of the held-out drop ± u"), Column("|E_n|"))  # fmt: skip
    return Table("Held-out drops", columns, tuple(groups))


def _e_n(row: HeldOutDrop | EngineHoldout) -> str:
    return numbers.plain(None if row.e_n is None else abs(row.e_n), 3)


def _residuals(drop: HeldOutDrop) -> str:
    """How far the predicted drop is from the measured one."""
    speeds = fits.speeds(drop.speeds_m_s)
    return f"RMS of residuals: {fits.rms_words(drop.rms)}; impacts at {speeds} m/s"


def others(run: Run) -> Table | None:
    """Other ways to judge the same data."""
    found = fits.bounces(run)
    closed = found.closed_form.parameters.get(RESTITUTION)
    if not found.other_estimates or closed is None or closed.value is None:
        return None
    low, high = fits.interval(closed)
    groups = []
    for number in dict.fromkeys(row.drop for row in found.other_estimates):
        own = [row for row in found.other_estimates if row.drop == number]
        differences = [row.value - closed.value for row in own]
        scale = scale_of(differences, 2)
        rows = tuple(
            (row.name, numbers.with_u(row.value, row.u), scale.text(difference),
             "yes" if low <= row.value <= high else "no", row.text)
            for row, difference in zip(own, differences, strict=True)
        )  # fmt: skip
        head = fits.drop_title(run, number)
        groups.append(Group(head + (f", difference{scale.unit('')}" if scale.power else ""), rows))
    columns = (Column("Rule", text=True), Column("Restitution ± u"),
               Column("Less the fit's"), Column("In its 95 %", text=True),
               Column("Beware", text=True))  # fmt: skip
    return Table("Restitution by other rules", columns, tuple(groups))
