"""Small valid logs that are text, made by code; all hold the same motion."""

from __future__ import annotations

import io
import json
import shutil
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

ROWS = 120
_TEXTS = ("csv", "tracker", "librsf", "lvm", "scope", "json")
STEP_S = 0.01
START_NS = 1_700_000_000_000_000_000


@dataclass(frozen=True)
class Log:
    """A valid log.

    Attributes:
        name: "format" or "format/variant".
        files: path within its folder -> bytes; one entry for a log that is a file.
        mapping: mapping file as a tree, for formats that know no units.
        separator: of a single table of text with plain rows of numbers, else empty.
        decimal: its decimal mark.
        encoding: its encoding.
    """

    name: str
    files: dict[str, bytes]
    mapping: dict = field(default_factory=dict)
    separator: str = ""
    decimal: str = "."
    encoding: str = "utf-8"

    @property
    def format(self) -> str:
        """Name of the importer."""
        return self.name.partition("/")[0]

    @property
    def is_text(self) -> bool:
        """Whether it is one file of text."""
        return (
            self.format in ("csv", "tracker", "librsf", "lvm", "scope", "json")
            or self.name == "phyphox"
        )

    def write(self, folder: Path, files: dict[str, bytes] | None = None) -> Path:
        """Puts it (or its mutation) into an empty folder; returns what is imported."""
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for name, data in (files or self.files).items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        first = next(iter(self.files))
        return folder / first.partition("/")[0] if len(self.files) > 1 else folder / first


def times(count: int = ROWS) -> np.ndarray:
    """Evenly spaced stamps."""
    return np.arange(count) * STEP_S


def motion(count: int = ROWS) -> np.ndarray:
    """Columns: a swing, a slope with noise, a rate."""
    t = times(count)
    noise = np.random.default_rng(7).normal(0, 0.003, (3, count))
    return np.column_stack(
        (np.sin(5 * t) + noise[0], 0.3 * t + 1.5 + noise[1], 5 * np.cos(5 * t) + noise[2])
    )


def rows(separator: str = ",", decimal: str = ".", end: str = "\n", count: int = ROWS) -> str:
    """A table of text without its header."""
    lines = [
        separator.join(f"{v:.6f}" for v in (t, *values))
        for t, values in zip(times(count), motion(count), strict=True)
    ]
    return "".join(line.replace(".", decimal) + end for line in lines)


# ---- text -------------------------------------------------------------------------------------


def _csv() -> list[Log]:
    head = "time (s),angle (rad),distance (m),rate (rad/s)\n"
    dates = np.datetime64("2024-02-28T23:59:59.500", "ms") + (times() * 1000).astype("m8[ms]")
    dated = "".join(f"{d};{v:.5f}\n" for d, v in zip(dates, motion()[:, 0], strict=True))
    stamps = "".join(
        f'{START_NS + i * 10_000_000},{v:.5f},"[{v:.3f}, {2 * v:.3f}]",{str(i % 9 > 0).lower()}\n'
        for i, v in enumerate(motion()[:, 0])
    )
    vector = [f"field.linear_acceleration.{axis}" for axis in "xyz"]
    echo = ",".join(["%time", "field.header.seq", "field.header.stamp", *vector]) + "\n"
    echo += "".join(
        f"{ns},{i},{ns},{a:.5f},{b:.5f},{9.8 + c / 99:.5f}\n"
        for i, (a, b, c) in enumerate(motion())
        for ns in [START_NS + i * 10_000_000]
    )
    return [
        Log("csv", {"log.csv": (head + rows()).encode()}, separator=","),
        Log("csv/comma", {"log.csv": b"\xef\xbb\xbf" + ("t;x\ns;mm\n" + "".join(
            f"{t:.3f};{v:.4f}\r\n" for t, v in zip(times(), motion()[:, 1], strict=True)
        ).replace(".", ",")).encode()}, separator=";", decimal=","),
        Log("csv/utf16", {"log.csv": (head.replace(",", "\t") + rows("\t", end="\r\n")).encode(
            "utf-16")}, separator="\t", encoding="utf-16"),
        Log("csv/blanks", {"log.txt": ("# bench 3, µ = 0.2\n# time [s]  x [m]  y [m]  z [m]\n"
            + rows("  ")).encode("latin-1")}, separator=" ", encoding="latin-1"),
        Log("csv/dates", {"log.csv": ("date;level (m)\n" + dated).encode()}),
        Log("csv/stamps", {"log.csv": (
            "timestamp,angle (rad),pair (V),on (V)\n" + stamps).encode()}),
        Log("csv/echo", {"log.csv": echo.encode()}),
    ]  # fmt: skip


def _phyphox() -> list[Log]:
    axes = ",".join(f'"Acceleration {a} (m/s^2)"' for a in "xyz")
    table = '"Time (s)",' + axes + "\n" + rows()
    turned = '"Time (s)",' + axes.replace("Acceleration", "Gyroscope").replace("m/s^2", "rad/s")
    device = '"property","value"\n"deviceModel","Pixel"\n"accelerometer Range","78.4532"\n'
    clock = (
        '"event","experiment time","system time","system time text"\n'
        '"START",0.000000000E0,1759650000.000,"2025-10-05 10:20:00.000 UTC+02:00"\n'
        '"PAUSE",1.330727321E0,1759650001.331,"2025-10-05 10:20:01.331 UTC+02:00"\n'
    )
    members = {
        "Accelerometer.csv": table, "Gyroscope.csv": turned + "\n" + rows(),
        "meta/device.csv": device, "meta/time.csv": clock,
    }  # fmt: skip
    return [
        Log("phyphox", {"raw.csv": table.encode()}, separator=","),
        Log("phyphox/zip", {"raw.zip": zipped({n: t.encode() for n, t in members.items()})}),
    ]


def zipped(members: dict[str, bytes], compression: int = zipfile.ZIP_DEFLATED) -> bytes:
    """A zip archive."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        for name, data in members.items():
            archive.writestr(zipfile.ZipInfo(name, (2024, 1, 1, 0, 0, 0)), data, compression)
    return buffer.getvalue()


def _tracker() -> list[Log]:
    units = {"channels": {n: {"column": c, "unit": u} for n, c, u in (
        ("x", "x", "m"), ("y", "y", "m"), ("speed", "v", "m/s"))}}  # fmt: skip
    double = "".join(
        f"{t:.6f},{a:.6f},{b:.6f},{a:.6f},{b:.6f},\n"
        for t, (a, b, _) in zip(times(), motion(), strict=True)
    )
    both = {"channels": {f"{b}_{n}": {"column": f"{b} {n}", "unit": "m"} for b in ("ball", "rod")
                         for n in ("x", "y")}}  # fmt: skip
    return [
        Log("tracker", {"clip.txt": ("mass A\nt\tx\ty\tv\n" + rows("\t")).encode()}, units, "\t"),
        Log("tracker/multi", {"clip.txt": (
            "#multi:\n,ball,,rod,,\nt,x,y,x,y,\n" + double).encode()}, both),
    ]  # fmt: skip


def _lvm() -> list[Log]:
    def text(x: str, names: str, body: str) -> bytes:
        return (
            "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
            f"Decimal_Separator\t.\nMulti_Headings\tYes\nX_Columns\t{x}\nTime_Pref\tAbsolute\n"
            "Date\t2013/02/19\nTime\t09:51:39.197\n***End_of_Header***\t\n\t\n"
            f"Channels\t3\t\t\t\nSamples\t{ROWS}\t{ROWS}\t{ROWS}\t\n"
            "Date\t2013/02/19\t2013/02/19\t2013/02/19\t\nTime\t09:51:40.7\t09:51:40.7\t09:51:40.7\t\n"
            "Y_Unit_Label\tVolts\tm\tm/s\t\nX_Dimension\tTime\tTime\tTime\t\n"
            "X0\t0.0E+0\t0.0E+0\t0.0E+0\t\nDelta_X\t1.0E-2\t1.0E-2\t1.0E-2\t\n"
            f"***End_of_Header***\t\t\t\t\nX_Value\t{names}\tComment\n{body}"
        ).encode()

    plain = "".join("\t" + "\t".join(f"{v:.6f}" for v in values) + "\n" for values in motion())
    return [
        Log("lvm", {"bench.lvm": text("No", "u\tx\tv", plain)}),
        Log("lvm/one", {"bench.lvm": text("One", "u\tx\tv", rows("\t"))}, separator="\t"),
    ]


def _scope() -> list[Log]:
    t, v = times() * 1e-4, motion()[:, 0]
    pairs = "".join(f"{a:.9f},{b:.4f}\n" for a, b in zip(t, v, strict=True))
    counted = "".join(f"{i},{b:.4f},,\n" for i, b in enumerate(v))
    left = [
        f"Record Length,{ROWS}",
        "Sample Interval,1.0e-06",
        "Vertical Units,V",
        "Probe Atten,10",
    ]
    left += [","] * (ROWS - len(left))
    beside = "".join(f"{h},,{a:.9f},{b:.4f}\n" for h, a, b in zip(left, t, v, strict=True))
    return [
        Log("scope", {"s.csv": (f"Record Length,Analog:{ROWS}\nSample Interval,Analog:0.000001\n"
            "Vertical Units,CH1:V\nVertical Scale,CH1:1.00\nHorizontal Units,s\n"
            f"Model Number,SDS1104X-E\nSource,CH1\nSecond,Value\n{pairs}").encode()},
            separator=","),
        Log("scope/rigol", {"s.csv": ("X,CH1,Start,Increment\nSequence,Volt,0.0,1.0e-06\n"
            + counted).encode()}),
        Log("scope/tektronix", {"s.csv": beside.encode()}),
        Log("scope/pico", {"s.csv": ("Time,Channel A\n(ms),(mV)\n\n" + pairs).encode()},
            separator=","),
    ]  # fmt: skip


def _librsf() -> list[Log]:
    """Odometry of two wheels and a place, one line each."""
    lines = "".join(
        f"odom2diff {t:.6f} {a:.6f} {b:.6f} 0 0.15 0.0001 0.0001 0.0001\n"
        f"point2 {t:.6f} {a:.6f} {c:.6f} 0 0 0 0\n"
        for t, (a, b, c) in zip(times(), motion(), strict=True)
    )
    return [Log("librsf", {"drive.txt": lines.encode()})]


def _json() -> list[Log]:
    units = {"time": {"column": "t", "unit": "s"}, "channels": {
        "x": {"column": "x", "unit": "m"}, "a": {"column": "p[0]", "unit": "m"},
        "b": {"column": "p[1]", "unit": "m"}}}  # fmt: skip
    records = [
        {"t": float(t), "x": round(float(a), 6), "p": [round(float(b), 5), round(float(c), 5)]}
        for t, (a, b, c) in zip(times(), motion(), strict=True)
    ]
    columns = {"t": times().tolist(), "x": motion()[:, 0].tolist()}
    columns |= {"p[0]": motion()[:, 1].tolist(), "p[1]": motion()[:, 2].tolist()}
    lines = "".join(json.dumps(record) + "\n" for record in records)
    return [
        Log("json", {"l.json": json.dumps({"mass": 0.5, "entries": records}).encode()}, units),
        Log("json/lines", {"l.json": lines.encode()}, units),
        Log("json/columns", {"l.json": json.dumps(columns, indent=1).encode()}, units),
    ]


def text_logs() -> list[Log]:
    """Logs of all formats of text."""
    return [*_csv(), *_phyphox(), *_tracker(), *_lvm(), *_scope(), *_librsf(), *_json()]
