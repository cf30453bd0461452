"""A time in parts, a column for each: date and time of day, or year, month, day, hour and so on."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.logs.text import dates
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.logs.text.state import Table
from simcompare.hardware.raw import RawColumn
from simcompare.model.recording import INFO, Repair

#: name of the column that the parts make
NAME = "time of its parts"
#: how the parts are called
_WORDS = {
    "year": ("year", "yyyy", "yr", "jahr"), "month": ("month", "mon", "mm", "monat"),
    "day": ("day", "dd", "mday", "tag"), "hour": ("hour", "hours", "hr", "hh", "stunde"),
    "minute": ("minute", "minutes", "min", "minuten"),
    "second": ("second", "seconds", "sec", "ss", "sekunde", "sekunden"),
    "millisecond": ("millisecond", "milliseconds", "msec", "millis", "ms"),
}  # fmt: skip
_DATE = ("year", "month", "day")
_SECONDS = {"hour": 3600.0, "minute": 60.0, "second": 1.0, "millisecond": 1e-3}


def parts(layout: Layout) -> dict[str, int]:
    """The column of each part; none where hour, minute and second are not all there."""
    found: dict[str, int] = {}
    for k, (name, _) in enumerate(layout.names):
        word = next((w for w, names in _WORDS.items() if name.strip().lower() in names), "")
        if word and layout.kinds[k] == "number":
            found.setdefault(word, k)
    if not all(word in found for word in ("hour", "minute", "second")):
        return {}
    whole = all(word in found for word in _DATE)
    return found if whole else {word: k for word, k in found.items() if word not in _DATE}


def join(table: Table, names: dict[str, str]) -> list[Repair]:
    """Adds the column of the times to a table, in place of its parts."""
    columns = {word: next(c for c in table.columns if c.name == n) for word, n in names.items()}
    seconds = sum(columns[w].values * factor for w, factor in _SECONDS.items() if w in columns)
    seconds = np.asarray(seconds + 86_400.0 * _days(columns, seconds), dtype=np.float64)
    origin = float(seconds[np.isfinite(seconds)][0]) if np.isfinite(seconds).any() else 0.0
    for column in columns.values():
        table.columns.remove(column)
        table.ignored[column.name] = f"is part of the {NAME.partition(' of')[0]}"
    table.columns.insert(0, RawColumn(NAME, seconds - origin, "s"))
    since = f" since {dates.iso(round(origin * 1e9))}" if "year" in columns else " since the first"
    text = f"{', '.join(c.name for c in columns.values())} together are the time, in seconds{since}"
    return [Repair("date_text", INFO, text)]


def _days(columns: dict[str, RawColumn], seconds: object) -> np.ndarray:
    """Days since 1970, or midnights passed where there is no date."""
    if "year" not in columns:
        steps = np.diff(np.asarray(seconds), prepend=np.asarray(seconds)[0])
        return np.cumsum(steps < -43_200.0)
    year, month, day = (columns[word].values for word in _DATE)
    known = np.isfinite(year + month + day)
    full = np.where(year < 100, 2000 + year, year)
    months = np.where(known, (full - 1970) * 12 + month - 1, 0).astype(np.int64)
    since = months.astype("datetime64[M]").astype("datetime64[D]").astype(np.float64)
    return np.where(known, since + day - 1, np.nan)


def date_and_clock(layout: Layout) -> tuple[str, str] | None:
    """Names of a column of dates and one of times of day that belong together."""
    days = [k for k, style in layout.styles.items() if style.kind != "clock"]
    clocks = [k for k, style in layout.styles.items() if style.kind == "clock"]
    if len(days) == 1 and len(clocks) == 1:
        return layout.names[days[0]][0], layout.names[clocks[0]][0]
    return None


def add_date(table: Table, joined: tuple[str, str]) -> None:
    """Adds the column of dates to that of the times of day."""
    date, clock = (next(c for c in table.columns if c.name == name) for name in joined)
    clock.values += date.values
    table.origins[clock.name] += table.origins[date.name]
    table.columns.remove(date)
    table.ignored[date.name] = f"was added to column {clock.name!r}"
