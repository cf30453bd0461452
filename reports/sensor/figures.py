"""Pictures of a data sheet: the share of each term, and what drawn devices read."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.sensors import sheet_units
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Bars, Figure, Panel, Series, Span
from simcompare.reports.render.styles import TRUTH_STYLE, numbered_style
from simcompare.reports.sensor import words
from simcompare.results.records.sensor import SensorReading

_BLUE = "#0072B2"
#: bars that have room for their own number
_ROOM = 12.0


def shares(found: SensorReading) -> Figure:
    """How much of the variance each term does."""
    rows = found.shares
    parts = np.array([100 * (row.share or 0.0) for row in rows])
    texts = tuple(f"{numbers.plain(part, 2)} %" if part > _ROOM else "" for part in parts.tolist())
    ticks = tuple(f"{row.title}\n{words.told(row.contribution or 0.0, found.unit)}" for row in rows)
    panel = Panel(
        "", "Share of the variance of a reading (%)", "", (),
        bars=(Bars("share of the variance", parts, _BLUE, "", texts),), y_ticks=ticks,
    )  # fmt: skip
    chip = f"{found.chip}, {found.part.replace('_', ' ')}"
    return Figure(
        "shares",
        f"What makes a reading of {found.reading_text} uncertain: {chip}",
        "Variances add, so the shares sum to 100 %. What is smaller than a tenth of the largest"
        " standard uncertainty does less than 1 % of the work.",
        (panel,),
        height=round(max(0.6, len(rows) / 7), 2),
    )


def readings(found: SensorReading) -> Figure:
    """What drawn devices read, and what the first order expects."""
    name, size = sheet_units.spoken(found.unit)
    edges = np.array(found.edges) / size
    width = np.diff(edges)
    share = np.array(found.counts) / sum(found.counts) / width
    middle = (edges[1:] + edges[:-1]) / 2
    u, true = found.u / size, found.reading / size
    fine = np.linspace(edges[0], edges[-1], 200)
    bell = np.exp(-(((fine - true) / u) ** 2) / 2) / (u * np.sqrt(2 * np.pi))
    panel = Panel(
        "", f"Reading ({name})", f"Density of devices (1/{name})",
        (
            Series("normal, from the first order", fine, bell, TRUTH_STYLE),
            Series("drawn devices", middle, share, numbered_style(0), points=True, line=False),
        ),
        spans=(
            Span(true, true, "true value"),
            Span(found.low / size, found.high / size, "95 % of the devices"),
        ),
    )  # fmt: skip
    return Figure(
        "readings",
        f"What {numbers.thousands(found.draws)} devices read of {found.reading_text}",
        "Each device has an error of its own; on one device, repeating does not show it.",
        (panel,),
    )
