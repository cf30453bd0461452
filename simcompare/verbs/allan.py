"""The verb ``allan``: the noise of a sensor at rest, told from how it averages out."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from simcompare import units
from simcompare.arguments import checked
from simcompare.errors import InputError
from simcompare.hardware.sensors import data_sheet, noise_units
from simcompare.inference import sources
from simcompare.model.recording import Recording
from simcompare.model.trajectory import Array
from simcompare.results.records.allan import AxisNoise, NoiseTerm
from simcompare.results.run_record import now, software
from simcompare.statistics import allan as deviation
from simcompare.statistics import allan_bounds, allan_terms, noise_audit
from simcompare.verbs import allan_audit, allan_sheets, allan_stretch
from simcompare.verbs.allan_shown import Allan
from simcompare.verbs.allan_stretch import Stretch


@checked
def allan(
    record: Any,  # noqa: ANN401  (a name, a path, a Recording, or whatever NumPy reads as numbers)
    *,
    channel: str | Sequence[str] | None = None,
    start: str | float | None = None,
    until: str | float | None = None,
    mapping: str | Path | None = None,
    rate_Hz: float | None = None,
    unit: str = "1",
    sheet: str | Path | None = None,
    audit: bool = False,
    again: Any = None,  # noqa: ANN401
    again_rate_Hz: float | None = None,
    claims: Mapping[str, float] | None = None,
) -> Allan:
    """How noisy a sensor is at rest: Allan deviation, noise types, and a number for each noise.

    ::

        found = simcompare.allan("imu_broad_translation", sheet="mpu6050")
        found.table()
        found.plot()
        simcompare.allan(values, rate_Hz=100)   # any signal, a column for each axis

    Args:
        record: name of a published recording, a stored recording, a log, a ``Recording``, or
            readings (n,) or (n, axes).
        channel: names, or how they begin, such as "acc"; all of accelerometer and gyroscope if
            left out.
        start: where the stretch begins, such as "5s"; if both are left out, the longest still
            stretch, or all of it for an audit.
        until: where it ends.
        mapping: YAML file that says what a log cannot.
        rate_Hz: readings in a second, where readings are given.
        unit: their SI unit, such as "rad/s".
        sheet: data sheet to hold the noise against, such as "mpu6050".
        audit: also test whether it can be the noise of a sensor, and of which; for streams of
            simulators.
        again: a second run of the same simulator, for the audit; what ``record`` may be.
        again_rate_Hz: readings in a second of the second run; as ``rate_Hz`` if left out.
        claims: what the simulator says that it adds, in SI: "density" (one-sided), "bias" and
            "bias_time".

    Raises:
        UnknownName: no such recording, channel or data sheet.
        InputError: a stretch that is too short or uneven, or readings without a rate.
    """
    if audit and start is None and until is None:
        start = 0.0  # a simulated sensor is at rest because its user says so
    stretch, source, title = taken(record, channel, start, until, mapping, rate_Hz, unit)
    held = None if sheet is None else data_sheet.load(sheet)
    allan_audit.checked_claims(claims or {})
    if not audit and (again is not None or claims):
        raise InputError("allan", ["a second run and claims are for an audit; add --audit"])
    stretch, silent = _loud(stretch)
    allan_audit.refuse_claims_of_several(claims or {}, stretch)
    axes = tuple(axis_of(name, stretch) for name in stretch.values)
    second = None
    if again is not None:
        whole = taken(again, channel, 0.0, None, mapping, again_rate_Hz or rate_Hz, unit)[0]
        whole, _ = _loud(whole)
        second = (whole, [axis_of(name, whole) for name in whole.values])
    found = allan_audit.findings(stretch, axes, held, claims or {}, second, silent) if audit else ()
    matches = allan_sheets.matches(axes) if audit else ()
    return Allan(
        created=now(),
        source=source, title=title, rate_Hz=stretch.rate_Hz, start_s=stretch.start_s,
        end_s=stretch.start_s + (stretch.count - 1) / stretch.rate_Hz,
        length_s=stretch.length_s, chosen=stretch.chosen, still_s=stretch.still_s, axes=axes,
        silent=silent,
        against=() if held is None else tuple(allan_sheets.against(axes, held)), audited=audit,
        findings=found, matches=matches, software=software(),
    )  # fmt: skip


def taken(
    record: object, channel: str | Sequence[str] | None, start: str | float | None,
    until: str | float | None, mapping: str | Path | None, rate_Hz: float | None, unit: str,
) -> tuple[Stretch, str, str]:  # fmt: skip
    """The stretch that is asked for, the name of its source, and what it is."""
    start_s = None if start is None else units.to_si(start, "s", "--from")
    end_s = None if until is None else units.to_si(until, "s", "--until")
    names = channel.split(",") if isinstance(channel, str) else channel
    chosen = [name.strip() for name in names or () if name.strip()]
    if isinstance(record, str | Path):
        found = sources.find(str(record), mapping=mapping)
        stretch = allan_stretch.of_recording(found.recording, chosen, start_s, end_s)
        return stretch, str(record), found.about.get("title", str(record))
    if isinstance(record, Recording):
        stretch = allan_stretch.of_recording(record, chosen, start_s, end_s)
        return stretch, record.provenance.file, record.provenance.file
    values = _columns(record, rate_Hz)
    time_s = np.arange(len(next(iter(values.values())))) / (rate_Hz or 1.0)
    of = dict.fromkeys(values, unit)
    whole = (start_s, end_s) if (start_s, end_s) != (None, None) else (0.0, None)
    stretch = allan_stretch.of_values(time_s, values, of, (), *whole)
    return stretch, "values", "Readings"


def _loud(stretch: Stretch) -> tuple[Stretch, tuple[str, ...]]:
    """The channels that have any noise, and names of the others.

    Raises:
        InputError: none has.
    """
    loud = {name: values for name, values in stretch.values.items() if np.ptp(values) > 0}
    silent = tuple(name for name in stretch.values if name not in loud)
    if not loud:
        text = f"all {stretch.count} readings of {', '.join(silent)} are the same"
        raise InputError("allan", [f"{text}; there is no noise at all"])
    return replace(stretch, values=loud), silent


def _columns(record: object, rate_Hz: float | None) -> Mapping[str, Array]:
    """Readings by name."""
    if rate_Hz is None or not rate_Hz > 0:
        raise InputError("allan", ["readings need their rate, such as rate_Hz=100"])
    try:
        if isinstance(record, Mapping):
            return {str(name): np.asarray(one, dtype=float) for name, one in record.items()}
        table = np.asarray(record, dtype=float)
    except (TypeError, ValueError):
        kind = type(record).__name__
        raise InputError("allan", [f"{kind} is no recording and holds no numbers"]) from None
    if table.ndim not in (1, 2) or not table.size:
        raise InputError("allan", [f"readings of shape {table.shape}; expected (n,) or (n, axes)"])
    if table.ndim == 1:
        return {"readings": table}
    letters = "xyz" if table.shape[1] <= 3 else map(str, range(1, table.shape[1] + 1))
    return {name: table[:, i] for i, name in zip(range(table.shape[1]), letters, strict=False)}


def axis_of(name: str, stretch: Stretch) -> AxisNoise:
    """Everything that is told of one channel."""
    values, unit, rate_Hz = stretch.values[name], stretch.units[name], stretch.rate_Hz
    found = deviation.deviations(values, rate_Hz)
    bounds = allan_bounds.bounds(found, deviation.phase_of(values, 1 / rate_Hz))
    terms = allan_terms.fitted(values, rate_Hz)
    best = int(np.argmin(found.values))
    return AxisNoise(
        channel=name, unit=unit, mean=float(values.mean()), samples=len(values),
        tau_s=_row(found.tau_s), deviation=_row(found.values), low=_row(bounds.low),
        high=_row(bounds.high),
        noise_types=tuple(allan_bounds.NOISE_TYPES[a] for a in bounds.alpha.tolist()),
        terms=tuple(_term(term, unit) for term in terms.terms),
        gauss_markov=terms.gauss_markov, fitted=_row(terms.total(found.tau_s)),
        chi_squared=terms.chi_squared, degrees_of_freedom=terms.degrees_of_freedom,
        from_s=terms.from_s, widened=terms.widened, best_tau_s=float(found.tau_s[best]),
        best=float(found.values[best]), still_falls=best >= len(found.values) - 2,
        rounding=noise_audit.smallest_step(values) / math.sqrt(6 * rate_Hz),
    )  # fmt: skip


def _row(values: Array) -> tuple[float, ...]:
    return tuple(values.tolist())


def _term(term: allan_terms.Term, unit: str) -> NoiseTerm:
    sheet_unit, size = noise_units.of_sheets(term.name, unit)
    value, u = (term.value, term.u) if term.seen else (None, None)
    return NoiseTerm(
        term.name, value, u, term.limit, noise_units.si(term.name, unit), sheet_unit, size
    )  # fmt: skip
