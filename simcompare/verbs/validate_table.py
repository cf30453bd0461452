"""``validate`` where the recording is a table of results: one experiment in each row."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from simcompare import units
from simcompare.comparison.repeats import sample_step_s
from simcompare.errors import InputError
from simcompare.hardware.recordings.results_table import Opened
from simcompare.results import result_file
from simcompare.results.records.tabled import Given, TabledColumn
from simcompare.results.run_record import now, software
from simcompare.running.runner import Progress
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.validation.tabled import tables
from simcompare.validation.tabled.judged import judged
from simcompare.validation.tabled.meaning import LEFT_OUT, Meaning
from simcompare.validation.tabled.simulated import ClosedForm, Setting, simulate
from simcompare.validation.tabled.tables import Read
from simcompare.validation.tabled.vocabulary import spoken
from simcompare.verbs.request import ValidateRequest
from simcompare.verbs.tabled import Tabled

FILE = "table.json"
#: why a parameter has its value
_OWN = "the scenario's own value, for no column says it"


def validate_table(
    table: Opened,
    file: ScenarioFile,
    request: ValidateRequest,
    engines: Sequence[str],
    *,
    out: Path | None,
    time_limit_s: float,
    progress: Progress | None,
) -> Tabled:
    """Holds every row of a table against every engine.

    Args:
        table: the table.
        file: the scenario.
        request: what was asked.
        engines: their names.
        out: folder for the folder of the results; nothing is stored where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(engine, done, total)``.

    Raises:
        InputError: all that is wrong with the table or the settings.
    """
    said = file.read_settings(request.set or {})
    read = tables.read(table, file, file.resolve())
    _check(request, read, said)
    step_s = None
    setting = Setting(file, {**read.above, **said})
    if request.step is not None:
        values = setting.values(read.found[0].set)
        step_s = sample_step_s(file, values, None, request.step)
    setting = Setting(file, setting.said, step_s)
    form = ClosedForm(setting, read.entries)
    closed = form.of([one.set for one in read.found])
    simulated = simulate(
        setting, read.found, read.entries, engines, contact=request.contact,
        time_limit_s=time_limit_s, progress=progress,
    )  # fmt: skip
    results = tuple(judged(one, read.found, form, closed, simulated) for one in read.entries)
    made = Tabled(
        created=now(), scenario=file.name, title=f"{file.tree['title']}: a table of results",
        question=_question(read), recording=str(request.recording), sha256=read.table.sha256,
        columns=tuple(map(_column, read.columns)), given=tuple(_given(setting, read, form)),
        results=results, remarks=read.table.remarks, beyond=form.beyond(read.found),
        contact=request.contact, engines_asked=request.engine,
        command=shlex.join(request.command()), software=software(),
    )  # fmt: skip
    return made if out is None else result_file.save(made, out, "table", FILE)


def _check(request: ValidateRequest, read: Read, said: Mapping[str, float]) -> None:
    faults = [
        f"{name} stands in a column of the table; leave it out of --set"
        for name in said
        if any(name in one.set for one in read.found)
    ]
    if request.streams:
        faults.append("--streams chooses streams of a log; a table of results has none")
    if faults:
        raise InputError(str(request.recording), faults)


def _question(read: Read) -> str:
    names = " and ".join(spoken(one) for one in read.entries)
    over = ", ".join(dict.fromkeys(
        spoken(one.entry) for one in read.columns
        if one.entry and one.entry.is_parameter and one.role == "parameter"
    ))  # fmt: skip
    verb = "was" if len(read.entries) == 1 else "were"
    return f"Does every engine give the {names} that {verb} measured, over {over}?"


def _column(one: Meaning) -> TabledColumn:
    note = one.note
    if one.count > 1:
        note = f"time of {one.count}, divided by {one.count}"
    elif one.of_total:
        note = "time of many, divided by their number"
    elif one.repeat is not None:
        note = "one of several repeats"
    elif one.limits:
        note = "limits, u = half-width/√3"
    name = "" if one.entry is None or one.role == LEFT_OUT else one.entry.name
    return TabledColumn(one.heading.text, one.role, name, note)


def _given(setting: Setting, read: Read, form: ClosedForm) -> list[Given]:
    """What no column says: what is assumed, what is said, and the scenario's own that matters."""
    row = read.found[0].set
    values, u = setting.values(row), setting.u_of_inputs(read.found[0])
    known = {} if setting.file.uncertainty is None else setting.file.uncertainty.inputs
    reasons = {
        name: f"{_OWN}. {known[name].reason}" if name in known else _OWN
        for name in (form.decisive(read.found[0]) if form.exists else [])
    }
    reasons |= {name: one.reason for name, one in setting.assume.items()
                if name not in setting.said and (one.reason or name in reasons)}  # fmt: skip
    reasons |= dict.fromkeys(setting.said, "as given with --set")
    reasons |= dict.fromkeys(read.above, "as stands above the table")
    return [
        Given(name, values[name], units.unit_of(name), u.get(name), reason)
        for name, reason in reasons.items()
        if name not in row and reason
    ]
