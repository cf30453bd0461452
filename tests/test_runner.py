"""One engine that crashes, hangs, prints or is absent never spoils another's result."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from simcompare.engine import engines
from simcompare.model.settings import Settings
from simcompare.running import process
from simcompare.running.jobs import FAILED, MISSING, OK, UNSUPPORTED, Job
from simcompare.running.runner import kept_processes, run_jobs
from simcompare.scenarios import catalogue

pytestmark = pytest.mark.usefixtures("own_processes")
#: how long a test waits for what must come; only a test that fails waits that long
PATIENCE_S = 120.0
#: for engines that hang; the others are through long before it, also on a busy machine
LIMIT_S = 15.0
NOISY = (
    "os.write(1, b'C to stdout\\n'); os.write(2, b'C to stderr\\n');"
    "print('Python to stdout'); print('Python to stderr', file=sys.stderr)"
)
#: the worker's connection to its runner, in a toy engine that looks for it
FIND_IT = (
    "import socket, stat; from simcompare.running import messages, wire;"
    "numbers = [int(n) for n in os.listdir('/proc/self/fd')];"
    "is_there = lambda n: os.path.exists(f'/proc/self/fd/{n}');"
    "is_it = lambda n: is_there(n) and stat.S_ISSOCK(os.fstat(n).st_mode);"
    "it = socket.socket(fileno=next(filter(is_it, numbers)));"
)
#: a process that lives on, which has every descriptor and is of no group that could be ended
LEFT_BEHIND = (
    "import ctypes; ctypes.CDLL(None).fork() or (os.setsid(), time.sleep(40), os._exit(0))"
)
#: what each toy engine does inside ``simulate``
BAD = {
    "aborts": "os.abort()",
    "segfaults": "import ctypes; ctypes.string_at(0)",
    "exits": "sys.exit('no licence')",
    "leaves": "os._exit(7)",
    "hangs": "time.sleep(600)",
    "raises": "raise RuntimeError('the solver gave up')",
    "diverges": "signals['ball.position_m'] = signals['ball.position_m'] * np.nan",
    "short": "signals['ball.position_m'] = signals['ball.position_m'][:-3]",
    "returns_nothing": "return None",
    "cannot_travel": "extra = dict(notes=(lambda: 0,))",
    "odd_note": "extra = dict(notes=(3,))",
    "writes_everywhere": FIND_IT + "[os.write(n, b'10 %\\n' * 99) for n in numbers if is_there(n)]",
    "closes_all": "os.closerange(3, 4096)",
    "hangs_up": FIND_IT + "it.shutdown(2); time.sleep(600)",
    "forges": FIND_IT + "wire.send(it, {'number': 7, 'status': 'failed', 'reason': 'x'})",
    "floods": FIND_IT + "it.sendall(wire._START.pack(wire._MARK, bytes(8), 9, 10**10, 0))",
    "goes_behind_a_child": f"{LEFT_BEHIND}; os._exit(9)",
}
#: what does no harm
HARMLESS = {
    "noisy": NOISY,
    "closes_some": "os.closerange(3, 21)",
    "reads": "extra = dict(notes=(sys.stdin.read(),))",
}
ABSENT = (
    "from simcompare.kit import EngineBackend, Feature, PipPackage\n"
    "class Backend(EngineBackend):\n"
    "    name = 'absent'; known_limits = (); mapping = ''\n"
    "    library = PipPackage('no_such_engine', \"pip install 'simcompare[absent]'\", ())\n"
    "    features = frozenset(Feature)\n"
    "    def make(self, engine, scene): raise NotImplementedError\n"
    "BACKEND = Backend()\n"
)


def jobs_for(names, fall, repeats=1):
    scenario = catalogue.load(str(fall)).resolve()
    return [Job(name, scenario, Settings(), i) for name in names for i in range(repeats)]


@pytest.fixture
def outcomes(add_engine, fall):
    """Outcomes by engine, of one run with every kind of bad engine between two good ones."""
    add_engine("good")
    add_engine("broken", on_import="import no_such_module")
    add_engine("absent", code=ABSENT)
    for name, during in {**BAD, **HARMLESS}.items():
        add_engine(name, during)
    names = ["good", *BAD, "broken", "absent", *HARMLESS]
    found = run_jobs(jobs_for(names, fall), time_limit_s=LIMIT_S)
    assert [o.job.engine for o in found] == names
    return {o.job.engine: o for o in found}


def test_every_fault_stays_with_its_engine(outcomes):
    assert {name: o.status for name, o in outcomes.items()} == {
        **dict.fromkeys(BAD, FAILED),
        **dict.fromkeys(HARMLESS, OK),
        "good": OK,
        "broken": FAILED,
        "absent": MISSING,
    }
    heights = outcomes["good"].trajectory.signals["ball.position_m"][:, 2]
    assert heights[-1] == pytest.approx(1 - 9.80665 * 0.4**2 / 2)
    reasons = {name: o.reason for name, o in outcomes.items() if o.status != OK}
    for name, expected in {
        "aborts": "killed by SIGABRT",
        "segfaults": "killed by SIGSEGV",
        "exits": "no licence",
        "leaves": "exit code 7",
        "hangs": f"no answer within {LIMIT_S:g} s",
        "raises": "RuntimeError: the solver gave up",
        "diverges": "ball.position_m is not finite from t = 0 s",
        "short": "398 samples",
        "returns_nothing": "returns_nothing",
        "cannot_travel": "cannot_travel",
        "odd_note": "string",
        "writes_everywhere": "it sent bytes that are no frame; its process was ended",
        "closes_all": "the connection to simcompare is broken",
        "hangs_up": "hangs_up: its process",  # which ends itself, or is ended, whichever is first
        "forges": "it sent an answer that nobody asked for",
        "floods": "expected at most",
        "goes_behind_a_child": "its process ended early with exit code 9",
        "broken": "no_such_module",
        "absent": "pip install 'simcompare[absent]'",
    }.items():
        assert expected in reasons[name], (name, reasons[name])
        assert name in reasons[name]
    noise = outcomes["noisy"].noise
    for line in ("C to stdout", "C to stderr", "Python to stdout", "Python to stderr"):
        assert line in noise


def test_jobs_after_a_crash_are_told_and_jobs_before_it_are_kept(add_engine, fall, tmp_path):
    count = tmp_path / "count"
    add_engine(
        "second",
        f"with open({str(count)!r}, 'a') as f: f.write('x')\n"
        f"        if os.path.getsize({str(count)!r}) == 2: os.abort()",
    )
    found = run_jobs(jobs_for(["second"], fall, repeats=3))
    assert [o.status for o in found] == [OK, FAILED, FAILED]
    assert [o.job.repeat for o in found] == [0, 1, 2]


def test_progress_counts_every_job_that_ends(add_engine, fall):
    add_engine("good")
    add_engine("raises", BAD["raises"])
    seen = []
    run_jobs(jobs_for(["good", "raises"], fall, 2), progress=lambda *step: seen.append(step))
    assert sorted(done for _, done, _ in seen) == [1, 2, 3, 4]
    assert {total for _, _, total in seen} == {4}


def test_more_engines_than_places_all_get_their_turn(add_engine, fall):
    for name in ("one", "two", "three"):
        add_engine(name)
    found = run_jobs(jobs_for(["one", "two", "three"], fall), processes=1)
    assert [o.status for o in found] == [OK, OK, OK]


def numbers_of(found):
    """Numbers of the processes that did the jobs, as the toy engine prints them."""
    return [int(outcome.noise.split()[-1]) for outcome in found]


def test_a_process_is_kept_for_further_jobs_and_ends_with_the_block(add_engine, fall):
    add_engine("told", "print(os.getpid())")
    with kept_processes():
        first, second = (run_jobs(jobs_for(["told"], fall)) for _ in range(2))
        assert numbers_of(first) == numbers_of(second)
        # what was printed belongs to the jobs that it was printed in
        assert len(second[0].noise.split()) == 1
    third = run_jobs(jobs_for(["told"], fall))
    assert numbers_of(third) != numbers_of(first)
    with pytest.raises(ProcessLookupError):
        os.kill(numbers_of(first)[0], 0)


def test_a_kept_process_may_wait_for_its_next_jobs(add_engine, fall):
    add_engine("good")
    with kept_processes():
        for count in (1, 2):
            found = run_jobs(jobs_for(["good"], fall, count))
            assert [outcome.status for outcome in found] == [OK] * count
            time.sleep(0.1)  # its listener has begun to wait


@pytest.mark.parametrize("during", ["os.abort()", "time.sleep(600)"])
def test_a_kept_process_that_has_ended_is_replaced(add_engine, fall, tmp_path, during):
    once = tmp_path / "once"
    add_engine(
        "second",
        f"print(os.getpid())\n        if os.path.exists({str(once)!r}):"
        f" os.remove({str(once)!r}); {during}",
    )
    with kept_processes():
        first = run_jobs(jobs_for(["second"], fall))
        once.touch()
        (failed,) = run_jobs(jobs_for(["second"], fall), time_limit_s=LIMIT_S)
        assert failed.status == FAILED
        third = run_jobs(jobs_for(["second"], fall))
    assert third[0].status == OK
    assert numbers_of(third) != numbers_of(first)


def test_very_much_noise_neither_blocks_nor_fills_the_record(add_engine, fall):
    add_engine("loud", "os.write(1, b'x' * 3_000_000 + b' the end')")
    (outcome,) = run_jobs(jobs_for(["loud"], fall))
    assert outcome.status == OK
    assert outcome.noise.endswith("the end")
    assert len(outcome.noise) < 10_000


def test_what_an_engine_prints_fills_no_disk_and_its_end_is_told(monkeypatch):
    monkeypatch.setattr(process, "_MOST_NOISE_BYTES", 10_000)
    one = process.EngineProcess("x")
    for end in (b"first end", b"second end"):
        one.stderr.write(b"noise " * 5000 + end)
        one.stderr.flush()
        one.throw_noise_away()
        assert one.stderr.seek(0, os.SEEK_END) == 0
        one.stderr.write(b" and more")
        assert one.noise().endswith(f"{end.decode()} and more")
    one.stderr.close()


def test_what_an_engine_lacks_is_unsupported_and_no_failure(fall):
    (outcome,) = run_jobs([Job("pymunk", spatial(fall), Settings())])
    assert outcome.status == UNSUPPORTED
    assert outcome.reason is not None
    assert "motion out of the x-z plane" in outcome.reason


def spatial(fall):
    scenario = catalogue.load(str(fall)).resolve()
    ball = scenario.bodies["ball"].model_copy(update={"velocity_m_s": (0.0, 1.0, 0.0)})
    return scenario.model_copy(update={"bodies": {"ball": ball}})


def test_a_missing_engine_names_its_cure(add_engine):
    add_engine("absent", code=ABSENT)
    from simcompare.errors import EngineMissing

    with pytest.raises(EngineMissing) as error:
        engines.get("absent").version()
    assert "pip install 'simcompare[absent]'" in str(error.value)
    assert "no_such_engine" in str(error.value)


@pytest.mark.parametrize("limit", [float("inf"), 1e11])
def test_no_time_limit_is_possible(add_engine, fall, limit):
    add_engine("good")
    (outcome,) = run_jobs(jobs_for(["good"], fall), time_limit_s=limit)
    assert outcome.status == OK


# --- through the command line, where a fault may also reach the parent process ---------------


def records(done: subprocess.CompletedProcess[str]):
    assert "Traceback" not in done.stderr, done.stderr[-2000:]
    record = json.loads(done.stdout)  # one object and nothing else
    return record, {source["name"]: source for source in record["sources"]}


def test_noise_of_an_engines_module_never_reaches_the_json(add_engine, fall, command):
    add_engine("on_import", on_import="print('hello'); os.write(1, b'hello\\n')")
    add_engine("at_exit", on_import="import atexit; atexit.register(print, 'bye')")
    add_engine("good")
    names = ("good", "on_import", "at_exit")
    done = command(
        "run", fall, "--engine", ",".join(names), "--contact", "assisted", "--json", "--no-report"
    )
    _, sources = records(done)
    assert {name: sources[name]["status"] for name in names} == dict.fromkeys(names, "ok")
    assert done.returncode == 0


#: engines of which each is odd in its way
ODD: dict[str, dict[str, str]] = {
    "aborts_on_import": {"on_import": "os.abort()"},
    "exits_on_import": {"on_import": "sys.exit(0)"},
    "broken_import": {"on_import": "import no_such_module"},
    "constructor": {
        "code": "class BACKEND:\n    def __init__(self): raise RuntimeError('no licence')\n"
    },
    "no_contract": {"code": "class BACKEND:\n    pass\n"},
    "other_signals": {"during": "signals = {'ball.hight_m': times}"},
    "odd_numbers": {"during": "extra = dict(wall_s={'step': np.float32(1), 'build': np.nan})"},
    "one_sample": {"during": "times = times[:1]; signals = {k: v[:1] for k, v in signals.items()}"},
    "two_components": {"during": "signals['ball.flow'] = np.zeros((len(times), 2))"},
    "no_trajectory": {"during": "return None"},
}


def test_whatever_an_engine_does_the_others_are_kept(add_engine, fall, command):
    add_engine("good")
    for name, arguments in ODD.items():
        add_engine(name, **arguments)
    asked = ",".join(["good", *ODD])
    done = command("run", fall, "--engine", asked, "--contact", "assisted", "--json", "--no-report")
    record, sources = records(done)
    assert sources["good"]["status"] == "ok"
    assert [s for s in record["scores"] if s["source"] == "good" and s["verdict"] == "pass"]
    # a run may end early
    expected = dict.fromkeys(ODD, "failed") | {"one_sample": "ok"}
    assert {name: sources[name]["status"] for name in ODD} == expected
    assert all(sources[name]["reason"] for name in ODD if name != "one_sample")
    assert done.returncode == 3


def test_a_broken_engine_spoils_neither_show_nor_doctor(add_engine, fall, call):
    add_engine("broken", on_import="import no_such_module")
    code, out, _ = call("show", fall, "--json")
    assert code == 0
    assert "broken" in json.loads(out)["engines"]
    code, out, _ = call("doctor", "--json")
    found = {d["engine"]: d for d in json.loads(out)["engines"]}
    assert found["broken"]["status"] == "failed"
    assert "no_such_module" in found["broken"]["message"]
    assert found["pymunk"]["status"] == "ok"
    assert code == 3


def test_an_engine_that_hangs_when_its_process_ends_does_not_hang_the_run(
    add_engine, fall, command, tmp_path
):
    """Its results are in; native threads that are never joined are a common fault of engines."""
    waited = tmp_path / "waited"
    leaving = f"lambda: (time.sleep(60), open({str(waited)!r}, 'w').close())"
    add_engine("sticky", f"import atexit; atexit.register({leaving})")
    done = command(
        "run", fall, "--engine", "sticky", "--contact", "assisted", "--json", "--no-report"
    )
    _, sources = records(done)
    assert sources["sticky"]["status"] == "ok"
    assert not waited.exists(), "the run waits for a process whose results it has"


# --- Ctrl-C -----------------------------------------------------------------------------------


def alive(pid: int) -> bool:
    """Whether a process runs; one that has ended and was not yet collected does not."""
    try:
        text = Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return False
    return text.rpartition(")")[2].split()[0] not in "ZX"


def wait_for(condition, seconds: float) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return bool(condition())


def wrote_whole(path: Path, text: str) -> str:
    """Code of an engine that writes a formatted text so that nobody sees half of it."""
    part = f"{path}.part"
    return f"open({part!r}, 'w').write(f'{text}'); os.rename({part!r}, {str(path)!r})"


@pytest.fixture
def slow_run(add_engine, fall, tmp_path):
    """A run whose first engine has finished and whose second hangs, with a child of its own."""
    quick, slow = tmp_path / "quick", tmp_path / "slow"
    add_engine("quick", wrote_whole(quick, "{os.getpid()}"))
    add_engine(
        "slow",
        "import subprocess; child = subprocess.Popen(['sleep', '400']);"
        + wrote_whole(slow, "{os.getpid()} {child.pid}")
        # a call of C that lets no other Python run
        + "; import ctypes; ctypes.PyDLL(None).sleep(400)",
    )
    words = ["run", str(fall), "--engine", "quick,slow", "--contact", "assisted", "--json"]
    process = subprocess.Popen(
        [sys.executable, "-m", "simcompare", *words, "--no-report", "--out", "kept"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # tests that a shell runs in the background inherit that Ctrl-C is to be ignored
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    assert wait_for(lambda: quick.exists() and slow.exists(), PATIENCE_S)
    # a worker is collected when its results are in
    quick_one = Path("/proc") / quick.read_text()
    assert wait_for(lambda: not quick_one.exists(), PATIENCE_S)
    pids = [int(word) for word in slow.read_text().split()]
    assert all(map(alive, pids))
    yield process, pids
    for pid in [*pids, process.pid]:
        if alive(pid):
            os.kill(pid, signal.SIGKILL)
    process.communicate()


needs_proc = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")


@needs_proc
def test_ctrl_c_leaves_no_process_and_keeps_what_had_finished(slow_run, tmp_path):
    process, pids = slow_run
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    assert wait_for(lambda: not any(map(alive, pids)), PATIENCE_S), "no orphan"
    record = json.loads(out)
    assert record["interrupted"] is True
    sources = {source["name"]: source for source in record["sources"]}
    assert sources["quick"]["status"] == "ok"
    assert sources["slow"]["status"] == "failed"
    assert "interrupted" in sources["slow"]["reason"]
    (folder,) = (tmp_path / "kept").iterdir()
    stored = json.loads((folder / "run.json").read_text())
    assert stored["interrupted"] is True
    assert [s for s in stored["scores"] if s["source"] == "quick"]


@needs_proc
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_no_process_outlives_the_command_however_it_ends(slow_run, number):
    """``timeout 60 simcompare run`` sends SIGTERM, a terminal that is closed SIGHUP."""
    process, pids = slow_run
    process.send_signal(number)
    process.wait(timeout=PATIENCE_S)
    assert wait_for(lambda: not any(map(alive, pids)), PATIENCE_S), "a process was left behind"
