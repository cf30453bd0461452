"""A policy that was learnt: a small network of layers, kept as one NumPy file with its recipe."""

from __future__ import annotations

import json
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import InputError, NoSuchFile
from simcompare.model.trajectory import Array

#: what NumPy, the archive and the recipe raise. TypeError: an .npy file, which is one array;
#: RuntimeError: a locked archive, a way to compress that is not known, a recipe without end
_UNREADABLE = (
    OSError, ValueError, EOFError, TypeError, RuntimeError, MemoryError, zlib.error,
    zipfile.BadZipFile,
)  # fmt: skip
#: standardised observations are kept within this, as they are while it is learnt
LIMIT = 10.0


@dataclass(frozen=True, eq=False)
class Policy:
    """What is done at what is seen; NumPy alone runs it.

    Attributes:
        mean: of the observations that it was learnt from (n,).
        deviation: standard deviation of them (n,).
        layers: weights (outputs, inputs) and biases (outputs,); tanh stands between them.
        recipe: how it was learnt, by name.
    """

    mean: Array
    deviation: Array
    layers: Sequence[tuple[Array, Array]]
    recipe: Mapping[str, Any] = field(default_factory=dict)

    def __call__(self, seen: Array) -> Array:
        """The action (m,) within -1 and 1 at an observation (n,)."""
        found = np.clip((seen - self.mean) / self.deviation, -LIMIT, LIMIT)
        for weight, bias in self.layers[:-1]:
            found = np.tanh(weight @ found + bias)
        weight, bias = self.layers[-1]
        return np.asarray(np.clip(weight @ found + bias, -1, 1), dtype=float)

    def save(self, path: Path) -> None:
        """Writes it in single precision, which is what it was learnt in."""
        arrays = {"mean": self.mean, "deviation": self.deviation}
        for i, (weight, bias) in enumerate(self.layers):
            arrays |= {f"weight_{i}": weight, f"bias_{i}": bias}
        single: Mapping[str, Any] = {n: v.astype(np.float32) for n, v in arrays.items()}
        np.savez_compressed(path, recipe=np.array(json.dumps(self.recipe)), **single)


def load(path: str | Path, observations: int, actions: int) -> Policy:
    """Reads a policy for an environment.

    Args:
        path: its file.
        observations: how many numbers the environment shows.
        actions: how many numbers it takes.

    Raises:
        NoSuchFile: there is none.
        InputError: it is no policy, or one for another environment; all that does not fit.
    """
    path = Path(path)
    if not path.is_file():
        raise NoSuchFile(path)
    try:
        with np.load(path, allow_pickle=False) as file:
            held = {name: file[name] for name in file.files}
        recipe = json.loads(str(held.pop("recipe", np.array("{}"))))
        if not isinstance(recipe, dict):
            raise ValueError(f"its recipe is {recipe!r:.50}")
    except _UNREADABLE as error:
        fault = f"is no policy ({error}); expected an .npz file as Policy.save writes it"
        raise InputError(str(path), [fault]) from None
    if faults := [*_of_recipe(recipe), *_faults(held, observations, actions)]:
        raise InputError(str(path), faults)
    layers = [(held[f"weight_{i}"], held[f"bias_{i}"]) for i in range(_depth(held))]
    return Policy(held["mean"], held["deviation"], layers, recipe)


def _of_recipe(recipe: Mapping[str, Any]) -> Iterator[str]:
    """What tables of trials read of a recipe, and cannot."""
    for name, kind, wanted in (
        ("engine", str, "a text"), ("seed", int, "a whole number"),
        ("sensors", int | float, "a number"),
    ):  # fmt: skip
        found = recipe.get(name)
        if name in recipe and (isinstance(found, bool) or not isinstance(found, kind)):
            yield f"its recipe has {name} = {found!r:.50}; expected {wanted}"


def _depth(held: Mapping[str, Array]) -> int:
    return sum(name.startswith("weight_") for name in held)


def _faults(held: Mapping[str, Array], observations: int, actions: int) -> Sequence[str]:
    """What of the arrays of a file does not fit an environment, or each other."""
    depth = _depth(held)
    names = [part for i in range(depth) for part in (f"weight_{i}", f"bias_{i}")]
    wanted = ("mean", "deviation", *(names or ["weight_0"]))
    missing = [name for name in wanted if name not in held]
    if missing:
        return [f"{', '.join(missing)}: not in the file; expected an .npz as Policy.save writes it"]
    odd = [name for name, values in held.items() if values.dtype.kind not in "fiu"]
    if odd:
        return [f"{', '.join(odd)}: expected real numbers, found {held[odd[0]].dtype}"]
    found = []
    width, why = observations, "the observation of the environment"
    cure = "take a policy that was learnt in this environment"
    for name in ("mean", "deviation"):
        if held[name].shape != (observations,):
            found.append(f"{name} has shape {held[name].shape}; {why} has {observations}; {cure}")
    for i in range(depth):
        weight, bias = held[f"weight_{i}"], held[f"bias_{i}"]
        outputs = actions if i == depth - 1 else bias.size
        if weight.shape != (outputs, width) or bias.shape != (outputs,):
            found.append(
                f"layer {i} has weights {weight.shape} and biases {bias.shape}; expected"
                f" ({outputs}, {width}) and ({outputs},): {width} is {why}; {cure}"
            )
        width, why = bias.size, f"the output of layer {i}"
    wrong = [name for name, values in held.items() if not np.isfinite(values).all()]
    found += [f"{name}: not all numbers are finite" for name in wrong]
    if "deviation" not in wrong and not (held["deviation"] > 0).all():
        found.append("deviation: not all numbers are above 0")
    return found
