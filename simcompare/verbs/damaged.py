"""What breaks on a stored artefact is the fault of that, not of ours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from simcompare.errors import InputError, SimcompareError


@contextmanager
def told_as_damaged(stored: Sequence[object], what: str) -> Iterator[None]:
    """Parts of stored results that do not belong together are told, whatever they break.

    Args:
        stored: the folders or files; where there are none, an error is a fault of our own.
        what: cannot be made, such as "report".

    Raises:
        InputError: names them.
    """
    try:
        yield
    except (SimcompareError, OSError):
        raise
    except Exception as error:
        if not stored:
            raise
        why = f"{type(error).__name__}: {error}"
        fault = f"no {what} can be made of it ({why}): it was changed, or is damaged; run it again"
        raise InputError(", ".join(map(str, stored)), [fault]) from error
