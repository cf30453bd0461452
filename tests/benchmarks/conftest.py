"""Prints what every benchmark found: a ratio to the bare loop, or the processor time of a fit."""


def pytest_terminal_summary(terminalreporter, config):
    session = getattr(config, "_benchmarksession", None)
    benchmarks = session.benchmarks if session else []
    for benchmark in benchmarks:
        if "processor_s" in benchmark.extra_info:
            spent_s = benchmark.extra_info["processor_s"]
            terminalreporter.write_line(f"{benchmark.name:<46} processor time {spent_s:5.2f} s")
    found = [b for b in benchmarks if "ratio" in b.extra_info]
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
