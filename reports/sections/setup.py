"""How the run was made, and how to make it again."""

from __future__ import annotations

from typing import Any

from simcompare import units
from simcompare.reports.render import numbers
from simcompare.reports.run import runs
from simcompare.reports.run.reproduce import command, scripts
from simcompare.reports.sections.base import Section
from simcompare.results.records.run import SourceRecord
from simcompare.results.run import Run


class Setup(Section):
    """Everything that is needed to repeat and to cite the run."""

    name, title, template = "setup", "How it was made", "setup.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Plain values of the record."""
        record = run.record
        return {
            "command": command(run),
            "scripts": scripts(run),
            "parameters": [_parameter(run, name) for name in record.parameters],
            "settings": _settings(run),
            "software": vars(record.software),
            "machine": vars(record.machine),
            "dither": _dither(run),
            "sources": [_times(source) for source in record.sources],
            "missing": runs.not_run(run),
        }


def _dither(run: Run) -> str | None:
    """How the repeats differ."""
    dither = run.record.dither
    if not dither or run.record.repeats < 2:
        return None
    name = dither.parameter
    unit = units.symbol(units.unit_of(name))
    each = [step.dither for step in runs.steps(run) if step.dither] or [dither]
    spans = " or ".join(dict.fromkeys(numbers.plain(one.span, 3) for one in each))
    span = spans + ("" if unit == "1" else f" {unit}")
    return f"{name.removesuffix(units.suffix_of(name))}, spread over {span}. {dither.reason}"


def _parameter(run: Run, name: str) -> dict[str, str]:
    unit = units.symbol(units.unit_of(name))
    return {
        "name": name.removesuffix(units.suffix_of(name)),
        "value": numbers.plain(run.record.parameters[name]),
        "unit": "" if unit == "1" else unit,
        "text": run.record.parameter_texts.get(name, ""),
    }


def _settings(run: Run) -> dict[str, str]:
    record = run.record
    return {
        "scenario": f"{record.scenario} (SHA-256 {record.scenario_sha256[:12]}…)",
        "made": str(record.created),
        "stored in": str(record.run or "was not stored"),
        "preset": str(record.preset or "none"),
        "time between samples": f"{_samples(run)} s",
        "simulated time": f"{numbers.plain(record.duration_s, 4)} s",
        "repeats": str(record.repeats),
        "seed": str(record.seed),
        "truth": str(record.truth or "none"),
    }


def _samples(run: Run) -> str:
    each = [step.step_s for step in runs.steps(run)] or [run.record.step_s]
    return " or ".join(dict.fromkeys(map(numbers.plain, each)))


def _times(source: SourceRecord) -> dict[str, Any]:
    # times are those of one simulation, like the steps
    wall, total = source.wall_s, source.steps or 0
    return {
        "name": source.name,
        "version": source.version or "–",
        "mode": runs.mode_words(source.contact),
        "status": source.status,
        "steps": source.steps if source.steps is not None else "–",
        "repeats": source.repeats,
        "build": _ms(wall.build),
        "step": _ms(wall.step),
        "per_step": numbers.plain(1e6 * (wall.step or 0) / total, 3) if total else "–",
    }


def _ms(seconds: float | None) -> str:
    return numbers.plain(None if seconds is None else 1e3 * seconds, 3)
