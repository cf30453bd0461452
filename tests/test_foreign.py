"""Files that are no logs are called what they are."""

import io
import zipfile

import pytest

from simcompare.errors import InputError
from simcompare.hardware.logs import importers
from simcompare.hardware.mapping import NOTHING


def zipped(*names):
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w") as archive:
        for name in names:
            archive.writestr(name, "<xml/>")
    return held.getvalue()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\xff\xd8\xff\xe0\x00\x10JFIF" + b"\x01" * 200, "is a JPEG picture, not a log"),
        (b"\x89PNG\r\n\x1a\n" + b"\x00" * 200, "is a PNG picture, not a log"),
        (b"%PDF-1.7\n1 0 obj\n0 1 2\n3 4 5\n", "is a PDF document, not a log"),
        (b"\x1f\x8b\x08" + b"\x00" * 50, "is a gzip archive, not a log; unpack it"),
        (b"\n<!DOCTYPE html><html></html>", "is a web page, not a log"),
        (zipped("[Content_Types].xml", "word/document.xml"), "is a Word document, not a log"),
        (zipped("[Content_Types].xml", "xl/workbook.xml"), "is an Excel workbook, not a log"),
        (
            b"ULog\x01\x12\x35\x01" + b"\x00" * 90,
            "is a log of PX4 .*: pip .*ulog2csv FILE",
        ),
        (b"\xa3\x95\x80\x80Y" + b"\x00" * 90, "is a log of ArduPilot in its binary form"),
        (b"H Product:Blackbox flight data recorder\nH I interval:32\n", "blackbox_decode FILE"),
        (b"#9000804346WAVEDESC" + b"\x00" * 90, "is a waveform of LeCroy.*as ASCII"),
        (b"\x02\x50\x10\x00" + b"\x00" * 90, "is a C3D file of motion capture"),
        (b"time (s),angle (deg)\n", r"has a header \(time \(s\), angle \(deg\)\) and no rows"),
        (b"t,x\ns,m\n", "has a header .* and no rows"),
    ],
)
def test_a_file_that_is_no_log_is_called_what_it_is(write, content, words):
    path = write("strange", content)
    with pytest.raises(InputError, match=words):
        importers.read(path, importers.recognise(path), NOTHING)


def test_a_folder_is_told_apart_from_a_bag_and_from_a_recording(tmp_path):
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "a.csv").write_text("t,x\n0,1\n1,2\n")
    with pytest.raises(InputError, match=r"a folder without a bag's metadata\.yaml; give a file"):
        importers.recognise(tmp_path / "logs")
    (tmp_path / "x.rec").mkdir()
    (tmp_path / "x.rec" / "recording.json").write_text("{}")
    with pytest.raises(InputError, match="imported already"):
        importers.recognise(tmp_path / "x.rec")


def test_somebody_elses_importer_may_read_what_looks_like_a_picture(write, monkeypatch):
    class Pictures:
        TITLE = "pictures of curves"

        def recognises(self, head):
            return 80 if head.start.startswith(b"\xff\xd8\xff") else 0

    monkeypatch.setattr(importers, "targets", lambda: {"picture": "somewhere"})
    monkeypatch.setattr(importers, "get", lambda name: Pictures())
    assert importers.recognise(write("a.jpg", b"\xff\xd8\xff\xe0" + b"\1" * 50)) == "picture"
