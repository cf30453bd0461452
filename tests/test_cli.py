"""The command line: exit codes, one JSON object, sentences instead of tracebacks, quick answers."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import simcompare
from simcompare import notation
from simcompare.cli import complete
from simcompare.cli.console import pairs
from simcompare.engine import engines
from simcompare.errors import InputError
from simcompare.model.plain import plain

HEAVY = ("numpy", "pandas", "scipy", "matplotlib", "plotly", "duckdb", "pint", "jinja2",
         "mujoco", "pybullet", "pymunk", "dartpy")  # fmt: skip
DROWNS = "signals['ball.position_m'] = signals['ball.position_m'] - [0, 0, 1.5]"


@pytest.fixture
def run_fall(call, fall):
    """Runs the toy scenario: ``run_fall("--engine", "toy") -> (exit code, stdout, stderr)``."""

    def run(*words):
        return call("run", fall, "--no-report", "--contact", "assisted", *words)

    return run


# --- exit codes -------------------------------------------------------------------------------


def test_0_when_all_is_well(run_fall, add_engine, tmp_path):
    add_engine("toy")
    code, out, err = run_fall("--engine", "toy")
    assert code == 0, err
    assert re.search(r"^toy +[\d.]+ pass$", out, re.MULTILINE)
    assert "closed form" in out
    assert "Stored in runs" in out
    assert len(list((tmp_path / "runs").iterdir())) == 1


def test_the_answer_and_one_table_fit_80_columns_and_details_show_the_other_measures(
    run_fall, add_engine
):
    long = "a" * 20
    add_engine(long)
    _, out, _ = run_fall("--engine", long)
    assert max(map(len, out[: out.index("Stored in")].splitlines())) <= 80
    assert out.startswith("Assisted, ")
    _, more, _ = run_fall("--engine", long, "--details")
    heads = [line for line in more.splitlines() if line.startswith("engine ")]
    assert len(heads) > 1
    assert out.count("\nengine ") == 1


def test_1_when_a_tolerance_fails(run_fall, add_engine):
    add_engine("drowns", DROWNS)
    add_engine("toy")
    code, out, _ = run_fall("--engine", "toy,drowns", "-v")
    assert code == 1
    assert "too far off: penetration in drowns" in out
    assert "Versions: toy 1.0, drowns 1.0." in out
    code, out, _ = run_fall("--engine", "drowns", "--json")
    assert code == 1
    assert json.loads(out)["exit_code"] == 1


def test_what_an_engine_does_by_default_is_not_judged(call, fall, add_engine):
    add_engine("drowns", DROWNS)
    words = ("--engine", "drowns", "--no-report", "--json", "--contact", "default")
    code, out, _ = call("run", fall, *words)
    assert code == 0
    assert {score["verdict"] for score in json.loads(out)["scores"]} == {"info"}


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["run", "bal"], "did you mean ball?"),
        (["run", "ball", "--engine", "mujco"], "did you mean mujoco?"),
        (["run", "ball", "--contact", "asisted"], "did you mean assisted"),
        (["run", "ball", "--preset", "tenis"], "did you mean tennis"),
        (["run", "ball", "--set", "drop_hight=1"], "did you mean drop_height_m?"),
        (["run", "ball", "--set", "drop_height=3s"], "the unit 's' does not fit"),
        (
            ["run", "ball", "--set", "drop_height=30"],
            "1 cm to 20 m; did you mean drop_height=30cm?",
        ),
        (["run", "ball", "--set", "drop_height"], "not of the form parameter=value"),
        (["run", "ball", "--step", "0"], "is not a time above 0"),
        (["run", "ball", "--step", "1kg"], "--step: the unit 'kg' does not fit"),
        (["run", "ball", "--step", "10"], "--step"),
        (["run", "ball", "--step", "1e-12", "--time-limit", "3"], "--step"),
        (["run", "ball", "--seeds", "0"], "--seeds: 0 is not a number of repeats"),
        (["run", "ball", "--seeds", "99999999999"], "--seeds: 99999999999 repeats of 4106 samples"),
        (["run", "ball", "--seeds", "9" * 400], "e+400 repeats"),
        (["run", "ball", "--time-limit", "-1"], "--time-limit"),
        (["run", "ball", "--time-limit", "nan"], "--time-limit"),
        (["run", "ball", "--against", "itf_tenis_rebound"], "did you mean itf_tennis_rebound"),
        (["run", "ball", "--bogus"], "--bogus"),
        (["run", "ball", "--engine", "pymunk", "--out", "file/runs"], "choose another folder"),
        (["show", "bal"], "did you mean ball?"),
        (["show", "broken.yaml"], "broken.yaml: line 1, column"),
        (["report", "nowhere"], "nowhere: there is no such file or folder"),
        (["frobnicate"], "frobnicate"),
    ],
    ids=lambda value: " ".join(value[1:] or value) if isinstance(value, list) else "",
)
def test_2_and_one_sentence_on_stderr_when_the_user_is_wrong(call, write, words, expected):
    write("file", "x")
    write("broken.yaml", "a: ]\n")
    if words[:2] == ["run", "ball"] and "--engine" not in words:
        words = [*words, "--engine", "pymunk", "--no-report"]
    code, out, err = call(*words)
    assert code == 2, (out, err)
    assert expected in err
    assert out == ""
    assert "Traceback" not in err


def test_3_when_an_engine_breaks_but_the_others_results_are_shown(run_fall, add_engine):
    add_engine("toy")
    add_engine("raises", "raise RuntimeError('the solver gave up')")
    code, out, _ = run_fall("--engine", "toy,raises")
    assert code == 3
    assert "the solver gave up" in " ".join(out.split())
    assert re.search(r"^toy +[\d.]+ pass$", out, re.MULTILINE)


def test_an_engine_that_is_not_installed_is_3_when_it_was_named_and_a_row_with_all(
    run_fall, add_engine, monkeypatch
):
    from simcompare.engine import engines

    code = (
        "from simcompare.kit import EngineBackend, Feature, PipPackage\n"
        "class BACKEND(EngineBackend):\n"
        "    name = 'absent'; known_limits = (); mapping = ''\n"
        "    library = PipPackage('nowhere', \"pip install 'simcompare[absent]'\", ['no-such'])\n"
        "    features = frozenset(Feature)\n"
        "    def make(self, engine, scene): raise NotImplementedError\n"
    )
    add_engine("toy")
    add_engine("absent", code=code)
    status, out, _ = run_fall("--engine", "toy,absent")
    assert status == 3
    assert "pip install 'simcompare[absent]'" in " ".join(out.split())
    monkeypatch.setattr(engines, "_built_in", dict)
    status, out, _ = run_fall("--engine", "all", "--json")
    sources = {s["name"]: s["status"] for s in json.loads(out)["sources"]}
    assert sources == {"toy": "ok", "absent": "missing"}
    assert status == 0


def test_a_reference_that_fails_is_one_sentence(run_fall, add_engine, fall):
    add_engine("toy")
    for body, expected in {
        "raise KeyError('height')": "height",
        "return {'ball.position_m': time_s[:3]}": "reference",
        "return None": "reference",
        "return {'ball.position_m': time_s * float('nan')}": "not finite",
    }.items():
        (fall / "reference.py").write_text(f"def reference(parameters, time_s):\n    {body}\n")
        code, out, err = run_fall("--engine", "toy", "--json", "--trust")
        assert (code, out) == (2, ""), body
        assert "reference.py" in err
        assert expected in err


@pytest.mark.parametrize("end", ["0.01", "20"])
def test_a_parameter_may_stand_at_its_bounds(call, end):
    """Dithering about the bound must not refuse what the user may set."""
    words = ("--engine", "pymunk", "--contact", "default", "--seeds", "2", "--no-report", "--json")
    code, _, err = call(
        "run", "ball", "--set", f"drop_height={end}", "--set", "restitution=0", *words
    )
    assert code == 0, err


# --- JSON -------------------------------------------------------------------------------------


def test_run_prints_one_object_with_the_names_of_the_contract(call):
    code, out, err = call(
        "run", "ball", "--engine", "pymunk", "--seeds", "1", "--set", "restitution=0.5",
        "--against", "itf_tennis_rebound", "--json", "--no-report",
    )  # fmt: skip
    assert code == 0, err
    assert out.count("\n") == 1
    record = json.loads(out)
    assert record["run"].startswith("runs")
    assert record["scenario"] == "ball"
    assert record["parameters"]["drop_height_m"] == pytest.approx(2.54), "as it was measured"
    assert "validates nothing" in record["against"]["caution"]
    for source in record["sources"]:
        assert {"name", "version", "contact", "status", "reason", "steps", "wall_s"} <= set(source)
        assert set(source["wall_s"]) == {"import", "build", "step"}
        assert (source["status"], source["reason"]) == ("ok", None)
        assert source["audit"]
    assert [s["contact"] for s in record["sources"]] == ["default", "tuned", "assisted"]
    keys = ["source", "contact", "measure", "value", "u", "unit", "truth", "tolerance", "verdict"]
    for score in record["scores"]:
        assert set(keys) <= set(score)
        assert score["verdict"] in ("pass", "fail", "info")
    (best,) = [
        s
        for s in record["scores"]
        if (s["contact"], s["measure"], s["index"]) == ("assisted", "restitution", None)
    ]
    assert best["value"] == pytest.approx(0.5, abs=1e-3)
    assert best["truth"] == pytest.approx(0.5)
    assert record["against"]["matches"][0]["measured"] == pytest.approx(1.41)
    written = json.loads((Path(record["run"]) / "run.json").read_text(encoding="utf-8"))
    assert written == {k: v for k, v in record.items() if k not in ("exit_code", "headline")}
    assert record["headline"][-1].startswith("Assisted, the ball bounces with 0.5")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--set", "drop_height=1m"], "drop_height_m = 1 is asked for, but the table was measured"),
        (["--preset", "golf"], "preset golf is asked for, but the table is of tennis"),
    ],
)
def test_a_measurement_is_never_compared_with_another_condition(call, words, expected):
    code, out, err = call("run", "ball", "--against", "itf_tennis_rebound", *words)
    assert (code, out) == (2, "")
    assert expected in err


def test_the_python_function_gives_what_the_command_prints(add_engine, fall):
    add_engine("toy")
    run = simcompare.run(str(fall), engine="toy", contact="assisted", set={"height": "120cm"})
    assert run.record.parameters == {"height_m": pytest.approx(1.2)}
    assert run.exit_code == 0
    assert run.folder is None
    json.dumps(plain(run.record), allow_nan=False)


def test_list_and_show_print_one_object(call):
    code, out, _ = call("list", "--json")
    listed = json.loads(out)
    assert code == 0
    assert "ball" in [scenario["name"] for scenario in listed["scenarios"]]
    assert {"dart", "mujoco", "pybullet", "pymunk"} <= set(listed["engines"])
    assert "itf_tennis_rebound" in listed["measurements"]
    code, out, _ = call("show", "ball", "--json")
    shown = json.loads(out)
    assert code == 0
    assert shown["parameters"]["drop_height_m"] | {"text": ""} == {
        "value": 1.0,
        "min": 0.01,
        "max": 20,
        "unit": "m",
        "text": "",
    }
    assert "restitution" in shown["needs"]
    assert shown["engines"]["pymunk"] == []
    assert set(shown["tolerances"]) >= {"restitution", "settling_time"}


def test_list_and_show_tell_people_the_same(call):
    code, out, _ = call("list")
    assert code == 0
    assert re.search("^ball +Bouncing ball$", out, re.MULTILINE)
    code, out, _ = call("list", "-v")
    assert "Bouncing ball: Does the ball bounce" in out
    code, out, _ = call("show", "ball")
    assert code == 0
    for part in ("drop_height_m", "0.01…20", "tennis", "settling_time 2 %", "impact_time_error"):
        assert part in out
    code, out, _ = call("show", "ball", "-v")
    for part in ("--preset tennis", "sphere shapes", "Tolerance of settling_time"):
        assert part in out


def test_what_is_printed_of_a_scenario_and_of_engines_fits_one_screen(call):
    for words in (("show", "ball"), ("doctor",)):
        _, out, _ = call(*words)
        assert len(out.splitlines()) <= 30
        assert max(map(len, out.splitlines())) <= 200


def test_doctor_examines_every_engine(call, add_engine, monkeypatch):
    from simcompare.engine import engines

    kept = {"pymunk": engines.targets()["pymunk"]}
    monkeypatch.setattr(engines, "_built_in", lambda: kept)
    add_engine("toy")
    add_engine(
        "light", "gravity = gravity / 2; signals = {k: v * 0.99 for k, v in signals.items()}"
    )
    code, out, _ = call("doctor", "--json")
    found = {d["engine"]: d for d in json.loads(out)["engines"]}
    assert found["pymunk"]["status"] == "ok"
    assert found["pymunk"]["version"]
    assert "restitution" in found["pymunk"]["features"]
    assert found["toy"]["known_limits"] == [{"text": "It only falls.", "reference": "this file"}]
    assert found["light"]["status"] == "failed"
    assert "instead of 0.196" in found["light"]["message"]
    assert code == 3
    code, out, _ = call("doctor")
    assert re.search("^light +1.0 +failed +1 +0$", out, re.MULTILINE)
    assert "light: fell " in out
    assert "2 of 3 engines work" in out
    _, out, _ = call("doctor", "-v")
    assert "limit: It only falls. [this file]" in out


# --- what people see ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "u", "shown"),
    [
        (None, None, "–"),
        (0.8, None, "0.8"),
        (0.8, 0.0, "0.8"),
        (0.79987, 0.00012, "0.79987(12)"),
        (123.456, 12.0, "123(12)"),
        (0.8, 1e-15, "0.8"),
        (0.8, 0.0996, "0.80(10)"),
        (1234.0, 500.0, "1230(500)"),
        (0.0, 1.0, "0.0(10)"),
    ],
)
def test_a_number_is_shown_to_the_digit_that_its_uncertainty_leaves(value, u, shown):
    assert notation.number(value, u) == shown


@pytest.mark.parametrize(
    ("tolerance", "values", "places"),
    [(0.0016, (), 4), (0.81, (), 2), (160.0, (), 0), (None, (1.25, 6e-7), 5), (None, (), None),
     (None, (18.0, 4.0, None), 0), (None, (0.0,), None)],
)  # fmt: skip
def test_decimals_follow_the_tolerance_or_the_largest_value(tolerance, values, places):
    assert notation.places(tolerance, values) == places


@pytest.mark.parametrize(
    ("value", "u", "shown"),
    [(0.79998, 7e-5, "0.8000"), (-1e-5, None, "0"), (-0.00013, None, "−0.0001"), (0.0, 0.0, "0"),
     (0.002, 0.006, "0.0020(60)"), (0.79834, 0.0003, "0.7983(3)")],
)  # fmt: skip
def test_nothing_is_shown_below_the_last_decimal_that_matters(value, u, shown):
    assert notation.number(value, u, 4) == shown


@pytest.mark.parametrize("value", [123.456, 0.000500277, -3.25, 8e5])
@pytest.mark.parametrize("u", [1e-3, 1e-6, 1e-9, 1e-10, 1e-12, 1e-15])
def test_a_small_uncertainty_never_rounds_the_value_away(value, u):
    shown = float(notation.number(value, u).split("(")[0].replace("−", "-"))
    assert shown == pytest.approx(value, rel=1e-5, abs=u)


def test_settings_are_pairs_and_a_value_may_hold_an_equals_sign():
    assert pairs(["a=1", " b = 30 cm ", "c=x=y"]) == {"a": "1", "b": "30 cm", "c": "x=y"}
    with pytest.raises(InputError):
        pairs(["=1"])


def test_a_terminal_gets_colours_only_where_they_are_wanted(tmp_path):
    pty = pytest.importorskip("pty")

    def shown(**more):
        mine, theirs = pty.openpty()
        env = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR")}
        process = subprocess.Popen(
            [sys.executable, "-m", "simcompare", "show", "ball"],
            stdout=theirs, stderr=theirs, stdin=subprocess.DEVNULL, cwd=tmp_path,
            env={**env, "TERM": "xterm-256color", "COLUMNS": "120", **more},
        )  # fmt: skip
        os.close(theirs)
        text = b""
        while True:
            try:
                part = os.read(mine, 65536)
            except OSError:  # the other side is closed
                break
            if not part:
                break
            text += part
        os.close(mine)
        assert process.wait() == 0
        assert b"drop_height_m" in text
        return text

    colour = re.compile(rb"\x1b\[[0-9;]*(3|4|9|10)[0-7]m|\x1b\[[0-9;]*[34]8;")
    assert not colour.search(shown(NO_COLOR="1"))
    assert b"\x1b" not in shown(TERM="dumb")


def test_a_pipe_gets_no_control_characters(command, add_engine, fall):
    add_engine("toy")
    done = command("run", fall, "--engine", "toy", "--no-report")
    assert "\x1b" not in done.stdout + done.stderr
    assert done.stderr == "", "no progress bar where nobody watches"


@pytest.mark.parametrize(
    "words", [["list"], ["show", "ball"], ["show", "ball", "--json"], ["--help"]]
)
def test_a_reader_that_goes_away_is_no_error(words, tmp_path):
    """As in ``simcompare list | head -1``; exit code 1 would say that a tolerance failed."""
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-m", "simcompare", *words],
        stdout=writer, stderr=subprocess.PIPE, text=True, cwd=tmp_path, check=False,
    )  # fmt: skip
    os.close(writer)
    assert done.stderr == ""
    assert done.returncode in (0, 141)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize("words", [["list"], ["show", "ball"], ["--help"], ["export", "ball"]])
def test_a_full_disk_behind_the_output_is_one_sentence(words, tmp_path):
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "simcompare", *words],
            stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    said = "simcompare: the output cannot be written (No space left on device); free some space\n"
    assert done.stderr.endswith(said)
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize("away", ["2>&-", "2>/dev/full", "2>&- >&-"])
@pytest.mark.parametrize(
    ("words", "code"),
    [
        ("run nothing", 2), ("data nothing", 2),
        ("run ball --engine pymunk --contact default --no-report --seeds 1", 0),
    ],
)  # fmt: skip
def test_exit_codes_hold_where_errors_cannot_be_written(words, code, away, tmp_path):
    command = f"{shlex.quote(sys.executable)} -m simcompare {words} {away}"
    done = subprocess.run(command, shell=True, stdout=subprocess.PIPE, cwd=tmp_path, check=False)
    assert done.returncode == code


def test_a_locale_without_unicode_is_no_error(command):
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"}
    done = command("show", "ball", env={**os.environ, **plain})
    assert done.returncode == 0, done.stderr[-500:]


# --- quick answers -----------------------------------------------------------------------------


def loaded_by(words, tmp_path, **env):
    """Which heavy modules a command loads."""
    code = (
        "import sys\nsys.argv = ['simcompare', *sys.argv[1:]]\n"
        "from simcompare.cli import main\n"
        "try:\n    main()\nfinally:\n"
        f"    print('LOADED', *[m for m in {HEAVY!r} if m in sys.modules], file=sys.stderr)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *words],
        capture_output=True, text=True, cwd=tmp_path, check=False, env={**os.environ, **env},
    )  # fmt: skip
    (line,) = [line for line in done.stderr.splitlines() if line.startswith("LOADED")]
    return done.stdout, line.split()[1:]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--help"], "doctor"),
        (["run", "--help"], "--against"),
        (["list"], "Bouncing ball"),
        (["list", "--json"], "pymunk"),
        (["--version"], "."),
    ],
    ids=" ".join,
)
def test_help_and_list_load_nothing_heavy(words, expected, tmp_path):
    out, loaded = loaded_by(words, tmp_path)
    assert expected in out
    assert loaded == []


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("simcompare run ba", "ball"),
        ("simcompare run ball --engine pym", "pymunk"),
        ("simcompare run ball --engine mujoco,pym", "mujoco,pymunk"),
        ("simcompare run ball --against itf", "itf_tennis_rebound"),
        ("simcompare do", "doctor"),
    ],
)
def test_completion_answers_and_loads_nothing_heavy(line, expected, tmp_path):
    words = line.split()
    out, loaded = loaded_by(
        [],
        tmp_path,
        _SIMCOMPARE_COMPLETE="complete_bash",
        COMP_WORDS=line,
        COMP_CWORD=str(len(words) - 1),
    )
    assert expected in out.split()
    assert loaded == []


def test_completion_offers_each_engine_of_a_list_once():
    others = [name for name in engines.names() if name != "pymunk"]
    assert complete.engines("pymunk,") == [f"pymunk,{name}" for name in others]
    assert complete.engines("a") == ["all"]
    assert "all" in complete.engines("")
    assert complete.scenarios("bal") == ["ball"]
    assert complete.scenarios("x") == []
    assert complete.tables("jena") == ["jena_2021_table_tennis"]
    assert "tuned" in complete.contact_levels("t")


def test_a_user_scenario_of_the_variable_is_listed_and_completed(call, fall, monkeypatch):
    monkeypatch.setenv("SIMCOMPARE_SCENARIOS", str(fall.parent))
    _, out, _ = call("list")
    assert re.search("^fall +Free fall$", out, re.MULTILINE)
    assert "fall" in complete.scenarios("")
