"""simcompare: one scene, many physics engines, and the truth.

The verbs of the command line are functions of the same names here; nothing heavy is imported until
one of them is used.
"""

from __future__ import annotations

import importlib
from typing import Any

_PUBLIC = {
    "run": "simcompare.verbs.run",
    "characterize": "simcompare.verbs.characterize",
    "control": "simcompare.verbs.control",
    "Run": "simcompare.results.run",
    "load_run": "simcompare.results.store",
    "runs": "simcompare.verbs.runs",
    "explain": "simcompare.verbs.explain",
    "export": "simcompare.exporters.export",
    "import_log": "simcompare.verbs.import_log",
    "fit": "simcompare.verbs.fit",
    "tune": "simcompare.verbs.tune",
    "validate": "simcompare.verbs.validate",
    "Recording": "simcompare.model.recording",
    "Scenario": "simcompare.model.scenario",
    "Trajectory": "simcompare.model.trajectory",
    "Settings": "simcompare.engine.backend",
    "SimcompareError": "simcompare.errors",
}
__all__ = list(_PUBLIC)


def __getattr__(name: str) -> Any:  # noqa: ANN401
    if name not in _PUBLIC:
        raise AttributeError(f"module 'simcompare' has no attribute {name!r}")
    module = importlib.import_module(_PUBLIC[name])
    return getattr(module, "load" if name == "load_run" else name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_PUBLIC])
