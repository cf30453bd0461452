"""What is said where a recording, read another way, would fit much better."""

from __future__ import annotations

from simcompare.statistics.suspicions import Suspicion


def sentence(found: Suspicion, what: str, unit: str) -> str:
    """The suspicion, what it explains, and how to try it.

    Args:
        found: what would explain the recording.
        what: the quantity that does not fit.
        unit: of its misfit.
    """
    return (
        f"A mistake in what is said of the recording is suspected: the {what} is off by"
        f" {found.before:.2g} {unit} rms, and with {' and '.join(found.says)} by"
        f" {found.after:.2g} {unit}. Nothing was changed; to try it, {' and '.join(found.cures)}."
    )
