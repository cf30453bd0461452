"""To be written."""

from __future__ import annotations

from simcompare.hardware.conditioning.work import Work


def check(work: Work) -> None:
    """Checks."""
