"""Lines of a mapping file, for messages: they are valid when they are pasted."""

from __future__ import annotations

import json
import re


def quoted(text: str) -> str:
    """A text as YAML reads it back; plain where it can only be a text."""
    simple = re.fullmatch(r"[A-Za-z][\w /^*.·²°µ-]*[\w²°µ]|[A-Za-z]", text)
    reserved = text.lower() in ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
    return text if simple and not reserved else json.dumps(text, ensure_ascii=False)


def unit_text(text: str) -> str:
    """A unit as a mapping file takes it: that of a plain number may stand as a number."""
    return text if text == "1" else quoted(text)


def time_line(name: str, unit: str) -> str:
    """The line that makes a column the time."""
    return f"time: {{column: {quoted(name)}{f', unit: {unit_text(unit)}' if unit else ''}}}"


def channels_line(*entries: str) -> str:
    """The line that says something of several channels."""
    return f"channels: {{{', '.join(entries)}}}"
