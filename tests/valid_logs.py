"""Small valid logs of every format, made by code: what the mutations start from.

``all_logs(folder)`` makes them once; each imports without any defect. All hold the same motion
(a swing, a slope and a pair of rates) as far as the format can say it.
"""

from __future__ import annotations

import io
import json
import pickle
import shutil
import struct
import wave
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

ROWS = 120
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
        return self.format in ("csv", "tracker", "lvm", "scope", "json") or self.name == "phyphox"

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
        f"{START_NS + i * 10_000_000},{v:.5f},\"[{v:.3f}, {2 * v:.3f}]\",{'true' if i % 9 else 'false'}\n"
        for i, v in enumerate(motion()[:, 0])
    )  # fmt: skip
    vector = [f"field.linear_acceleration.{axis}" for axis in "xyz"]
    echo = ",".join(["%time", "field.header.seq", "field.header.stamp", *vector]) + "\n"
    echo += "".join(
        f"{START_NS + i * 10_000_000},{i},{START_NS + i * 10_000_000},{a:.5f},{b:.5f},{9.8 + c / 99:.5f}\n"
        for i, (a, b, c) in enumerate(motion())
    )  # fmt: skip
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
        Log("csv/stamps", {"log.csv": ("timestamp,angle (rad),pair (V),on (V)\n" + stamps).encode()}),
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


# ---- arrays -----------------------------------------------------------------------------------


def _channels(*names: str) -> dict:
    return {"channels": {n.lower().replace(".", "_"): {"column": n, "unit": "m"} for n in names}}


def _mat() -> list[Log]:
    import h5py
    import scipy.io

    t, x = times(), motion()
    plain = {"t": t, "x": x[:, 0], "y": x[:, 1]}
    cells = np.empty((1, 2), dtype=object), np.empty((1, 2), dtype=object)
    for i in range(2):
        cells[0][0, i], cells[1][0, i] = t[: 60 + i], x[: 60 + i, 0]
    found = []
    for name, tree, packed in (
        ("mat", plain, True),
        ("mat/plain", plain, False),
        ("mat/struct", {"log": plain, "note": "bench", "mass": 0.5}, True),
        ("mat/cells", {"t_run": cells[0], "x_run": cells[1]}, False),
    ):
        buffer = io.BytesIO()
        scipy.io.savemat(buffer, tree, do_compression=packed)
        names = {"mat/struct": ("log.x", "log.y"), "mat/cells": ("x_run",)}.get(name, ("x", "y"))
        time = {"mat/struct": "log.t", "mat/cells": "t_run"}.get(name, "t")
        mapping = {**_channels(*names), "time": {"column": time, "unit": "s"}}
        found.append(Log(name, {"l.mat": buffer.getvalue()}, mapping))
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", userblock_size=512) as file:
        for name, values in plain.items():
            item = file.create_dataset(name, data=values[None, :], chunks=(1, 50), compression=4)
            item.attrs["MATLAB_class"] = np.bytes_("double")
    text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(124) + b"\0\2IM"
    data = text.ljust(512, b"\0") + buffer.getvalue()[512:]
    mapping = {**_channels("x", "y"), "time": {"column": "t", "unit": "s"}}
    return [*found, Log("mat/73", {"l.mat": data}, mapping)]


def _hdf5() -> list[Log]:
    import h5py

    def made(fill: Callable[[h5py.File], None]) -> bytes:
        buffer = io.BytesIO()
        with h5py.File(buffer, "w") as file:
            fill(file)
        return buffer.getvalue()

    def sets(file: h5py.File) -> None:
        group = file.create_group("run")
        for name, values, unit in (("time", times(), "s"), ("x", motion(), "m")):
            chunks = (40,) if values.ndim == 1 else (40, 3)
            more = {"chunks": chunks, "compression": 4, "shuffle": True, "fletcher32": True}
            item = group.create_dataset(name, data=values, **more)
            item.attrs["unit"] = unit

    def table(file: h5py.File) -> None:
        kinds = [("time (s)", "<f8"), ("x (m)", "<f4"), ("n (1)", "<i4")]
        one = np.zeros(ROWS, dtype=kinds)
        one["time (s)"], one["x (m)"], one["n (1)"] = times(), motion()[:, 0], np.arange(ROWS) % 7
        file.create_dataset("log", data=one)

    return [Log("hdf5", {"l.h5": made(sets)}), Log("hdf5/table", {"l.h5": made(table)})]


def _numpy() -> list[Log]:
    table = np.zeros(ROWS, dtype=[("t", "<f8"), ("x", "<f8"), ("n", "<i8")])
    table["t"], table["x"], table["n"] = times(), motion()[:, 0], np.arange(ROWS)
    npy, npz, fortran = io.BytesIO(), io.BytesIO(), io.BytesIO()
    np.save(npy, table)
    np.savez_compressed(npz, t=times(), x=motion()[:, 0], p=motion())
    np.save(fortran, np.asfortranarray(motion()))
    time = {"time": {"column": "t", "unit": "s"}}
    rate = {"time": {"rate_Hz": 100}}
    return [
        Log("numpy", {"l.npy": npy.getvalue()}, {**time, **_channels("x", "n")}),
        Log("numpy/npz", {"l.npz": npz.getvalue()}, {**time, **_channels("x", "p.x", "p.y")}),
        Log("numpy/fortran", {"l.npy": fortran.getvalue()}, {**rate, **_channels("data.0")}),
        Log("numpy/torch", {"l.pt": torch_zip()}, {**rate, **_channels("x")}),
    ]


def torch_zip() -> bytes:
    """What ``torch.save({"x": tensor})`` writes, put together step by step."""
    import pickletools

    data = motion()[:, 0].astype("<f4").tobytes()
    storage = (
        b"(X\x07\0\0\0storagectorch\nFloatStorage\nX\x01\0\0\0"
        b"0X\x03\0\0\0cpu" + pickle.dumps(ROWS, 2)[2:-1] + b"tQ"
    )
    tensor = b"ctorch._utils\n_rebuild_tensor_v2\n(" + storage + b"K\0K" + bytes([ROWS])
    tensor += b"\x85K\x01\x85\x89ccollections\nOrderedDict\n)RtR"
    program = b"\x80\x02}(X\x01\0\0\0x" + tensor + b"u."
    assert list(pickletools.genops(program))
    return zipped(
        {"l/data.pkl": program, "l/data/0": data, "l/version": b"3\n"}, zipfile.ZIP_STORED
    )


def _parquet(folder: Path) -> list[Log]:
    import duckdb
    import pandas as pd

    frame = pd.DataFrame(motion(), columns=["x (m)", "y (m)", "v (m/s)"])
    frame.insert(0, "time (s)", times())
    frame["n (1)"] = np.arange(ROWS)
    frame["when"] = pd.Timestamp("2024-03-01") + pd.to_timedelta(times(), unit="s")
    found = []
    for name, columns, how in (
        ("parquet", '"time (s)", "x (m)", "y (m)", "n (1)"', "zstd"),
        ("parquet/plain", '"time (s)", "x (m)", ["x (m)", "y (m)"] AS "p (m)"', "uncompressed"),
    ):
        path = folder / "made.parquet"
        with duckdb.connect() as base:
            base.register("frame", frame)
            base.execute(
                f"COPY (SELECT {columns} FROM frame) TO '{path}' (FORMAT parquet, COMPRESSION {how})"
            )
        found.append(Log(name, {"l.parquet": path.read_bytes()}))
    return found


def all_logs(folder: Path) -> dict[str, Log]:
    """Every valid log by its name.

    Args:
        folder: for what libraries must write into files first.
    """
    folder.mkdir(parents=True, exist_ok=True)
    logs = [
        *_csv(), *_phyphox(), *_tracker(), *_lvm(), *_scope(), *_json(), *_bag(folder),
        *_tdms(), *_mat(), *_hdf5(), *_numpy(), *_parquet(folder), *_audio(),
    ]  # fmt: skip
    return {log.name: log for log in logs}
