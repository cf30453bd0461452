"""Reports from runs: HTML, PDF, Markdown, and the figures alone for a paper."""

from __future__ import annotations

import functools
import re
import unicodedata
from collections.abc import Sequence
from pathlib import Path

import jinja2
from markupsafe import Markup, escape

from simcompare.errors import InputError, UnknownName
from simcompare.reports import pages
from simcompare.reports.render import film, matplotlib_, numbers, output, plotly_, replay_page
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Block
from simcompare.reports.render.replays import Replay
from simcompare.reports.render.styles import style_of
from simcompare.reports.render.tables import printable
from simcompare.reports.run import runs as of_runs
from simcompare.reports.run import settings
from simcompare.reports.sections import of_run
from simcompare.results.records.run import Record, RunRecord
from simcompare.results.run import Run

_TEMPLATES = Path(__file__).parent / "templates"
#: signs that begin a verdict, and what it is; no verdict is told by its colour alone
_MARKS = {"✓": "pass", "✗": "fail", "·": "info", "≠": "unset", "⇄": "translated"}


def write_html(runs: Sequence[Run], path: Path) -> Path:
    """Writes one HTML file that needs no network and nothing beside it.

    Raises:
        OutputError: it cannot be written, or plotly's script is not installed.
    """
    return write_html_of(blocks_of(runs), path)


def write_html_of(blocks: Sequence[Block], path: Path) -> Path:
    """The same for what is shown of something, which need not be a run."""
    return output.write(
        Path(path), html_of(blocks).encode("utf-8", "backslashreplace"), output.MARKS["html"]
    )


def html_of(blocks: Sequence[Block]) -> str:
    """A page of such blocks that loads nothing.

    Raises:
        OutputError: plotly's script is not installed.
    """
    page = _environment().get_template("report.html")
    css, js, replay_js = (
        Markup((_TEMPLATES / name).read_text(encoding="utf-8"))
        for name in ("report.css", "report.js", "replay.js")
    )
    plotly = Markup(plotly_.script())
    return page.render(blocks=blocks, css=css, js=js, replay_js=replay_js, plotly=plotly)


def write_figures(runs: Sequence[Run], folder: Path, format: str) -> list[Path]:
    """Writes every figure of the runs as a file of its own, for a paper.

    Args:
        runs: one or several runs.
        folder: where to; made where it does not exist.
        format: "pdf" and "svg" (vectors) or "png" (300 dpi).

    Raises:
        UnknownName: another format.
        OutputError: a file cannot be written.
    """
    return write_figures_of(blocks_of(runs), folder, format)


def write_figures_of(blocks: Sequence[Block], folder: Path, format: str) -> list[Path]:
    """The same for what is shown of something, which need not be a run."""
    if format not in matplotlib_.FORMATS:
        raise UnknownName("figure format", format, matplotlib_.FORMATS)
    written = []
    for block in blocks:
        # with several of them their number keeps the names apart
        prefix = f"{block.anchor}-" if len(blocks) > 1 else ""
        for figure in block.figures:
            stem = re.sub(r"[^\w.-]+", "_", f"{prefix}{block.name}-{figure.name}")
            content = matplotlib_.rendered(figure, format)
            path = Path(folder) / f"{stem}.{format}"
            written.append(output.write(path, content, output.MARKS[format]))
    return written


def write_pdf(runs: Sequence[Run], path: Path) -> Path:
    """Writes one PDF with all that the HTML file holds, what is folded there as well.

    Raises:
        OutputError: it cannot be written.
    """
    return output.write(Path(path), pages.rendered(blocks_of(runs)), output.MARKS["pdf"])


def write_film(run: Run, path: Path, format: str, contact: str | None, told: film.Told) -> Path:
    """Writes the replay of a run as a film.

    Args:
        run: what is shown.
        path: file to write.
        format: "gif" or "mp4".
        contact: level that is shown; that which a report shows first where ``None``.
        told: progress.

    Raises:
        InputError: no source tells where a body is; no ffmpeg for mp4.
        UnknownName: the run has no such contact level.
        OutputError: it cannot be written.
    """
    every = (one for block in blocks_of([run]) for part in block.parts for one in part.every_replay)
    replay = next(every, None)
    if replay is None:
        raise InputError(f"--format {format}", [f"nothing moves in {_title(run.record)}"])
    named = {mode: of_runs.mode_title(mode) for mode in of_runs.modes(run)}
    levels = {mode: words for mode, words in named.items() if words in replay.levels}
    if contact is not None and contact not in levels:
        raise UnknownName("contact level", contact, [*levels])
    level = next(iter(replay.levels), "") if contact is None else levels[contact]
    return film.write(replay, level, path, format, told)


def write_markdown(runs: Sequence[Run], path: Path) -> Path:
    """Writes a short report of tables that reads well as plain text too.

    Raises:
        OutputError: it cannot be written.
    """
    text = _environment().get_template("report.md").render(blocks=blocks_of(runs))
    mark = output.MARKS["md"]
    return output.write(
        Path(path), text.encode("utf-8", "backslashreplace") + b"\n" + mark + b"\n", mark
    )


def blocks_of(runs: Sequence[Run]) -> list[Block]:
    """What a report shows of each run."""
    return [_block(f"run{number}", run) for number, run in enumerate(runs, start=1)]


def _block(anchor: str, run: Run) -> Block:
    record = run.record
    parts = (section(run) for section in of_run(record))
    measured = record.against if isinstance(record, RunRecord) else None
    against = f"against {measured.file}" if measured is not None else None
    return Block(
        anchor,
        record.scenario,
        _title(record),
        record.question,
        origin=", ".join(filter(None, (record.preset, against, record.created))),
        version=record.software.simcompare,
        parts=tuple(part for part in parts if part is not None),
        settings=settings.settings(run),
        made_with=settings.made_with(run),
    )


def _title(record: Record) -> str:
    """What kind of report it is, of what; of fits and validations with the recording."""
    asked = getattr(record, "recording_asked", ())
    names = [printable(Path(name).name) for name in ((asked,) if isinstance(asked, str) else asked)]
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    if not names or not names[0]:
        return f"{record.title} – {record.kind}"
    if record.kind == "fit":
        return f"Fit of {record.title} to {names[0]}{more}"
    return f"{record.title} against {names[0]}{more} – {record.kind}"


@functools.cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        autoescape=jinja2.select_autoescape(["html"]),
        finalize=_visible,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.policies["urlize.rel"] = None  # the page is a file, which no site opened
    environment.filters.update(
        figure_json=_figure_json,
        replay_json=_replay_json,
        cell=_cell,
        style=style_of,
        tied=numbers.tied,
        marked=_marked,
    )
    return environment


def _visible(value: object) -> object:
    """A text of somebody else's without characters that steer, turn or hide, or are none."""
    if not isinstance(value, str) or isinstance(value, Markup) or value.isprintable():
        return value
    return "".join("\ufffd" if _is_hidden(one) else one for one in value)


def _is_hidden(one: str) -> bool:
    return one not in "\n\t" and unicodedata.category(one) in ("Cc", "Cf", "Cs")


def _figure_json(figure: Figure) -> Markup:
    return Markup(plotly_.embedded(figure))  # it has escaped itself


def _replay_json(replay: Replay) -> Markup:
    return Markup(replay_page.embedded(replay))  # it has escaped itself


def _marked(text: str) -> Markup:
    """Text with every verdict in its colour."""
    marked = re.sub(
        r"(^·|[✓✗≠⇄])[^✓✗≠⇄,]*",  # a dot inside of a text is a product
        lambda found: f'<span class="{_MARKS[found[1]]}">{found[0]}</span>',
        escape(_visible(text)),
    )
    return Markup(marked)


def _cell(text: str) -> str:
    """Text that neither ends a cell of a Markdown table nor is read as markup."""
    return re.sub(r"([\\`*_\[\]<>|])", r"\\\1", " ".join(text.split()))
