"""Bytes on their way to the browser: compressed where it wants that, and kept by it."""

from __future__ import annotations

import functools
import gzip
import hashlib
import json
import re
from pathlib import Path

import jinja2
from starlette.requests import Request
from starlette.responses import Response

from simcompare import reports
from simcompare.lab import guard, refusals
from simcompare.lab.refusals import Refused
from simcompare.model import whole, yaml_file
from simcompare.reports.render import plotly_

_HERE = Path(__file__).parent
_REPLAY = Path(reports.__file__).parent / "templates" / "replay.js"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*(?:\.[a-z0-9]+)+")
_TYPES = {
    "js": "text/javascript; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "html": "text/html; charset=utf-8",
    "json": "application/json",
    "svg": "image/svg+xml",
    "png": "image/png",
    "woff2": "font/woff2",
}
#: what is not shown, but kept as a file
_FILE = "application/octet-stream"
#: bytes below which compressing costs more than it saves; how hard it is tried
_SMALL, _EFFORT = 1000, 5


def json_of(request: Request, body: bytes, status: int = 200) -> Response:
    """JSON, compressed where that pays."""
    headers = {}
    if len(body) > _SMALL and _takes_gzip(request):
        body, headers["content-encoding"] = gzip.compress(body, _EFFORT), "gzip"
    return Response(body, status, headers | {"vary": "accept-encoding"}, "application/json")


def spoken(value: object) -> bytes:
    """A value as JSON."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False).encode("utf-8", "replace")


def static(request: Request, name: str) -> Response:
    """A script or style of the lab.

    Raises:
        Refused: there is none of this name.
    """
    plain, packed, tag = _static(name)
    headers = {"etag": tag, "cache-control": "no-cache", "vary": "accept-encoding"}
    if tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    if _takes_gzip(request):
        plain, headers["content-encoding"] = packed, "gzip"
    return Response(plain, headers=headers, media_type=_type_of(name))


@functools.cache
def _static(name: str) -> tuple[bytes, bytes, str]:
    """A file as it is, compressed, and its tag."""
    if name == "plotly.js":
        content = plotly_.script().encode()
    elif name == "replay.js":
        content = _REPLAY.read_bytes()
    elif _NAME.fullmatch(name) and name.rpartition(".")[2] in _TYPES:
        try:
            content = (_HERE / "static" / name).read_bytes()
        except OSError:
            raise Refused(404, "no_file") from None
    else:
        raise Refused(404, "no_file")
    return content, gzip.compress(content, 9), f'"{hashlib.sha256(content).hexdigest()[:20]}"'


@functools.cache
def page(name: str, language: str, **values: str) -> bytes:
    """A page of the lab in one language.

    Args:
        name: of its file.
        language: that it speaks.
        values: that stand in it.
    """
    loader = jinja2.FileSystemLoader(_HERE / "pages")
    undefined = jinja2.StrictUndefined
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=undefined)
    words = refusals.sentences(language)
    texts = yaml_file.read_yaml(_HERE / "texts" / f"{language}.yaml")[0]
    made = environment.get_template(name)
    return made.render(language=language, texts=texts, words=words, **values).encode()


def file(path: Path, *, downloaded: bool) -> Response:
    """A file that a job has made: a report is shown as a stranger, all else is downloaded."""
    try:
        with whole.opened(path) as opened:
            content = opened.read()
    except OSError:
        raise Refused(404, "no_file") from None
    if path.suffix == ".html" and not downloaded:
        headers = {"content-security-policy": guard.REPORT_POLICY}
        return Response(content, headers=headers, media_type=_TYPES["html"])
    headers = {"content-disposition": f'attachment; filename="{path.name}"'}
    return Response(content, headers=headers, media_type=_FILE)


def _type_of(name: str) -> str:
    return _TYPES[name.rpartition(".")[2]]


def _takes_gzip(request: Request) -> bool:
    return "gzip" in request.headers.get("accept-encoding", "")
