"""Runs scripts where simcompare cannot be imported: python -I script_runner.py FOLDER.

Prints one JSON object: name of each script -> what it printed, or the traceback that ended it. The
argument of a script, if it has one, is in the file NAME.arg beside it.
"""

import contextlib
import importlib.abc
import io
import json
import runpy
import sys
import traceback
from pathlib import Path


class Hidden(importlib.abc.MetaPathFinder):
    """Finds no simcompare."""

    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "simcompare":
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


def run(path):
    """What a script prints."""
    arg = path.with_suffix(".arg")
    sys.argv = [str(path), *(arg.read_text().split() if arg.exists() else [])]
    out = io.StringIO()
    try:
        with contextlib.redirect_stdout(out):
            runpy.run_path(str(path), run_name="__main__")
    except BaseException:  # noqa: BLE001
        return {"error": traceback.format_exc(limit=-2)}
    finally:
        if "pybullet" in sys.modules:  # the next script's calls would go to this one's world
            with contextlib.suppress(sys.modules["pybullet"].error):
                sys.modules["pybullet"].disconnect()
    return {"out": out.getvalue()}


if __name__ == "__main__":
    sys.meta_path.insert(0, Hidden())
    print(json.dumps({path.stem: run(path) for path in sorted(Path(sys.argv[1]).glob("*.py"))}))
