"""The verb ``import``: a hardware log becomes a recording, which is stored."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from simcompare.arguments import checked
from simcompare.errors import InputError
from simcompare.hardware import mapping as mappings
from simcompare.hardware import reading_process
from simcompare.model import recording_store
from simcompare.model.recording import Clock, Event, Provenance, Recording


@checked
def import_log(
    log: str | Path,
    *,
    kind: str | None = None,
    mapping: str | Path | None = None,
    strict: bool = False,
    assume_units: bool = False,
    out: str | Path | None = None,
) -> Recording:
    """Reads a log of a real device.

    ::

        recording = simcompare.import_log("drop.csv", out="recordings/drop")
        recording.streams  # what was measured
        simcompare.fit("ball", recordings=["recordings/drop"])

    Args:
        log: file or folder.
        kind: format, recognised by content where ``None``.
        mapping: YAML file that says what the log cannot.
        strict: refuse whatever is not whole, instead of repairing what is safe to repair.
        assume_units: replace a unit that contradicts physics by the one that fits, and record it.
        out: folder in which the recording is stored; it is not stored where ``None``.

    Returns:
        The recording, with everything that was noticed or changed in its provenance.

    Raises:
        InputError: every fault of the log or the mapping file, with rows and columns.
        EngineMissing: the package that reads the format is not installed.
        OutputError: the recording cannot be stored.
    """
    columns = mappings.NOTHING if mapping is None else mappings.read(Path(mapping))
    try:
        recording = reading_process.read(
            Path(log), columns, kind=kind, strict=strict, assume_units=assume_units
        )
    except InputError as error:
        raise (_told_as_table(error, Path(log)) if mapping is None else error) from None
    if out is not None:
        recording_store.save(recording, Path(out))
    return recording


def _told_as_table(error: InputError, log: Path) -> InputError:
    """The same error, which says for which scenario a log is a table of results, where it is."""
    from simcompare.validation.tabled import tables

    names = tables.fitting(log)
    if not names:
        return error
    command = f"simcompare validate {names[0]} --recording {shlex.quote(str(log))}"
    *others, last = error.faults
    return InputError(error.where, [*others, f"{last}. As a table of results: {command}"])


@dataclass(frozen=True)
class StreamFacts:
    """A stream without its samples.

    Attributes:
        samples: how many there are.
        duration_s: time of the last one [s].
        clock: where the times come from.
        gaps: how many places lack samples.
        channels: name -> unit.
    """

    samples: int
    duration_s: float
    clock: Clock
    gaps: int
    channels: Mapping[str, str]


@dataclass(frozen=True)
class RecordingFacts:
    """A recording without its samples.

    Attributes:
        recording: the folder in which it is stored.
        provenance: where it comes from, and all that was done to it.
        events: instants that were found in it.
        streams: name -> stream.
    """

    recording: str
    provenance: Provenance
    events: tuple[Event, ...]
    streams: Mapping[str, StreamFacts]


def facts(recording: Recording, folder: Path) -> RecordingFacts:
    """What a recording holds, without its samples."""
    streams = {
        name: StreamFacts(
            len(stream.time_s), float(stream.time_s[-1]) if len(stream.time_s) else 0.0,
            stream.clock, len(stream.gaps), {c: one.unit for c, one in stream.channels.items()},
        )
        for name, stream in recording.streams.items()
    }  # fmt: skip
    return RecordingFacts(str(folder), recording.provenance, recording.events, streams)
