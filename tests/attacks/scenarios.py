"""Damaged scenario files: each is read, or refused in words, with bounded time and memory.

python -m tests.attacks.scenarios [COUNT] [--seed 0] [--only NAME:SEED]
"""

from __future__ import annotations

import argparse
import json
import random
import re
import resource
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simcompare.comparison.repeats import repeats_of
from simcompare.errors import SimcompareError
from simcompare.hardware import confined
from simcompare.scenarios import catalogue
from tests.text_mutations import Edit, text_edits

#: what one file may take
SECONDS, MEMORY_MB = 30.0, 256
VALUES = (
    "9" * 40, "1e308", "-1", "0", "1e-300", "nan", ".inf", "null", "true", "[]", "{}", "[[[1]]]",
    '""', "x", '"${9**9**9}"', '"${1/0}"', '"${unknown}"', '"${' + "(" * 300 + '1"', "*none",
    "&a [*a]", "!!python/object:os.system x", "2024-01-01", "0x7f", "1_000", "~", '"\\0"', "1e12",
    "[" * 400, "x" * 20_000, "'${[1] * 999999999}'", "|", "? a", "- a", "9999999999", "1000001",
)  # fmt: skip
_VALUE = re.compile(r"(?<=: )[^,{}\[\]\n#]+(?=[,}\]\n])|(?<=[\[,] )[-\w.]+(?=[,\]])")
_KEY = re.compile(r"\b\w+(?=:)")


@dataclass(frozen=True)
class Fault:
    """A file that ended otherwise than it should."""

    name: str
    seed: int
    text: str


def mutated(name: str, seed: int) -> bytes:
    """One to three edits of a scenario file, the same each time."""
    chance = random.Random(f"{name} {seed}")
    data = Path(catalogue.load(name).path).read_bytes()
    edits: dict[str, Edit] = {
        **text_edits("utf-8"), "value": _value, "value ": _value, "value  ": _value, "key": _key,
        "block": _block, "repeated": _repeated, "splice": _splice,
    }  # fmt: skip
    for _ in range(chance.choice((1, 1, 2, 3))):
        data = edits[chance.choice(sorted(edits))](chance, data)
    return data


def _value(chance: random.Random, data: bytes) -> bytes:
    return _changed(chance, data, _VALUE, lambda _: chance.choice(VALUES))


def _key(chance: random.Random, data: bytes) -> bytes:
    known = _KEY.findall(data.decode("utf-8", "replace")) or ["x"]
    new = chance.choice((chance.choice(known), "unknown", "extends", "<<", '""', "1", "x" * 5000))
    return _changed(chance, data, _KEY, lambda _: new)


def _changed(
    chance: random.Random, data: bytes, pattern: re.Pattern[str], new: Callable[[Any], str]
) -> bytes:
    text = data.decode("utf-8", "replace")
    found = list(pattern.finditer(text))
    if not found:
        return data
    match = chance.choice(found)
    return (text[: match.start()] + new(match) + text[match.end() :]).encode("utf-8", "replace")


def _block(chance: random.Random, data: bytes) -> bytes:
    """Lines that stand twice, somewhere."""
    lines = data.splitlines(keepends=True) or [b""]
    start, at = chance.randrange(len(lines)), chance.randrange(len(lines))
    return b"".join([*lines[:at], *lines[start : start + chance.randrange(1, 20)], *lines[at:]])


def _repeated(chance: random.Random, data: bytes) -> bytes:
    """Many more entries than any scenario has."""
    many = chance.choice((1000, 20_000))
    kind = chance.choice(("k{0}: {0}\n", "parameters{0}: {{value: 1}}\n", "- {0}\n"))
    return data + b"".join(kind.format(i).encode() for i in range(many))


def _splice(chance: random.Random, data: bytes) -> bytes:
    other = Path(catalogue.load(chance.choice(catalogue.names())).path).read_bytes()
    return data[: chance.randrange(len(data) + 1)] + other[chance.randrange(len(other) + 1) :]


def _read(folder: Path) -> None:
    """Reads the file of a folder as a run does, up to the engines."""
    began = time.perf_counter()
    try:
        file = catalogue.load(str(folder / "mine.yaml"))
        repeats_of(file, {}, None, None, None)
        outcome, text = "read", ""
    except SimcompareError as error:
        outcome, text = "refused", str(error)
    except BaseException:  # noqa: BLE001
        outcome, text = "traceback", traceback.format_exc()
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    told = {"outcome": outcome, "text": text, "seconds": time.perf_counter() - began}
    confined.answer(folder, {**told, "peak_mb": peak_mb})


def one(name: str, seed: int, folder: Path) -> dict:
    """What becomes of one mutation."""
    (folder / "mine.yaml").write_bytes(mutated(name, seed))
    answer = folder / confined.ANSWER
    answer.unlink(missing_ok=True)
    limits = confined.Limits(MEMORY_MB << 20, MEMORY_MB << 20, SECONDS)
    ending = confined.run(_read, f"{__name__}:_read", folder, limits)
    if not answer.exists():
        return {"outcome": "ended", "text": str(ending), "seconds": SECONDS, "peak_mb": 0.0}
    found: dict = json.loads(answer.read_text())
    if len(found["text"]) > 20_000:
        found["outcome"] = "endless"
    return found


def run(count: int, first: int = 0) -> tuple[Counter[str], list[Fault], float, float]:
    """Outcomes, faults, the longest time [s] and the largest memory [MB] of many mutations."""
    outcomes: Counter[str] = Counter()
    faults, slowest_s, largest_mb = [], 0.0, 0.0
    names = catalogue.names()
    with tempfile.TemporaryDirectory() as folder:
        for i in range(count):
            name, seed = names[i % len(names)], first + i // len(names)
            found = one(name, seed, Path(folder))
            outcomes[found["outcome"]] += 1
            slowest_s = max(slowest_s, found["seconds"])
            largest_mb = max(largest_mb, found["peak_mb"])
            if found["outcome"] not in ("read", "refused"):
                faults.append(Fault(name, seed, f"{found['outcome']}: {found['text'][-2000:]}"))
    return outcomes, faults, slowest_s, largest_mb


def main() -> None:
    """Runs many, and shows what is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=1000)
    parser.add_argument("--seed", type=int, default=0, help="the first of the seeds")
    parser.add_argument("--only", default="", help="one mutation (name:seed)")
    options = parser.parse_args()
    if options.only:
        name, _, seed = options.only.partition(":")
        with tempfile.TemporaryDirectory() as folder:
            print(one(name, int(seed), Path(folder)))
        return
    outcomes, faults, slowest_s, largest_mb = run(options.count, options.seed)
    for fault in faults[:20]:
        print(f"{fault.name}:{fault.seed} {fault.text}\n")
    print(f"{dict(outcomes)}; slowest {slowest_s:.1f} s, largest process {largest_mb:.0f} MB")


if __name__ == "__main__":
    main()
