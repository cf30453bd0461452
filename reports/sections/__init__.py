"""Sections of a report: what each shows of a run, ``None`` where there is nothing to show."""

from __future__ import annotations

from simcompare.reports.render.parts import Section
from simcompare.reports.sections import pictures
from simcompare.reports.sections.assistance import assistance
from simcompare.reports.sections.events import events
from simcompare.reports.sections.given import given
from simcompare.reports.sections.headline import headline
from simcompare.reports.sections.limits import limits
from simcompare.reports.sections.measurement import measurement
from simcompare.reports.sections.scores import scores
from simcompare.reports.sections.sensing import sensing
from simcompare.reports.sections.setup import setup
from simcompare.reports.sections.tuning import tuning
from simcompare.results.records.run import Record

#: at the end of every report
_LAST: tuple[Section, ...] = (given, limits, setup)
#: in the order in which a reader wants them
SECTIONS: tuple[Section, ...] = (
    headline,
    pictures.moving,
    pictures.ranges,
    measurement,
    sensing,
    pictures.drive,
    assistance,
    pictures.curves,
    events,
    pictures.energy,
    pictures.contrast,
    pictures.signals,
    scores,
    tuning,
    *_LAST,
)


def of_run(record: Record) -> tuple[Section, ...]:
    """The sections that suit a run; those of fits and validations are imported for these alone."""
    if record.kind == "validation":
        from simcompare.reports.sections import validation

        return (*validation.SECTIONS, *_LAST)
    if record.kind == "fit":
        from simcompare.reports.sections import fits

        return (*fits.of_fit(record), *_LAST)
    return SECTIONS
