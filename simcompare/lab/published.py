"""Balls that others measured: what engines are held against before a recording of one's own."""

from __future__ import annotations

from pathlib import Path

from simcompare.hardware.recordings import bounce_table, published
from simcompare.hardware.recordings.bounce_table import BounceTable
from simcompare.lab.numbers import shortened
from simcompare.lab.refusals import say
from simcompare.lab.translation import each, translated
from simcompare.model.plain import Plain
from simcompare.results.records.run import RunRecord
from simcompare.results.run import Run
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs.run_plan import measured_units


def of_scenario(file: ScenarioFile, language: str) -> list[Plain]:
    """All that engines can be held against: what was measured, under which conditions, by whom."""
    if file.fit is None or file.fit.by != "bounces":
        return []
    units = measured_units(file.resolve())
    every = {name: bounce_table.read(path, units) for name, path in published.tables().items()}
    return [_told(name, table, file, language) for name, table in every.items()]


def _told(name: str, table: BounceTable, file: ScenarioFile, language: str) -> Plain:
    told = [table.head[key] for key in ("citation", "note") if key in table.head]
    return {
        "name": name,
        "title": translated(table.head["title"], language),
        "text": ". ".join(each(told, language)),
        "preset": table.preset or "",
        "parameters": file.read_settings(table.parameters, str(table.path)),
    }


def path_of(name: str) -> Path:
    """The table of a name that is known."""
    return published.tables()[name]


def scores(result: Run, language: str) -> list[Plain]:
    """Every source beside what was measured; within its limits or not."""
    assert isinstance(result.record, RunRecord)
    held = result.record.against
    assert held is not None
    return [
        {
            "source": one.source, "level": one.contact, "measure": one.quantity, "unit": one.unit,
            "value": shortened(one.value), "truth": shortened(one.measured),
            "text": say(
                language, "no_bounce" if one.value is None else "beside_published",
                value="" if one.value is None else f"{one.value:.3g}",
                low=f"{one.measured if one.low is None else one.low:.3g}",
                high=f"{one.measured if one.high is None else one.high:.3g}",
                unit="" if one.unit == "1" else f" {one.unit}",
            ),
            **({} if one.inside is None else {"ok": one.inside}),
        }
        for one in held.matches
    ]  # fmt: skip
