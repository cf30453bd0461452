"""The function ``reference`` of a Python file beside a scenario, loaded where it is called."""

from __future__ import annotations

import importlib.util
import inspect
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeAlias

from simcompare.errors import InputError
from simcompare.model.signals import Signal
from simcompare.model.trajectory import Array

Reference: TypeAlias = Callable[
    [Mapping[str, float], Array, Mapping[str, Signal]], Mapping[str, Array]
]


def loaded(source: Path) -> Reference:
    """Runs a file; its function is called with parameters, times and signals of the inputs.

    One that takes no inputs is written with the first two alone.

    Raises:
        InputError: it cannot be imported or has no such function.
    """
    name = f"simcompare_reference_{source.parent.name}"
    spec = importlib.util.spec_from_file_location(name, source)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # dataclasses look their module up by name while it is being executed
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise InputError(
            str(source), [f"cannot be imported: {type(error).__name__}: {error}"]
        ) from error
    if not callable(getattr(module, "reference", None)):
        raise InputError(str(source), ["has no function reference(parameters, time_s)"])
    return _with_inputs(module.reference)


def _with_inputs(function: Callable[..., Mapping[str, Array]]) -> Reference:
    """A reference that is given the inputs, whether or not it wants them."""
    if len(inspect.signature(function).parameters) > 2:
        return function

    def reference(
        parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
    ) -> Mapping[str, Array]:
        return function(parameters, time_s)

    return reference
