"""The verb ``import``: a hardware log becomes a recording, which is stored."""

from __future__ import annotations

from pathlib import Path

from simcompare.hardware import importing
from simcompare.hardware import mapping as mappings
from simcompare.model import recording_store
from simcompare.model.recording import Recording


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
    recording = importing.read(
        Path(log), columns, kind=kind, strict=strict, assume_units=assume_units
    )
    if out is not None:
        recording_store.save(recording, Path(out))
    return recording
