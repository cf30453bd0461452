"""Large logs: time and memory of an import beside those of a bare reader; run by hand.

python -m tests.benchmarks.large_logs [--gigabytes 1] [--only csv|bag] [--folder /somewhere]

Each import and each bare reader is a process of its own. Anonymous memory is what the process
itself holds; the rest of its resident memory are pages of files, which the system takes back when
it needs them. Files are made in a temporary folder and removed.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from tests import valid_logs

COLUMNS = 10
_BLOCK = 100_000


def make_csv(path, size):
    """Ten columns: a time that increases and nine signals that repeat every 100 000 rows."""
    chance = np.random.default_rng(1)
    names = [f"x{i} (m)" for i in range(COLUMNS - 1)]
    signals = np.cumsum(chance.normal(0, 0.01, (_BLOCK, COLUMNS - 1)), axis=0)
    signals -= np.linspace(0, 1, _BLOCK)[:, None] * signals[-1]
    rest = [",".join(f"{v:.6f}" for v in row) for row in signals.tolist()]
    start = 0
    with path.open("w") as file:
        file.write(",".join(["time (s)", *names]) + "\n")
        while file.tell() < size:
            lines = zip(range(start, start + _BLOCK), rest, strict=True)
            file.write("".join(f"{i / 1000:.3f},{text}\n" for i, text in lines))
            start += _BLOCK
    return path


def make_bag(path, size):
    """A ROS 2 bag (MCAP) of messages of an inertial unit at 1 kHz."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kind = "sensor_msgs/msg/Imu"
    message = np.frombuffer(valid_logs.imu_message(store, 0), np.uint8)
    chance = np.random.default_rng(1)
    count = size // (len(message) + 40)
    at = {"stamp": 4, "values": len(message) - 8 * (3 + 9)}  # linear acceleration, covariance
    writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
    with writer:
        topic = writer.add_connection("/imu", kind, typestore=store)
        for start in range(0, count, _BLOCK):
            number = min(_BLOCK, count - start)
            table = np.tile(message, (number, 1))
            ns = valid_logs.START_NS + 1_000_000 * np.arange(start, start + number)
            stamps = np.column_stack((ns // 10**9, ns % 10**9)).astype("<u4")
            table[:, at["stamp"] : at["stamp"] + 8] = stamps.view(np.uint8)
            values = chance.normal(0, 0.02, (number, 3)) + np.array([0, 0, 9.8])
            table[:, at["values"] : at["values"] + 24] = values.astype("<f8").view(np.uint8)
            data = table.tobytes()
            length = len(message)
            for i, stamp in enumerate(ns.tolist()):
                writer.write(topic, stamp, data[i * length : (i + 1) * length])
    return path


# ---- what the processes do --------------------------------------------------------------------


def import_(path, out):
    """As `simcompare import`; says how long its parts took."""
    from simcompare.hardware import importing, mapping
    from simcompare.model import recording_store

    started = time.perf_counter()
    found = importing.read(Path(path), mapping.NOTHING)
    read = time.perf_counter()
    recording_store.save(found, Path(out))
    stored = time.perf_counter()
    bad = [r.rule for r in found.provenance.repairs if r.severity != "info"]
    (stream,) = found.streams.values()
    return {
        "read and checked": read - started, "stored": stored - read,
        "samples": len(stream.time_s), "defects": bad,
    }  # fmt: skip


def bare_csv(path, _):
    import pandas as pd

    return {"samples": len(pd.read_csv(path))}


def bare_bag(path, _):
    from rosbags.highlevel import AnyReader

    count = 0
    with AnyReader([Path(path)]) as reader:
        for connection, _, data in reader.messages():
            reader.deserialize(data, connection.msgtype)
            count += 1
    return {"samples": count}


TASKS = {"import": import_, "pandas.read_csv": bare_csv, "rosbags": bare_bag}


def measured(task, path, out):
    """Seconds, those of the processor, peaks of memory [MB], and what the process says."""
    started, used = time.perf_counter(), _processor_s()
    process = subprocess.Popen(
        [sys.executable, "-m", __spec__.name, "--task", task, str(path), str(out)],
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    peaks = {"RssAnon": 0, "VmRSS": 0}
    while process.poll() is None:
        for line in _status(process.pid):
            key = line.partition(":")[0]
            if key in peaks:
                peaks[key] = max(peaks[key], int(line.split()[1]) / 1024)
        time.sleep(0.02)
    seconds = time.perf_counter() - started
    text = process.stdout.read()
    if process.returncode:
        raise SystemExit(f"{task} ended with {process.returncode}")
    return seconds, _processor_s() - used, peaks["RssAnon"], peaks["VmRSS"], json.loads(text)


def _processor_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _status(pid):
    try:
        return Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return []


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--gigabytes", type=float, default=1.0)
    parser.add_argument("--only", choices=("csv", "bag"))
    parser.add_argument("--folder", type=Path, help="where the files are made")
    parser.add_argument("--task", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.task:
        name, path, out = options.task
        print(json.dumps(TASKS[name](path, out)))
        return
    size = int(options.gigabytes * 10**9)
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        for kind, make, bare in (
            ("csv", make_csv, "pandas.read_csv"), ("bag", make_bag, "rosbags")
        ):  # fmt: skip
            if options.only in (None, kind):
                path = make(Path(folder) / f"large_{kind}", size)
                compare(kind, path, bare, Path(folder) / "recording")


def compare(kind, path, bare, out):
    files = path.rglob("*") if path.is_dir() else [path]
    size = sum(file.stat().st_size for file in files if file.is_file())
    print(f"{kind}: {size / 1e9:.2f} GB")
    taken = {}
    for task in (bare, "import"):
        seconds, processor_s, anonymous, whole, said = measured(task, path, out)
        taken[task] = seconds, processor_s
        parts = ", ".join(f"{k} {v:.1f} s" for k, v in said.items() if isinstance(v, float))
        print(
            f"  {task:<16} {seconds:7.1f} s  {size / 1e6 / seconds:6.1f} MB/s"
            f"  processor {processor_s:6.1f} s"
            f"  anonymous {anonymous:6.0f} MB  resident {whole:6.0f} MB"
            f"  {said['samples']} samples  {parts} {said.get('defects', '')}",
            flush=True,
        )
    wall, processor = (a / b for a, b in zip(taken["import"], taken[bare], strict=True))
    print(f"  import over {bare}: {wall:.2f} by the clock, {processor:.2f} by processor time")


if __name__ == "__main__":
    main()
