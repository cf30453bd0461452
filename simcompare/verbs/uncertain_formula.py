"""``uncertainty`` of a formula alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from simcompare.propagation import formulas, inputs
from simcompare.propagation.inputs import Input, Known
from simcompare.propagation.propagated import Asked
from simcompare.reports.uncertainty.answer import words
from simcompare.results.records.uncertainty import FORMULA, Way
from simcompare.results.run_record import now, software
from simcompare.verbs.request import UncertaintyRequest
from simcompare.verbs.uncertain import Uncertain


def of_formula(
    request: UncertaintyRequest,
    asked: Asked,
    stated: Mapping[str, str | float],
    reasons: Mapping[str, str],
) -> Uncertain:
    """A formula with quantities that the user gives.

    Raises:
        InputError: it is more than arithmetic, quantities are unknown or lack a value, or nothing
            is uncertain.
    """
    formula = formulas.asked_of(request.of or "")
    given = formulas.quantities_of(formula, request.set or {})
    known = inputs.of_formula(formula.names, given.values, given.units, stated, reasons)
    unit = formulas.unit_of(formula, given.values, given.units)
    found = formulas.propagated(formula, given.values, replace(asked, known=known))
    return record_of(
        request,
        asked,
        known,
        subject=formula.text,
        of="",
        unit=unit,
        ways=(Way(FORMULA, found=found),),
    )


def record_of(
    request: UncertaintyRequest,
    asked: Asked,
    known: Sequence[Known],
    *,
    subject: str,
    of: str,
    unit: str,
    ways: tuple[Way, ...],
    beyond: tuple[str, ...] = (),
) -> Uncertain:
    """What was found, with all that it was asked with."""
    what = words(of) if of else subject
    return Uncertain(
        created=now(),
        title=f"Uncertainty of {what}{f' of {subject}' if of else ''}",
        question=f"How well is {what} known, and which input matters most?",
        subject=subject, of=of, unit=unit,
        inputs=tuple(Input(one.name, one.stated, one.reason, one.unit) for one in known),
        correlation=tuple((*pair, r) for pair, r in asked.correlation.items()),
        ways=ways, beyond=beyond, engines_asked=request.engine, command="", software=software(),
    )  # fmt: skip
