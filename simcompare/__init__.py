"""simcompare: one scene, many physics engines, and the truth.

The verbs of the command line are functions of the same names here; nothing heavy is imported until
one of them is used.
"""

from __future__ import annotations

import importlib as _importlib
from typing import Any as _Any

#: name -> the module that has it, and what it is called there where that differs
_PUBLIC = {
    "run": "simcompare.verbs.run",
    "resume": "simcompare.verbs.run",
    "load_run": "simcompare.verbs.load_run",
    "report": "simcompare.verbs.report",
    "list": "simcompare.verbs.listing:listing",
    "show": "simcompare.verbs.show",
    "fit": "simcompare.verbs.fit",
    "validate": "simcompare.verbs.validate",
    "tune": "simcompare.verbs.tune",
    "characterize": "simcompare.verbs.characterize",
    "sense": "simcompare.verbs.sense",
    "sensor": "simcompare.verbs.sensor",
    "estimate": "simcompare.verbs.estimate",
    "uncertainty": "simcompare.verbs.uncertainty",
    "gauge": "simcompare.verbs.gauge",
    "calibrate": "simcompare.verbs.calibrate",
    "allan": "simcompare.verbs.allan",
    "control": "simcompare.verbs.control",
    "gym": "simcompare.verbs.gym",
    "compare": "simcompare.verbs.compare",
    "runs": "simcompare.verbs.runs",
    "explain": "simcompare.verbs.explain",
    "export": "simcompare.exporters.export",
    "robot": "simcompare.verbs.robot",
    "import_log": "simcompare.verbs.import_log",
    "Result": "simcompare.verbs.result",
    "Recording": "simcompare.model.recording",
    "Scenario": "simcompare.model.scenario",
    "Trajectory": "simcompare.model.trajectory",
    "Settings": "simcompare.engine.backend",
    "SimcompareError": "simcompare.errors",
}
#: all of it but what would hide a name of Python itself
__all__ = [name for name in _PUBLIC if name != "list"]


def __getattr__(name: str) -> _Any:  # noqa: ANN401
    if name not in _PUBLIC:
        raise AttributeError(f"module 'simcompare' has no attribute {name!r}")
    module, _, other = _PUBLIC[name].partition(":")
    return getattr(_importlib.import_module(module), other or name)


def __dir__() -> list[str]:
    return sorted([*_PUBLIC, "__doc__", "__file__", "__name__", "__path__"])
