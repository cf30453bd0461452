"""The lab as it is opened: real connections, https, Ctrl-C, and what the command refuses."""

import contextlib
import errno
import http.client
import json
import os
import signal
import socket
import ssl
import stat
import subprocess
import sys
import threading
import time
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
import typer.testing

pytest.importorskip("starlette", reason="the extra [web] is not installed")
pytest.importorskip("uvicorn", reason="the extra [web] is not installed")
pytest.importorskip("segno", reason="the extra [web] is not installed")
pytest.importorskip("trustme", reason="the extra [web] is not installed")

from cryptography import x509
from uvicorn.protocols.http import h11_impl

from simcompare import cli
from simcompare.cli import lab as lab_verb
from simcompare.errors import InputError
from simcompare.lab import connections, serving, share, uploads
from simcompare.lab.groups import Groups
from tests import lab_stand_in
from tests.test_lab_server import WAV

#: a lab in a process of its own, as the command opens it, with a stand-in that does the jobs
ALONE = """
import sys
from pathlib import Path
from simcompare.lab import serving
from simcompare.running import interruption
from tests import lab_stand_in
interruption.take_over()
made = serving.open_lab(serving.Wanted(Path(sys.argv[1]), 0), lab_stand_in.perform)
serving.serve(made, lambda: print(made.listening.getsockname()[1], flush=True))
print("closed", flush=True)
"""


@contextlib.contextmanager
def served(folder, **wanted):
    """A lab that is served in a thread."""
    opened = serving.open_lab(serving.Wanted(folder, 0, **wanted), lab_stand_in.perform)
    thread = threading.Thread(target=opened.server.run, kwargs={"sockets": [opened.listening]})
    thread.start()
    try:
        yield opened
    finally:
        opened.server.should_exit = True
        thread.join()


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    with served(tmp_path_factory.mktemp("plain")) as opened:
        yield opened


def port_of(opened):
    return opened.listening.getsockname()[1]


def ask(connection, method, path, body=None):
    given = {"Content-Type": "application/json"} if isinstance(body, str) else {}
    connection.request(method, path, body, given)
    answer = connection.getresponse()
    return answer.status, json.loads(answer.read())


def worker_of(connection):
    """Has a job done; the number of the process that did it."""
    body = json.dumps({"group": "Newton", "kind": "run"})
    status, told = ask(connection, "POST", "/api/jobs", body)
    assert status == 202, told
    return ask(connection, "GET", f"/api/jobs/{told['id']}?wait=20")[1]["result"]["pid"]


def test_it_listens_to_this_machine_alone_unless_it_is_shared(plain):
    assert plain.listening.getsockname()[0] == "127.0.0.1"
    assert not plain.lab.pin.is_wanted
    connection = http.client.HTTPConnection("127.0.0.1", port_of(plain))
    assert ask(connection, "GET", "/api/share") == (200, {})


def test_a_shared_lab_speaks_https_with_its_own_certificate(tmp_path):
    with served(tmp_path, shared=True, host="192.0.2.7", pin="4711") as opened:
        assert opened.listening.getsockname()[0] in ("0.0.0.0", "::")
        trusting = ssl.create_default_context(cafile=tmp_path / "certificate" / "certificate.pem")
        trusting.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN
        connection = http.client.HTTPSConnection("127.0.0.1", port_of(opened), context=trusting)
        status, told = ask(connection, "GET", "/api/share")
        assert (status, told["url"]) == (200, f"https://192.0.2.7:{port_of(opened)}/")
        # also as a picture of its own, which needs the name of what it is written in
        assert told["qr_svg"].startswith('<svg xmlns="http://www.w3.org/2000/svg"')
        assert "certificate" in told["sentence"]
        assert ask(connection, "GET", "/api/teacher")[0] == 401
        assert ask(connection, "GET", "/files/certificate/certificate.pem")[0] == 404
        assert worker_of(connection) != os.getpid()


def test_a_shared_lab_always_has_a_pin(tmp_path):
    wanted = serving.Wanted(tmp_path, 0, shared=True, host="192.0.2.7")
    opened = serving.open_lab(wanted, lab_stand_in.perform)
    opened.listening.close()
    assert opened.lab.pin.is_wanted
    assert opened.pin.isdigit()
    assert len(opened.pin) == 6


def raw(port, *parts):
    """All that is answered to these bytes."""
    with socket.create_connection(("127.0.0.1", port), timeout=30) as connection:
        for part in parts:
            connection.sendall(part)
        answered = b""
        while more := connection.recv(65536):
            answered += more
    return answered


def head(port, *lines):
    first = (b"POST /api/recordings?group=Galilei HTTP/1.1", b"Host: 127.0.0.1:%d" % port)
    return b"\r\n".join([*first, b"Connection: close", *lines, b"", b""])


def test_an_upload_that_ends_before_its_length_is_not_kept(plain):
    port, folder = port_of(plain), plain.lab.groups.join("Galilei").folder / "recordings"
    with socket.create_connection(("127.0.0.1", port)) as connection:
        connection.sendall(head(port, b"Content-Length: 9000") + WAV + bytes(4000))
        until(lambda: list(folder.glob(".*")), "the upload is not taken up")
    until(lambda: not list(folder.iterdir()), "the upload is kept")


def test_what_comes_beyond_the_length_is_not_part_of_the_file(plain):
    port, folder = port_of(plain), plain.lab.groups.join("Galilei").folder / "recordings"
    raw(port, head(port, b"Content-Length: %d" % len(WAV)), WAV, b"GET /secret\r\n")
    # the whole connection may be refused, as the server sees what follows early or late
    until(lambda: not list(folder.glob(".*")), "the upload does not end")
    assert {path.read_bytes() for path in folder.glob("*/source.*")} <= {WAV}


def test_a_file_that_says_it_is_too_large_is_refused_before_it_comes(plain):
    port = port_of(plain)
    answered = raw(port, head(port, b"Content-Length: 2200000000"))
    assert answered.startswith(b"HTTP/1.1 413")
    assert b"at most 300 MB are taken" in answered


def test_a_length_and_parts_together_are_refused(plain):
    port = port_of(plain)
    both = head(port, b"Content-Length: 3", b"Transfer-Encoding: chunked")
    assert raw(port, both, b"0\r\n\r\nGET / HTTP/1.1\r\n\r\n").startswith(b"HTTP/1.1 400")


@pytest.mark.parametrize("parts", [[], [b"GET / HTTP/1.1\r\nHost: 127"], [b"GET", b" / "]])
def test_a_connection_on_which_nothing_is_asked_is_closed(plain, monkeypatch, parts):
    monkeypatch.setattr(connections, "_HEAD_S", 0.05)
    assert raw(port_of(plain), *parts) == b""


def test_a_connection_from_nobody_any_more_is_closed(plain, monkeypatch):
    monkeypatch.setattr(connections, "_HEAD_S", 0.05)
    monkeypatch.setattr(h11_impl, "get_remote_addr", lambda _: None)
    assert raw(port_of(plain)) == b""


def test_each_request_on_a_connection_has_its_own_time_for_its_head(plain, monkeypatch):
    monkeypatch.setattr(connections, "_HEAD_S", 1.0)  # far beyond what sending takes
    port = port_of(plain)
    whole = b"GET /api/share HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % port
    with socket.create_connection(("127.0.0.1", port), timeout=30) as connection:
        connection.sendall(whole)
        assert connection.recv(12) == b"HTTP/1.1 200"
        connection.sendall(whole[:20])
        while more := connection.recv(65536):  # until it is closed
            assert b"HTTP/1.1" not in more


def test_a_connection_on_which_the_rest_of_a_refused_file_does_not_come_is_closed(
    plain, monkeypatch
):
    monkeypatch.setattr(connections, "_HEAD_S", 1.0)  # far beyond what sending takes
    port = port_of(plain)
    kept = head(port, b"Content-Length: 2200000000").replace(b"Connection: close\r\n", b"")
    with socket.create_connection(("127.0.0.1", port), timeout=30) as connection:
        connection.sendall(kept)
        assert connection.recv(12) == b"HTTP/1.1 413"
        connection.sendall(b"x")
        while connection.recv(65536):
            pass


def test_one_address_cannot_take_all_connections(plain, monkeypatch):
    monkeypatch.setattr(plain.server.config, "limit_concurrency", 6)
    with contextlib.ExitStack() as stack:
        address = ("127.0.0.1", port_of(plain))
        held = [
            stack.enter_context(socket.create_connection(address, timeout=30)) for _ in range(9)
        ]
        refused = [closed(one) for one in held[3:]]
        assert all(refused)
        held[0].sendall(head(address[1], b"Content-Length: 2200000000"))
        assert held[0].recv(12) == b"HTTP/1.1 413"


def closed(connection):
    try:
        return connection.recv(1) == b""
    except ConnectionResetError:
        return True


def test_an_upload_that_trickles_is_ended(plain, monkeypatch):
    monkeypatch.setattr(uploads, "_EACH_S", 0.05)
    port = port_of(plain)
    answered = raw(port, head(port, b"Content-Length: 9000"), WAV[:100])
    assert answered.startswith(b"HTTP/1.1 408")


@pytest.mark.parametrize(("number", "says"), [("SIGINT", "closed\n"), ("SIGKILL", "")])
def test_no_process_is_left_when_the_lab_ends(tmp_path, number, says):
    lab = subprocess.Popen(
        [sys.executable, "-c", ALONE, tmp_path],
        stdout=subprocess.PIPE,
        text=True,
        # Ctrl-C is not ignored, also where the tests run in the background of a script
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )
    with lab:
        connection = http.client.HTTPConnection("127.0.0.1", int(lab.stdout.readline()))
        worker = worker_of(connection)
        lab.send_signal(getattr(signal, number))
        assert lab.stdout.read() == says
    assert lab.returncode == (0 if says else -signal.SIGKILL)
    until(lambda: is_gone(worker), "its worker is left")


def until(is_so, fault):
    """Returns when something is so; the limit is far beyond what the slowest machine needs."""
    for _ in range(6000):
        if is_so():
            return
        time.sleep(0.01)
    raise AssertionError(fault)


def is_gone(number):
    try:
        text = Path(f"/proc/{number}/stat").read_text(encoding="latin-1")
    except OSError:
        return True
    return text.rpartition(")")[2].split()[0] == "Z"


# ---- the certificate and the code


def test_a_certificate_is_kept_while_it_holds_and_made_anew_for_another_name(tmp_path):
    first = share.certificate(tmp_path, ["localhost", "127.0.0.1", "192.0.2.7"])
    assert stat.S_IMODE(first.path.stat().st_mode) == 0o600
    again = share.certificate(tmp_path, ["localhost", "192.0.2.7"])
    assert again == first
    other = share.certificate(tmp_path, ["localhost", "192.0.2.8"])
    assert other.fingerprint != first.fingerprint
    first.path.write_text("damaged")
    assert share.certificate(tmp_path, ["localhost"]).fingerprint != other.fingerprint


def test_a_certificate_holds_no_longer_than_browsers_take(tmp_path):
    made = share.certificate(tmp_path, ["localhost"])
    found = x509.load_pem_x509_certificate(made.path.read_bytes())
    # Apple and Chrome take 398 days from the first second to the last
    assert found.not_valid_after_utc - found.not_valid_before_utc < timedelta(days=398)
    assert found.not_valid_before_utc < datetime.now(UTC)


def test_addresses_are_those_of_others():
    assert not {"127.0.0.1", "::1", "0.0.0.0"} & set(share.addresses())


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("Lecturer.example", ["lecturer.example", "lecturer.local"]),
        ("my_laptop", []),
        ("a" * 64, []),
        ("localhost", []),
        ("m\u00fcller", ["xn--mller-kva", "xn--mller-kva.local"]),
    ],
)
def test_names_of_this_machine_that_no_certificate_can_hold_are_left_out(monkeypatch, name, found):
    monkeypatch.setattr(socket, "gethostname", lambda: name)
    assert share.names() == found
    share.addresses()


@pytest.mark.parametrize(
    "host",
    ["https://192.0.2.7:8000/", "192.0.2.7:1", "foo bar", "<b>", "*.x", "a" * 300, "fe80::1%1"],
)
def test_a_host_that_is_none_is_refused(tmp_path, host):
    wanted = serving.Wanted(tmp_path / "lab", 0, shared=True, host=host)
    with pytest.raises(InputError, match="is no name or address of a computer"):
        serving.open_lab(wanted, lab_stand_in.perform)
    assert not (tmp_path / "lab").exists()


def test_phones_cannot_get_in_without_a_network(tmp_path, monkeypatch):
    monkeypatch.setattr(share, "addresses", list)
    wanted = serving.Wanted(tmp_path, 0, shared=True)
    with pytest.raises(InputError, match="join the Wi-Fi"):
        serving.open_lab(wanted, lab_stand_in.perform)


def test_a_shared_lab_answers_to_both_kinds_of_addresses(tmp_path):
    if not socket.has_dualstack_ipv6():
        pytest.skip("this machine has no IPv6")
    with served(tmp_path, shared=True, host="fd00::7") as opened:
        assert opened.lab.address == f"https://[fd00::7]:{port_of(opened)}/"
        for address in ("::1", "127.0.0.1"):
            with socket.create_connection((address, port_of(opened)), timeout=30):
                pass


@pytest.mark.parametrize(("port", "other"), [(80, 8000), (8000, 8001), (65535, 8000)])
def test_a_port_that_may_not_be_had_is_told_with_one_that_may(tmp_path, monkeypatch, port, other):
    def refuse(*_, **__):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(socket, "create_server", refuse)
    with pytest.raises(InputError, match=f"Permission denied; .* --port {other}$"):
        serving.open_lab(serving.Wanted(tmp_path, port), lab_stand_in.perform)


def test_the_code_in_the_terminal_can_be_scanned():
    cv2 = pytest.importorskip("cv2", reason="the reader of pictures is not installed")
    address = "https://192.168.178.23:8000/"
    halves = {"█": (255, 255), "▀": (255, 0), "▄": (0, 255), " ": (0, 0)}
    lines = share.code_as_text(address).splitlines()
    dots = np.array([[halves[letter] for letter in line] for line in lines], np.uint8)
    picture = dots.transpose(0, 2, 1).reshape(2 * len(lines), -1)
    large = np.kron(picture, np.ones((8, 8), np.uint8))
    assert cv2.QRCodeDetector().detectAndDecode(large)[0] == address


# ---- the command


def refused(*words):
    cli.register()
    result = typer.testing.CliRunner().invoke(cli.app, ["lab", *words])
    return result.exit_code, " ".join(result.output.split())


def test_all_that_does_not_fit_together_is_told_at_once():
    code, text = refused("--pin", "12", "--host", "me", "--language", "fr")
    assert code == 2
    for sentence in (
        "--host needs --share beside it",
        "--pin needs --share beside it",
        "--pin must be 4 to 12 digits, such as 4711",
        "--language fr is not spoken; choose en or de",
    ):
        assert sentence in text


def test_a_missing_extra_is_told_with_its_cure(monkeypatch):
    monkeypatch.setattr(lab_verb, "_WEB", ("starlette", "no_such_module"))
    code, text = refused()
    assert code == 3
    assert "the lab needs no_such_module, not installed; cure:" in text
    assert "pip install 'simcompare[web]'" in text


def test_a_port_that_is_taken_is_told_with_its_cure(tmp_path, plain):
    wanted = serving.Wanted(tmp_path, port_of(plain))
    with pytest.raises(InputError, match="cure: simcompare lab --port"):
        serving.open_lab(wanted, lab_stand_in.perform)


def test_a_lab_that_nobody_used_leaves_no_folder(tmp_path):
    for name, is_there in (("unused", False), ("used", True), ("before", True)):
        folder = tmp_path / name
        if name == "before":
            folder.mkdir()
        groups = Groups(folder)
        if name == "used":
            groups.join("Newton")
        assert groups.leave() is folder.exists() is is_there


def test_a_folder_that_is_a_file_is_told(tmp_path):
    (tmp_path / "lab").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        serving.open_lab(serving.Wanted(tmp_path / "lab", 0), lab_stand_in.perform)
