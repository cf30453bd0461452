"""Whole commands, cold, in pairs: the median of the ratios of alternating runs.

python tests/benchmarks/commands.py [PAIRS]
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BARE = [sys.executable, str(Path(__file__).with_name("bare.py"))]
NOTHING = [sys.executable, "-c", "pass"]
SIMCOMPARE = str(Path(sys.executable).with_name("simcompare"))


def seconds(command, **environment):
    started = time.perf_counter()
    subprocess.run(
        command, check=True, capture_output=True, stdin=subprocess.DEVNULL,
        env={**os.environ, **environment},
    )  # fmt: skip
    return time.perf_counter() - started


def ratio(name, command, beside, limit, pairs, **environment):
    seconds(command, **environment)  # files into the cache
    seconds(beside)
    found = [(seconds(command, **environment), seconds(beside)) for _ in range(pairs)]
    ratios = sorted(ours / theirs for ours, theirs in found)
    middle = statistics.median(ratios)
    took = statistics.median(ours for ours, _ in found)
    print(
        f"{name:<44} {middle:5.2f} (limit {limit:g}; {ratios[0]:.2f} to {ratios[-1]:.2f};"
        f" {took:.2f} s)",
        flush=True,
    )


def main():
    pairs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    completing = {
        "_SIMCOMPARE_COMPLETE": "complete_bash",
        "COMP_WORDS": "simcompare run b",
        "COMP_CWORD": "2",
    }
    print("command                                      ratio to `python -c pass`")
    ratio("simcompare --help", [SIMCOMPARE, "--help"], NOTHING, 15, 2 * pairs)
    ratio("simcompare list", [SIMCOMPARE, "list"], NOTHING, 15, 2 * pairs)
    ratio("completion of `run b`", [SIMCOMPARE], NOTHING, 15, 2 * pairs, **completing)
    with tempfile.TemporaryDirectory() as folder:
        run = [SIMCOMPARE, "run", "ball", "--engine", "all", "--out", folder]
        print("command                                      ratio to the bare script")
        ratio("run ball --engine all --no-report", [*run, "--no-report"], BARE, 2, pairs)
        ratio("run ball --engine all, with the report", run, BARE, 3, pairs)


if __name__ == "__main__":
    main()
