"""One motion, written as many programs write it: the same numbers and units each time.

Each dialect opens at the first try. The motion is known, so that a wrong separator, decimal mark,
unit or clock shows as a wrong number.
"""

from __future__ import annotations

import datetime

import numpy as np
import pytest

from simcompare.hardware import importing
from simcompare.hardware.mapping import NOTHING

COUNT, STEP_S = 60, 0.01
TIME = STEP_S * np.arange(COUNT)
X = np.round(1.2345 + 1.5 * np.sin(5 * TIME), 4)
Y = np.round(0.3 * TIME - 2.5, 4)
PLAIN = "t (s),x (m),y (m)"
START = datetime.datetime(2024, 5, 17, 11, 59, 59, 800_000)


def stamped(form):
    """Stamps as ``strftime`` writes them, with {ms} for the milliseconds."""
    moments = [START + datetime.timedelta(milliseconds=10 * i) for i in range(COUNT)]
    return [m.strftime(form).format(ms=f"{m.microsecond // 1000:03d}") for m in moments]


def rows(separator=",", decimal=".", stamps=None, cell="{:.4f}", scale=1.0):
    stamps = stamps or [f"{t:.2f}".replace(".", decimal) for t in TIME]
    return [
        separator.join([stamp, *(cell.format(scale * v).replace(".", decimal) for v in (x, y))])
        for stamp, x, y in zip(stamps, X, Y, strict=True)
    ]


def table(head=PLAIN, **how):
    separator = how.get("separator", ",")
    return "\n".join([*(head.replace(",", separator).split("\n")), *rows(**how)]) + "\n"


def each(text, make):
    """Each line with its number made into another one."""
    return "".join(f"{make(i, line)}\n" for i, line in enumerate(text.splitlines()))


def quoted(text, separator=","):
    return each(text, lambda _, line: ",".join(f'"{c}"' for c in line.split(separator)))


def counted(values):
    return [str(value) for value in values]


def pairs(text):
    """A line for each row, made of its numbers."""
    return "".join(text.format(t=t, ms=10 * i, x=x, y=y)
                   for i, (t, x, y) in enumerate(zip(TIME, X, Y, strict=True)))  # fmt: skip


UNIX_MS = 1_715_947_199_800
GERMAN = {"separator": ";", "decimal": ","}
TAIL = "Remark {}: the table was pushed\n"
DATED = "time,x (m),y (m)"
INTERLEAVED = pairs("A,{ms},{x},{y}\nB,{ms},1\n")
DIALECTS = {
    # separators and decimal marks
    "plain": table(),
    "semicolons": table(separator=";"),
    "tabs": table(separator="\t"),
    "double tabs": table("t_s,x_m,y_m", separator="\t\t"),
    "pipes": table(separator="|"),
    "blanks": table("t_s,x_m,y_m", separator="   "),
    "tabs and blanks": table("t_s,x_m,y_m", separator=" \t"),
    "decimal commas": table(**GERMAN),
    "decimal commas and tabs": table(separator="\t", decimal=","),
    "sep line": "sep=;\n" + table(**GERMAN),
    "quoted": quoted(table()),
    "quoted decimal commas": quoted(table(**GERMAN), ";"),
    "exponents": table(cell="{:+.8E}"),
    "Fortran exponents": table(cell="{:+.8E}").replace("E", "D"),
    "ends of Windows": table().replace("\n", "\r\n"),
    "ends of an old Mac": table().replace("\n", "\r"),
    "separator at each end": each(table(), lambda _, line: line + ","),
    "separator at the end of rows": each(table(), lambda i, line: line + "," * (i > 0)),
    # encodings
    "byte order mark": "\ufeff" + table(),
    "UTF-16": table().encode("utf-16"),
    "Latin-1": ("# Größe\n" + table()).encode("latin-1"),
    # headers
    "remark as header": "# " + table(),
    "percent header": "% " + table(),
    "slashes": "//" + table(),
    "units below": table("t,x,y\ns,m,m"),
    "units in brackets below": table("t,x,y\n[s],[m],[m]"),
    "units in a remark": table("# t,x,y\n# s,m,m"),
    "a group above": table(",position,\nt (s),x (m),y (m)"),
    "square brackets": table("Time[s],x[m],y[m]"),
    "German norm": table("t/s,x/m,y/m"),
    "suffixes": table("t_s,x_m,y_m"),
    "millimetres": table("t (s),x (mm),y (mm)", scale=1000, cell="{:.1f}"),
    "index of pandas": each(table(), lambda i, line: f"{i - 1 if i else ''},{line}"),
    "index without a name": each(table(), lambda i, line: f"{i - 1},{line}" if i else line),
    "index of R": each(table(), lambda i, line: f'"{i}",{line}' if i else quoted(line).strip()),
    "header again": table() + table().partition("\n")[0] + "\n",
    "a long head": "".join(TAIL.format(i) for i in range(100)) + "\n" + table(),
    "a long tail": table() + "\n" + "".join(TAIL.format(i) for i in range(100)),
    "a tail without an empty line": table() + "".join(TAIL.format(i) for i in range(100)),
    "a summary": table() + "\nchannel,mean,std\nx,1.2,0.3\n",
    "a second table": table() + "\nTime (s),F (N)\n" + "".join(f"{i},{i}\n" for i in range(30)),
    # missing values
    "words for missing": table() + "0.60,NaN,--\n0.61,,#N/A\n0.62,1.0,1.0\n",
    # stamps
    "ISO": table(DATED, stamps=stamped("%Y-%m-%dT%H:%M:%S.{ms}Z")),
    "ISO with a zone": table(DATED, stamps=stamped("%Y-%m-%dT%H:%M:%S.{ms}+02:00")),
    "German dates": table(DATED, stamps=stamped("%d.%m.%Y %H:%M:%S,{ms}"), **GERMAN),
    "AM and PM": table(DATED, stamps=stamped("%m/%d/%Y %I:%M:%S.{ms} %p")),
    "date and time": table("date,time,x (m),y (m)", stamps=stamped("%d.%m.%Y,%H:%M:%S.{ms}")),
    "time in parts": table("year,month,day,hour,minute,second,x (m),y (m)",
                           stamps=stamped("%Y,%m,%d,%H,%M,%S.{ms}")),
    "minutes": table(DATED, stamps=stamped("%M:%S.{ms}")),
    "colon before ms": table(DATED, stamps=stamped("%H:%M:%S:{ms}")),
    "unix s": table(DATED, stamps=[f"{UNIX_MS / 1000 + t:.3f}" for t in TIME]),
    "unix ms": table(DATED, stamps=counted(UNIX_MS + 10 * i for i in range(COUNT))),
    "unix us": table(DATED, stamps=counted(1000 * (UNIX_MS + 10 * i) for i in range(COUNT))),
    "unix ns": table(DATED, stamps=counted(10**6 * (UNIX_MS + 10 * i) for i in range(COUNT))),
    "spreadsheet days": table(DATED, stamps=[f"{45429.5 + t / 86400:.11f}" for t in TIME]),
    "milliseconds": table("millis,x (m),y (m)", stamps=counted(range(500, 1100, 10))),
    "wrap of 16 bits": table("t (ms),x (m),y (m)",
                             stamps=counted((65_300 + 10 * i) % 65_536 for i in range(COUNT))),
    "wrap of 32 bits": table("t (us),x (m),y (m)", stamps=counted(
        (2**32 - 200_000 + 10_000 * i) % 2**32 for i in range(COUNT))),
    "stale rows": PLAIN + "\n55.20,1,2\n55.21,1,2\n" + "\n".join(rows()) + "\n",
    "rate in the head": "Sample rate: 100 Hz\nx (m),y (m)\n" + pairs("{x},{y}\n"),
    "interval in the head": "Sample interval (ms),10\nx (m),y (m)\n" + pairs("{x},{y}\n"),
    # consoles and records
    "keys": pairs("t_s={t:.2f} x_m={x} y_m={y}\n"),
    "labels with units": pairs("t: {t:.2f} s, x: {x} m, y: {y} m\n"),
    "stamps of a console": pairs("11:59:59.{ms:03d} -> {t:.2f},{x},{y}\n").replace(
        "11:", "11:59:58.990 -> t_s,x_m,y_m\n11:", 1),
    "sentences of a GPS": table().replace("\n0.1", "\n$GPGGA,123519,4807.0,N,01131.0,E\n0.1"),
    "kinds of rows": "A,t_ms,x_m,y_m\nB,t_ms,n_m\n" + INTERLEAVED,
    "records": pairs('{{"t_s": {t:.2f}, "x_m": {x}, "y_m": {y}}}\n'),
}  # fmt: skip


@pytest.mark.parametrize("name", DIALECTS)
def test_the_motion_is_the_same_in_every_dialect(tmp_path, name):
    text = DIALECTS[name]
    path = tmp_path / "log.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    stream = next(iter(importing.read(path, NOTHING).streams.values()))
    # microseconds: seconds since 1970 in a float, and days in eleven decimals
    assert stream.time_s[:COUNT] == pytest.approx(TIME, abs=2e-6)
    axes = {c.raw.split(" ")[-1].removesuffix("_m"): c for c in stream.channels.values()}
    for axis, true in (("x", X), ("y", Y)):
        assert axes[axis].unit == "m"
        # a unit of millimetres costs a bit in the last place
        assert axes[axis].values[:COUNT] == pytest.approx(true, rel=1e-15, abs=1e-15)
