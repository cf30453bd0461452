"""Letting phones in: the addresses of this machine, its own certificate, and a code to scan."""

from __future__ import annotations

import contextlib
import hashlib
import io
import ipaddress
import socket
import ssl
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

import idna
import segno
import trustme
from cryptography import x509

from simcompare.model import whole

#: how long a certificate holds, of the 398 days that browsers take, with a day for clocks that
#: are late; how long it must hold still [days]
_HOLDS, _LATE, _MUST_HOLD = 396, 1, 7
#: addresses for documentation: nothing is sent there, they only say which way leads outside
_OUTSIDE = ((socket.AF_INET, "192.0.2.1"), (socket.AF_INET6, "2001:db8::1"))
LOCAL = ("localhost", "127.0.0.1", "::1")


@dataclass(frozen=True)
class Certificate:
    """A certificate that this machine made itself.

    Attributes:
        path: of the file that holds it and its key.
        fingerprint: by which it can be told from another.
    """

    path: Path
    fingerprint: str


def addresses() -> list[str]:
    """Addresses of this machine in its network, the one that leads outside first."""
    found = [*filter(None, (_way_out(*way) for way in _OUTSIDE))]
    with contextlib.suppress(OSError, UnicodeError):
        found += [str(one[4][0]) for one in socket.getaddrinfo(socket.gethostname(), None)]
    usable = [one for one in dict.fromkeys(found) if _leads_here(one)]
    return sorted(usable, key=lambda one: ":" in one)


def names() -> list[str]:
    """Names of this machine; some can be in no certificate, and none leads to itself alone."""
    name, found = socket.gethostname(), []
    for one in (name, f"{name.partition('.')[0]}.local"):
        with contextlib.suppress(ValueError):
            found.append(host(one))
    return [one for one in dict.fromkeys(found) if one.partition(".")[0] != LOCAL[0]]


def host(text: str) -> str:
    """A name or address as browsers say it.

    Raises:
        ValueError: it is neither.
    """
    if "%" in text:  # of one link alone
        raise ValueError(text)
    with contextlib.suppress(ValueError):
        return str(ipaddress.ip_address(text))
    return idna.encode(text, uts46=True).decode("ascii")


def _way_out(family: socket.AddressFamily, there: str) -> str | None:
    with contextlib.suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as probe:
        probe.connect((there, 9))
        return str(probe.getsockname()[0])
    return None


def _leads_here(address: str) -> bool:
    if "%" in address:  # of one link alone
        return False
    parsed = ipaddress.ip_address(address)
    return not (parsed.is_loopback or parsed.is_link_local or parsed.is_unspecified)


def certificate(folder: Path, hosts: Sequence[str]) -> Certificate:
    """The certificate of this lab: kept, or made anew where it is old or lacks a name.

    Args:
        folder: of the lab.
        hosts: names and addresses that it is for.
    """
    place = folder / "certificate"
    path = place / "certificate.pem"
    if not _holds(path, hosts):
        made = trustme.CA(organization_name="simcompare lab")
        now = datetime.now(UTC)
        times = {
            "not_before": now - timedelta(days=_LATE),
            "not_after": now + timedelta(days=_HOLDS),
        }
        issued = made.issue_cert(*hosts, common_name="simcompare lab", **times)
        with whole.folder(place) as new:
            new.chmod(0o700)
            issued.private_key_and_cert_chain_pem.write_to_path(new / path.name)
            (new / path.name).chmod(0o600)
    return Certificate(path, _fingerprint(path))


def _holds(path: Path, hosts: Iterable[str]) -> bool:
    """Whether there is one for all these names, for some days at least."""
    try:
        found = x509.load_pem_x509_certificate(_first(path))
        kept = found.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
        ssl.create_default_context(ssl.Purpose.CLIENT_AUTH).load_cert_chain(path)
    except (OSError, ValueError, x509.ExtensionNotFound):
        return False
    held = {str(one.value) for one in kept}
    latest = datetime.now(UTC) + timedelta(days=_MUST_HOLD)
    whole_time = found.not_valid_after_utc - found.not_valid_before_utc
    is_taken = whole_time <= timedelta(days=_HOLDS + _LATE)
    return is_taken and set(hosts) <= held and found.not_valid_after_utc > latest


def _first(path: Path) -> bytes:
    """The certificate in a file, without the key and those behind it."""
    text = path.read_text(encoding="ascii")
    begin, end = "-----BEGIN CERTIFICATE-----", "-----END CERTIFICATE-----"
    return (begin + text.partition(begin)[2].partition(end)[0] + end).encode()


def _fingerprint(path: Path) -> str:
    raw = ssl.PEM_cert_to_DER_cert(_first(path).decode())
    shown = hashlib.sha256(raw).hexdigest()[:16].upper()
    return " ".join(shown[i : i + 4] for i in range(0, len(shown), 4))


def url(host: str, port: int, *, secure: bool) -> str:
    """The address to type."""
    name = f"[{host}]" if ":" in host else host
    return f"http{'s' if secure else ''}://{name}:{port}/"


def code(address: str) -> str:
    """An address as a picture to scan, as SVG."""
    made, drawn = segno.make(address, error="m"), io.BytesIO()
    plain = {"xmldecl": False, "nl": False, "svgclass": None, "lineclass": None}
    made.save(drawn, kind="svg", scale=6, border=4, light="white", **plain)
    return drawn.getvalue().decode()


def code_as_text(address: str) -> str:
    """An address as a picture of letters, to scan from a terminal."""
    rows = [list(row) for row in segno.make(address, error="l").matrix_iter(border=2)]
    rows += [[0] * len(rows[0])] * (len(rows) % 2)
    # light blocks on the dark ground of a terminal: both halves of a letter are one dot each
    letters = {(0, 0): "█", (0, 1): "▀", (1, 0): "▄", (1, 1): " "}
    pairs = zip(rows[::2], rows[1::2], strict=True)
    return "\n".join(
        "".join(letters[bool(a), bool(b)] for a, b in zip(*pair, strict=True)) for pair in pairs
    )
