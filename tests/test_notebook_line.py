"""What a notebook shows while a verb runs, and of an error."""

import sys
from types import ModuleType, SimpleNamespace

import pytest

from simcompare.engine import engines
from simcompare.errors import InputError, UnknownName
from simcompare.verbs.notebook_line import in_notebook, with_line


@with_line
def verb(count, progress=None):
    """Counts."""
    for done in range(1, count + 1):
        if progress is not None:
            progress("<engine>", done, count)
    return count


@pytest.fixture
def notebook(monkeypatch):
    """A kernel that keeps what is displayed, line after line."""
    shown = []
    display = ModuleType("IPython.display")
    display.HTML = str
    display.display = lambda text, display_id: (
        shown.append(text) or SimpleNamespace(update=shown.append)
    )
    ipython = ModuleType("IPython")
    ipython.get_ipython = lambda: SimpleNamespace(kernel=None)
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    return shown


def test_a_terminal_is_no_notebook(monkeypatch):
    ipython = ModuleType("IPython")
    ipython.get_ipython = lambda: None
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    assert not in_notebook()
    assert verb(2) == 2


def test_a_notebook_shows_one_line_that_vanishes(notebook):
    assert verb(2) == 2
    assert notebook == [
        '<progress max="2" value="1"></progress> 1 of 2, &lt;engine&gt;',
        '<progress max="2" value="2"></progress> 2 of 2, &lt;engine&gt;',
        "",
    ]


def test_it_vanishes_after_an_error_too(notebook):
    @with_line
    def failing(progress=None):
        progress("mine", 1, 2)
        raise InputError("verb", ["fails"])

    with pytest.raises(InputError):
        failing()
    assert notebook[-1] == ""


def test_nothing_is_shown_where_nothing_is_done_or_somebody_else_is_told(notebook):
    told = []
    verb(0)
    verb(1, progress=lambda *one: told.append(one))
    assert told == [("<engine>", 1, 1)]
    assert notebook == []


def test_an_error_in_a_notebook_is_the_users_line_and_the_message():
    with pytest.raises(UnknownName) as caught:
        engines.select("mujco")
    lines = caught.value._render_traceback_()
    assert lines[0].endswith(': engines.select("mujco")')
    assert lines[1:] == ["UnknownName: no engine is called 'mujco'; did you mean mujoco?"]
