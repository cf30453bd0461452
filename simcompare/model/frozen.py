"""What parts of users' files are read into: frozen, finite, and no truth value is a number."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from typing import Any, get_args

from pydantic import BaseModel, ConfigDict, model_validator


class Frozen(BaseModel):
    """Base of every part of a user's file: immutable, finite numbers, no unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _no_truth_for_a_number(cls, given: Any) -> Any:  # noqa: ANN401
        """Pydantic takes true for 1. As a text it is refused where a number is expected."""
        if not isinstance(given, dict):
            return given
        numbers = _numbers(cls)
        return {key: _told(one) if key in numbers else one for key, one in given.items()}


@functools.cache
def _numbers(model: type[BaseModel]) -> frozenset[str]:
    """Keys of fields that hold numbers, and neither truth values nor models, which check theirs."""
    found = set()
    for name, field in model.model_fields.items():
        kinds = set(_kinds(field.annotation))
        others = (one for one in kinds if isinstance(one, type) and issubclass(one, BaseModel))
        if kinds & {int, float} and bool not in kinds and not any(others):
            found.add(field.alias or name)
    return frozenset(found)


def _kinds(annotation: Any) -> Iterator[Any]:  # noqa: ANN401
    """The kinds of value in an annotation such as ``Mapping[str, float | None]``."""
    inner = get_args(annotation)
    for one in inner:
        yield from _kinds(one)
    if not inner:
        yield annotation


def _told(value: Any) -> Any:  # noqa: ANN401
    """The same, with truth values as they are written."""
    if isinstance(value, dict):
        return {key: _told(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_told(one) for one in value]
    return str(value).lower() if isinstance(value, bool) else value
