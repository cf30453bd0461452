"""Damaged stores of every kind: what becomes of them; run by hand, a small part in the tests.

python -m tests.attacks.stores [COUNT of each kind] [--seed 0] [--only KIND[:SEED]] [--show 20]
"""

import argparse
import contextlib
import json
import os
import random
import shutil
import tempfile
import time
import traceback
import warnings
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import simcompare
from simcompare.errors import SimcompareError
from simcompare.inference import sources
from simcompare.model import plain, recording_store
from simcompare.results import fit_file, store
from simcompare.scenarios import catalogue
from simcompare.verbs import calibrate
from tests import validations
from tests.test_fitting import stopwatch
from tests.test_recording_store import a_recording

#: outcomes
CLEAN, AS_IT_WAS, FAILED, WRONG = "refused", "read", "traceback", "wrong data"
WORDS: tuple[object, ...] = (
    None, True, False, 0, -1, 1, 3, 1e-320, -1e308, 10**30, 1 << 53, "", "x", "pass", "../b",
    "/etc/passwd", "*", "a\x1b[31m", "\udcfc", "=1+1", "NaN", "9" * 400, [], {}, [None], {"x": 1},
    [[[]]], "2026",
)  # fmt: skip
#: of stores that can be read, how many are also reported on, which takes long
SHARE = 0.2
#: texts that take the place of a value in a file of JSON
TEXTS = ("NaN", "Infinity", "1e999", "9" * 5000, "[" * 20_000, "{", '"', "-", "tru", "\0", "")


@dataclass(frozen=True)
class Result:
    """What became of one mutation."""

    kind: str
    seed: int
    change: str
    outcome: str
    text: str
    seconds: float

    def __str__(self):
        return f"{self.kind}:{self.seed} {self.change}: {self.outcome}, {self.text}"


def valid_stores(folder):
    """One whole store of every kind: kind -> (folder, how it is used)."""
    run = simcompare.run(
        "ball", engine="pymunk", seeds=1, contact="default", step="10ms", out=folder / "run"
    )
    robot = {"engine": "mujoco", "contact": "default", "sensor": {"imu": "mpu6050"}}
    sensed = simcompare.run("robot", **robot, out=folder / "sensed")
    drop = stopwatch(folder / "drop.csv")
    fit = simcompare.fit("ball", recordings=[drop], engine="pymunk", out=folder / "fit")
    recording_store.save(a_recording(), folder / "recording" / "x.rec")
    return {
        "run": (run.folder, use_run),
        "sensed": (sensed.folder, use_run),
        "fit": (fit.folder, use_fit),
        "validation": (validation(run, folder / "validation"), use_run),
        "recording": (folder / "recording" / "x.rec", use_recording),
        "calibration": (calibration(folder / "calibration"), use_calibration),
    }


def validation(run, folder):
    """A stored validation of which all is made up."""
    place = store.save(run, folder).folder
    common = json.loads((place / "run.json").read_text(encoding="utf-8"))
    for name in (
        "against",
        "against_asked",
        "fit_asked",
        "cautions",
        "beyond",
        "sensing",
        "without",
    ):
        common.pop(name, None)
    more = {"kind": "validation", "validation": plain.plain(validations.record())}
    text = json.dumps({**common, **more, "recording_asked": ["swings"], "scores": []})
    (place / "run.json").write_text(text, encoding="utf-8")
    return place


def calibration(folder):
    """A stored calibration of a simulated accelerometer."""
    return simcompare.calibrate(simulate="mpu6050", out=folder).folder


# ---- use ----------------------------------------------------------------------------------------


def use_run(place, rng):
    """All that is done with a stored run; returns what was read of its tables."""
    simcompare.runs(place.parent)
    found = simcompare.load_run(place)
    if rng.random() < SHARE:
        repr(found)
        found.table()
        with contextlib.suppress(SimcompareError):
            simcompare.compare(place)
        format = rng.choice(["md", "md", "html"])
        simcompare.report(place, format=format, out=place.parent / f"r.{format}")
    moved = [one.trajectory for one in found.trajectories]
    return [
        *(array for one in moved for array in (one.time_s, *one.signals.values())),
        *(one.reading.measured for one in found.stored_readings),
    ]


def use_fit(place, rng):
    """A fit is a run, and gives engines their parameters."""
    fit = fit_file.read(place / "fit.json")
    file = catalogue.load("ball")
    scene = file.resolve(fit.base(file))
    fit.settings("pymunk", scene)
    fit.of_engine("pymunk", file)
    fit.drop(file)
    fit.cautions(scene, file)
    return use_run(place, rng)


def use_recording(place, rng):
    """What a recording is read for."""
    found = sources.find(str(place)).recording
    repr(found)
    return [
        array
        for stream in found.streams.values()
        for array in (stream.time_s, *(channel.values for channel in stream.channels.values()))
    ]


def use_calibration(place, rng):
    repr(calibrate._stored(place / "calibration.json"))
    return []


# ---- mutations ----------------------------------------------------------------------------------


def mutated(place, rng):
    """Damages one file of a store; returns what was done in words."""
    path = rng.choice([p for p in sorted(place.iterdir()) if p.suffix in (".json", ".parquet")])
    changes = [cut, flipped, replaced_by_something_else, repeated]
    if path.suffix == ".json":
        changes = [*changes[:3], *[edited] * 6, worded]
    change = rng.choice(changes)
    return f"{path.name} {change.__name__} {change(path, rng)}"


def cut(path, rng):
    content = path.read_bytes()
    start = rng.choice([0, rng.randrange(len(content))])
    end = rng.randrange(start, len(content) + 1)
    path.write_bytes(content[:start] + content[end:])
    return f"{start}-{end}"


def flipped(path, rng):
    content = bytearray(path.read_bytes())
    places = [rng.randrange(len(content)) for _ in range(rng.choice([1, 1, 2, 20]))]
    for i in places:
        content[i] ^= 1 << rng.randrange(8)
    path.write_bytes(content)
    return places[:3]


def repeated(path, rng):
    content = path.read_bytes()
    start = rng.randrange(len(content))
    path.write_bytes(content[: start + 100] + content[start:])
    return start


def replaced_by_something_else(path, rng):
    other = rng.choice(["nothing", "folder", "pipe", "zeros", "link", "outside", "sibling"])
    siblings = [p for p in path.parent.glob("*.parquet") if p != path]
    content = path.read_bytes()
    path.unlink()
    if other == "folder":
        path.mkdir()
    elif other == "pipe":
        os.mkfifo(path)
    elif other == "zeros":
        path.symlink_to("/dev/zero")
    elif other == "link":
        (path.parent / "linked").write_bytes(content)
        path.symlink_to("linked")
    elif other == "outside":
        path.symlink_to("/etc/passwd")
    elif other == "sibling" and siblings:
        shutil.copy(siblings[0], path)
    return other


def worded(path, rng):
    """Puts a text that is no JSON in the place of a word of the file."""
    text = path.read_text(encoding="utf-8")
    start = rng.randrange(len(text))
    word = rng.choice(TEXTS)
    path.write_text(text[:start] + word + text[start + rng.randrange(9) :], encoding="utf-8")
    return f"{start} {word[:9]!r}"


def edited(path, rng):
    """Changes one value, name or list of a file of JSON."""
    tree = json.loads(path.read_text(encoding="utf-8"))
    places = list(_places(tree))
    inside, key = rng.choice(places)
    how = rng.choice(["value", "value", "value", "gone", "renamed", "swapped", "twice", "more"])
    if how == "value":
        inside[key] = rng.choice(WORDS)
    elif how == "gone":
        del inside[key]
    elif how == "renamed" and isinstance(inside, dict):
        inside[rng.choice(["x", "", "../x", key + "_"])] = inside.pop(key)
    elif how == "swapped":
        other, there = rng.choice(places)
        inside[key], other[there] = other[there], inside[key]
        if _is_circle(tree):
            return "nothing"
    elif how == "twice" and isinstance(inside, list):
        inside.append(inside[key])
    elif isinstance(inside, dict):
        inside["of_a_newer_version"] = 1
    path.write_text(json.dumps(tree), encoding="utf-8")
    return f"{how} {key!r} {str(inside)[:60]!r}"


def _places(tree):
    for key, value in list(tree.items() if isinstance(tree, dict) else enumerate(tree)):
        yield tree, key
        if isinstance(value, dict | list):
            yield from _places(value)


def _is_circle(tree):
    try:
        json.dumps(tree)
    except (ValueError, RecursionError):
        return True
    return False


# ---- the attack ---------------------------------------------------------------------------------


def attack(kind, whole, use, seed, right):
    """One mutation of a store, in a copy of it."""
    rng = random.Random(f"{kind}:{seed}")
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / whole.parent.name / whole.name
        shutil.copytree(whole, place)
        change = mutated(place, rng)
        started = time.perf_counter()
        outcome, text = _outcome(place, use, rng, right)
        return Result(kind, seed, change, outcome, text, time.perf_counter() - started)


def _outcome(place, use, rng, right):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = use(place, rng)
    except SimcompareError as error:
        text = str(error)
        return (CLEAN, text) if "Traceback" not in text else (FAILED, text)
    except Exception:  # noqa: BLE001  (that there is any is what is told)
        return FAILED, traceback.format_exc()
    if all(any(np.array_equal(a, b, equal_nan=True) for b in right) for a in found):
        return AS_IT_WAS, ""
    return WRONG, "samples that were never stored"


def attacks(folder, count, first=0, only=""):
    """Mutations of stores, kind by kind."""
    stores = valid_stores(Path(folder))
    for kind, (place, use) in stores.items():
        if only in ("", kind):
            right = use(place, random.Random(0))
            for seed in range(first, first + count):
                yield attack(kind, place, use, seed, right)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=1700, help="for each kind")
    parser.add_argument("--seed", type=int, default=0, help="the first of the seeds")
    parser.add_argument("--only", default="", help="kind, or one mutation (kind:seed)")
    parser.add_argument("--show", type=int, default=20, help="failures that are shown whole")
    options = parser.parse_args()
    kind, _, seed = options.only.partition(":")
    first, count = (int(seed), 1) if seed else (options.seed, options.count)
    results, started, seen = [], time.perf_counter(), Counter()
    with tempfile.TemporaryDirectory() as folder, contextlib.suppress(KeyboardInterrupt):
        for result in attacks(folder, count, first, kind):
            results.append(result)
            seen[result.text[-150:]] += 1
            is_new = seen[result.text[-150:]] == 1 and seen.total() and options.show > 0
            if seed or (result.outcome in (FAILED, WRONG) and is_new):
                options.show -= 1
                print(result, flush=True)
    table(results)
    print(f"{len(results)} mutations in {time.perf_counter() - started:.0f} s")


def table(results):
    """Kinds by outcomes, and the longest time of each."""
    outcomes = (CLEAN, AS_IT_WAS, FAILED, WRONG)
    print(f"{'kind':<12}" + "".join(f"{name:>12}" for name in outcomes) + "   worst s")
    for kind in dict.fromkeys(result.kind for result in results):
        mine = [result for result in results if result.kind == kind]
        count = Counter(result.outcome for result in mine)
        worst = max(result.seconds for result in mine)
        print(f"{kind:<12}" + "".join(f"{count[one]:>12}" for one in outcomes) + f"{worst:10.2f}")


if __name__ == "__main__":
    main()
