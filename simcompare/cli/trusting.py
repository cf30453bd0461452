"""Whether code beside a scenario from elsewhere may run: ``--trust``, or a question."""

from __future__ import annotations

import sys

import typer

from simcompare.cli import manner
from simcompare.errors import UntrustedCode


def agreed(error: UntrustedCode) -> bool:
    """Whether the user says yes, which is then remembered; without a terminal nobody is asked."""
    if not manner.is_trusting() and not _asked(error):
        return False
    from simcompare.scenarios import trust

    trust.remember(error.digest)  # to what was shown, not to what may lie there by now
    return True


def _asked(error: UntrustedCode) -> bool:
    if not _is_on_a_terminal():
        return False
    typer.echo(f"{error.source} is code from elsewhere (SHA-256 {error.digest[:12]}).", err=True)
    question = "Did you read it, and may all Python files of its folder run, now and later?"
    return typer.confirm(question, err=True)


def _is_on_a_terminal() -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty()
