"""Ctrl-C and its kin: they wait while something is held, and come when it has ended in order.

A terminal that is closed and a batch job that is ended count as Ctrl-C. A command is interrupted
once; whatever comes after that finds it ending already, and changes nothing.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from typing import Any

#: what interrupts, as far as this system knows it
SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)


@dataclass
class _Now:
    """What came, and who waits.

    Attributes:
        came: whether a signal did.
        answered: whether whoever held knows it, and tells its caller.
        blocks: that hold, each within the one before; what tells each of them.
    """

    came: bool = False
    answered: bool = False
    blocks: list[Callable[[], None]] = field(default_factory=list)


_now = _Now()


def take_over() -> None:
    """Makes a command of this process: signals that interrupt are ours from now on.

    What is ignored stays so, as Ctrl-C in the background of a script and SIGHUP below ``nohup``.
    """
    _forget()
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _take)
    sys.unraisablehook = _unraisable


def leave() -> None:
    """Ends what ``take_over`` began: a signal that comes now finds nothing to bring to an end."""
    for number in SIGNALS:
        if signal.getsignal(number) is _take:
            signal.signal(number, signal.SIG_IGN if _now.came else signal.SIG_DFL)
    _forget()


def came() -> bool:
    """Whether a signal has come: what can be left out now should be.

    In other threads than the main one it never has: none of them is what was interrupted.
    """
    return _now.came and _is_main()


def answer() -> None:
    """Says that the caller is told in another way than by ``KeyboardInterrupt``."""
    _now.answered = True


@contextmanager
def held(tell: Callable[[], None] = lambda: None) -> Iterator[None]:
    """Within it a signal raises nothing; it does at the end, unless it was answered.

    Args:
        tell: called when one comes, from between any two steps of the main thread; it may raise
            nothing and wait for nothing.

    Raises:
        KeyboardInterrupt: at the end of the outermost block.
    """
    if not _is_main():
        yield  # signals never come to it
        return
    with nullcontext() if _now.blocks else _ours():
        _now.blocks.append(tell)
        try:
            yield
        finally:
            _now.blocks.remove(tell)
        if _now.came and not _now.answered and not _now.blocks:
            raise KeyboardInterrupt


@contextmanager
def _ours() -> Iterator[None]:
    """Takes Ctrl-C over for a while, where it is Python's and this is no command."""
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    _forget()
    signal.signal(signal.SIGINT, _take)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        _forget()


def _is_main() -> bool:
    return threading.current_thread() is threading.main_thread()


def _take(*_: object) -> None:
    is_first, _now.came = not _now.came, True
    for tell in _now.blocks:
        tell()
    if is_first and not _now.blocks:
        raise KeyboardInterrupt


def _forget() -> None:
    _now.came = _now.answered = False


def _unraisable(what: Any) -> None:  # noqa: ANN401
    """Where a destructor has swallowed it, the next Ctrl-C is the first again."""
    if issubclass(what.exc_type, KeyboardInterrupt):
        _forget()
    else:
        sys.__unraisablehook__(what)
