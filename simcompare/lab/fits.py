"""The job "fit": every engine's own values for a ball that was recorded."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

import yaml

from simcompare.engine import by_hand
from simcompare.errors import InputError
from simcompare.fitting.bounces import reading
from simcompare.fitting.bounces.bounce_models import GRAVITY
from simcompare.lab import kept, published, recordings, runs, scores, sentences
from simcompare.lab.asked import Asked
from simcompare.lab.numbers import shortened
from simcompare.model.plain import Plain
from simcompare.model.settings import DEFAULT
from simcompare.reports.run import runs as shown
from simcompare.reports.run import source_styles
from simcompare.results import fit_file
from simcompare.results.fit_file import FILE, FITTED
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.run import Run
from simcompare.scenarios import catalogue
from simcompare.verbs.fit import fit as fit_to
from simcompare.verbs.run import run as simulate

#: folder of a group in which fits are stored, by the id of the result; longest simulation [s]
FITS, _LIMIT_S = "fits", 60.0


def fit(asked: Asked) -> Plain:
    """Fits engines to a recording or to published bounces, and runs them with what was found.

    Raises:
        SimcompareError: nothing bounces in the recording, or it cannot be fitted.
    """
    scenario, engines = asked.scenario(), asked.engines()
    made = asked.folder() / FITS / asked.text("id")
    with _source(asked) as file:
        drop = recordings.drop(reading.drops_of(file, None, None, GRAVITY)[0])
        result = fit_to(
            scenario, recordings=file, engine=engines, out=made.parent / f"{made.name}.new",
            time_limit_s=_LIMIT_S,
        )  # fmt: skip
    _put(result.folder, made)
    assert isinstance(result.record, FitRecord)
    found = result.record.fit
    assert isinstance(found, BouncesFit)
    able = [row.name for row in found.sources if row.status == "ok"]
    values = {name: _typed(found, name) for name in able}
    height = fit_file.read(made / FILE).drop(catalogue.load(scenario))
    after = _after(asked, scenario, able, made / FILE, drop, height)
    return {
        "sentence": sentences.of_fit(result, found, asked.language),
        "restitution": _restitution(found),
        "engines": [
            {"name": name, "level": FITTED, "values": values[name], **_near(after, name)}
            for name in able
        ],
        "missing": [f"{r.name}: {r.reason}" for r in found.sources if r.status != "ok"],
        "notes": list(found.dropped),
        "student": _student(asked.own(), values),
        "parameters": {k: shortened(v) for k, v in {**found.run_with.closed, **height}.items()},
        "drop": drop,
        "files": [_values_file(asked, found, values, height)],
        **after,
    }


def _source(asked: Asked) -> AbstractContextManager[Path]:
    """What is fitted to."""
    name, place = asked.published(), asked.recording()
    if name is not None:
        return nullcontext(published.path_of(name))
    if place is None:
        raise InputError("recording", ["none is chosen; record a ball, or send a file"])
    return kept.fittable(place, asked.struck())


def file_of(asked: Asked) -> Path | None:
    """The fit.json of the result that is named; ``None`` where none is named.

    Raises:
        InputError: that is no fit.
    """
    place = asked.result()
    if place is None:
        return None
    file = asked.folder() / FITS / place.name / FILE
    if not file.is_file():
        raise InputError("result", ["is no fit; fit to a recording first"])
    return file


def _put(made: Path | None, place: Path) -> None:
    """Moves a stored fit to where it is found by the id of its result."""
    assert made is not None
    shutil.rmtree(place, ignore_errors=True)
    made.rename(place)
    shutil.rmtree(made.parent, ignore_errors=True)


def _typed(found: BouncesFit, name: str) -> dict[str, float]:
    """An engine's values as they are typed in."""
    numbers = found.run_with.numbers.get(name, ())
    return by_hand.typed(name, numbers[0].values) if numbers else {}


def _restitution(found: BouncesFit) -> Plain:
    """That of the fastest impact, with its standard uncertainty."""
    ends = found.closed_form.restitution
    fastest = max(ends, key=lambda one: one.speed_m_s)
    return {
        "value": shortened(fastest.value),
        "u": shortened(fastest.u),
        "speed_m_s": shortened(fastest.speed_m_s),
    }


def _after(
    asked: Asked, scenario: str, able: Sequence[str], file: Path, drop: Mapping[str, Any],
    height: Mapping[str, float],
) -> Plain:  # fmt: skip
    """Engines as they come, as fitted, and as the student set them, beside what was recorded.

    They are judged by the ball that was dropped, no longer by the truth of the scenario.
    """
    own = {key: value for key, value in asked.own().items() if key.partition(".")[0] in able}
    result = simulate(
        scenario, engine=able, contact=[DEFAULT, str(file)], own=own or None, seeds=1,
        set=dict(height), time_limit_s=_LIMIT_S,
    )  # fmt: skip
    drawn = runs.drawn(result, asked)
    return {
        **{key: drawn[key] for key in ("replay", "curves", "y_label")},
        "scores": scores.of_recording(result, drop, asked.language),
        "bounces": _bounces(result, drop),
    }


def _bounces(result: Run, drop: Mapping[str, Any]) -> Plain:
    """Restitution of each bounce, as recorded and in every engine."""
    numbers = [one["bounce"] for one in drop["restitution"]]
    rows = []
    for level in shown.modes(result):
        for name in shown.ran(result, level):
            made = scores.by_bounce(result, name, level, "restitution")
            look = source_styles.level_look(result, name, level)
            values = [shortened(made.get(number)) for number in numbers]
            rows.append({"name": name, "level": level, "colour": look.colour, "values": values})
    measured = [one["value"] for one in drop["restitution"]]
    return {"numbers": numbers, "measured": measured, "engines": rows}


def _near(after: Mapping[str, Any], name: str) -> Plain:
    """How near a fitted engine is to what was recorded."""
    for one in after["scores"]:
        if (one["source"], one["level"]) == (name, FITTED):
            return {"misfit": one.get("misfit_mm"), "restitution": one["value"]}
    return {}


def _student(own: Mapping[str, float], values: Mapping[str, Mapping[str, float]]) -> list[Plain]:
    """The values that a student had set, beside those that were found."""
    rows = []
    for key, yours in own.items():
        engine, _, name = key.partition(".")
        fitted = values.get(engine, {}).get(name)
        value = next(one for one in by_hand.known(engine) if one.name == name)
        if fitted is None:  # all else is as in "tuned"
            fitted = value.tuned
        rows.append({
            "engine": engine, "name": name, "yours": yours, "fitted": shortened(fitted),
            "unit": value.unit,
        })  # fmt: skip
    return rows


def _values_file(
    asked: Asked, found: BouncesFit, values: Mapping[str, Mapping[str, float]],
    height: Mapping[str, float],
) -> str:  # fmt: skip
    """Writes all that was found as YAML, and how each engine is run with it; the file's name."""
    name = kept.name_of(asked, "values", "yaml")
    content = {
        "scenario": found.scenario,
        "step_s": found.valid.engine_step_s,
        "parameters": {**height, **found.run_with.closed},
        "engines": {engine: dict(own) for engine, own in values.items()},
    }
    runs = [_command(found, engine, own, height) for engine, own in values.items()]
    head = "".join(f"# {line}\n" for line in ["at home, with simcompare:", *runs])
    return kept.file(asked.folder(), name, head + yaml.safe_dump(content, sort_keys=False))


def _command(
    found: BouncesFit, engine: str, own: Mapping[str, float], height: Mapping[str, float]
) -> str:
    set_ = {**height, "restitution": found.run_with.closed.get("restitution")}
    options = [f"--set {name}={shortened(v)}" for name, v in set_.items() if v is not None]
    options += [f"--own {engine}.{name}={shortened(value)}" for name, value in own.items()]
    return " ".join([f"simcompare run {found.scenario} --engine {engine}", *options])
