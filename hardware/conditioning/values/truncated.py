"""Logs that end early."""

from __future__ import annotations

from simcompare.hardware.conditioning.work import Work


def check(work: Work) -> None:
    """Says what is missing at the end."""
    missing = work.stream.truncated
    if missing:
        work.warn(
            "truncated",
            f"the log ends early, after {work.place(len(work.stream) - 1)}: {missing}; what was"
            " read before is whole."
            " Copy the file from the device again if you can",
            samples=[len(work.stream) - 1],
            after={"samples": float(len(work.stream))},
        )
