"""What is installed: every folder that ships is listed, and a wheel holds all that they hold."""

import importlib.util
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from tests.present import need

ROOT = Path(__file__).parent.parent
OUTER = ("backends", "hardware", "reports", "scenarios")


def configuration():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def folders_with_code():
    for top in ("simcompare", *OUTER):
        for path in (ROOT / top).rglob("*"):
            linked = top == "simcompare" and path.relative_to(ROOT / top).parts[0] in OUTER
            if path.is_file() and not linked and "__pycache__" not in path.parts:
                yield path


def package_of(folder):
    parts = folder.relative_to(ROOT).parts
    return ".".join(parts if parts[0] == "simcompare" else ("simcompare", *parts))


def test_every_folder_that_holds_files_is_listed():
    listed = set(configuration()["tool"]["setuptools"]["packages"])
    present = {package_of(path.parent) for path in folders_with_code()}
    assert present == listed


def test_every_package_has_an_init():
    for path in {path.parent for path in folders_with_code()}:
        assert (path / "__init__.py").is_file(), path


def test_outer_folders_are_linked_relatively():
    for name in OUTER:
        link = ROOT / "simcompare" / name
        assert link.is_symlink()
        assert link.readlink() == Path("..") / name


def test_files_are_short_and_say_what_they_are():
    for path in folders_with_code():
        if path.suffix != ".py":
            continue
        text = path.read_text(encoding="utf-8")
        assert text.lstrip().startswith('"""'), f"{path} has no docstring"
        # two backends carry four shapes and their audit; they are one job each
        assert text.count("\n") <= 420, f"{path} is too long to read in one go"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    # from a copy: setuptools builds inside the source and takes up what an earlier build left there
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    left_out = shutil.ignore_patterns(".*", "build", "runs", "*.egg-info", "__pycache__")
    shutil.copytree(ROOT, source, symlinks=True, ignore=left_out)
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", folder, source],
        check=True,
        capture_output=True,
    )
    (made,) = folder.glob("*.whl")
    return made


def test_a_wheel_holds_every_file(wheel):
    inside = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info" not in name}
    expected = set()
    for path in folders_with_code():
        parts = path.relative_to(ROOT).parts
        expected.add("/".join(parts if parts[0] == "simcompare" else ("simcompare", *parts)))
    assert inside == expected


def test_the_wheel_works_without_the_checkout(tmp_path, wheel):
    """In an environment of its own, which knows the libraries, but not this folder."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "env"], check=True)
    python = tmp_path / "env" / "bin" / "python"
    (place,) = (tmp_path / "env" / "lib").glob("python*/site-packages")
    zipfile.ZipFile(wheel).extractall(place)
    # files that end in .pth within these folders, such as ours of this checkout, are not read
    libraries = [path for path in sys.path if Path(path).name in ("site-packages", "dist-packages")]
    (place / "libraries.pth").write_text("\n".join(libraries), encoding="utf-8")

    def simcompare(*words):
        command = [python, "-P", "-m", "simcompare", *words]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)

    where = [python, "-P", "-c", "import simcompare; print(simcompare.__file__)"]
    found = subprocess.run(where, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == str(place / "simcompare" / "__init__.py")
    assert "ball" in simcompare("list").stdout
    need("pymunk")
    simcompare("run", "ball", "--engine", "pymunk", "--seeds", "1")
    assert len(list(tmp_path.glob("runs/*/report.html"))) == 1


def test_every_engine_has_an_extra_of_its_name():
    from simcompare.engine import engines

    extras = configuration()["project"]["optional-dependencies"]
    for name in engines.names():
        assert name in extras
        assert any(name in part for part in extras["engines"])


@pytest.mark.parametrize("name", ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE"])
def test_the_papers_are_there(name):
    assert (ROOT / name).stat().st_size > 200


READERS = ("h5py", "rosbags", "nptdms", "soundfile", "pooch")


@pytest.mark.parametrize("module", READERS)
def test_the_readers_of_the_extra_test_are_installed(module):
    """Tests of formats are skipped without them; so that this is seen, one test fails."""
    assert importlib.util.find_spec(module), f"{module} is missing; pip install -e '.[test]'"
