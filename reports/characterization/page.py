"""The page of a characterization: what a class must see, then pictures, then numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from simcompare.model.settings import CONTACT_LEVELS
from simcompare.reports.characterization import bounce_figures, tables
from simcompare.reports.characterization import figures as characterized_figures
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Block, Part, part_of
from simcompare.results.records.characterization import Characterization
from simcompare.running.jobs import MISSING

_FIGURES: Mapping[str, Callable[[Characterization], list[Figure]]] = {
    "bounce": bounce_figures.of_bounce,
    "friction": characterized_figures.of_friction,
    "joint": characterized_figures.of_joint,
    "force": characterized_figures.of_force,
}
_TITLES = {
    "bounce": "A ball that bounces",
    "friction": "A block that sticks and slides",
    "joint": "A hinge with damper and spring",
    "force": "Forces at rest and in motion",
}
#: what the levels are, in a sentence each
_LEVELS = {
    "default": "By default: the engine as it is first met.",
    "coefficients": "Coefficients typed in: restitution and friction, in an engine that is else as"
    " it comes.",
    "tuned": "Tuned: everything typed in, in a plain loop of one step; what stands for the"
    " restitution is found by dropping a ball at one speed and step, and then held.",
    "assisted": "With our helps: the same, and we land on impacts and give efforts at the right"
    " instant; that is our work and not the engine's.",
}


def block_of(result: Characterization) -> Block:
    """What the page shows."""
    figures = {name: _FIGURES[name](result) for name in result.experiments}
    first = next(filter(None, figures.values()), [])
    lead = [figure for figure in first if figure.title.startswith(first[0].title)]
    del first[: len(lead)]
    experiments = (_experiment(result, name, drawn) for name, drawn in figures.items())
    return Block(
        "c1",
        "characterization",
        result.title,
        result.question,
        result.created,
        result.software.simcompare or "",
        (_answer(result, lead), *experiments, _how(result)),
    )


def _answer(result: Characterization, lead: list[Figure]) -> Part:
    """What leads, with the first picture, which may go on; the rest is in the sections."""
    leading = [one.text for one in result.sentences if one.leads]
    answer = leading or [one.text for one in result.sentences]
    missing = {t.engine: t.reason for t in result.answers if t.status == MISSING}
    answer += [f"Did not run: {reason}" for reason in missing.values()]
    return part_of("Answer", "answer", lead, answer=answer)


def _experiment(result: Characterization, name: str, figures: list[Figure]) -> Part:
    sentences = [one.text for one in result.sentences if one.experiment == name]
    notes = [*sentences, *tables.reasons(result, name)]
    return part_of(_TITLES[name], name, figures, [tables.of(result, name)], notes)


def _how(result: Characterization) -> Part:
    versions = {trial.engine: trial.version for trial in result.answers}
    engines = ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    notes = [_LEVELS[level] for level in CONTACT_LEVELS if level in result.contact]
    notes += [
        f"Engines: {engines}." if engines else "No engine ran.",
        f"Made on {result.created} with simcompare {result.software.simcompare}:"
        f" simcompare characterize {','.join(result.experiments)}"
        f" --contact {','.join(result.contact)} --step {1e3 * result.step_s:g}ms"
        f" --engine {result.engines_asked}",
    ]
    return part_of("How it was made", "how", notes=notes)
