"""The examples run as their first lines say."""

import ast
import functools
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from simcompare.engine import engines
from tests.present import INSTALLED

EXAMPLES = Path(__file__).parent.parent / "examples"


@functools.cache
def run(path):
    """What an example prints; each takes seconds, and two tests look at it."""
    return subprocess.run(
        [sys.executable, path],
        cwd=tempfile.gettempdir(),
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_an_example_runs(path):
    done = run(path)
    assert done.returncode == 0, done.stderr
    assert "python examples/" + path.name in path.read_text(encoding="utf-8")


def cells(path):
    """The code of a notebook, cell by cell."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    codes = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert not any(cell["outputs"] for cell in codes)
    return ["".join(cell["source"]) for cell in codes]


@pytest.mark.engines("mujoco", "dart", "pymunk")
@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_runs_and_every_cell_shows_something(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    space = {}
    for code in cells(path):
        *before, last = ast.parse(code).body
        exec(compile(ast.Module(before, []), str(path), "exec"), space)
        assert isinstance(last, ast.Expr), code
        shown = eval(compile(ast.Expression(last.value), str(path), "eval"), space)
        assert shown is not None, code
    if path.stem == "first_steps":  # it writes its report
        assert (tmp_path / "ball.html").is_file()


def test_the_controller_drives_every_engine_along_the_line():
    done = run(EXAMPLES / "drive_along_a_line.py")
    assert done.returncode == 0, done.stderr
    rows = {line.split()[0]: line for line in done.stdout.splitlines()}
    assert set(rows) == set(engines.names())
    for row in map(rows.get, INSTALLED):
        speed = float(row.partition(" s: ")[2].split()[0])
        beside_mm = float(row.split()[-4])
        assert speed == pytest.approx(0.3, rel=0.05)
        assert abs(beside_mm) < 10


def test_the_scene_with_joints_that_is_shown_to_contributors_runs(tmp_path):
    import simcompare

    text = (EXAMPLES.parent / "CONTRIBUTING.md").read_text(encoding="utf-8")
    scene = text.partition("```yaml\nname: driven_pendulum")[2].partition("```")[0]
    path = tmp_path / "driven_pendulum.yaml"
    path.write_text("name: driven_pendulum" + scene, encoding="utf-8")
    run = simcompare.run(str(path), contact="assisted")
    ends = [score.value for score in run.record.scores if score.measure == "final"]
    assert len(ends) == len(INSTALLED)
    # the motor has lifted it, and all engines agree how far
    assert min(ends) > 0.1
    assert max(ends) - min(ends) < 1e-3
