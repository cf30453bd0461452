"""Where a recording and its plan come from: a public data set, a stored recording, or a log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from simcompare.errors import exists, unknown_or_missing
from simcompare.hardware import mapping as mappings
from simcompare.hardware import reading_process
from simcompare.hardware.recordings import registry
from simcompare.inference.plan import Entries
from simcompare.model import recording_store
from simcompare.model.estimate_plan import RecordedPlan
from simcompare.model.recording import Recording
from simcompare.model.yaml_file import read_yaml


@dataclass(frozen=True)
class Source:
    """A recording with what is known of it.

    Attributes:
        name: as the user called it.
        recording: the recording.
        plans: entries of ``validate:``, unread.
        about: title, citation, licence and so on of a public data set.
        estimates: entries of ``estimate:``.
    """

    name: str
    recording: Recording
    plans: Entries
    about: Mapping[str, str]
    estimates: tuple[RecordedPlan, ...] = ()


def find(name: str, *, mapping: str | Path | None = None, strict: bool = False) -> Source:
    """Finds and reads a recording.

    Args:
        name: a public data set, the folder of a stored recording, or a log.
        mapping: a mapping file; its ``validate:`` is used for a stored recording as well.
        strict: refuse logs with defects.

    Raises:
        UnknownName: nothing of that name exists.
        InputError: there is no such file, or what is wrong with the files.
    """
    reading = None if mapping is None else mappings.read(Path(mapping))
    plans = Entries((), name)
    if mapping is not None and reading is not None and reading.validate_ is not None:
        plans = Entries(reading.validate_, str(mapping), read_yaml(Path(mapping))[1])
    path = Path(name)
    if name in registry.files() and not recording_store.is_recording(path):
        return _public(name, reading, plans, strict)
    if not exists(path):
        kind = "recording (public data set, stored recording, or log)"
        raise unknown_or_missing(kind, name, registry.files())
    if recording_store.is_recording(path):
        recording = recording_store.load(path)
    else:
        recording = reading_process.read(path, reading or mappings.NOTHING, strict=strict)
    return Source(name, recording, plans, {}, () if reading is None else reading.estimate)


def _public(name: str, reading: mappings.Mapping | None, plans: Entries, strict: bool) -> Source:
    data_set = registry.get(name)
    paths = registry.locate(name)
    reading = reading or mappings.of_tree(dict(data_set.read), f"{name}, read")
    about = {
        "title": data_set.title,
        "text": data_set.text,
        "citation": data_set.citation,
        "licence": data_set.licence,
        "source": f"github.com/{data_set.source.repository} at {data_set.source.commit}",
    }
    recording = reading_process.read(paths[0], reading, strict=strict, about=about)
    plans = plans or Entries(data_set.validation, name)
    return Source(name, recording, plans, about, reading.estimate or data_set.estimate)


def digest(name: str) -> str:
    """SHA-256 of the log behind a recording, to tell whether two names mean the same."""
    return find(name).recording.provenance.sha256
