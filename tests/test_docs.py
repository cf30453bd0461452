"""README and docs: short, with links that lead somewhere and commands that exist."""

import re
import shlex
import sys
from pathlib import Path

import pytest

import simcompare
from simcompare import glossary
from simcompare.cli.console import pairs
from simcompare.engine import engines
from simcompare.scenarios import catalogue
from tests.present import need
from tools import refresh_docs

ROOT = Path(__file__).parent.parent
LABS = sorted(ROOT.glob("docs/lab/*.md"))
STUDENTS = [page for page in LABS if page.name not in ("README.md", "solutions.md")]
OF_SCENARIOS = sorted(ROOT.glob("scenarios/*/README.md"))
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted(ROOT.glob("docs/*.md")),
    *LABS,
    *OF_SCENARIOS,
]
README = (ROOT / "README.md").read_text(encoding="utf-8")
#: an engine's own names for its numbers are options of tune, too
FOREIGN = {"--solref"}


def named(page):
    return str(page.relative_to(ROOT))


def blocks(text, kind):
    return re.findall(rf"^```{kind}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


def commands(text):
    """Every command line of simcompare in the shell blocks of a page, as words."""
    lines = [line for block in blocks(text, "sh") for line in block.splitlines()]
    for line in lines:
        words = shlex.split(line.partition(">")[0], comments=True)
        if words[:1] == ["simcompare"]:
            yield words[1:]


def call(monkeypatch, capsys, *words):
    from simcompare.cli import main

    monkeypatch.setattr(sys, "argv", ["simcompare", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return ended.value.code, capsys.readouterr().out


@pytest.fixture(scope="module")
def helps():
    """What each verb tells of itself, asked once."""
    return {}


def test_the_readme_is_short():
    assert len(README.encode()) <= 12_000


def test_sentences_of_the_readme_are_short():
    prose = re.sub(r"^```.*?^```|^[#|<!].*?$|^- ", "", README, flags=re.MULTILINE | re.DOTALL)
    prose = re.sub(r"\]\([^)]*\)", "]", prose)
    paragraphs = [" ".join(part.split()) for part in prose.split("\n\n")]
    sentences = [one for part in paragraphs for one in re.split(r"(?<=[.!?:])\s", part)]
    # the reference to the paper is as long as it is
    long = [one for one in sentences if len(one.split()) > 20 and "Acta IMEKO" not in one]
    assert not long


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_links_lead_somewhere(page):
    links = re.findall(r"\]\(([^)#]*)(#[^)]*)?\)", page.read_text(encoding="utf-8"))
    for place, part in links:
        if place.startswith("http"):
            continue
        target = page.parent / place if place else page
        assert target.exists(), place
        if part:
            assert part[1:] in headings(target.read_text(encoding="utf-8")), (place, part)


def headings(text):
    """Names of the parts of a page, as GitHub makes them of headings."""
    titles = re.findall(r"^#+ (.*)$", text, flags=re.MULTILINE)
    return {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}


def test_every_page_is_in_the_index():
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    for page in ROOT.glob("docs/*.md"):
        assert page.name == "README.md" or f"({page.name})" in index, page.name


def test_every_lab_is_in_the_index_of_labs_and_has_its_answers():
    index = (ROOT / "docs" / "lab" / "README.md").read_text(encoding="utf-8")
    answers = (ROOT / "docs" / "lab" / "solutions.md").read_text(encoding="utf-8")
    for page in LABS:
        assert page.name == "README.md" or f"({page.name})" in index, page.name
    for page in STUDENTS:
        text = page.read_text(encoding="utf-8")
        title = text.partition("\n")[0].removeprefix("# ")
        asked = re.findall(r"^\d+\. ", text.partition("## Questions")[2], flags=re.MULTILINE)
        answered = answers.partition(f"## {title}\n")[2].partition("\n## ")[0]
        assert 4 <= len(asked) <= 6, page.name
        assert len(re.findall(r"^\d+\. ", answered, flags=re.MULTILINE)) == len(asked), title


@pytest.mark.parametrize("page", STUDENTS, ids=named)
def test_the_figure_of_a_lab_can_be_drawn_again(page):
    text = page.read_text(encoding="utf-8")
    drawn = refresh_docs.DRAWN.findall(text)
    assert len(drawn) == len(re.findall(r"^!\[", text, flags=re.MULTILINE)) >= 1
    for file, line in drawn:
        assert (page.parent / file).stat().st_size > 1000
        assert re.match(r"simcompare\.(\w+)\(", line)[1] in simcompare.__all__
        assert re.search(r"\.plot\([^()]*\)$", line)


@pytest.mark.parametrize("page", STUDENTS, ids=named)
def test_what_a_student_types_runs(page, tmp_path, monkeypatch, capsys):
    need("mujoco")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    done = set()
    for words in commands(page.read_text(encoding="utf-8")):
        if words[0] in ("run", "fit"):
            settings = [words[i + 1] for i, word in enumerate(words) if word == "--set"]
            catalogue.load(words[1]).read_settings(pairs(settings))
        # one line of each kind is enough to see that it runs; recordings are tested elsewhere
        kind = tuple(words[:2])
        if kind not in done and words[0] not in ("allan", "data", "fit", "validate"):
            code, _ = call(monkeypatch, capsys, *quick(words))
            # a tolerance that an engine misses is no fault of the line
            assert code in (0, 1, None), words
            done.add(kind)


@pytest.mark.parametrize("page", STUDENTS, ids=named)
def test_what_a_student_types_into_python_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for lines in blocks(page.read_text(encoding="utf-8"), "python"):
        exec(compile(lines, page.name, "exec"), {})


def quick(words):
    """The same with one engine and level, few draws, and without a report."""
    if words[0] == "tune":
        return [*without(words, "--engine"), "--engine", "pymunk"]
    if words[0] == "estimate":
        return [*without(words, "--engine"), "--engine", "mujoco", "--draws", "4", "--no-report"]
    if words[0] != "run":
        return words
    words = without(without(words, "--engine"), "--contact")
    return [*words, "--engine", "mujoco", "--contact", "tuned", "--no-report"]


def without(words, option):
    if option not in words:
        return words
    place = words.index(option)
    return words[:place] + words[place + 2 :]


def test_every_scenario_is_in_the_readme_with_its_page():
    linked = re.findall(r"\[(\w+)\]\(scenarios/(\w+)/README\.md\)", README)
    assert [name for name, _ in linked] == [folder for _, folder in linked]
    assert sorted(name for name, _ in linked) == sorted(catalogue.names())


@pytest.mark.parametrize("page", OF_SCENARIOS, ids=named)
def test_the_page_of_a_scenario_says_how_it_is_run(page):
    asked = list(commands(page.read_text(encoding="utf-8")))
    assert ["run", page.parent.name] in asked


def test_the_words_of_the_readme_are_those_of_the_glossary():
    table = README.partition("## Eight words")[2].partition("\n\n")[0]
    words = dict(re.findall(r"^\| (\w.*?) \| (.*) \|$", table, re.MULTILINE)[1:])
    assert len(words) == 8
    assert words == {word: glossary.term(word).short for word in words}


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_commands_have_the_verbs_options_and_scenarios_that_exist(page, monkeypatch, capsys, helps):
    for words in commands(page.read_text(encoding="utf-8")):
        verb = tuple(words[:2] if words[0] == "data" else words[:1])
        if verb not in helps:
            helps[verb] = call(monkeypatch, capsys, *verb, "--help")[1]
        told = helps[verb]
        options = {word.partition("=")[0] for word in words if re.match(r"--?[a-z]", word)}
        assert options - FOREIGN <= set(re.findall(r"(?<!\S)--?[a-z][a-z-]*", told)), words
        if words[0] in ("run", "show", "fit", "validate", "export") and words[1] != "--resume":
            assert words[1] in catalogue.names(), words
        for engine in chosen(words, "--engine"):
            assert engine.partition(":")[0] in [*engines.names(), "all"], words


def chosen(words, option):
    return words[words.index(option) + 1].split(",") if option in words else []


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_every_shown_output_is_there(page):
    shown = re.findall(
        r"<!-- shown: simcompare (\w+).*?-->\n```\n(.*?)```",
        page.read_text(encoding="utf-8"),
        re.DOTALL,
    )
    for verb, block in shown:
        assert block.strip(), f"python tools/refresh_docs.py {named(page)} ({verb})"


def test_the_commands_for_a_ball_of_ones_own_run(tmp_path, monkeypatch, capsys):
    need("pymunk")
    own = [words for words in commands(README) if "examples/" in " ".join(words)]
    assert [words[0] for words in own] == ["fit", "run"]
    monkeypatch.chdir(ROOT)
    for words in own:
        engines = [] if "--engine" in words else ["--engine", "pymunk"]
        code, out = call(
            monkeypatch, capsys, *words, *engines, "--no-report", "--out", str(tmp_path)
        )
        # a restitution that an engine misses when tuned is no fault of the command
        assert code in (0, None)
        assert "pymunk" in out


def test_the_lines_for_a_notebook_run(tmp_path, monkeypatch):
    need("pymunk")
    monkeypatch.chdir(tmp_path)
    (lines,) = blocks(README, "python")
    assert len([line for line in lines.splitlines() if line]) <= 5
    exec(compile(lines, "README.md", "exec"), names := {})
    assert "pymunk" in set(names["run"].scores["source"])
    assert (tmp_path / "ball.pdf").stat().st_size > 1000
