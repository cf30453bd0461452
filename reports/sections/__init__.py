"""Sections of a report: a template name and a dictionary."""

from __future__ import annotations

from simcompare.reports.sections.base import Section
from simcompare.reports.sections.contrast import Contrast
from simcompare.reports.sections.curves import Curves
from simcompare.reports.sections.energy import Energy
from simcompare.reports.sections.events import Events
from simcompare.reports.sections.given import Given
from simcompare.reports.sections.headline import Headline
from simcompare.reports.sections.limits import Limits
from simcompare.reports.sections.measured import Measured
from simcompare.reports.sections.scores import Scores
from simcompare.reports.sections.setup import Setup
from simcompare.reports.sections.signals import Signals

#: in the order in which a reader wants them
SECTIONS: tuple[Section, ...] = (
    Headline(),
    Measured(),
    Curves(),
    Events(),
    Energy(),
    Contrast(),
    Signals(),
    Scores(),
    Given(),
    Limits(),
    Setup(),
)
