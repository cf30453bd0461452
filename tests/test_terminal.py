"""The terminal: options of every verb, opening a report, widths."""

from __future__ import annotations

import webbrowser
from pathlib import Path

import pytest


@pytest.fixture
def opened(monkeypatch):
    """Addresses that the browser was given; ``opened.works = False`` for a machine without one."""

    class Opened(list):
        works = True

        def __call__(self, address):
            self.append(address)
            return self.works

    addresses = Opened()
    monkeypatch.setattr(webbrowser, "open", addresses)
    return addresses


# --- opening a report -------------------------------------------------------------------------


def test_open_shows_the_report_in_the_browser(call, fall, add_engine, opened, tmp_path):
    add_engine("toy")
    words = ("run", fall, "--engine", "toy", "--contact", "assisted")
    assert call(*words)[0] == 0
    assert opened == [], "nothing opens by itself"
    _, out, _ = call(*words, "--open")
    (address,) = opened
    (place,) = [line.split(": ")[1] for line in out.splitlines() if line.startswith("Report: ")]
    assert address == (tmp_path / place).resolve().as_uri()
    assert call("report", Path(place).parent, "--open")[0] == 0
    assert opened == [address] * 2


def test_where_there_is_no_browser_the_page_is_named(call, fall, add_engine, opened):
    add_engine("toy")
    opened.works = False
    words = ("run", fall, "--engine", "toy", "--contact", "assisted", "--open")
    code, _, err = call(*words)
    assert code == 0
    assert "No browser was found; open runs" in err


def test_a_report_that_is_not_written_is_not_opened(call, fall, opened):
    code, out, err = call("run", fall, "--open", "--no-report")
    assert (code, out, opened) == (2, "", [])
    assert "--open: there is no page to open; leave out --no-report" in err
