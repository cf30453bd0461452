"""Runs that are killed at a random moment: what is lost, mixed or left; a small part in the tests.

python -m tests.attacks.kills [COUNT] [--seed 0]
"""

import argparse
import contextlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import simcompare
from simcompare.results import unfinished

#: what is simulated: small, and each simulation is kept by itself
ASKED = ("ball", "--engine", "pymunk", "--contact", "default", "--set", "drop_height=0.1")
REPEATS = 6
#: what marks all processes of a run, also those that have lost their parent
MARK = "SIMCOMPARE_KILLED_RUN"
#: longest wait for what must come
PATIENCE_S = 300.0

#: who is killed or told, and by what, one after the other
KINDS = {
    "parent killed": [signal.SIGKILL],
    "worker killed": [signal.SIGKILL],
    "Ctrl-C": [signal.SIGINT],
    "Ctrl-C twice": [signal.SIGINT, signal.SIGINT],
    "hang-up": [signal.SIGHUP],
    "three at once": [signal.SIGTERM, signal.SIGHUP, signal.SIGINT],
    "Ctrl-C, then killed": [signal.SIGINT, signal.SIGKILL],
}


@dataclass(frozen=True)
class Kill:
    """One attack.

    Attributes:
        kind: one of ``KINDS``.
        moment: number of simulations that are kept then, 0 when it has looked where to store them;
            or "writing": the run is being stored.
        fault: what was lost, mixed or left; empty where nothing was.
        kept: simulations that were kept when it came.
    """

    kind: str
    moment: int | str
    fault: str
    kept: int


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=1000)
    parser.add_argument("--seed", type=int, default=0, help="of the first attack")
    options = parser.parse_args()
    started, seen, bad = time.monotonic(), Counter(), 0
    with tempfile.TemporaryDirectory() as folder:
        whole = unbroken(Path(folder) / "whole")
        for seed in range(options.seed, options.seed + options.count):
            found = attack(seed, Path(folder) / str(seed), whole)
            seen[found.kind] += 1
            bad += bool(found.fault)
            if found.fault:
                print(f"seed {seed}: {found}", flush=True)
    for kind, count in sorted(seen.items()):
        print(f"{count:5} {kind}")
    spent = time.monotonic() - started
    print(f"{sum(seen.values())} attacks in {spent:.0f} s: {bad} lost, mixed or left something")
    return bool(bad)


def unbroken(out):
    """What the run gives when nobody ends it."""
    run(out).wait()
    (folder,) = out.iterdir()
    return samples(folder), scores(folder)


def drawn(seed):
    """Kind, moment, and how much later it comes."""
    of = random.Random(seed)
    moments = [*range(REPEATS + 1), "writing"]
    return of.choice(list(KINDS)), of.choice(moments), of.choice([0, 0, of.random() * 0.2])


def attack(seed, out, whole):
    """Begins a run, ends it, goes on with it, and says what is wrong."""
    kind, moment, later_s = drawn(seed)
    process = run(out)
    wait_for(lambda: process.poll() is not None or has_come(out, moment))
    time.sleep(later_s)
    kept = len(parts(out))
    for number in KINDS[kind]:
        for pid in workers(process.pid) if kind == "worker killed" else [process.pid]:
            send(pid, number)
    process.wait(PATIENCE_S)
    fault = fault_of(kind, process, out, whole, kept)
    return Kill(kind, moment, fault, kept)


def fault_of(kind, process, out, whole, kept):
    if not wait_for(lambda: not marked(out)):
        return f"processes are left: {marked(out)}"
    if "Traceback" in (said := process.communicate()[1]):
        return said
    found = folders(out)
    if len(found) > 1:
        return f"several folders: {found}"
    if kept and not found:
        return f"{kept} simulations are lost"
    if not parts(out) and not any((folder / "run.json").exists() for folder in found):
        again = run(out)  # nothing was simulated; what is left of it goes now
    elif unfinished.is_unfinished(found[0]):
        if len(parts(out)) < kept:
            return f"{len(parts(out))} of {kept} simulations are kept"
        again = run(out, "--resume", str(found[0]))
    else:
        again = None
    if again is not None and (again.wait(PATIENCE_S) or again.communicate()[1]):
        return f"the next run ended with {again.returncode}: {again.communicate()[1]}"
    if [path.name for path in out.iterdir()] != [path.name for path in folders(out)[:1]]:
        return f"left: {[path.name for path in out.iterdir()]}"
    return difference(kind, folders(out)[0], whole, kept)


def difference(kind, folder, whole, kept):
    """How a run differs from the one that nobody ended."""
    found, (expected, expected_scores) = samples(folder), whole
    engine = [key for key in found if key[0] == "pymunk"]
    if kind == "worker killed" and len(found) < len(expected):  # what it owed has failed
        if len(engine) < kept:
            return f"{len(engine)} of {kept} simulations are stored"
    elif found.keys() != expected.keys():
        return f"has {sorted(found)}"
    elif scores(folder) != expected_scores:
        return "other scores"
    wrong = [key for key, values in found.items() if not np.array_equal(values, expected[key])]
    return f"other samples: {wrong}" if wrong else ""


def run(out, *words):
    """Begins a command; Ctrl-C is heard, also where these tests run in the background."""
    asked = words or (*ASKED, "--seeds", str(REPEATS), "--out", str(out))
    return subprocess.Popen(
        [sys.executable, "-m", "simcompare", "run", *asked, "--no-report", "-q"],
        env={**os.environ, MARK: str(out)},
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
        preexec_fn=lambda: [signal.signal(one, signal.SIG_DFL) for one in (2, 1, 15)],
    )  # fmt: skip


def has_come(out, moment):
    if moment == "writing":
        return any(out.glob(".*.partial")) and len(parts(out)) == REPEATS
    return out.is_dir() and len(parts(out)) >= moment


def folders(out):
    inside = out.iterdir() if out.is_dir() else []
    return [path for path in inside if not path.name.startswith(".")]


def parts(out):
    """The simulations that are kept now."""
    return list(out.glob(f"*/{unfinished.PARTS}/*.npz"))


def samples(folder):
    """Whose they are -> all samples, as numbers."""
    return {
        (one.source, one.contact, one.repeat): np.column_stack(
            [*one.trajectory.to_columns().values()]
        )
        for one in simcompare.load_run(folder).trajectories
    }


def scores(folder):
    return (folder / "scores.csv").read_text()


def workers(pid):
    """The processes that a run has begun."""
    try:
        return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def marked(out):
    """All processes of a run that still live, the run itself included."""
    return [int(path.name) for path in Path("/proc").glob("[0-9]*") if _lives(path, out)]


def _lives(path, out):
    try:
        is_ours = f"{MARK}={out}".encode() in (path / "environ").read_bytes().split(b"\0")
        return is_ours and (path / "stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def send(pid, number):
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, number)


def wait_for(condition):
    end = time.monotonic() + PATIENCE_S
    while not (found := condition()) and time.monotonic() < end:
        time.sleep(0.01)
    return found


if __name__ == "__main__":
    sys.exit(main())
