"""Files that are no logs and are often mistaken for one: pictures, documents, archives, folders."""

from __future__ import annotations

from simcompare.hardware.raw import Head

_EXPORT = "export the numbers as CSV"
_UNPACK = "unpack it and give the log inside"
#: first bytes -> what such a file is, and what to do
_MAGIC = {
    b"\xff\xd8\xff": ("a JPEG picture", _EXPORT),
    b"\x89PNG\r\n": ("a PNG picture", _EXPORT),
    b"GIF8": ("a GIF picture", _EXPORT),
    b"%PDF-": ("a PDF document", _EXPORT),
    b"{\\rtf": ("an RTF document", _EXPORT),
    b"\xd0\xcf\x11\xe0": ("an old Microsoft Office document", _EXPORT),
    b"\x1f\x8b": ("a gzip archive", _UNPACK),
    b"BZh": ("a bzip2 archive", _UNPACK),
    b"\xfd7zXZ\x00": ("an xz archive", _UNPACK),
    b"7z\xbc\xaf\x27\x1c": ("a 7z archive", _UNPACK),
    b"Rar!": ("a RAR archive", _UNPACK),
    b"\x7fELF": ("a program", "give the log that it wrote"),
    b"MZ\x90": ("a program", "give the log that it wrote"),
}
#: first bytes of logs that only their makers' programs read -> what it is, and how to make a table
_BINARY = {
    b"ULog\x01\x12\x35": ("a log of PX4", "pip install pyulog; ulog2csv FILE"),
    b"\xa3\x95\x80\x80": (
        "a log of ArduPilot",
        "pip install pymavlink; mavlogdump.py --format csv --types IMU FILE > imu.csv",
    ),
    b"H Product:Blackbox": ("a black box of Betaflight", "blackbox_decode FILE"),
    b":WFM#": ("a waveform of Tektronix", "save it on the oscilloscope as CSV"),
}
#: a member of a zip archive -> what it is
_MEMBERS = {
    "word/document.xml": "a Word document",
    "xl/workbook.xml": "an Excel workbook",
    "ppt/presentation.xml": "a PowerPoint presentation",
    "META-INF/manifest.xml": "an OpenDocument file",
}


def kind_of(head: Head) -> str:
    """What a file is that is certainly no log, and what to do; empty for all others."""
    if head.path.is_dir():
        return _folder(head)
    if binary := _binary(head.start):
        what, how = binary
        return f"is {what} in its binary form, which is not read; make a CSV of it: {how}"
    kind = next((words for magic, words in _MAGIC.items() if head.start.startswith(magic)), None)
    if kind is None:
        member = next((words for name, words in _MEMBERS.items() if name in head.members), "")
        kind = (member, _EXPORT) if member else None
    if kind is None and head.start[4:8] == b"ftyp":
        kind = ("a film", "give the log that was taken from it, such as that of Tracker")
    if kind is None and head.start[:200].lstrip().lower().startswith((b"<!doctype html", b"<html")):
        kind = ("a web page", "download the file itself, not the page that shows it")
    return f"is {kind[0]}, not a log; {kind[1]}" if kind else ""


def _binary(start: bytes) -> tuple[str, str] | None:
    """What a binary log is, and how a table is made of it."""
    if b"WAVEDESC" in start[:64]:
        return "a waveform of LeCroy", "save it on the oscilloscope as ASCII (Time and Amplitude)"
    if start[:2] in (b"\x02\x50", b"\x03\x50"):
        return "a C3D file of motion capture", "export it as CSV or TRC"
    return next((words for magic, words in _BINARY.items() if start.startswith(magic)), None)


def _folder(head: Head) -> str:
    if "recording.json" in head.members:
        return "is a recording that was imported already; give the log it was made of"
    if any(name.endswith(("metadata.yaml", ".db3", ".mcap")) for name in head.members):
        return ""
    return "is a folder without a bag's metadata.yaml; give a file"
