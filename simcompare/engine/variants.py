"""Variants of an engine: the engine with one of its own choices made otherwise.

A backend declares them in a file ``variants.py`` beside it, which loads nothing, so that their
names are known at once: it takes all of ours from here, and not from the kit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from simcompare.engine.helps import CENTRED_EFFORTS, HALF_STEP_START, LANDING

__all__ = ["CENTRED_EFFORTS", "HALF_STEP_START", "LANDING", "Variant"]


@dataclass(frozen=True)
class Variant:
    """An engine with one thing set otherwise, at every contact level.

    Attributes:
        text: what differs, in one sentence.
        reference: where it is documented.
        value: what the adapter sets for it, if its name does not tell.
        without: our helps that the engine takes, and this variant not.
        why: why it takes them not, in one sentence.
    """

    text: str
    reference: str
    value: Any = None
    without: frozenset[str] = frozenset()
    why: str = ""
