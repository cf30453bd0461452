"""Faults of a job as a page tells them: no places of this machine, no advice for a terminal."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from simcompare.errors import InputError, SimcompareError
from simcompare.lab.refusals import say
from simcompare.lab.translation import translated

#: what only a command line understands, and where a part of a fault ends
_COMMAND = re.compile(r"\bsimcompare [a-z]|(?<!\w)--[a-z]|SIMCOMPARE_|\bmap\.yaml|rate_Hz")
#: files as the lab calls them, of which a student knows nothing
_STORED = re.compile(r"(source|track)\.\w+")
_END = re.compile(r"(?<=[;.]) ")
#: faults that are told; whoever made so many made most of them the same way
_TOLD = 20


def told(error: SimcompareError, request: Mapping[str, Any]) -> tuple[str, ...]:
    """The sentences of an error.

    Args:
        error: why a job failed.
        request: what was asked; its "folder" and "path" are places of this machine, and "name" is
            what a student calls the file.
    """
    if not isinstance(error, InputError):
        return (_without_places(str(error), request).strip(),)
    language, folder = str(request.get("language", "en")), str(request.get("folder", "\0"))
    is_ours = folder in error.where or ("path" not in request and _STORED.fullmatch(error.where))
    where = "" if is_ours or _COMMAND.search(error.where) else f"{error.where}: "
    given = list(error.faults[:_TOLD])
    plain = [for_page(fault) for fault in given]
    faults = [f"{where}{translated(fault, language)}" for fault in plain]
    if plain != given and "path" in request:
        faults.append(say(language, "send_another"))
    if len(error.faults) > _TOLD:
        faults.append(translated(f"… and {len(error.faults) - _TOLD} more", language))
    return tuple(_without_places(fault, request) for fault in faults)


def for_page(text: str) -> str:
    """A fault without its parts that only a command line understands, if anything is left then."""
    parts = [part for part in _END.split(text) if not _COMMAND.search(part)]
    return " ".join(parts).rstrip(";") or text


def _without_places(text: str, request: Mapping[str, Any]) -> str:
    path, folder = str(request.get("path", "\0")), str(request.get("folder", "\0"))
    name = str(request.get("name") or Path(path).name)
    for place, shown in ((path, name), (Path(path).name, name), (folder, "")):
        text = text.replace(place, shown)
    return text
