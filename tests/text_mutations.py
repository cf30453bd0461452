"""Seeded damage to text: cells, lines, headers, separators, decimal marks, encodings."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

Edit = Callable[[random.Random, bytes], bytes]

#: sizes that a damaged length field may claim
HUGE = (2**60, 2**63 - 1, 2**63, 2**64 - 1, 2**40, 2**32 - 1, 2**31, 2**31 - 1, 10**9, 10**7)
CELLS = (
    "NaN", "nan", "inf", "-inf", "1e999", "-1e999", "1e-999", "", " ", "abc", "ERR", "9" * 40,
    "9" * 400, "-", "+", ".", "1.2.3", "1,2", "1.234,5", "1e", "0x10", "1_000", "١٢٣", "½", "²",
    "\0", "\ufeff", "∞", "true", "[1, 2]", '"', '""', "'", "1e5e5", "2024-13-45", "25:61:00",
    "2024-02-30 12:00:00", "#", "%", "=1+1", "1 000", "NULL", "-9999", "1e308", "4.9e-324",
    "−1",
)  # fmt: skip
LINES = (
    "garbage", "", ",,,", "\t\t\t", "#", "# remark", "time,x,y", "*** restarted ***", '"open quote',
    "1", "1,2", "0.5,0.5,0.5,0.5", "0.5,0.5,0.5,0.5,0.5,0.5,0.5", "\0\0\0\0", "a" * 70_000,
    "***End_of_Header***", "#multi:", "{", "]", "1;" * 500, "﻿time;x", "\x1a", "\u2028", "\x85",
)  # fmt: skip
HEADS = (
    "", "x", "time", "t (s)", "a (furlong)", "(V)", '"', "x" * 300, "1", "\0", "{}", "ä (°)",
    "t\nu", "x (m", ".",
)  # fmt: skip
ENCODINGS = ("utf-16", "utf-16-le", "utf-16-be", "utf-8-sig", "utf-32", "cp1252", "utf-7")


def text_edits(encoding: str) -> dict[str, Edit]:
    """Edits of a text, by their kind."""

    def of(edit: Callable[[random.Random, str], str]) -> Edit:
        def done(chance: random.Random, data: bytes) -> bytes:
            text = data.decode(encoding, "surrogateescape" if encoding == "utf-8" else "replace")
            changed = edit(chance, text)
            if encoding == "utf-8":
                return changed.encode(encoding, "surrogateescape")
            return changed.encode(encoding, "replace")

        return done

    return {
        "cell": of(_cell), "line": of(_line), "separators": of(_separators), "ends": of(_ends),
        "header": of(_header), "drop cells": of(_drop),
        "digits": of(_digits), "lines moved": of(_moved), "lines gone": of(_gone),
        "recoded": lambda chance, data: _recoded(chance, data, encoding),
        "decimal": of(_decimal), "quote": of(_quote),
    }  # fmt: skip


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True) or [""]


def _cell(chance: random.Random, text: str) -> str:
    """A cell becomes something else."""
    cells = list(re.finditer(r"[^,;\t\r\n]+", text))
    if not cells:
        return text
    cell = chance.choice(cells)
    return text[: cell.start()] + chance.choice(CELLS) + text[cell.end() :]


def _line(chance: random.Random, text: str) -> str:
    lines = _lines(text)
    lines.insert(
        chance.randrange(len(lines) + 1), chance.choice(LINES) + chance.choice(("\n", "\r\n"))
    )
    return "".join(lines)


def _separators(chance: random.Random, text: str) -> str:
    old, new = chance.choice(",;\t "), chance.choice(",;\t |:")
    if chance.random() < 0.5:
        return text.replace(old, new)
    at = chance.randrange(len(text) + 1)
    return text[:at] + text[at:].replace(old, new, chance.choice((1, 5, -1)))


def _ends(chance: random.Random, text: str) -> str:
    new = chance.choice(("\r\n", "\r", "\n\n", "\n\r", "", "\n ", "\x0b", "\x0c"))
    if chance.random() < 0.5:
        return text.replace("\r\n", "\n").replace("\n", new)
    at = chance.randrange(len(text) + 1)
    return text[:at] + text[at:].replace("\n", new, chance.choice((1, 3, -1)))


def _header(chance: random.Random, text: str) -> str:
    lines = _lines(text)
    at = chance.randrange(min(len(lines), 4))
    cells = re.split(r"([,;\t])", lines[at])
    k = chance.randrange(len(cells))
    cells[k] = chance.choice((*HEADS, cells[0], cells[-1]))
    lines[at] = "".join(cells)
    if chance.random() < 0.2:
        del lines[at]
    return "".join(lines)


def _drop(chance: random.Random, text: str) -> str:
    lines = _lines(text)
    for _ in range(chance.choice((1, 2, 10))):
        at = chance.randrange(len(lines))
        cells = re.split(r"([,;\t])", lines[at])
        lines[at] = "".join(cells[: chance.randrange(len(cells) + 1)]) + "\n"
    return "".join(lines)


def _digits(chance: random.Random, text: str) -> str:
    numbers = list(re.finditer(r"\d+", text))
    if not numbers:
        return text
    number = chance.choice(numbers)
    return text[: number.start()] + str(chance.choice((0, -1, *HUGE))) + text[number.end() :]


def _moved(chance: random.Random, text: str) -> str:
    lines = _lines(text)
    a, b = (chance.randrange(len(lines)) for _ in range(2))
    lines.insert(a, lines.pop(b))
    return "".join(lines)


def _gone(chance: random.Random, text: str) -> str:
    lines = _lines(text)
    start = chance.randrange(len(lines))
    del lines[start : start + chance.choice((1, 1, 5, 50))]
    return "".join(lines)


def _decimal(chance: random.Random, text: str) -> str:
    old, new = chance.choice(((".", ","), (",", "."), (".", ""), (".", "..")))
    at = chance.randrange(len(text) + 1) if chance.random() < 0.5 else 0
    return text[:at] + text[at:].replace(old, new, chance.choice((1, -1)))


def _quote(chance: random.Random, text: str) -> str:
    at = chance.randrange(len(text) + 1)
    return text[:at] + chance.choice("\"'[{(\\#%") + text[at:]


def _recoded(chance: random.Random, data: bytes, encoding: str) -> bytes:
    text = data.decode(encoding, "replace")
    return text.encode(chance.choice(ENCODINGS), "replace")
