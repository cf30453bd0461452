"""Damping ratio of a spring and damper that can only push, for a restitution."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.engine import dashpot
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example

_EXACT = {
    0.95: "0.0164982309", 0.9: "0.0342652041", 0.85: "0.0534789537", 0.8: "0.0743550971",
    0.75: "0.0971577713", 0.7: "0.122214748", 0.6: "0.180858308", 0.5: "0.255275638",
    0.3: "0.497239395",
}  # fmt: skip


def _checks() -> Iterator[Check]:
    yield Check("restitution at damping ratio 1", "0.13533528", dashpot.restitution(1.0))
    for e, exact in _EXACT.items():
        yield Check(f"damping ratio for e = {e:g}", exact, dashpot.damping_ratio(e))


EXAMPLE = Example(
    "Spring and damper that can only push: damping ratio for a restitution",
    "Formula of Schwager and Pöschel, Granular Matter 9 (2007) 465: contact ends where the force"
    " does; solved with mpmath. At damping ratio 1 it is e⁻².",
    _checks,
    kind="exact",
    closed_form=True,
)
