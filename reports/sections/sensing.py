"""What the sensors of a run read: a picture, the drawn device, and how far readings are off."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.model.trajectory import TRUTH
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Part
from simcompare.reports.run import runs
from simcompare.reports.sensing import tables, words
from simcompare.reports.sensing.figures import reading_figure
from simcompare.results.records.run import RunRecord
from simcompare.results.records.sensing import SensorRecord
from simcompare.results.run import Run


def sensing(run: Run) -> Part | None:
    """What every sensor that is not ideal reads; ``None`` where there is none."""
    found = run.record.sensing if isinstance(run.record, RunRecord) else None
    if found is None:
        return None
    return Part(
        "What the sensor reads" if len(found.sensors) == 1 else "What the sensors read",
        "sensors",
        answer=tuple(words.lines(found)),
        parts=tuple(_part(run, sensor) for sensor in found.sensors),
    )


def _part(run: Run, sensor: SensorRecord) -> Part:
    """One signal; of many zones the long table of their sheet is folded away."""
    drawn = tables.drawn_table(sensor)
    is_long = sensor.zones is not None
    deviations = tables.deviation_table(sensor)
    folded = Part(drawn.title, tables=(drawn._replace(title=""),), folded=True)
    return Part(
        sensor.signal,
        figures=tuple(_figures(run, sensor)),
        facts=words.settings(sensor),
        tables=(deviations,) if is_long else (drawn, deviations),
        parts=(folded,) if is_long else (),
    )


def _figures(run: Run, sensor: SensorRecord) -> Iterator[Figure]:
    """The reading of the source that stands for all."""
    lead = words.lead(sensor)
    if lead is None:
        return
    for one in run.stored_readings:
        if (one.source, one.contact, one.signal) == (lead.source, lead.contact, sensor.signal):
            level = f" {runs.mode_words(one.contact)}" if one.contact else ""
            whose = f"the {TRUTH}" if one.source == TRUTH else f"{one.source}{level}"
            yield reading_figure(sensor, one.reading, whose)
