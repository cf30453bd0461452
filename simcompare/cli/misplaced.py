"""Words that stand where the command line cannot take them, and what was meant."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperCommand

from simcompare import units
from simcompare.cli import complete, trusting
from simcompare.errors import InputError, SimcompareError, UnknownName, UntrustedCode
from simcompare.scenarios import catalogue

_TIMES = {2: "twice"}
_MORE = "simcompare {} --help has examples"
#: what the parser raises where words do not fit
_USAGE: type[Exception] = typer.BadParameter.__mro__[1]


class Verb(TyperCommand):
    """A verb that says which option a word too many belongs to."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:  # noqa: ANN401
        """Reads the words behind the verb."""
        _refuse_empty(args, {name for p in self.params if not _is_flag(p) for name in p.opts})
        given, takes_more, ctx.allow_extra_args = [*args], ctx.allow_extra_args, True
        try:
            if not ctx.resilient_parsing:
                _refuse_twice(str(self.name), given, self.make_parser(ctx).parse_args([*args])[2])
            super().parse_args(ctx, args)
        except typer.BadParameter as error:
            raise self._missing(error) or _no_number(error, given) or error from None
        except _USAGE as error:
            raise self._no_option(error) or error from None
        if ctx.args and not takes_more and not ctx.resilient_parsing:
            raise too_many(str(self.name), given, ctx.args, self.params)
        return list(ctx.args)

    def invoke(self, ctx: Any) -> Any:  # noqa: ANN401
        """Runs it, and again where code from elsewhere stands in the way and may then run."""
        try:
            return super().invoke(ctx)
        except UntrustedCode as error:
            if not trusting.agreed(error):
                raise
        return super().invoke(ctx)

    def _missing(self, error: typer.BadParameter) -> InputError | None:
        """What is said where something that must be given is not."""
        param, more = error.param, _MORE.format(self.name)
        if param is None or type(error).__name__ != "MissingParameter":
            return None
        if param.name == "scenario":
            return which_scenario(str(self.name))
        name = param.opts[0] if param.param_type_name == "option" else str(param.name).upper()
        wanted = (getattr(param, "help", "") or "a value").rstrip(".")
        return InputError(str(self.name), [f"{name} is missing ({wanted}); {more}"])

    def _no_option(self, error: Any) -> SimcompareError | None:  # noqa: ANN401
        """What is said of an option that there is not, or that has no value, or one too many."""
        name, more = getattr(error, "option_name", None), f"simcompare {self.name} --help"
        if name is None:
            return None
        by_name = {name: param for param in self.params for name in param.opts}
        if hasattr(error, "possibilities"):
            both = [one for param in self.params for one in (*param.opts, *param.secondary_opts)]
            known = [one for one in both if one.startswith("--")]
            return UnknownName(f"option of {self.name}", name, known)
        cure = "takes no value" if _is_flag(by_name.get(name)) else "needs a value behind it"
        return InputError(str(self.name), [f"{name} {cure}; all options: {more}"])


def which_scenario(verb: str) -> InputError:
    """What is said where a scenario must be given and is not."""
    return InputError(verb, [f"which scenario? simcompare list names all, {_MORE.format(verb)}"])


def _is_flag(param: Any) -> bool:  # noqa: ANN401
    return bool(getattr(param, "is_flag", False))


def _takes_commas(param: Any) -> bool:  # noqa: ANN401
    return "commas" in (getattr(param, "help", "") or "") and not param.multiple


def _refuse_twice(verb: str, words: Sequence[str], order: Sequence[Any]) -> None:
    """Refuses options that take one value and are given several, of which all but one are lost.

    Args:
        verb: its name.
        words: as they were typed.
        order: of the parser: the option or argument that each belongs to.

    Raises:
        InputError: all of them.
    """
    twice = [param for param, count in Counter(order).items() if count > 1 and _is_single(param)]
    faults = [f"{param.opts[0]} {_twice(param, words)}" for param in twice]
    if faults:
        raise InputError(verb, faults)


def _is_single(param: Any) -> bool:  # noqa: ANN401
    return param.param_type_name == "option" and not (param.multiple or _is_flag(param))


def _twice(param: Any, words: Sequence[str]) -> str:  # noqa: ANN401
    values = _values(param.opts, words)
    cure = f"write {param.opts[0]} {','.join(values)}" if _takes_commas(param) else "give one"
    return f"is given {_TIMES.get(len(values), 'several times')}: {', '.join(values)}; {cure}"


def _values(names: Collection[str], words: Sequence[str]) -> list[str]:
    """What stands behind an option, wherever it is given."""
    values = []
    for word, behind in pairwise([*words, ""]):
        name, equals, text = word.partition("=")
        if name in names:
            values.append(text if equals else behind)
    return values


def _refuse_empty(words: Sequence[str], options: Collection[str]) -> None:
    """Refuses empty texts, which a path would take for the current folder.

    Raises:
        InputError: all of them.
    """
    behind = [option for option, text in pairwise(words) if option in options and not text]
    within = [word[:-1] for word in words if word.endswith("=") and word[:-1] in options]
    alone = ["''" for before, word in pairwise(["", *words]) if not word and before not in options]
    if behind or within or alone:
        what = "is empty; give a value, or leave it out"
        raise InputError(", ".join(dict.fromkeys([*behind, *within, *alone])), [what])


def _no_number(error: typer.BadParameter, words: Sequence[str]) -> InputError | None:
    """What stands behind an option that takes a number and was given none."""
    names = [*getattr(error.param, "opts", ())]
    found = _values(names, words)
    if not found or not ("integer" in error.message or "number" in error.message):
        return None
    whole = "integer" in error.message
    pointed = None if whole else units.with_point(found[-1])
    wanted = "a whole number, such as 9" if whole else "a number, such as 60"
    cure = f"write {pointed}" if pointed else f"expected {wanted}"
    return InputError(names[0], [f"{found[-1]!r} is no number here; {cure}"])


def too_many(
    verb: str, given: Sequence[str], extra: Sequence[str], params: Sequence[Any]
) -> SimcompareError:
    """The error of a verb that was given words that it has no place for.

    Args:
        verb: its name.
        given: all words behind it.
        extra: those for which there is no place.
        params: options and arguments that the verb has.
    """
    left = [*given]
    for word in extra:
        left.remove(word)
    by_name = {name: param for param in params for name in param.opts}
    options = [(_option_of(word, by_name), word) for word in extra]
    named = " and ".join(map(repr, extra))
    if any(not option for option, _ in options):
        known = f"all options: simcompare {verb} --help"
        return InputError(verb, [f"nothing is known of {named} here; {known}"])
    for option, word in options:
        left = _with(left, by_name[option], option, word)
    command = shlex.join(["simcompare", verb, *left])
    return InputError(verb, [f"{named} must stand behind an option; write: {command}"])


def _with(words: Sequence[str], param: Any, option: str, word: str) -> list[str]:  # noqa: ANN401
    """The words of a command with one more value of an option, which is given once if it must."""
    others: list[str] = []
    earlier = _values(param.opts, words) if _is_single(param) else []
    rest = iter(words)
    for one in rest:
        name, equals, _ = one.partition("=")
        if not (earlier and name in param.opts):
            others.append(one)
        elif not equals:
            next(rest, None)
    kept = earlier if _takes_commas(param) else []
    return [*others, option, ",".join([*kept, word])]


def _option_of(word: str, options: Collection[str]) -> str:
    """The option of a word that stands alone; empty where none fits."""
    for name, fits in (
        ("--set", "=" in word), ("--engine", _is_engines(word)),
        ("--contact", set(word.split(",")) <= {*complete.contact_levels("")}),
        ("--recording", Path(word).is_file()),
    ):  # fmt: skip
        if name in options and fits:
            return name
    return ""


def _is_engines(word: str) -> bool:
    from simcompare.engine import engines

    names = [one.partition(engines.VARIANT)[0] for one in word.split(",")]
    return set(names) <= {*engines.names(), "all"}


def unknown(name: str, rest: Sequence[str], verbs: Iterable[str]) -> SimcompareError:
    """The error of a first word that is no verb.

    Args:
        name: this word.
        rest: all behind it.
        verbs: that there are.
    """
    if name in catalogue.names():
        command = shlex.join(["simcompare", "run", name, *rest])
        return InputError(name, [f"is a scenario; write: {command}"])
    if _is_engines(name):
        command = shlex.join(["simcompare", "run", "ball", "--engine", name, *rest])
        return InputError(name, [f"is an engine; write, such as: {command}"])
    return UnknownName("command", name, verbs)
