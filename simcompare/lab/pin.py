"""The teacher's PIN: few tries, and no hint of how near one was."""

from __future__ import annotations

import hmac
import time
from collections.abc import Callable

from simcompare.lab.refusals import Refused

#: wrong tries from one address, and from all together, before one must wait; for how long [s]
_OWN, _ALL, _WAIT_S = 5, 50, 60.0


class Pin:
    """Checks a PIN.

    Args:
        pin: the right one; where it is ``None``, none is asked for.
        clock: seconds that only grow.
    """

    def __init__(self, pin: str | None, clock: Callable[[], float] = time.monotonic) -> None:
        self._pin, self._clock = pin, clock
        self._wrong: list[tuple[float, str]] = []

    @property
    def is_wanted(self) -> bool:
        """Whether one is asked for."""
        return self._pin is not None

    def check(self, given: str, address: str) -> None:
        """Lets the right PIN pass.

        Args:
            given: what was typed.
            address: of who typed it.

        Raises:
            Refused: it is wrong, or there were too many wrong ones just now.
        """
        if self._pin is None:
            return
        now = self._clock()
        self._wrong = [one for one in self._wrong if one[0] > now - _WAIT_S]
        own = [when for when, whose in self._wrong if whose == address]
        if len(own) >= _OWN or len(self._wrong) >= _ALL:
            first = own[0] if len(own) >= _OWN else self._wrong[0][0]
            raise Refused(429, "pin_wait", seconds=max(first + _WAIT_S - now, 1.0))
        if not hmac.compare_digest(given.encode(), self._pin.encode()):
            self._wrong.append((now, address))
            raise Refused(401, "pin_wrong")
