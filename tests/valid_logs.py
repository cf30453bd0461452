"""Small valid logs of every format, made by code: what the mutations start from.

``all_logs(folder)`` makes them; each imports without any defect. All hold the same motion (a
swing, a slope and a rate) as far as the format can say it.
"""

from __future__ import annotations

import io
import pickle
import wave
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tests.text_samples import ROWS, START_NS, STEP_S, Log, motion, text_logs, times, zipped

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
        buffer: Any = io.BytesIO()  # its type is known to newer stubs only
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
                f"COPY (SELECT {columns} FROM frame) TO '{path}'"
                f" (FORMAT parquet, COMPRESSION {how})"
            )
        found.append(Log(name, {"l.parquet": path.read_bytes()}))
    return found


# ---- recorders --------------------------------------------------------------------------------


def _tdms() -> list[Log]:
    import nptdms

    start = np.datetime64("2024-03-01T12:00:00.250000", "us")
    even = {"wf_start_time": start, "wf_increment": STEP_S, "wf_start_offset": 0.0}
    waves, times_too = io.BytesIO(), io.BytesIO()
    with nptdms.TdmsWriter(waves) as writer:
        for part in (slice(0, 70), slice(70, ROWS)):
            writer.write_segment([
                nptdms.RootObject({"Operator": "Ada"}),
                *(nptdms.ChannelObject("bench", name, motion()[part, i].astype(kind),
                                       {**even, "unit_string": "V"})
                  for i, (name, kind) in enumerate((("u", "<f8"), ("v", "<f4")))),
            ])  # fmt: skip
    with nptdms.TdmsWriter(times_too) as writer:
        writer.write_segment([
            nptdms.ChannelObject("g", "Time (s)", times(), {}),
            nptdms.ChannelObject("g", "x [mm]", motion()[:, 1], {}),
            nptdms.ChannelObject("g", "note [V]", (np.arange(ROWS) % 5).astype("<i2"), {}),
        ])  # fmt: skip
    return [
        Log("tdms", {"l.tdms": waves.getvalue()}),
        Log("tdms/time", {"l.tdms": times_too.getvalue()}),
    ]


def _audio() -> list[Log]:
    import soundfile

    rate, count = 8000, 4000
    chance = np.random.default_rng(3)
    sound = chance.normal(0, 0.002, count)
    for at in (600, 1900, 2900):
        ring = np.exp(-np.arange(300) / 40) * np.sin(np.arange(300) * 1.1)
        sound[at : at + 300] += 0.6 * ring
    whole = np.round(sound * 32767).astype("<i2")
    wav, flac, floats = io.BytesIO(), io.BytesIO(), io.BytesIO()
    with wave.open(wav, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(whole.tobytes())
    soundfile.write(flac, whole, rate, format="FLAC")
    both = np.column_stack((sound, sound))[:2500].astype("<f4")
    soundfile.write(floats, both, rate, format="WAV", subtype="FLOAT")
    return [
        Log("audio", {"l.wav": wav.getvalue()}),
        Log("audio/flac", {"l.flac": flac.getvalue()}),
        Log("audio/float", {"l.wav": floats.getvalue()}),
    ]


def _bag(folder: Path) -> list[Log]:
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2

    found = []
    for name in ("bag", "bag/lz4"):
        path = folder / f"{name.replace('/', '_')}.bag"
        writer = Writer1(path)
        if name == "bag/lz4":
            writer.set_compression(writer.CompressionFormat.LZ4)
        fill_bag(writer, ros1=True)
        found.append(Log(name, {"l.bag": path.read_bytes()}))
    for name, plugin in (("bag/db3", StoragePlugin.SQLITE3), ("bag/folder", StoragePlugin.MCAP)):
        path = folder / name.replace("/", "_")
        fill_bag(Writer2(path, version=9, storage_plugin=plugin), ros1=False)
        files = {f"log/{p.name}": p.read_bytes() for p in sorted(path.iterdir())}
        found.append(Log(name, files))
    path = folder / "packed"
    writer2 = Writer2(path, version=9, storage_plugin=StoragePlugin.MCAP)
    writer2.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    fill_bag(writer2, ros1=False)
    (mcap,) = path.glob("*.mcap")
    return [*found, Log("bag/mcap", {"l.mcap": mcap.read_bytes()})]


def fill_bag(writer, *, ros1: bool) -> None:
    """Messages of an inertial unit and of a range finder, 10 ms apart."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    topics = {"/imu": ("sensor_msgs/msg/Imu", imu_message),
              "/range": ("sensor_msgs/msg/Range", _range_message)}  # fmt: skip
    with writer:
        connections = {
            topic: writer.add_connection(topic, kind, typestore=store)
            for topic, (kind, _) in topics.items()
        }
        for i in range(ROWS):
            for topic, (_, message) in topics.items():
                received = START_NS + i * 10_000_000 + 2_000_000
                writer.write(connections[topic], received, message(store, i, ros1=ros1))


def imu_message(store, i: int, *, ros1: bool = False) -> bytes:
    """A packed message of an inertial unit."""
    vector = store.types["geometry_msgs/msg/Vector3"]
    turn = store.types["geometry_msgs/msg/Quaternion"]
    a, b, c = motion()[i].tolist()
    return _packed(
        store, "sensor_msgs/msg/Imu", i, ros1, orientation=turn(x=0.0, y=0.0, z=0.0, w=1.0),
        orientation_covariance=np.zeros(9), angular_velocity=vector(x=a, y=0.1 * b, z=0.2 * c),
        angular_velocity_covariance=np.diag([1e-4, 4e-4, 9e-4]).ravel(),
        linear_acceleration=vector(x=a, y=0.1 * b, z=9.8),
        linear_acceleration_covariance=np.zeros(9),
    )  # fmt: skip


def _range_message(store, i: int, *, ros1: bool = False) -> bytes:
    return _packed(
        store, "sensor_msgs/msg/Range", i, ros1, radiation_type=0, field_of_view=0.1,
        min_range=0.1, max_range=4.0, range=1.0 + 0.1 * motion()[i, 1],
    )  # fmt: skip


def _packed(store, kind: str, i: int, ros1: bool, **fields) -> bytes:
    ns = START_NS + i * 10_000_000
    stamp = store.types["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)
    more = {"seq": i} if ros1 else {}
    head = store.types["std_msgs/msg/Header"](stamp=stamp, frame_id="imu", **more)
    message = store.types[kind](header=head, **fields)
    return bytes((store.serialize_ros1 if ros1 else store.serialize_cdr)(message, kind))


def all_logs(folder: Path) -> dict[str, Log]:
    """Every valid log by its name.

    Args:
        folder: for what libraries must write into files first.
    """
    folder.mkdir(parents=True, exist_ok=True)
    logs = [
        *text_logs(), *_bag(folder), *_tdms(), *_mat(), *_hdf5(), *_numpy(), *_parquet(folder),
        *_audio(),
    ]  # fmt: skip
    return {log.name: log for log in logs}
