"""Public recordings: described fully, found where they are, fetched with their checksum."""

import functools
import gzip
import hashlib
import http.server
import threading

import pytest
import yaml

from simcompare.errors import InputError, OutputError, UnknownName
from simcompare.hardware import mapping as mappings
from simcompare.hardware.recordings import registry
from simcompare.inference import plan as plans

NAMES = list(registry.files())


@pytest.mark.parametrize("name", NAMES)
def test_every_data_set_is_described_fully(name):
    found = registry.get(name)
    mappings.of_tree(dict(found.read), name)
    for entry in found.validation:
        plans.of_tree(entry, name)
    assert len(found.text) > 40
    assert len(found.citation) > 20


@pytest.fixture
def a_set(tmp_path, monkeypatch):
    content = b"t,x\n0,1\n1,2\n"
    (tmp_path / "sets").mkdir()
    tree = {
        "title": "a title", "text": "a text", "citation": "A. Author 2026", "licence": "MIT",
        "source": {"repository": "someone/something", "commit": "0" * 40},
        "files": [{"path": "folder/log file.csv", "local": "mine/log.csv",
                   "sha256": hashlib.sha256(content).hexdigest(), "size_bytes": len(content)}],
    }  # fmt: skip
    (tmp_path / "sets" / "mine.yaml").write_text(yaml.safe_dump(tree))
    monkeypatch.setattr(registry, "files", lambda: {"mine": tmp_path / "sets" / "mine.yaml"})
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv(registry.FOLDER_VARIABLE, raising=False)
    registry.get.cache_clear()
    yield content
    registry.get.cache_clear()


def test_a_folder_of_the_users_own_comes_first_and_is_checked(a_set, tmp_path, monkeypatch):
    with pytest.raises(InputError, match="data fetch mine"):
        registry.locate("mine")
    (tmp_path / "own" / "mine").mkdir(parents=True)
    log = tmp_path / "own" / "mine" / "log.csv"
    log.write_bytes(a_set)
    monkeypatch.setenv(registry.FOLDER_VARIABLE, str(tmp_path / "own"))
    assert registry.locate("mine") == [log]
    log.write_bytes(a_set + b"2,3\n")
    with pytest.raises(InputError, match="is not the registered file"):
        registry.locate("mine")


def test_an_unknown_name_is_told_with_the_nearest(a_set):
    with pytest.raises(UnknownName, match="mine"):
        registry.get("mime")


class _Server(http.server.ThreadingHTTPServer):
    daemon_threads = True


@pytest.fixture
def server(tmp_path):
    (tmp_path / "web").mkdir()
    handler = functools.partial(
        http.server.SimpleHTTPRequestHandler, directory=str(tmp_path / "web")
    )
    with _Server(("127.0.0.1", 0), handler) as found:
        threading.Thread(target=found.serve_forever, daemon=True).start()
        yield tmp_path / "web", f"http://127.0.0.1:{found.server_address[1]}"
        found.shutdown()


def test_a_recording_is_fetched_once_and_checked(a_set, server, monkeypatch):
    pytest.importorskip("pooch", reason="pooch fetches recordings; it is in simcompare[hardware]")
    folder, address = server
    monkeypatch.setattr(registry.DataSet, "url", lambda self, file: f"{address}/log.csv")
    with pytest.raises(OutputError, match="cannot be fetched"):
        registry.fetch("mine")
    (folder / "log.csv").write_bytes(b"somebody else's file")
    with pytest.raises(OutputError, match="cannot be fetched"):
        registry.fetch("mine")
    (folder / "log.csv").write_bytes(a_set)
    (found,) = registry.fetch("mine")
    assert found.read_bytes() == a_set
    (folder / "log.csv").unlink()
    assert registry.fetch("mine") == [found]


class _Told(http.server.BaseHTTPRequestHandler):
    """Answers with what the server was told."""

    def do_GET(self):
        status, headers, body = self.server.answer
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


@pytest.fixture
def answering(monkeypatch):
    pytest.importorskip("pooch", reason="pooch fetches recordings; it is in simcompare[hardware]")
    with _Server(("127.0.0.1", 0), _Told) as found:
        threading.Thread(target=found.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{found.server_address[1]}/log.csv"
        monkeypatch.setattr(registry.DataSet, "url", lambda self, file: address)
        yield found
        found.shutdown()


@pytest.mark.parametrize(
    ("headers", "body", "told"),
    [
        ({"Content-Length": "12"}, b"t,x\n0", "was cut: 5 of 12 bytes came; try again"),
        ({}, b"t,x\n0", "was cut: 5 of 12 bytes came; try again"),
        ({}, b"0" * 10**6, "it has more than the 12 bytes that were registered"),
        ({"Content-Encoding": "gzip"}, gzip.compress(b"0" * 10**7), "more than the 12 bytes"),
        ({}, b"t,x\n0,1\n1,3\n", "cannot be fetched (SHA256 hash"),
    ],
)
def test_what_is_not_the_registered_file_is_told_and_not_kept(
    a_set, answering, tmp_path, headers, body, told
):
    answering.answer = 200, headers, body
    with pytest.raises(OutputError) as fault:
        registry.fetch("mine")
    assert told in str(fault.value)
    assert not [path for path in (tmp_path / "cache").rglob("*") if path.is_file()]


@pytest.mark.parametrize("place", ["file:///etc/passwd", "ftp://127.0.0.1/log.csv"])
def test_a_redirect_leads_to_the_web_alone(a_set, answering, place):
    answering.answer = 302, {"Location": place}, b""
    with pytest.raises(OutputError, match="leads to what is no web address"):
        registry.fetch("mine")


def test_a_damaged_file_of_the_cache_is_fetched_again(a_set, answering):
    answering.answer = 200, {}, a_set
    (found,) = registry.fetch("mine")
    found.write_bytes(b"damaged")
    with pytest.raises(InputError, match="cure: simcompare data fetch mine"):
        registry.locate("mine")
    assert registry.fetch("mine") == [found]
    assert found.read_bytes() == a_set


def test_without_a_network_it_is_said_what_to_do(a_set, monkeypatch, tmp_path):
    pytest.importorskip("pooch", reason="pooch fetches recordings; it is in simcompare[hardware]")
    # a port that nobody listens to
    monkeypatch.setattr(registry.DataSet, "url", lambda self, file: "http://127.0.0.1:9/log.csv")
    with pytest.raises(OutputError) as error:
        registry.fetch("mine")
    text = str(error.value)
    target = tmp_path / "cache" / "simcompare" / "recordings" / "mine" / "log.csv"
    assert "127.0.0.1:9 cannot be reached (no network?)" in text
    assert f"put it at {target}" in text
    assert registry.FOLDER_VARIABLE in text
    assert "Pool" not in text
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(a_set)
    assert registry.fetch("mine") == [target]


def test_a_folder_of_the_users_that_is_none_is_told(a_set, tmp_path, monkeypatch):
    monkeypatch.setenv(registry.FOLDER_VARIABLE, str(tmp_path / "nowhere"))
    with pytest.raises(InputError, match=r"SIMCOMPARE_DATA: names .*nowhere, which is no folder"):
        registry.locate("mine")


def test_names_that_are_missing_or_unknown_are_told_with_those_there_are(a_set, call):
    for words, told in (((), "at least one"), (("mine", "yours", "his"), "'yours', 'his'")):
        code, _, err = call("data", "fetch", *words)
        assert code == 2
        assert told in err
        assert "known: mine" in err


def test_the_address_names_repository_commit_and_file(a_set):
    found = registry.get("mine")
    assert found.url(found.files[0]) == (
        f"https://raw.githubusercontent.com/someone/something/{'0' * 40}/folder/log%20file.csv"
    )
