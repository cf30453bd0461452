"""NIST's reference problems of nonlinear regression: values and standard deviations."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.gauging.nist import files
from simcompare.gauging.nist.fit import fitted
from simcompare.gauging.nist.models import MODELS
from simcompare.model.trajectory import Array

#: digits that are enough of a value and of a standard deviation
_VALUE, _DEVIATION = 6.0, 4.0
#: problems whose residuals are not larger than the rounding of 64-bit numbers
_NO_NOISE = ("Lanczos1",)
_ADDRESS = "https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml"
_ROUNDING = "the data carry no noise, so the residuals are rounding"


def _checks() -> Iterator[Check]:
    folder = files.folder()
    assert folder is not None, _missing()
    for name, model in MODELS.items():
        problem = files.read(folder / f"{name}.dat")
        fits = [fitted(model, problem, start) for start in problem.starts]
        values = np.array([fit.values for fit in fits])
        yield _worst(f"{name}: b", problem.certified, values, _VALUE)
        deviations = np.array([fit.deviations for fit in fits])
        yield _worst(f"{name}: s of b", problem.deviations, deviations, _DEVIATION)


def _worst(name: str, certified: Array, found: Array, wanted: float) -> Check:
    """The one of all parameters (p,), fitted from both starts (2, p), that is farthest off."""
    off = np.abs(found / certified - 1)
    start, k = np.unravel_index(int(np.argmax(off)), off.shape)
    size = float(certified[k])
    noiseless = wanted == _DEVIATION and name.partition(":")[0] in _NO_NOISE
    return Check(
        f"{name}{k + 1}, start {start + 1}", f"{size:.10e}", float(found[start, k]),
        allowed=0.01 * abs(size) if noiseless else 0.0, remark=_ROUNDING if noiseless else "",
        wanted=wanted,
    )  # fmt: skip


def _missing() -> str:
    folder = files.folder()
    if folder is None:
        return (
            "NIST's files are not on this machine; put the *.dat files of"
            f" {_ADDRESS} into a folder nist_strd, and let SIMCOMPARE_DATA name the folder above it"
        )
    lacking = [name for name in MODELS if not (folder / f"{name}.dat").is_file()]
    return f"{folder} lacks {', '.join(lacking)}; files: {_ADDRESS}" if lacking else ""


EXAMPLE = Example(
    "NIST StRD, nonlinear regression: 27 sets from both starts",
    "Certified to 11 digits by NIST, itl.nist.gov/div898/strd. Of the parameters of a set, fitted"
    " from both starts, the one that is farthest off; 6 digits of a value and 4 of a standard"
    " deviation are enough.",
    _checks,
    _missing,
)
