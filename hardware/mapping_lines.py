"""Lines of a mapping file, for messages: they are valid when they are pasted."""

from __future__ import annotations

import json
import re


def quoted(text: str) -> str:
    """A text as YAML reads it back; plain where it can only be a text, or the unit 1."""
    simple = re.fullmatch(r"[A-Za-z][\w /^*.·²°µ-]*[\w²°µ]|1|[A-Za-z]", text)
    reserved = text.lower() in ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
    return text if simple and not reserved else json.dumps(text, ensure_ascii=False)


def time_line(name: str, unit: str) -> str:
    """The line that makes a column the time."""
    return f"time: {{column: {quoted(name)}{f', unit: {quoted(unit)}' if unit else ''}}}"


def channels_line(*entries: str) -> str:
    """The line that says something of several channels."""
    return f"channels: {{{', '.join(entries)}}}"
