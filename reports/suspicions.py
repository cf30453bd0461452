"""What is said where a recording, read another way, would fit much better."""

from __future__ import annotations

from simcompare.reports.render import numbers
from simcompare.statistics.suspicions import Suspicion


def sentence(found: Suspicion, what: str, unit: str) -> str:
    """The suspicion, what it explains, and how to try it.

    Args:
        found: what would explain the recording.
        what: the quantity that does not fit.
        unit: of its misfit.
    """
    return _told(found, what, f"{found.before:.2g} {unit} rms", f"{found.after:.2g} {unit}")


def of_range(found: Suspicion) -> str:
    """The same of a simulation, whose misfit is a part of the range of what was measured.

    Args:
        found: what would explain the recording.
    """
    before, after = (numbers.plain(100 * part, 2) for part in (found.before, found.after))
    return _told(found, "closed form", f"{before} % of the range (rms)", f"{after} %")


def _told(found: Suspicion, what: str, before: str, after: str) -> str:
    alike = f" (or as well {' or '.join(found.also)})" if found.also else ""
    return (
        f"A mistake in what is said of the recording is suspected: the {what} is off by {before}."
        f" With {' and '.join(found.says)}{alike} it is off by {after}. Nothing was changed; to"
        f" try it, {' and '.join(found.cures)}."
    )
