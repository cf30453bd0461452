"""Damaged logs of every format: what becomes of them; run by hand, a small part in the tests.

python -m tests.attacks.logs [COUNT of each format] [--seed 0] [--only NAME[:SEED]]
"""

import argparse
import tempfile
import time
from collections import Counter
from pathlib import Path

from tests import fuzzing, valid_logs


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=10_000, help="for each format")
    parser.add_argument("--seed", type=int, default=0, help="the first of the seeds")
    parser.add_argument("--children", type=int, default=2)
    parser.add_argument("--limit", type=float, default=60, help="seconds for one import")
    parser.add_argument("--only", default="", help="format, log, or one mutation (log:seed)")
    parser.add_argument("--show", type=int, default=30, help="failures that are shown whole")
    options = parser.parse_args()
    only, _, seed = options.only.partition(":")
    started = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        logs = valid_logs.all_logs(place / "first")
        names = [name for name, log in logs.items() if only in ("", name, log.format)]
        tasks = tasks_of(names, options.count, options.seed)
        if seed:
            tasks = [(only, int(seed))]
        results = []
        seen = Counter()
        for result in fuzzing.run(tasks, place, children=options.children, limit_s=options.limit):
            results.append(result)
            bad = result.outcome in (*fuzzing.FAILURES, "unforeseen") or seed
            key = (result.name.partition("/")[0], result.outcome, result.text[-120:])
            seen[key] += 1
            if bad and seen[key] == 1 and len(seen) and options.show > 0:
                options.show -= 1
                print(result, flush=True)
    table(results)
    print(f"{len(results)} mutations in {time.perf_counter() - started:.0f} s")


def tasks_of(names, count, first):
    """As many mutations of each format, shared by its logs."""
    of_format = Counter(name.partition("/")[0] for name in names)
    most = max(-(-count // shared) for shared in of_format.values())
    return [
        (name, first + i)
        for i in range(most)
        for name in names
        if i < -(-count // of_format[name.partition("/")[0]])
    ]


def table(results):
    """Formats by outcomes, and the worst time and memory of each."""
    formats = sorted({result.name.partition("/")[0] for result in results})
    print(f"{'format':<9}" + "".join(f"{name:>11}" for name in fuzzing.OUTCOMES)
          + "  worst s  worst MB  at (bytes)")  # fmt: skip
    for name in [*formats, ""]:
        mine = [r for r in results if name in ("", r.name.partition("/")[0])]
        count = Counter(result.outcome for result in mine)
        slow = max(mine, key=lambda r: r.seconds)
        large = max(mine, key=lambda r: r.peak_mb - fuzzing.TIMES * r.size / 2**20)
        print(
            f"{name or 'all':<9}" + "".join(f"{count[o]:>11}" for o in fuzzing.OUTCOMES)
            + f"  {slow.seconds:7.2f}  {large.peak_mb:8.0f}  {large.name}:{large.seed}"
            f" ({large.size})"
        )  # fmt: skip


if __name__ == "__main__":
    main()
