"""The job "run": a scenario through engines, as the page draws it."""

from __future__ import annotations

import base64
import functools
from collections.abc import Iterator
from typing import Any

from simcompare.errors import InputError
from simcompare.lab import kept, published, scores, sentences
from simcompare.lab.asked import Asked
from simcompare.lab.numbers import listed
from simcompare.lab.translation import translated
from simcompare.model.plain import Plain
from simcompare.model.scenario import Probe
from simcompare.model.settings import BY_HAND
from simcompare.model.trajectory import TRUTH, Trajectory
from simcompare.reports.render import matplotlib_replay, replay_page
from simcompare.reports.render.decimation import decimated
from simcompare.reports.render.replays import Replay
from simcompare.reports.render.styles import TRUTH_STYLE
from simcompare.reports.render.tables import Table, printable
from simcompare.reports.run import lead_table, not_run, replay, source_styles
from simcompare.reports.run import runs as shown
from simcompare.results.run import Run
from simcompare.scenarios import catalogue
from simcompare.verbs.run import run as simulate

#: longest time for one simulation [s]; points of a curve; dots in an inch of a still
_LIMIT_S, _POINTS, _DPI = 30.0, 700, 100


def run(asked: Asked) -> Plain:
    """Simulates the nominal repeat alone, so that a slider's answer comes at once.

    Raises:
        SimcompareError: what is asked for cannot be run.
    """
    levels, own = asked.levels(), asked.own()
    if not levels and not own:
        raise InputError("levels", ["nothing is chosen; choose a level, or set values by hand"])
    scenario = asked.scenario()
    result = simulate(
        scenario,
        engine=asked.engines(),
        contact=levels or BY_HAND,
        set=asked.parameters(),
        own=own or None,
        against=asked.published(),
        seeds=1 if _is_dithered(scenario) else None,
        time_limit_s=_LIMIT_S,
    )
    return {**drawn(result, asked), "scores": _scores(asked, result)}


def _scores(asked: Asked, result: Run) -> list[Plain]:
    """Against published bounces or those that were recorded, if any."""
    if asked.published() is not None:
        return published.scores(result, asked.language)
    place = asked.recording()
    drop = None if place is None else kept.drop_of(place)
    return [] if drop is None else scores.of_recording(result, drop, asked.language)


@functools.cache
def _is_dithered(scenario: str) -> bool:
    """Whether it has repeats, of which one is enough here."""
    return catalogue.load(scenario).resolve().dither is not None


def drawn(result: Run, asked: Asked) -> Plain:
    """Replay, curves, table and sentence of a run.

    Args:
        result: the run.
        asked: by whom; with ``still`` there are pictures too, for browsers that draw nothing.
    """
    made, name = replay.replay_of(result), next(iter(shown.probes(result)))
    probe = shown.probes(result)[name]
    table = lead_table.lead_table(result)
    return {
        "replay": None if made is None else {**replay_page.as_dict(made), **_stills(made, asked)},
        "curves": list(_curves(result, probe)),
        "y_label": f"{translated(probe.label, asked.language)} ({probe.unit})",
        "table": None if table is None else _table(table),
        "sentence": sentences.of_run(result, asked.language),
        "missing": [f"{row.name}: {row.reason}" for row in not_run.not_run(result)],
        "exit": result.exit_code,
    }


def _stills(made: Replay, asked: Asked) -> Plain:
    """A picture of each level."""
    if not asked.request.get("still"):
        return {}
    found = {level: matplotlib_replay.rendered(made, level, _DPI) for level in made.levels}
    return {
        "pictures": {
            level: f"data:image/png;base64,{base64.b64encode(png).decode()}"
            for level, png in found.items()
        }
    }


def _curves(result: Run, probe: Probe) -> Iterator[dict[str, Any]]:
    true = shown.truth(result)
    if (line := _line(true, probe)) is not None:
        yield {"source": TRUTH, "level": "", "colour": TRUTH_STYLE.colour, **line}
    for level in shown.modes(result):
        for name in shown.names(result):
            if (line := _line(shown.nominal(result, name, level), probe)) is None:
                continue
            look = source_styles.level_look(result, name, level)
            yield {
                "source": name, "level": level, "colour": look.colour, "dash": look.dash, **line,
            }  # fmt: skip


def _line(trajectory: Trajectory | None, probe: Probe) -> dict[str, list[float | None]] | None:
    values = shown.observed(trajectory, probe)
    if trajectory is None or values is None:
        return None
    time_s, y = decimated(trajectory.time_s, values, _POINTS)
    return {"t": listed(time_s), "y": listed(y)}


def _table(table: Table) -> Plain:
    return {
        "title": table.title,
        "head": [column.full_head for column in table.columns],
        "rows": [list(map(printable, row)) for group in table.groups for row in group.rows],
        "note": table.note,
    }
