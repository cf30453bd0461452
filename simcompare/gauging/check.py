"""One published number held against what this program computes, and the verdict."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Literal

Verdict = Literal["PASS", "NOTE", "DIFF", "SKIPPED"]


@dataclass(frozen=True)
class Check:
    """A number as it is printed in its source, and as it is computed here.

    Attributes:
        quantity: what it is of, with its unit in brackets.
        published: as it is printed, all digits.
        computed: by this program.
        chance: how far trials that are drawn may put it off, beyond the rounding of the published
            digits.
        allowed: how far else it may be off for the reason in ``remark``; it is a NOTE then.
        remark: why it may be off, in a few words.
        wanted: significant digits that are enough, where more are published.
    """

    quantity: str
    published: str
    computed: float
    chance: float = 0.0
    allowed: float = 0.0
    remark: str = ""
    wanted: float | None = None

    @property
    def value(self) -> float:
        """The published number."""
        return float(self.published)

    @property
    def rounding(self) -> float:
        """Half a unit in the last digit that is printed."""
        exponent = Decimal(self.published).as_tuple().exponent
        assert isinstance(exponent, int)
        return 0.5 * 10.0**exponent

    @property
    def digits(self) -> float:
        """Significant digits that agree; those that are printed where all of them do."""
        printed = float(len(Decimal(self.published).as_tuple().digits))
        off = abs(self.computed - self.value)
        if not math.isfinite(off):
            return 0.0
        if off <= self._near or not self.value:
            return printed if off <= self._near else 0.0
        return min(max(-math.log10(off / abs(self.value)), 0.0), printed)

    @property
    def verdict(self) -> Verdict:
        """PASS, or NOTE where it is off for a reason that is known, or DIFF."""
        off = abs(self.computed - self.value)
        enough = self.wanted is not None and self.digits >= self.wanted
        if enough or off <= self._near + self.chance:
            return "PASS"
        return "NOTE" if self.remark and off <= self._near + self.allowed else "DIFF"

    @property
    def _near(self) -> float:
        """The rounding, and what is lost in binary numbers."""
        return self.rounding * (1 + 1e-9)


def last_digit(check: Check) -> Check:
    """The same where the source may be off by one in its last digit, cut or rounded twice."""
    return replace(check, allowed=2 * check.rounding, remark="the last published digit is off by 1")
