"""Prints the ratios of every group: ours over the bare loop, both timed in the same run."""

from collections import defaultdict


def pytest_terminal_summary(terminalreporter, config):
    session = getattr(config, "_benchmarksession", None)
    groups = defaultdict(dict)
    for benchmark in session.benchmarks if session else []:
        if not benchmark.has_error:
            groups[benchmark.group][benchmark.params["who"]] = benchmark.stats
    if not groups:
        return
    terminalreporter.section("cost beside the engine's own bare loop")
    for group, stats in sorted(groups.items()):
        if {"ours", "bare"} <= set(stats):
            ours, bare = stats["ours"].median, stats["bare"].median
            terminalreporter.write_line(
                f"{group:<24} ratio {ours / bare:5.2f}"
                f"   ({ours * 1e3:.1f} ms beside {bare * 1e3:.1f} ms, medians)"
            )
