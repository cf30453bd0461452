"""The interface check that asks for the record of what an engine was given and holds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from simcompare.backends.conformance_run import Run
from simcompare.engine.features import Feature
from simcompare.model.audit import AuditRow
from simcompare.model.scenario import Contact, Scenario
from simcompare.model.settings import COEFFICIENTS
from simcompare.model.shapes import sizes_m

#: what is on record of a joint besides where it is
_LAWS = {"friction", "damping", "stiffness", "rest", "armature", "rate", "lower", "upper"}


def values_are_read_back(run: Run) -> None:
    """Everything that an engine holds of a scenario is on record, and holds what was set."""
    audit = run.trajectory.audit
    for row in audit:
        if row.set_value is not None and row.read_value is not None:
            close = math.isclose(row.set_value, row.read_value, rel_tol=1e-6, abs_tol=1e-12)
            assert close, f"{row.quantity}: set {row.set_value}, holds {row.read_value}"
    read = [row for row in audit if row.read_value is not None]
    is_planar = Feature.SPATIAL not in run.backend.features
    for quantity, wanted in _quantities(run.scenario):
        if not (is_planar and quantity.endswith(".y")):  # it has no such length
            _is_read(read, quantity, wanted)
    for name, joint in run.scenario.joints.items():
        if joint.type != "fixed":
            _is_placed(read, name)
    if run.settings.gives(COEFFICIENTS):
        for contact in run.scenario.contacts:
            _is_given(audit, contact)


def _quantities(scenario: Scenario) -> Iterator[tuple[str, tuple[float, ...]]]:
    """What every engine is given, with the scenario's values where an engine holds just these."""
    yield "gravity_m_s2", ()
    for name, body in scenario.moving_bodies().items():
        yield f"{name}.mass_kg", (body.mass_kg or 0.0,)
        yield f"{name}.inertia_kg_m2", body.inertia_kg_m2 or ()
        for shape in body.shapes:
            for size in sizes_m(shape):
                yield f"{name}.{size}", ()


def _is_read(read: Iterable[AuditRow], quantity: str, wanted: tuple[float, ...]) -> None:
    rows = [row for row in read if row.quantity.startswith(quantity)]
    assert rows, f"{quantity} is not read back"
    for row in rows:
        told = row.scenario_value
        if wanted and told is not None:
            known = any(math.isclose(told, value, rel_tol=1e-9) for value in wanted)
            assert known, f"{row.quantity}: on record as {told}, the scenario has {wanted}"


def _is_placed(read: Iterable[AuditRow], joint: str) -> None:
    """Where a joint is, and along what it moves, is read back; engines say it in their own ways."""
    parts = [row.quantity.split(".")[1] for row in read if row.quantity.startswith(f"{joint}.")]
    assert any(part not in _LAWS for part in parts), f"{joint}: its place is not read back"


def _is_given(audit: Iterable[AuditRow], contact: Contact) -> None:
    """Both coefficients of a pair are on record: read back, or with a note why they are not."""
    names = {"-".join(contact.pair), "-".join(reversed(contact.pair))}
    for part, wanted in (("restitution", contact.restitution), ("friction", contact.friction)):
        rows = [row for row in audit if row.quantity in {f"{name} {part}" for name in names}]
        assert rows, f"the {part} of {'-'.join(contact.pair)} is not on record"
        for row in rows:
            said = f"{row.quantity}: on record as {row.scenario_value}, the scenario has {wanted}"
            assert row.scenario_value is None or math.isclose(row.scenario_value, wanted), said
            assert row.read_value is not None or row.note, f"{row.quantity} is not read back"
