"""Puts what commands print today into the pages that show it.

Usage: ``python tools/refresh_docs.py [PAGE …]``; all pages by default.
Above a block stands a remark that a reader does not see:
``<!-- shown: simcompare run ball; from: restitution; until: Stored; lines: 9 -->``.
The command runs beside the examples. What is shown begins with the first line that holds one
text, ends before the next one that holds the other, and has so many lines at most; each of the
three may be left out.

A figure of a lab page, and of a scenario's, stands above the line that draws it, which a reader
can type as well:
``*Drawn by* `simcompare.run("ball").plot("restitution")` ``.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
SHOWN = re.compile(
    r"<!-- shown: (?P<command>[^;]+?)(?:; from: (?P<start>[^;]+?))?(?:; until: (?P<end>[^;]+?))?"
    r"(?:; lines: (?P<lines>\d+))? -->\n```\n(?P<block>.*?)```\n",
    re.DOTALL,
)

DRAWN = re.compile(r"!\[[^\]]*\]\((?P<file>[^)]+)\)\n\*Drawn by\* `(?P<line>[^`]+)`")
#: dots to the inch of the figures, and their colours: a palette keeps the files small
_DPI, _COLOURS = 100, 128


def main() -> None:
    """Refreshes the pages that are named, or all."""
    every = [ROOT / "README.md", *ROOT.glob("docs/*.md"), *ROOT.glob("docs/lab/*.md")]
    every += ROOT.glob("scenarios/*/README.md")
    pages = [Path(name) for name in sys.argv[1:]] or every
    for page in pages:
        text = page.read_text(encoding="utf-8")
        page.write_text(SHOWN.sub(refreshed, text), encoding="utf-8")
        for figure in DRAWN.finditer(text):
            draw(figure["line"], page.resolve().parent / figure["file"])


def refreshed(shown: re.Match[str]) -> str:
    """The remark with the block below it as the command fills it today."""
    remark = shown.group(0).partition("\n")[0]
    block = cut(printed(shown["command"]), shown["start"], shown["end"])
    lines = block[: int(shown["lines"])] if shown["lines"] else block
    return "\n".join([remark, "```", *lines, "```", ""])


def draw(line: str, file: Path) -> None:
    """Writes the figure that a line of Python gives."""
    script = f"import simcompare; ({line}).savefig({str(file)!r}, dpi={_DPI})"
    done = beside_the_examples([sys.executable, "-c", script])
    if done.returncode:
        raise SystemExit(f"{line}\n{done.stderr}")
    with Image.open(file) as drawn:
        drawn.convert("RGB").quantize(_COLOURS).save(file, optimize=True)


def beside_the_examples(words: list[str]) -> subprocess.CompletedProcess[str]:
    """Runs a command in a new folder that holds the examples and nothing else."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "examples").symlink_to(ROOT / "examples")
        return subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)


def cut(text: str, start: str | None, end: str | None) -> list[str]:
    """Lines from the one that holds a text to before the one that holds the other."""
    every = [line.rstrip() for line in text.strip("\n").splitlines()]
    first = next((i for i, line in enumerate(every) if start and start in line), 0)
    after = every[first + 1 :]
    count = next((i for i, line in enumerate(after) if end and end in line), len(after))
    block = every[first : first + 1 + count]
    while block and not block[-1]:
        block.pop()
    return block


@cache
def printed(command: str) -> str:
    """What a command of simcompare prints in a pipe."""
    words = shlex.split(command)
    assert words[0] == "simcompare", command
    done = beside_the_examples([sys.executable, "-m", *words])
    if done.returncode not in (0, 1):  # 1: a tolerance is missed
        raise SystemExit(f"{command}\n{done.stderr}")
    return done.stdout


if __name__ == "__main__":
    main()
