"""How far a verb has come, as one line in a notebook; it vanishes at the end."""

from __future__ import annotations

import functools
import html
import sys
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

Asked = ParamSpec("Asked")
Given = TypeVar("Given")


def with_line(function: Callable[Asked, Given]) -> Callable[Asked, Given]:
    """The same verb; in a notebook it shows how far it is where nobody else is told."""

    @functools.wraps(function)
    def called(*args: Asked.args, **kwargs: Asked.kwargs) -> Given:
        if kwargs.get("progress") is not None or not in_notebook():
            return function(*args, **kwargs)
        line = _Line()
        kwargs["progress"] = line.show
        try:
            return function(*args, **kwargs)
        finally:
            line.end()

    return called


def in_notebook() -> bool:
    """Whether a kernel of Jupyter runs this, and not a terminal."""
    ipython = sys.modules.get("IPython")
    return ipython is not None and hasattr(ipython.get_ipython(), "kernel")


class _Line:
    """An output of its own below the cell, which is written anew."""

    def __init__(self) -> None:
        self._output: Any = None

    def show(self, engine: str, done: int, total: int) -> None:
        self._write(
            f'<progress max="{total}" value="{done}"></progress>'
            f" {done} of {total}, {html.escape(engine)}"
        )

    def end(self) -> None:
        if self._output is not None:
            self._write("")

    def _write(self, text: str) -> None:
        from IPython.display import HTML, display

        if self._output is None:
            self._output = display(HTML(text), display_id=True)
        else:
            self._output.update(HTML(text))
