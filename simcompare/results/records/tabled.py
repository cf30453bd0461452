"""What table.json says of a table of results that was held against simulations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from simcompare.results.records.answered import Answered
from simcompare.running.jobs import OK, exit_code_of

#: a source that is mathematics
CLOSED_FORM = "closed form"
#: how a source stands to the table
AGREES, DISAGREES, OPEN = "agrees", "disagrees", "open"


@dataclass(frozen=True)
class TabledColumn:
    """What a column of the table was taken for.

    Attributes:
        heading: as it stands in the file.
        role: parameter, measured, uncertainty, count or left out.
        name: parameter or result, empty for none.
        note: how it was read, or why it was left out.
    """

    heading: str
    role: str
    name: str = ""
    note: str = ""


@dataclass(frozen=True)
class Given:
    """A parameter that no column says.

    Attributes:
        name: of the parameter.
        value: that was taken, SI.
        unit: SI unit.
        u: its standard uncertainty, ``None`` for exact.
        reason: why so.
    """

    name: str
    value: float
    unit: str
    u: float | None
    reason: str


@dataclass(frozen=True)
class Point:
    """One experiment and one result of it.

    Attributes:
        lines: of the file.
        set: parameter -> value that the rows say, SI.
        measured: mean of what was measured, SI.
        repeats: values in that mean.
        u_measured: its standard uncertainty.
        u_input: standard uncertainty of the simulated value by what was set and assumed; ``None``
            where it is not known.
        values: source -> its value; ``None`` where it has none.
    """

    lines: tuple[int, ...]
    set: Mapping[str, float]
    measured: float
    repeats: int
    u_measured: float
    u_input: float | None
    values: Mapping[str, float | None]

    @property
    def u(self) -> float:
        """Standard uncertainty of the difference between measurement and simulation."""
        return float((self.u_measured**2 + (self.u_input or 0.0) ** 2) ** 0.5)

    def residual(self, source: str) -> float | None:
        """Measured less simulated, in units of u."""
        value = self.values.get(source)
        return None if value is None else (self.measured - value) / self.u


@dataclass(frozen=True)
class Verdict:
    """How one source stands to one result of the table.

    Attributes:
        source: "closed form" or the engine's name.
        status: "ok", "unsupported", "missing" or "failed".
        reason: one sentence where the status is not "ok".
        version: the engine's version.
        verdict: "agrees", "disagrees", or "open" where it gave no value.
        points: experiments in which it gave a value.
        within: of these, how many are within 2 u.
        ratio: measured over simulated, over all experiments.
        expanded: expanded uncertainty of the ratio (95 %).
        scatter: root mean square of the residuals about that ratio, in units of u.
    """

    source: str
    status: str = OK
    reason: str | None = None
    version: str | None = None
    verdict: str = OPEN
    points: int = 0
    within: int = 0
    ratio: float | None = None
    expanded: float | None = None
    scatter: float | None = None


@dataclass(frozen=True)
class Told:
    """What the table itself says of a parameter, by the closed form.

    Attributes:
        name: of the parameter.
        unit: its SI unit.
        value: that fits all rows best.
        expanded: its expanded uncertainty (95 %).
        offset: name of the column that may be off by the same amount in all rows, empty for none.
        offset_value: by how much it is off, in its SI unit.
        offset_expanded: expanded uncertainty of that (95 %).
        scatter: root mean square of what is left, in units of u.
    """

    name: str
    unit: str
    value: float
    expanded: float
    offset: str = ""
    offset_value: float | None = None
    offset_expanded: float | None = None
    scatter: float = 0.0


@dataclass(frozen=True)
class TabledResult:
    """One measured result of the table against all sources.

    Attributes:
        name: of the result.
        unit: its SI unit.
        over: parameter over which it is drawn.
        basis: where its uncertainty comes from: stated, repeats, or scatter of the rows.
        degrees_of_freedom: behind that, ``None`` for many.
        points: the experiments.
        verdicts: the closed form first.
        told: what the table says of a parameter; without and with an offset.
        timed: how many times as long as simulated it seems to be, where one time may be of many.
        inputs: parameter -> by what part of the result its u changes the simulated value.
        curve: of the closed form, as pairs of parameter and result; empty where more than one
            parameter differs between rows.
    """

    name: str
    unit: str
    over: str
    basis: str
    degrees_of_freedom: float | None
    points: tuple[Point, ...]
    verdicts: tuple[Verdict, ...]
    told: tuple[Told, ...] = ()
    timed: int | None = None
    inputs: Mapping[str, float] = field(default_factory=dict)
    curve: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, kw_only=True)
class TableValidation(Answered):
    """A table of results against simulations.

    Attributes:
        scenario: its name.
        recording: the file, as the user called it.
        sha256: of the file.
        columns: what each of its columns was taken for.
        given: parameters that no column says, as far as they matter or are assumed.
        results: what was measured, against all sources.
        remarks: what was noticed while the table was read.
        beyond: why the closed form does not hold.
        contact: contact level of the engines.
        command: that makes it again.
    """

    scenario: str
    recording: str
    sha256: str
    columns: tuple[TabledColumn, ...]
    given: tuple[Given, ...]
    results: tuple[TabledResult, ...]
    remarks: tuple[str, ...] = ()
    beyond: tuple[str, ...] = ()
    contact: str
    command: str

    @property
    def exit_code(self) -> int:
        """0 fine, 3 an engine is broken, or one that was named is missing."""
        statuses = [one.status for result in self.results for one in result.verdicts
                    if one.source != CLOSED_FORM]  # fmt: skip
        return exit_code_of(statuses, self.engines_asked, out_of_reach=True)
