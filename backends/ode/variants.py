"""Variants of ODE: its two functions that take a step."""

from __future__ import annotations

from simcompare.engine.variants import Variant

#: what is called
STEP = "dWorldStep"
VARIANTS = {
    "quickstep": Variant(
        "steps by dWorldQuickStep, 20 sweeps over all constraints, in place of dWorldStep, which"
        " solves them at once; its random order is the same in every step",
        "ODE manual, World: dWorldQuickStep",
        "dWorldQuickStep",
    ),
}
