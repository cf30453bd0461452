"""The lab's server, asked as a browser asks it; a stand-in does the jobs."""

import errno
import json
import os
from urllib.parse import quote

import pytest

pytest.importorskip("starlette", reason="the extra [web] is not installed")
pytest.importorskip("httpx", reason="what asks the lab in tests is not installed")
pytest.importorskip("trustme", reason="the extra [web] is not installed")

from starlette.testclient import TestClient

from simcompare.lab import application, contents, groups, uploads
from simcompare.lab.groups import Groups
from simcompare.lab.laboratory import Lab
from simcompare.lab.pin import Pin
from simcompare.lab.queue import Queue
from tests import lab_stand_in

HOST = "testserver"
WAV = b"RIFF\x24\x00\x00\x00WAVEfmt " + bytes(2000)


def opened(folder, *, pin=None, limits_s=None):
    lab = Lab(Groups(folder), Queue(lab_stand_in.perform, 1, limits_s), Pin(pin))
    return TestClient(application.build(lab, [HOST]), raise_server_exceptions=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("lab")


@pytest.fixture(scope="module")
def client(folder):
    with opened(folder, limits_s={"report": 1.0}) as client:
        yield client


def asked(client, group="Newton", kind="run", **rest):
    """What comes of a job."""
    answer = client.post("/api/jobs", json={"group": group, "kind": kind, **rest})
    assert answer.status_code == 202, answer.text
    for _ in range(10):
        told = client.get(f"/api/jobs/{answer.json()['id']}?wait=20").json()
        if told["state"] in ("done", "failed"):
            return told
    raise AssertionError(told)


def sent(client, content, **query):
    return client.post("/api/recordings", params={"group": "Newton", **query}, content=content)


def files_below(folder):
    return {path for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("name", ["Anna/Ben", "3/4", "Zoë & <b>Ötzi</b>", "100 %", "a?b#c"])
def test_whatever_a_group_is_called_it_finds_what_it_has(client, folder, name):
    path = quote(name, safe="")
    told = asked(client, name, scenario="ball")
    heard = client.post("/api/recordings", params={"group": name}, content=WAV).json()
    listing = client.get(f"/api/groups/{path}").json()
    assert listing["name"] == name
    assert client.get(f"/api/results/{path}/{told['id']}").json() == told
    assert client.get(f"/api/recordings/{path}/{heard['id']}").json() == heard
    (folder / listing["key"] / "files" / "ball.py").write_text("1", encoding="utf-8")
    assert client.get(f"/files/{path}/ball.py").text == "1"


def test_a_job_is_done_and_its_result_is_kept(client):
    told = asked(client, scenario="ball")
    assert told["result"]["sentence"] == "run of ball"
    (kept,) = [
        one for one in client.get("/api/groups/newton").json()["results"] if one["id"] == told["id"]
    ]
    assert kept["scenario"] == "ball"
    assert client.get(f"/api/results/Newton/{told['id']}").json() == told


@pytest.mark.parametrize(
    ("how", "sentence"),
    [
        ("fault", "holds no bounce"),
        ("unknown", "no engine is called 'mujoko'; did you mean mujoco?"),
        ("broken", "The job failed by a mistake of the program."),
        ("no number", "The job failed by a mistake of the program."),
        ("full", "The disk of the lab is nearly full, so nothing more is stored."),
        ("die", "The process of this job ended without an answer"),
    ],
)
def test_what_goes_wrong_is_told_in_sentences_and_the_next_job_is_done(client, how, sentence):
    told = asked(client, how=how)
    assert told["state"] == "failed"
    assert told["faults"][0].startswith(sentence)
    assert asked(client)["state"] == "done"


def test_all_faults_of_a_request_are_told_and_no_place_of_this_machine(client, folder):
    told = asked(client, how="fault")
    assert told["faults"] == ["holds no bounce", "is too short"]
    assert str(folder) not in json.dumps(told)


def test_what_a_whole_class_asks_is_computed_once_and_kept_by_each(client):
    first, second = (asked(client, group=name, how="count", of="x") for name in ("Tycho", "Brahe"))
    assert first["result"] == second["result"] == {"sentence": "x was counted 1 times"}
    assert first["id"] != second["id"]
    assert asked(client, group="Tycho", how="count", of="y")["result"] != first["result"]
    recording = sent(client, WAV).json()["id"]
    again = asked(client, how="count", of="x", recording=recording)
    assert again["result"] == {"sentence": "x was counted 2 times"}


def test_a_job_that_takes_too_long_is_ended(client):
    told = asked(client, kind="report", how="long")
    assert told["faults"] == [
        "The job took too long, so it was ended. Choose fewer engines, or a shorter run."
    ]
    assert asked(client)["state"] == "done"


def test_a_worker_warms_up_before_its_first_job(client):
    assert asked(client, how="warmed")["result"] == {"sentence": "warm"}


def test_faults_are_told_in_the_language_of_the_browser(client):
    german = {"accept-language": "de-AT,de;q=0.9,en;q=0.5"}
    told = client.get("/api/groups/Nobody", headers=german).json()
    assert told == {"faults": ["Keine Gruppe heißt 'Nobody'."]}
    assert client.get("/api/groups/Nobody").json() == {"faults": ["No group is called 'Nobody'."]}


@pytest.mark.parametrize(
    ("asked", "status", "sentence"),
    [
        ({"group": "Newton"}, 400, "There is no job of the kind 'None'."),
        ({"group": "Newton", "kind": "scenarios"}, 400, "There is no job of the kind"),
        ({"group": "", "kind": "run"}, 400, "A group needs a name"),
        ({"group": ["x"], "kind": "run"}, 400, "A group needs a name"),
        ({"group": "a\u202eb", "kind": "run"}, 400, "A group needs a name"),
        ({"group": "x" * 61, "kind": "run"}, 400, "A group needs a name"),
        ({"group": "Newton", "kind": "run", "scenario": "../x.yaml"}, 404, "'../x.yaml' is no sc"),
        ({"group": "Newton", "kind": "run", "scenario": ["ball"]}, 404, "\"['ball']\" is no scen"),
        ({"group": "Newton", "kind": "fit", "recording": "../../etc"}, 404, "There is no such rec"),
        ({"group": "Newton", "kind": "fit", "recording": "0" * 16}, 404, "There is no such rec"),
        ({"group": "Newton", "kind": "report", "result": 7}, 404, "There is no such result"),
    ],
)
def test_jobs_that_name_what_is_not_there_are_refused(client, asked, status, sentence):
    client.post("/api/jobs", json={"group": "Newton", "kind": "run"})
    answer = client.post("/api/jobs", json=asked)
    assert answer.status_code == status
    (fault,) = answer.json()["faults"]
    assert fault.startswith(sentence)


@pytest.mark.parametrize(
    "raw",
    [
        *(b"", b"[]", b"{", b"\xff", b'"xxx"', b"[" * 100_000),
        *(b'{"a": NaN}', b'{"a": -Infinity}', b'{"a": 1e400}', b'{"a": 1' + b"0" * 400 + b"}"),
        *(b'{"a": ' + b"[" * 9 + b"]" * 9 + b"}", b'{"a":' * 50 + b"1" + b"}" * 50),
    ],
)
def test_what_is_no_json_object_is_refused(client, raw):
    answer = client.post("/api/jobs", content=raw, headers={"content-type": "application/json"})
    assert (answer.status_code, answer.json()["faults"]) == (
        400,
        ["The request is no JSON object."],
    )


def test_large_json_is_refused(client):
    raw = b'{"a": "' + b"x" * uploads.JSON_BYTES + b'"}'
    answer = client.post("/api/jobs", content=raw, headers={"content-type": "application/json"})
    assert answer.status_code == 413


# ---- recordings


def test_a_recording_is_kept_with_what_was_heard_in_it(client, folder):
    told = sent(client, WAV, name="../../drop 1.wav", kind="sound").json()
    assert (told["kind"], told["sentence"]) == ("sound", "recording of None")
    (kept,) = [
        one
        for one in client.get("/api/groups/Newton").json()["recordings"]
        if one["id"] == told["id"]
    ]
    assert (kept["name"], kept["bytes"]) == ("drop 1.wav", len(WAV))
    (place,) = folder.glob(f"*/recordings/{told['id']}")
    assert (place / "source.wav").read_bytes() == WAV
    assert client.get(f"/api/recordings/Newton/{told['id']}").json() == told
    assert asked(client, kind="fit", recording=told["id"])["state"] == "done"


@pytest.mark.parametrize(
    ("content", "status", "sentence"),
    [
        (b"", 400, "The file is empty."),
        (b"\x89PNG\r\n\x1a\n" + bytes(500), 415, "The file holds no sound, no video and no table"),
        (b"MZ" + bytes(500), 415, "The file holds no sound, no video and no table"),
        (b"<!DOCTYPE html><script>1</script>", 415, "The file holds no sound, no video and no ta"),
        (bytes(500), 415, "The file holds no sound, no video and no table"),
    ],
)
def test_files_that_lie_about_their_type_are_refused_and_not_kept(
    client, folder, content, status, sentence
):
    before = files_below(folder)
    answer = sent(client, content, name="drop.wav", kind="sound")
    assert answer.status_code == status
    assert answer.json()["faults"][0].startswith(sentence)
    assert files_below(folder) == before


def test_a_recording_that_cannot_be_used_is_not_kept(client, folder):
    before = files_below(folder)
    answer = sent(client, WAV, name="silence.wav")
    told = answer.json()["faults"]
    assert (answer.status_code, told) == (422, ["silence.wav: no impact is heard in it"])
    assert files_below(folder) == before


def test_too_large_a_file_is_refused_by_what_it_says_and_by_what_it_is(client, folder, monkeypatch):
    before = files_below(folder)
    largest = max(contents.LARGEST.values())
    answer = client.post(
        "/api/recordings?group=Newton", content=WAV, headers={"content-length": f"{largest + 1}"}
    )
    assert (answer.status_code, answer.json()["faults"]) == (
        413,
        ["The file is too large: at most 300 MB are taken. Record a shorter drop."],
    )
    monkeypatch.setitem(contents.LARGEST, contents.SOUND, 10**6)
    answer = sent(client, (WAV for _ in range(1000)))  # in parts, without a length
    assert (answer.status_code, answer.json()["faults"]) == (
        413,
        ["The file is too large: at most 1 MB are taken. Record a shorter drop."],
    )
    assert files_below(folder) == before


@pytest.mark.parametrize("length", ["-1", "x", "9" * 30, "\u0663"])
def test_a_length_that_is_none_is_refused(client, length):
    answer = client.post(
        "/api/recordings?group=Newton",
        content=WAV,
        headers={"content-length": length.encode()},
    )
    assert answer.status_code in (400, 413)


def test_a_disk_that_becomes_full_while_a_file_comes_is_told(client, folder, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    before = files_below(folder)
    with monkeypatch.context() as changed:
        changed.setattr(uploads, "_write", full)
        answer = sent(client, WAV)
    assert (answer.status_code, answer.json()["faults"]) == (
        507,
        ["The disk of the lab is nearly full, so nothing more is stored."],
    )
    assert files_below(folder) == before


def test_a_group_may_not_fill_the_disk_with_small_files_or_jobs(client, monkeypatch):
    asked(client, group="Hooke")
    monkeypatch.setattr(groups, "_MOST_KEPT", 0)
    for answer in (
        client.post("/api/jobs", json={"group": "Hooke", "kind": "report"}),
        sent(client, WAV, group="Hooke"),
    ):
        assert answer.status_code == 507
        (fault,) = answer.json()["faults"]
        assert fault.startswith("The group has stored all that it may, 2 GB or 0 recordings")
    # of runs only the latest are kept
    assert asked(client, group="Hooke")["state"] == "done"


def test_a_full_disk_is_told(client, monkeypatch):
    import shutil

    usage = shutil.disk_usage("/")
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage._replace(free=10**6))
    for answer in (sent(client, WAV), client.post("/api/jobs", json={"group": "H", "kind": "run"})):
        assert (answer.status_code, answer.json()["faults"]) == (
            507,
            ["The disk of the lab is nearly full, so nothing more is stored."],
        )


# ---- what is served


@pytest.mark.parametrize(
    "path",
    [
        "/files/Newton/..%2f..%2fgroup.json",
        "/files/Newton/../group.json",
        "/files/..%2f/x",
        "/files/Newton/.hidden",
        "/files/Newton/link.yaml",
        "/files/Newton/absent.yaml",
        "/static/..%2fapplication.py",
        "/static/__init__.py",
        "/static/absent.js",
        "/api/groups/..",
        "/api/results/Newton/..%2f..",
        "/api/jobs/..%2f..%2fgroup",
        "/etc/passwd",
    ],
)
def test_nothing_else_is_served(client, folder, path):
    asked(client)
    (files,) = folder.glob("newton-*/files")
    if not (files / "link.yaml").is_symlink():
        (files / "link.yaml").symlink_to("/etc/passwd")
    answer = client.get(path)
    assert answer.status_code in (400, 404)
    assert "root:" not in answer.text


def test_files_are_downloaded_and_reports_are_strangers_to_the_lab(client, folder):
    asked(client)
    (files,) = folder.glob("newton-*/files")
    (files / "1-report.html").write_text("<script>1</script>", encoding="utf-8")
    (files / "1-values.yaml").write_text("a: 1\n", encoding="utf-8")
    values = client.get("/files/Newton/1-values.yaml")
    assert values.headers["content-disposition"] == 'attachment; filename="1-values.yaml"'
    assert values.text == "a: 1\n"
    shown = client.get("/files/Newton/1-report.html")
    assert shown.headers["content-security-policy"].startswith("sandbox allow-scripts")
    kept = client.get("/files/Newton/1-report.html?download=1")
    assert kept.headers["content-disposition"] == 'attachment; filename="1-report.html"'


@pytest.mark.parametrize("path", ["/teacher", "/static/teacher.js", "/api/groups/x", "/nothing"])
def test_every_answer_is_guarded_and_sets_no_cookie(client, path):
    headers = client.get(path).headers
    policy = headers["content-security-policy"]
    assert "default-src 'self'" in policy
    assert "script-src 'self';" in policy
    assert "http" not in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert "set-cookie" not in headers


def test_pages_hold_no_script_that_stands_in_them(client):
    text = client.get("/teacher").text
    assert text.count("<script") == 2
    assert '<script type="application/json"' in text
    assert '<script src="/static/teacher.js">' in text


def test_scripts_are_sent_small_and_once(client):
    answer = client.get("/static/plotly.js")
    assert answer.headers["content-encoding"] == "gzip"
    # of the 3 MB that the page may weigh
    assert int(answer.headers["content-length"]) < 1.6e6
    again = client.get("/static/plotly.js", headers={"if-none-match": answer.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


@pytest.mark.parametrize(
    "headers",
    [
        {"origin": "https://elsewhere.example"},
        {"origin": "null"},
        {"sec-fetch-site": "cross-site"},
        {"host": "elsewhere.example"},
    ],
)
def test_requests_of_other_pages_are_refused(client, headers):
    answer = client.post("/api/jobs", json={"group": "Newton", "kind": "run"}, headers=headers)
    assert answer.status_code == 403


def test_a_form_of_another_page_cannot_send_a_job(client):
    answer = client.post("/api/jobs", content=b"{}", headers={"content-type": "text/plain"})
    assert answer.status_code == 415


def test_titles_come_as_they_are_for_the_page_to_escape(client):
    assert client.get("/api/scenarios").json() == lab_stand_in.SCENARIOS
    assert client.get("/api/scenarios").headers["content-type"] == "application/json"
    assert client.get("/api/scenarios/no_such").status_code == 404


def test_names_of_groups_are_data_and_not_places(client, folder):
    name = "../<script>alert(1)</script>"
    asked(client, group=name)
    assert client.get("/api/groups/" + "%2e%2e%2f%3Cscript%3Ealert(1)").status_code == 404
    (made,) = folder.glob("script-alert-1-script-*")
    assert client.get(f"/api/groups/{made.name}").json()["name"] == name
    assert {path.parent for path in folder.iterdir()} == {folder}


# ---- the teacher


def test_the_teacher_sees_all_groups_and_closes_the_queue(tmp_path):
    with opened(tmp_path, pin="4711") as client:
        asked(client, group="Kepler")
        asked(client, group="Galilei")
        assert client.get("/api/teacher").status_code == 401
        pin = {"x-pin": "4711"}
        told = client.get("/api/teacher", headers=pin).json()
        assert [group["name"] for group in told["groups"]] == ["Galilei", "Kepler"]
        assert told["open"]
        assert client.post("/api/teacher/queue", json={"open": False}).status_code == 401
        client.post("/api/teacher/queue", json={"open": False}, headers=pin)
        refused = client.post("/api/jobs", json={"group": "Kepler", "kind": "run"})
        assert refused.status_code == 503
        assert refused.json()["faults"][0].startswith("The teacher has closed the queue.")
        assert sent(client, WAV, group="Kepler").status_code == 503
        assert client.get("/api/groups/Kepler").json()["recordings"] == []
        # a phone that comes now still sees what there is
        assert client.get("/api/scenarios").status_code == 200
        client.post("/api/teacher/queue", json={"open": True}, headers=pin)
        assert asked(client, group="Kepler")["state"] == "done"


def test_wrong_pins_are_soon_refused_and_then_the_right_one_too(tmp_path):
    with opened(tmp_path, pin="4711") as client:
        codes = [
            client.get("/api/teacher", headers={"x-pin": f"{i}"}).status_code for i in range(6)
        ]
        assert codes == [401] * 5 + [429]
        assert client.get("/api/teacher", headers={"x-pin": "4711"}).status_code == 429


def test_results_survive_a_restart(tmp_path):
    with opened(tmp_path) as client:
        told = asked(client, group="Kepler", scenario="ball")
        recording = client.post("/api/recordings?group=Kepler&name=a.wav", content=WAV).json()
    with opened(tmp_path) as client:
        assert client.get(f"/api/jobs/{told['id']}").json() == told
        listing = client.get("/api/groups/Kepler").json()
        assert [one["id"] for one in listing["results"]] == [told["id"]]
        assert client.get(f"/api/recordings/Kepler/{recording['id']}").json() == recording
        # one whose file had come when the lab ended, but had not been looked at
        (told_of,) = tmp_path.glob("kepler-*/recordings/*/recording.json")
        told_of.unlink()
        again = client.get(f"/api/recordings/Kepler/{recording['id']}").json()
        assert again == {**recording, "pid": again["pid"]}
        assert told_of.is_file()
        lost = client.get(f"/api/jobs/{'0' * 16}")
        assert lost.status_code == 404
        assert "send it once more" in lost.json()["faults"][0]
