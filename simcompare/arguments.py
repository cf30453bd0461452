"""Arguments of our functions, held against the types that these say they take.

Pydantic does not serve here: strict, it refuses whole numbers of NumPy; else it takes "3" for 3.
"""

from __future__ import annotations

import functools
import inspect
import re
import threading
import types
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from numbers import Integral, Real
from pathlib import Path, PurePath
from typing import Any, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

from simcompare.errors import InputError, SimcompareError, UnknownName

Asked = ParamSpec("Asked")
Given = TypeVar("Given")
#: types that stand for more than their own instances, numbers of NumPy among them
_KINDS: Mapping[Any, type] = {float: Real, int: Integral, Path: PurePath}
#: options that are called otherwise here
_ARGUMENTS = {
    "map": "mapping", "unknown": "unknowns", "fix": "fixed", "prior": "priors", "as": "kind",
    "u_time": "u_time_s", "time_limit": "time_limit_s",
}  # fmt: skip
_OPTION = re.compile(r"simcompare [a-z]+ [^;\n]*|--(?P<option>[a-z]+(?:-[a-z]+)*)")
_by_options: ContextVar[bool] = ContextVar("_by_options", default=False)
_limit_s: ContextVar[float | None] = ContextVar("_limit_s", default=None)
_WORDS: Mapping[Any, str] = {
    str: "text",
    Path: "a path",
    bool: "True or False",
    int: "a whole number",
    float: "a number",
}


def checked(function: Callable[Asked, Given]) -> Callable[Asked, Given]:
    """The same function; it refuses what it does not take with one error that names all of it."""

    @functools.wraps(function)
    def called(*args: Asked.args, **kwargs: Asked.kwargs) -> Given:
        hints, given = _hints(function), _bound(function, args, kwargs)
        faults = [
            f"{name}={value!r}: expected {words(hints[name])}"
            for name, value in given.items()
            if name in hints and not fits(value, hints[name])
        ]
        faults += [
            f"{name}={value!r} is empty; expected {words(hints[name])}"
            for name, value in given.items()
            if name in hints and _takes_path(hints[name]) and _is_empty(value)
        ]
        if faults:
            raise InputError(function.__name__, faults)
        try:
            with _limited(given.get("time_limit_s")):
                return function(*args, **kwargs)
        except SimcompareError as error:
            if not _by_options.get():
                error.args = tuple(_in_python(str(arg), hints) for arg in error.args)
            raise

    return called


def time_limit_s(usual_s: float) -> float:
    """The longest time that the function in progress was told for one simulation [s].

    Args:
        usual_s: where it was told none.
    """
    return min(_limit_s.get() or usual_s, threading.TIMEOUT_MAX)


@contextmanager
def _limited(limit_s: Any) -> Iterator[None]:  # noqa: ANN401
    """Keeps a time limit at hand for what is called; one that is none is told elsewhere."""
    token = _limit_s.set(float(limit_s) if limit_s is not None and limit_s > 0 else _limit_s.get())
    try:
        yield
    finally:
        _limit_s.reset(token)


@contextmanager
def given_as_options() -> Iterator[None]:
    """While the command line calls: what it was given are options, and errors name those."""
    token = _by_options.set(True)
    try:
        yield
    finally:
        _by_options.reset(token)


def _hints(function: Callable[..., Any]) -> Mapping[str, Any]:
    """The types of the arguments; that of the answer may be unknown until it is needed."""
    asked = {name: hint for name, hint in function.__annotations__.items() if name != "return"}
    holder = types.SimpleNamespace(__annotations__=asked)
    return get_type_hints(holder, getattr(inspect.unwrap(function), "__globals__", {}))


def _in_python(text: str, arguments: Collection[str]) -> str:
    """A message with the names of arguments for options; commands in it stay as they are."""

    def called(found: re.Match[str]) -> str:
        word = (found["option"] or "").replace("-", "_")
        names = [_ARGUMENTS.get(word, word), f"{word}s"]
        return next((name for name in names if word and name in arguments), found[0])

    return _OPTION.sub(called, text)


def _bound(
    function: Callable[..., Any], args: Sequence[object], kwargs: Mapping[str, object]
) -> Mapping[str, object]:
    """Each argument by its name.

    Raises:
        InputError: one that there is not, or one that is missing.
    """
    signature = inspect.signature(function)
    known = signature.parameters
    faults = [_unknown(name, kwargs[name], known) for name in kwargs if name not in known]
    by_place = [one for one in known.values() if one.kind is not one.KEYWORD_ONLY]
    by_name = [one.name for one in known.values() if one.kind is one.KEYWORD_ONLY]
    if by_name and len(args) > len(by_place):
        extra = args[len(by_place)]
        faults.append(f"{extra!r} needs a name, such as {by_name[0]}={extra!r}")
    try:
        return signature.bind(*args, **kwargs).arguments
    except TypeError as error:
        raise InputError(function.__name__, faults or [str(error)]) from None


def _unknown(name: str, value: object, known: Collection[str]) -> str:
    """That there is no argument of a name; it may be a parameter of the scenario."""
    fault = str(UnknownName("argument", name, known))
    cure = f"set={{{name!r}: {value!r}}}"
    return f"{fault}; a parameter of the scenario is given as {cure}" if "set" in known else fault


def fits(value: object, hint: Any) -> bool:  # noqa: ANN401
    """Whether a value is what a type says."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return any(fits(value, one) for one in inner)
    if origin is tuple and Ellipsis not in inner:
        return isinstance(value, Sequence) and len(value) == len(inner) and all(
            map(fits, value, inner)
        )  # fmt: skip
    if origin is Callable:
        return callable(value)
    if origin is Mapping:
        return isinstance(value, Mapping) and all(
            fits(key, inner[0]) and fits(one, inner[1]) for key, one in value.items()
        )
    if origin is not None:
        is_text = isinstance(value, str | bytes | Mapping)
        return (
            isinstance(value, Collection)
            and not is_text
            and all(fits(one, inner[0]) for one in value)
        )
    is_truth = isinstance(value, bool) and hint is not bool
    return hint is Any or (isinstance(value, _KINDS.get(hint, hint)) and not is_truth)


def _takes_path(hint: Any) -> bool:  # noqa: ANN401
    return hint is Path or any(map(_takes_path, get_args(hint)))


def _is_empty(value: object) -> bool:
    """Whether a text is empty, or one in a list: as a path it would mean the current folder."""
    return value == "" or (isinstance(value, list | tuple) and "" in value)


def words(hint: Any) -> str:  # noqa: ANN401
    """A type in words; what may be left out is not told."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return _joined([words(one) for one in inner if one is not type(None)])
    if origin is Callable:
        return "a function"
    if origin is Mapping:
        return f"a dictionary of names with {words(inner[1])}"
    if origin is tuple and Ellipsis not in inner:
        return f"{len(inner)} of {words(inner[0])}"
    if origin is not None:
        return f"a list of {words(inner[0])}"
    return _WORDS.get(hint, getattr(hint, "__name__", str(hint)))


def _joined(parts: Sequence[str]) -> str:
    return " or ".join([", ".join(parts[:-1]), parts[-1]] if parts[:-1] else parts)
