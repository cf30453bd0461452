"""What ``simcompare fit`` prints."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

import typer

from simcompare import notation
from simcompare.cli import console, toss_tables
from simcompare.engine import engines
from simcompare.model.settings import TUNED
from simcompare.reports.fit import fits
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_parts import Value
from simcompare.results.records.fit_tosses import TossFit
from simcompare.results.records.fit_waveforms import HeldOutSegment, WaveformFit, WaveParameter
from simcompare.results.run import Run


def show(result: Run, written: Path | None) -> None:
    """Prints what was found: for a plain loop first what to type in."""
    any_fit = fits.of_any(result)
    if isinstance(any_fit, TossFit):
        toss_tables.show(result, any_fit, written)
        return
    found = fits.record(result)
    for sentence in found.chosen_words if isinstance(found, WaveformFit) else found.dropped:
        typer.echo(sentence)
    rest = _print_tables(found)
    for source in found.sources:
        if source.status != "ok":
            typer.echo(f"{source.name}: {source.failure}")
    typer.echo("")
    for sentence in rest:
        typer.echo(sentence)
    if result.folder is not None:
        _print_places(result, result.folder)
    if written is not None:
        typer.echo(f"Report: {written}")


def _print_tables(found: BouncesFit | WaveformFit) -> tuple[str, ...]:
    """Prints the tables of a kind of fit; returns the sentences that are still to be printed."""
    if isinstance(found, WaveformFit):
        _print_waves(found)
        return found.sentences
    if not found.is_tuned:
        _print_choice(found)
        _print_engines(found)
        return found.sentences
    rest = found.sentences
    if any(source.numbers for source in found.sources):
        typer.echo(rest[0])
        rest = rest[1:]
    _print_tuned(found)
    _print_choice(found)
    return rest


def _print_places(result: Run, folder: Path) -> None:
    """Where the fit is stored, and how it is used."""
    found, place = fits.record(result), shlex.quote(str(folder / "fit.json"))
    able = [str(source.name) for source in found.sources if source.status == "ok"]
    reusable = isinstance(found, BouncesFit) and able
    reuse = f"; reuse it with --contact {place}" if reusable else ""
    typer.echo(f"Stored in {folder}{reuse}")
    if reusable and found.contact == TUNED:
        name = result.record.scenario
        export = f"simcompare export {shlex.quote(str(result.record.scenario_asked))} --fit {place}"
        typer.echo(f"All settings to type in: {export} --contact-values")
        for writer in [one for one in able if _has_scripts(one)][:1]:
            script = f"--format script --engine {writer} -o {name}_{writer}.py"
            typer.echo(f"As a script that needs no simcompare: {export} {script}")


def _has_scripts(engine: str) -> bool:
    """Whether scenes of an engine can be written as scripts."""
    backend = engines.get(engine) if engine in engines.names() else None
    return bool(getattr(backend, "script_module", ""))


def _print_waves(found: WaveformFit) -> None:
    """Parameters and what engines show with them, and how well they predict what was held out."""
    closed, names = found.closed_form, found.closed_form.names
    held = found.holdout.streams
    lead = found.probes[0]
    made = console.Rows(
        "engine", "contact", *names, *(f"rms {lead} {row.stream}" for row in held),
        "simulations", "seconds",
    )  # fmt: skip
    for source in found.sources:
        if source.status != "ok":
            made.add_row(source.name, source.contact, source.status)
            continue
        rms_of = {row.source: row.rms[lead] for row in source.holdout}
        made.add_row(
            f"{source.name} {source.version or ''}",
            source.contact,
            *_cells(source.parameters, names),
            *(f"{rms_of[row.stream]:.3g}" if row.stream in rms_of else "" for row in held),
            str(source.simulations), f"{source.wall_s:.2f}",
        )  # fmt: skip
    made.add_row("closed form", "", *_cells(closed.parameters, names),
                 *(f"{row.rms[lead]:.3g}" for row in held), "", "")  # fmt: skip
    console.show_table(made)
    _print_holdout(held)


def _cells(parameters: Mapping[str, WaveParameter], names: Sequence[str]) -> list[str]:
    return [notation.number(parameters[name].value, parameters[name].u) for name in names]


def _print_holdout(held: Sequence[HeldOutSegment]) -> None:
    """E_n of each value of each stream, engine by engine."""
    names = list(dict.fromkeys(name for row in held for name in row.engines))
    if not names:
        return
    made = console.Rows("held out", "value", "measured", *(f"E_n {name}" for name in names))
    for row in held:
        for i, value in enumerate(row.values):
            found = [row.engines[n].values[i:] for n in names if n in row.engines]
            scores = [own[0].e_n if own else None for own in found]
            made.add_row(
                row.stream, value.measure,
                notation.number(value.measured, value.u_data),
                *("–" if score is None else f"{score:+.2f}" for score in scores),
            )  # fmt: skip
    console.show_table(made)


def _print_choice(found: BouncesFit) -> None:
    criterion = found.choice.criterion
    made = console.Rows("closed form", "unknowns", "χ²", criterion, "BIC", "weight", "restitution")
    for row in found.choice.candidates:
        e = row.parameters.get("restitution", Value(None, None))
        value = row.score(criterion)
        score = "–" if value is None else f"{value:.1f}"
        made.add_row(
            row.text, f"{row.unknowns:.1f}", f"{row.chi2:.1f}", score, f"{row.bic:.1f}",
            f"{row.weight:.2f}", notation.number(e.value, e.u),
        )  # fmt: skip
    console.show_table(made)


def _print_tuned(found: BouncesFit) -> None:
    """The numbers to type in, and what each engine does with them in its plain loop."""
    step_ms = 1e3 * found.valid.engine_step_s
    made = console.Rows(
        "engine", f"type in, step {step_ms:.4g} ms", "first restitution", "scatter",
        "mean restitution", "depth [mm]", "contact [ms]", "late [ms]", "seconds",
    )  # fmt: skip
    for source in found.sources:
        name = f"{source.name} {source.version or ''}"
        if source.status != "ok":
            made.add_row(name, source.status)
            continue
        first, last = source.impacts[0], source.impacts[-1]
        mean, contact = source.effective["restitution"], source.contact_of_first_impact
        made.add_row(
            name,
            "\n".join(
                f"{row.name} = {notation.number(row.value, row.u or None)} {row.unit}"
                .removesuffix(" 1") for row in source.numbers
            ),
            notation.number(first.restitution, first.u_phase), f"{first.scatter:.2g}",
            notation.number(mean.value, mean.u),
            _milli(contact.penetration_m), _milli(contact.contact_s),
            f"{1e3 * last.late_s:.3g} ({last.number})", f"{source.wall_s:.2f}",
        )  # fmt: skip
    goal, all_of_them = found.tuned_to, found.tuned_mean
    assert goal is not None
    made.add_row(
        "closed form", "", notation.number(goal.restitution, goal.u), "",
        "" if all_of_them is None else f"{all_of_them:.6g}", "", "", "", "",
    )  # fmt: skip
    console.show_table(made)
    typer.echo(
        "scatter: standard deviation over the phases of the step. late: of the impact in brackets,"
        " against the closed form."
    )


def _milli(value: float | None) -> str:
    return "–" if value is None else f"{1e3 * value:.3g}"


def _print_engines(found: BouncesFit) -> None:
    names = list(dict.fromkeys(name for source in found.sources for name in source.parameters))
    made = console.Rows(
        "engine", "contact", *names, "effective restitution", "simulations", "seconds"
    )
    closed = found.closed_form.parameters
    for source in found.sources:
        if source.status != "ok":
            made.add_row(source.name, source.contact, *[""] * len(names), source.status)
            continue
        rows = [source.parameters[name] for name in names]
        effective = source.effective["restitution"]
        made.add_row(
            f"{source.name} {source.version or ''}", source.contact,
            *(notation.number(row.value, row.u) for row in rows),
            notation.number(effective.value, effective.u),
            str(source.simulations), f"{source.wall_s:.2f}",
        )  # fmt: skip
    none = Value(None, None)
    cells = [notation.number(one.value, one.u) for one in (closed.get(n, none) for n in names)]
    made.add_row("closed form", "", *cells, "", "", "")
    console.show_table(made)
