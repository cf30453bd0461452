"""Imports damaged logs in child processes and judges what comes out.

A child reads ``name seed`` from its input and answers with one line of JSON each. A child that
hangs, dies or takes too much memory is a failure of that one mutation, not of the run.
"""

from __future__ import annotations

import contextlib
import ctypes
import faulthandler
import json
import os
import resource
import selectors
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests import valid_logs
from tests.mutations import Mutation, mutated
from tests.text_samples import Log

#: what becomes of a mutation; the last ones are failures
OUTCOMES = (
    "ok",
    "repaired",
    "refused",
    "unforeseen",
    "traceback",
    "memory",
    "hang",
    "crash",
    "silent",
)
FAILURES = OUTCOMES[4:]
#: memory that an import may take: so many times the file, beside what a small file needs
TIMES, BASE_MB = 10, 256
#: address space beyond which a child's allocation fails: far above what is allowed
SPACE_MB = 6000
_ROOT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Result:
    """What became of one mutation.

    Attributes:
        name: of the valid log.
        seed: of the mutation.
        outcome: one of ``OUTCOMES``.
        kinds: what was done to it.
        text: message or trace.
        seconds: of the import.
        peak_mb: growth of the process during it.
        size: of the damaged log in bytes.
    """

    name: str
    seed: int
    outcome: str
    kinds: tuple[str, ...] = ()
    text: str = ""
    seconds: float = 0.0
    peak_mb: float = 0.0
    size: int = 0

    @property
    def failed(self) -> bool:
        """Whether it is a fault of the program: what a library did not foresee is told in words."""
        frames = [line for line in self.text.splitlines() if line.startswith('  File "')]
        ours = bool(frames) and "/simcompare/hardware/" in frames[-1]
        return self.outcome in FAILURES or (self.outcome == "unforeseen" and ours)

    def __str__(self) -> str:
        what = ", ".join(self.kinds)
        return (
            f"{self.outcome}: {self.name}:{self.seed} ({what}) {self.seconds:.2f} s"
            f" {self.peak_mb:.0f} MB of {self.size} bytes\n{self.text}"
        )


# ---- the parent -------------------------------------------------------------------------------


def run(tasks: Iterable[tuple[str, int]], logs: Path, *, children: int = 2, limit_s: float = 30):
    """Judges all tasks; yields a result for each, in no order."""
    waiting, lock, done = iter(tasks), threading.Lock(), []
    ready = threading.Condition()
    left = [children]

    def one() -> None:
        with _Child(logs, limit_s) as child:
            while True:
                with lock:
                    task = next(waiting, None)
                if task is None:
                    break
                result = child.ask(*task)
                with ready:
                    done.append(result)
                    ready.notify()
        with ready:
            left[0] -= 1
            ready.notify()

    threads = [threading.Thread(target=one, daemon=True) for _ in range(children)]
    for thread in threads:
        thread.start()
    while True:
        with ready:
            ready.wait_for(lambda: done or not left[0], timeout=1)
            if done:
                result = done.pop(0)
            elif not left[0]:
                return
            else:
                continue
        yield result


class _Child(contextlib.AbstractContextManager):
    """A process that imports one log after the other, and is started again where it failed."""

    def __init__(self, logs: Path, limit_s: float) -> None:
        self.logs, self.limit_s = logs, limit_s
        self.process: subprocess.Popen[bytes] | None = None
        self.errors = tempfile.TemporaryFile()  # noqa: SIM115

    def __exit__(self, *_: object) -> None:
        self._stop()
        self.errors.close()

    def _start(self) -> subprocess.Popen[bytes]:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.fuzzing", str(self.logs)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, cwd=_ROOT,
        )  # fmt: skip
        self._answer(120)  # it says when it is ready
        return self.process

    def _stop(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            for pipe in (self.process.stdin, self.process.stdout):
                assert pipe is not None
                with contextlib.suppress(OSError):
                    pipe.close()
        self.process = None

    def _answer(self, limit_s: float) -> bytes | None:
        """One line; ``None`` where none comes in time, empty where the process is gone."""
        assert self.process is not None
        assert self.process.stdout is not None
        with selectors.DefaultSelector() as selector:
            selector.register(self.process.stdout, selectors.EVENT_READ)
            if not selector.select(limit_s):
                return None
        return self.process.stdout.readline()

    def ask(self, name: str, seed: int) -> Result:
        process = self.process or self._start()
        assert process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            process.stdin.write(f"{name} {seed}\n".encode())
            process.stdin.flush()
        answer = self._answer(self.limit_s)
        if answer:
            result = Result(**{**json.loads(answer), "name": name, "seed": seed})
            if result.outcome == "memory":
                self._stop()  # its memory stays as large as it was
            return result
        if answer is None:
            process.send_signal(signal.SIGUSR1)  # it says where it hangs
            time.sleep(0.5)
            process.kill()
        code = process.wait()
        self.errors.seek(max(self.errors.tell() - 3000, 0))
        text = self.errors.read().decode(errors="replace")
        self._stop()
        outcome = "hang" if answer is None else "crash"
        return Result(name, seed, outcome, text=f"exit status {code}\n{text}", seconds=self.limit_s)


# ---- the child --------------------------------------------------------------------------------


def made(folder: Path) -> dict[str, Log]:
    """All valid logs, made anew."""
    return valid_logs.all_logs(folder)


def _serve(folder: Path) -> None:
    """Answers every line of the input."""
    faulthandler.enable()
    faulthandler.register(signal.SIGUSR1)
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what libraries print is no answer
    judge = Judge(folder)
    resource.setrlimit(resource.RLIMIT_AS, (SPACE_MB << 20, resource.RLIM_INFINITY))
    out.write("ready\n")
    out.flush()
    for line in sys.stdin:
        name, seed = line.rsplit(maxsplit=1)
        out.write(json.dumps(judge.one(name, int(seed)), ensure_ascii=True) + "\n")
        out.flush()


class Judge:
    """Imports mutations and compares them with the valid logs."""

    def __init__(self, folder: Path) -> None:
        self.place = Path(tempfile.mkdtemp(dir=folder))
        self.logs = made(self.place)
        self.valid = {name: self._import(log, log.files) for name, log in self.logs.items()}

    def _import(self, log: Log, files: dict[str, bytes], *, kind: str | None = None):
        from simcompare.hardware import importing, mapping
        from simcompare.model import recording_store

        path = log.write(self.place / "log", files)
        wanted = mapping.of_tree(log.mapping, "map")
        found = importing.read(path, wanted, kind=kind)
        recording_store.save(found, self.place / "recording")
        return found

    def mutation(self, name: str, seed: int) -> Mutation:
        return mutated(self.logs[name], seed, list(self.logs.values()))

    def one(self, name: str, seed: int) -> dict:
        """The outcome of one mutation, as ``Result`` takes it."""
        log, mutation = self.logs[name], self.mutation(name, seed)
        size = sum(map(len, mutation.files.values()))
        before = _memory()
        started = time.perf_counter()
        # every other one is named by the user, as with --as: the reader sees what is unlike it
        outcome, text, found = self._outcome(log, mutation, log.format if seed % 2 else None)
        seconds = time.perf_counter() - started
        peak = (_peak() - before) / 2**20
        if found is not None and outcome == "ok":
            fault = lost(log, mutation, self.valid[name], found)
            if fault:
                outcome, text = "silent", fault
        if peak > BASE_MB + TIMES * size / 2**20:
            outcome, text = "memory", f"{peak:.0f} MB for {size} bytes; {outcome} {text}"
        return {
            "outcome": outcome, "kinds": mutation.kinds, "text": text[-3000:], "seconds": seconds,
            "peak_mb": peak, "size": size,
        }  # fmt: skip

    def _outcome(self, log: Log, mutation: Mutation, kind: str | None):
        from simcompare.errors import SimcompareError

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", RuntimeWarning)
                found = self._import(log, mutation.files, kind=kind)
        except SimcompareError as error:
            if any(isinstance(cause, MemoryError) for cause in _chain(error)):
                return "memory", "".join(traceback.format_exception(error)), None
            if error.__cause__ is not None and "cannot be read as" in str(error):
                return "unforeseen", "".join(traceback.format_exception(error.__cause__)), None
            return "refused", str(error), None
        except Exception:  # noqa: BLE001
            return "traceback", traceback.format_exc(), None
        bad = [r for r in found.provenance.repairs if r.severity != "info"]
        return ("repaired" if bad else "ok"), "\n".join(r.text for r in bad), found


def _chain(error: BaseException | None) -> Iterator[BaseException]:
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


def _memory() -> int:
    """Resident memory now; the peak is counted from here on."""
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
    Path("/proc/self/clear_refs").write_text("5")
    return _status("VmRSS")


def _peak() -> int:
    return _status("VmHWM")


def _status(key: str) -> int:
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(key):
            return int(line.split()[1]) * 1024
    raise KeyError(key)


# ---- what may not happen in silence -----------------------------------------------------------


def lost(log: Log, mutation: Mutation, valid, found) -> str:
    """What is wrong with a recording that says it is whole; empty where nothing is."""
    return _unsound(found) or _rows_lost(log, mutation, found) or _cut(log, mutation, valid, found)


def _unsound(found) -> str:
    for name, stream in found.streams.items():
        if len(stream.time_s) < 2 or not np.all(np.diff(stream.time_s) > 0):
            return f"stream {name}: times do not increase"
        for channel, content in stream.channels.items():
            if np.isinf(content.values).any():
                return f"{name}/{channel} holds infinite values"
    return ""


def _rows_lost(log: Log, mutation: Mutation, found) -> str:
    """A table of text: whatever a plain reader takes for a row must be there with its values."""
    if not log.separator or len(found.streams) != 1:
        return ""
    data = next(iter(mutation.files.values()))
    if _is_recoded(data, log):
        return ""  # a plain reader does not know the encoding
    rows = plain_rows(data, log)
    (stream,) = found.streams.values()
    if len(stream.time_s) < len(rows):
        return f"{len(stream.time_s)} samples, but {len(rows)} plain rows of numbers"
    factors = {c.channel: (c.factor, c.offset) for c in found.provenance.conversions if c.channel}
    if not rows or len(factors) != len(rows[0]) - 1:
        return ""
    wanted = np.array(rows)[:, 1:] * [f for f, _ in factors.values()]
    wanted += [offset for _, offset in factors.values()]
    have = {
        _key(row) for row in zip(*(stream.channels[name].values for name in factors), strict=True)
    }
    missing = [row for row in wanted if _key(row) not in have]
    return f"{len(missing)} plain rows are missing, such as {missing[0]}" if missing else ""


def _key(row) -> tuple:
    return tuple(np.format_float_scientific(value + 0.0, 9) for value in row)


def _is_recoded(data: bytes, log: Log) -> bool:
    text = data.decode(log.encoding, errors="replace")
    return text.count("\ufffd") > 3 or text.count("\0") > 3


def plain_rows(data: bytes, log: Log) -> list[list[float]]:
    """Lines with as many numbers as the valid log has, read as simply as can be."""
    text = data.decode(log.encoding, errors="replace").lstrip("\ufeff")
    width = len(_cells(next(iter(log.files.values())).decode(log.encoding).rstrip(), log))
    found: list[list[float]] = []
    for line in text.split("\n")[:-1]:  # the last one may be cut
        cells = _cells(line, log)
        try:
            numbers = [float(cell.replace(log.decimal, ".")) for cell in cells if "_" not in cell]
        except ValueError:
            numbers = []
        if len(numbers) == len(cells) == width:
            found.append(numbers)
        elif len(found) < 3:
            found.clear()  # what looks like a row within the header is none
    return found


def _cells(text: str, log: Log) -> list[str]:
    line = text.split("\n")[-1]
    return line.split() if log.separator == " " else line.strip("\r ").split(log.separator)


def _cut(log: Log, mutation: Mutation, valid, found) -> str:
    """A container that only lost its end must say so, or still hold every value."""
    if mutation.kinds != ("cut",) or log.is_text:
        return ""
    for name, stream in valid.streams.items():
        other = found.streams.get(name)
        if other is None or len(other.time_s) != len(stream.time_s):
            have = "is gone" if other is None else f"has {len(other.time_s)} samples"
            return f"stream {name} {have}; {len(stream.time_s)} were there"
        for channel, content in stream.channels.items():
            same = other.channels.get(channel)
            if same is None or not np.array_equal(same.values, content.values, equal_nan=True):
                return f"{name}/{channel} has other values"
    return ""


if __name__ == "__main__":
    _serve(Path(sys.argv[1]))
