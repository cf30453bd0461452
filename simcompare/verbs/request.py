"""What a verb was asked, as one frozen value: its options, and the command that repeats it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from numbers import Integral, Real
from pathlib import Path
from typing import Annotated, Any, ClassVar, NamedTuple, get_type_hints

from simcompare.engine.assist import ALL
from simcompare.model.settings import ASSISTED, DEFAULT, TUNED

Values = Mapping[str, str | float] | None
Place = str | Path


class Option(NamedTuple):
    """How a field is asked for on the command line.

    Attributes:
        flag: name of the option.
        commas: whether several values stand behind one flag.
        always: whether the command names it, also where it is the default.
        unit: of a plain number.
    """

    flag: str
    commas: bool = False
    always: bool = False
    unit: str = ""


#: options of each kind of request, read once: that takes a hundredth of a second
_KNOWN: dict[type[Any], Mapping[str, Option]] = {}


@dataclass(frozen=True, kw_only=True)
class Request:
    """What every verb is asked.

    Attributes:
        verb: its name.
        scenario: name, folder or file.
        engine: "all" or names with commas.
        set: parameters that differ from the file.
        step: of the engine, "1ms" or in seconds.
    """

    verb: ClassVar[str]
    scenario: str
    engine: Annotated[str, Option("--engine", always=True)] = "all"
    set: Annotated[Values, Option("--set")] = None
    step: Annotated[Any, Option("--step", commas=True, unit="s")] = None

    def command(self) -> tuple[str, ...]:
        """The words of the command line that ask the same; what is the default is left out."""
        words = ["simcompare", self.verb, self.scenario]
        for one in fields(self):
            option, value = options(type(self)).get(one.name), getattr(self, one.name)
            if option is not None and (value != one.default or option.always):
                words += _words(option, value)
        return tuple(words)


@dataclass(frozen=True, kw_only=True)
class RunRequest(Request):
    """What ``run`` is asked; the options are those of ``simcompare.run``."""

    verb: ClassVar[str] = "run"
    contact: Annotated[tuple[str, ...], Option("--contact", commas=True)] = (
        DEFAULT,
        TUNED,
        ASSISTED,
    )
    assist: Annotated[tuple[str, ...], Option("--assist", commas=True)] = (ALL,)
    judge: Annotated[tuple[str, ...], Option("--judge", commas=True)] = (ASSISTED,)
    own: Annotated[Values, Option("--own")] = None
    robot: Annotated[Place | None, Option("--robot")] = None
    preset: Annotated[str | None, Option("--preset")] = None
    seeds: Annotated[int | None, Option("--seeds")] = None
    against: Annotated[Place | None, Option("--against")] = None
    sensor: Annotated[Mapping[str, Place | float] | None, Option("--sensor")] = None
    seed: Annotated[int, Option("--seed")] = 0


@dataclass(frozen=True, kw_only=True)
class FitRequest(Request):
    """What ``fit`` is asked; the options are those of ``simcompare.fit``."""

    verb: ClassVar[str] = "fit"
    recordings: Annotated[tuple[Place, ...], Option("--recording")] = ()
    hold_out: Annotated[tuple[Place, ...], Option("--hold-out")] = ()
    model: Annotated[str, Option("--model")] = "auto"
    unknowns: Annotated[tuple[str, ...], Option("--unknown", commas=True)] = ()
    fixed: Annotated[Values, Option("--fix")] = None
    priors: Annotated[Mapping[str, tuple[float, float]] | None, Option("--prior")] = None
    u_time_s: Annotated[float | None, Option("--u-time", unit="s")] = None
    preset: Annotated[str | None, Option("--preset")] = None
    mapping: Annotated[Place | None, Option("--map")] = None
    assist: Annotated[str | Sequence[str] | None, Option("--assist", commas=True)] = None


@dataclass(frozen=True, kw_only=True)
class ValidateRequest(Request):
    """What ``validate`` is asked; the options are those of ``simcompare.validate``."""

    verb: ClassVar[str] = "validate"
    recording: Annotated[Place, Option("--recording")]
    contact: Annotated[str, Option("--contact")] = ASSISTED
    mapping: Annotated[Place | None, Option("--map")] = None
    streams: Annotated[tuple[str, ...], Option("--streams", commas=True)] = ()
    strict: Annotated[bool, Option("--strict")] = False


@dataclass(frozen=True, kw_only=True)
class UncertaintyRequest(Request):
    """What ``uncertainty`` is asked; the options are those of ``simcompare.uncertainty``."""

    verb: ClassVar[str] = "uncertainty"
    scenario: str = ""
    engine: Annotated[str, Option("--engine")] = ""
    of: Annotated[str | None, Option("--of")] = None
    u: Annotated[Values, Option("--u")] = None
    inputs: Annotated[Place | None, Option("--inputs")] = None
    correlation: Annotated[Values, Option("--correlation")] = None
    contact: Annotated[str, Option("--contact")] = ASSISTED
    robot: Annotated[Place | None, Option("--robot")] = None
    preset: Annotated[str | None, Option("--preset")] = None
    seeds: Annotated[int | None, Option("--seeds")] = None
    trials: Annotated[int | None, Option("--trials")] = None
    probability: Annotated[float, Option("--probability")] = 0.95
    seed: Annotated[int, Option("--seed")] = 1

    def command(self) -> tuple[str, ...]:
        """The words of the command line that ask the same; a formula has no scenario."""
        return tuple(filter(None, super().command()))


def options(kind: type[Request]) -> Mapping[str, Option]:
    """Field -> its option."""
    if kind not in _KNOWN:
        hints = get_type_hints(kind, include_extras=True)
        known = {name: getattr(hint, "__metadata__", (None,))[0] for name, hint in hints.items()}
        _KNOWN[kind] = {name: one for name, one in known.items() if isinstance(one, Option)}
    return _KNOWN[kind]


def _words(option: Option, value: Any) -> list[str]:  # noqa: ANN401
    if value is True:
        return [option.flag]
    if isinstance(value, Mapping):
        texts = [_assigned(*item) for item in value.items()]
    else:
        parts = value if isinstance(value, tuple | list) else [value]
        texts = [_written(option, part) for part in parts]
    texts = [",".join(texts)] if option.commas else texts
    return [word for text in texts for word in (option.flag, text)]


def _written(option: Option, value: Any) -> str:  # noqa: ANN401
    return f"{_plain(value)!r}{option.unit}" if isinstance(value, Real) else str(value)


def _plain(value: Real) -> float | int:
    """A number of Python, where it is one of NumPy."""
    return int(value) if isinstance(value, Integral) else float(value)


def _assigned(name: str, value: Any) -> str:  # noqa: ANN401
    """``name=value``; of a prior ``name=value:u``."""
    return f"{name}={value[0]!r}:{value[1]!r}" if isinstance(value, tuple) else f"{name}={value}"
