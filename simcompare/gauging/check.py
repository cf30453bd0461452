"""One reference number held against what this program computes, and the verdict."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Literal

Verdict = Literal["PASS", "NOTE", "DIFF", "SKIPPED"]
#: "published": read in the source that is named; "exact": from a closed form or quadrature
Kind = Literal["published", "exact"]
#: standard errors within which trials that are drawn agree with a reference
STANDARD_ERRORS = 3


@dataclass(frozen=True)
class Check:
    """A reference number, and the same as it is computed here.

    Attributes:
        quantity: what it is of, with its unit in brackets.
        reference: all digits that its source gives.
        computed: by this program.
        kind: "published" or "exact"; empty for that of its example.
        source: of this number; empty for that of its example.
        standard_error: of ``computed`` where trials are drawn, else 0.
        allowed: how far else it may be off for the reason in ``remark``; it is a NOTE then.
        remark: why it may be off, in a few words.
        wanted: significant digits that are enough, where more are given.
    """

    quantity: str
    reference: str
    computed: float
    kind: Kind | Literal[""] = ""
    source: str = ""
    standard_error: float = 0.0
    allowed: float = 0.0
    remark: str = ""
    wanted: float | None = None

    @property
    def value(self) -> float:
        """The reference number."""
        return float(self.reference)

    @property
    def rounding(self) -> float:
        """Half a unit in the last digit that is given."""
        exponent = Decimal(self.reference).as_tuple().exponent
        assert isinstance(exponent, int)
        return 0.5 * 10.0**exponent

    @property
    def digits(self) -> float:
        """Significant digits that agree; those that are given where all of them do."""
        given = float(len(Decimal(self.reference).as_tuple().digits))
        off = abs(self.computed - self.value)
        if not math.isfinite(off):
            return 0.0
        if off <= self._near or not self.value:
            return given if off <= self._near else 0.0
        return min(max(-math.log10(off / abs(self.value)), 0.0), given)

    @property
    def held_to(self) -> str:
        """What PASS asks of this number, in words."""
        if self.wanted is not None:
            return f"{self.wanted:g} digits"
        return f"{STANDARD_ERRORS} standard errors" if self.standard_error else "last digit"

    @property
    def verdict(self) -> Verdict:
        """PASS, or NOTE where it is off for a reason that is named, or DIFF."""
        off = abs(self.computed - self.value)
        enough = self.wanted is not None and self.digits >= self.wanted
        if enough or off <= self._near + STANDARD_ERRORS * self.standard_error:
            return "PASS"
        return "NOTE" if self.remark and off <= self._near + self.allowed else "DIFF"

    @property
    def _near(self) -> float:
        """The rounding, and what is lost in binary numbers."""
        return self.rounding * (1 + 1e-9)


def last_digit(check: Check) -> Check:
    """The same where the source may be off by one in its last digit, cut or rounded twice."""
    return replace(check, allowed=2 * check.rounding, remark="the last published digit is off by 1")
