"""Prints the ratio of every benchmark: ours over the bare loop, median of alternating pairs."""


def pytest_terminal_summary(terminalreporter, config):
    session = getattr(config, "_benchmarksession", None)
    found = [b for b in (session.benchmarks if session else []) if "ratio" in b.extra_info]
    if not found:
        return
    terminalreporter.section("cost beside the engine's own bare loop")
    for benchmark in found:
        extra = benchmark.extra_info
        terminalreporter.write_line(
            f"{benchmark.group:<26} ratio {extra['ratio']:5.2f}"
            f"   (pairs {extra['low']:.2f} to {extra['high']:.2f};"
            f" bare {extra['bare_ms']:.1f} ms)"
        )
