"""A file of the web of which size and content are known before."""

from __future__ import annotations

import time
from pathlib import Path

from simcompare.errors import EngineMissing, OutputError

#: how long the next bytes are waited for, and the slowest network that is waited for
_PATIENCE_S, _SLOWEST_BYTES_S = 30.0, 10_000.0
_BLOCK = 1 << 16


class _Wrong(ValueError):
    """What came is not what was registered; the message says how."""


def fetch(url: str, target: Path, sha256: str, size_bytes: int) -> None:
    """Fetches a file, unless it lies there already as it should be.

    Raises:
        EngineMissing: pooch is not installed.
        OutputError: it cannot be fetched, is too large, was cut, or has another content.
    """
    try:
        import pooch
    except ModuleNotFoundError:
        cure = "pip install 'simcompare[hardware]'"
        raise EngineMissing("the download of recordings", "pooch", cure) from None
    pooch.get_logger().setLevel("CRITICAL")

    def limited(url: str, output_file: str, _: object) -> None:
        _download(url, Path(output_file), size_bytes)

    try:
        pooch.retrieve(url, f"sha256:{sha256}", target.name, target.parent, downloader=limited)
    # pooch and requests raise many kinds; each means that the file is not here
    except Exception as error:  # noqa: BLE001
        raise OutputError(_why(error, url)) from None


def _download(url: str, target: Path, size: int) -> None:
    """Writes what comes, as long as it can be the file; nothing is unpacked on the way."""
    import requests
    import urllib3

    until = time.monotonic() + _PATIENCE_S + size / _SLOWEST_BYTES_S
    plain = {"Accept-Encoding": "identity"}
    got = 0
    with (
        requests.get(url, stream=True, timeout=_PATIENCE_S, headers=plain) as answer,
        target.open("wb") as file,
    ):
        answer.raise_for_status()
        try:
            for block in answer.raw.stream(_BLOCK, decode_content=False):
                got += len(block)
                if got > size:
                    raise _Wrong(f"it has more than the {size} bytes that were registered")
                if time.monotonic() > until:
                    raise _Wrong(f"it is too slow: {got} of {size} bytes came")
                file.write(block)
        except urllib3.exceptions.HTTPError:
            pass  # the number of bytes tells
    if got < size:
        raise _Wrong(f"the download was cut: {got} of {size} bytes came; try again")


def _why(error: Exception, url: str) -> str:
    """Why a file is not here."""
    import requests

    host = url.partition("://")[2].partition("/")[0]
    answer = getattr(error, "response", None)  # of the server, where one was reached
    if answer is not None:
        return f"{host} cannot be fetched from: it answers {answer.status_code}"
    if isinstance(error, _Wrong):
        return f"{url} cannot be fetched: {error}"
    if isinstance(error, requests.exceptions.InvalidSchema | requests.exceptions.InvalidURL):
        return f"{url} cannot be fetched: it leads to what is no web address ({error!s:.100})"
    if isinstance(error, requests.exceptions.TooManyRedirects):
        return f"{url} cannot be fetched: it is redirected without end"
    if isinstance(error, requests.exceptions.RequestException):
        return f"{host} cannot be reached (no network?)"
    if isinstance(error, OSError):
        return f"the file cannot be written ({error.strerror or error})"
    reason = str(error).splitlines()[0][:80] if str(error) else type(error).__name__
    return f"{url} cannot be fetched ({reason} …)"
