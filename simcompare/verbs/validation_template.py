"""The mapping file of a validation, to be filled in: ``validate --template``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware import reading_process
from simcompare.hardware.mapping import UNKNOWN
from simcompare.inference import plan_template, sources
from simcompare.inference.plan_template import Candidate
from simcompare.model.recording import Recording, Stream
from simcompare.scenarios import catalogue


def template(
    scenario: str, *, recording: str | None = None, mapping: str | Path | None = None
) -> str:
    """A mapping file for a validation: a line for every probe, and every key that there is.

    Args:
        scenario: name, folder or file.
        recording: a public data set, the folder of an imported recording, or a log; its channels
            stand beside what they may be. Of a log without units, its columns are part of the file.
        mapping: mapping file of the log, which stands first in the new one.

    Raises:
        SimcompareError: faults of the arguments or of a file.
    """
    file = catalogue.load(scenario)
    if mapping is not None and recording is None:
        raise InputError("--map", [f"{mapping} is of no log; name it with --recording"])
    head = f"# How {file.name} is held against {recording or 'a recording'}: replace every"
    head += f" {UNKNOWN}, delete what was not measured.\n"
    reading, channels = "", list[Candidate]()
    if recording is not None:
        reading, channels = _read(recording, mapping)
    return head + reading + plan_template.of_scenario(file, channels)


def _read(recording: str, mapping: str | Path | None) -> tuple[str, list[Candidate]]:
    """How the log is read, as text, and its channels."""
    reading = "" if mapping is None else _without_plan(Path(mapping))
    try:
        found = sources.find(recording, mapping=mapping).recording
    except InputError:
        # a log that does not say all: what is missing is asked for in the same file
        if mapping is not None or not Path(recording).exists():
            raise
        text = reading_process.template(recording)
        return text, list(_columns(yaml.safe_load(text)))
    return reading, _channels(found)


def _without_plan(path: Path) -> str:
    """A mapping file up to its own ``validate:``."""
    lines = path.read_text(encoding="utf-8-sig").splitlines(keepends=True)
    own = [i for i, line in enumerate(lines) if line.startswith("validate:")]
    text = "".join(lines[: own[0]] if own else lines)
    return text if not text or text.endswith("\n") else f"{text}\n"


def _channels(recording: Recording) -> list[Candidate]:
    found = {
        name: Candidate(name, channel.unit, _step_s(stream))
        for stream in recording.streams.values()
        for name, channel in stream.channels.items()
    }
    return list(found.values())


def _step_s(stream: Stream) -> float | None:
    steps = np.diff(stream.time_s)
    return float(np.median(steps)) if len(steps) else None


def _columns(tree: dict[str, Any]) -> Iterator[Candidate]:
    """Channels of a template for a log, whose units may be open."""
    for name, channel in (tree.get("channels") or {}).items():
        unit = channel["unit"]
        yield Candidate(name, unit if unit == UNKNOWN else units.si_of(unit, name)[2])
