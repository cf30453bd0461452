"""Damping ratio of a spring and damper that can only push, for a restitution."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.engine import dashpot
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example

_PUBLISHED = {
    0.95: "0.016498", 0.9: "0.034265", 0.85: "0.053479", 0.8: "0.074355", 0.75: "0.097158",
    0.7: "0.122215", 0.6: "0.180858", 0.5: "0.255276", 0.3: "0.497239",
}  # fmt: skip


def _checks() -> Iterator[Check]:
    yield Check("restitution at damping ratio 1", "0.1353", dashpot.restitution(1.0))
    for e, published in _PUBLISHED.items():
        yield Check(f"damping ratio for e = {e:g}", published, dashpot.damping_ratio(e))


EXAMPLE = Example(
    "Spring and damper that can only push: damping ratio for a restitution",
    "Formula of Schwager and Pöschel, Granular Matter 9 (2007) 465; solved independently with"
    " scipy's brentq.",
    _checks,
    closed_form=True,
)
