"""What a file holds, told by its first bytes and not by its name."""

from __future__ import annotations

#: bytes that are looked at
LOOKED_AT = 4096
SOUND, VIDEO, TABLE = "sound", "video", "table"
#: largest file of each kind [bytes]
LARGEST = {SOUND: 64 * 10**6, VIDEO: 300 * 10**6, TABLE: 64 * 10**6}
#: how sounds begin, and the endings of their files
_SOUNDS = (
    (b"fLaC", "flac"),
    (b"OggS", "ogg"),
    (b"FORM", "aiff"),
    (b"caff", "caf"),
    (b"ID3", "mp3"),
    (b"\xff\xfb", "mp3"),
    (b"\xff\xf3", "mp3"),
    (b"\xff\xf2", "mp3"),
    (b".snd", "au"),
)
#: tables that are no text: HDF5, TDMS, MATLAB, archives of phones, NumPy
_TABLES = (
    (b"\x89HDF\r\n", "h5"),
    (b"TDSm", "tdms"),
    (b"MATLAB 5.0", "mat"),
    (b"PK\x03\x04", "zip"),
    (b"\x93NUMPY", "npy"),
)


def kind_of(head: bytes, wish: str = "") -> tuple[str, str] | None:
    """Kind of a file and the ending that its name should have; ``None`` where it is neither.

    Args:
        head: its first bytes.
        wish: the kind that is meant, where it may be sound or video.
    """
    for kind, beginnings in ((SOUND, _SOUNDS), (TABLE, _TABLES)):
        for beginning, ending in beginnings:
            if head.startswith(beginning):
                return kind, ending
    return _boxed(head, wish) or ((TABLE, "csv") if _is_text(head) else None)


def _boxed(head: bytes, wish: str) -> tuple[str, str] | None:
    """Kind and ending of what holds sound, video or both."""
    either = SOUND if wish == SOUND else VIDEO
    if head[:4] == b"RIFF":
        return {b"WAVE": (SOUND, "wav"), b"AVI ": (VIDEO, "avi")}.get(head[8:12])
    if head.startswith(b"\x1aE\xdf\xa3"):
        return either, "webm"
    if head[4:8] == b"ftyp":
        if head[8:11] in (b"M4A", b"M4B"):
            return SOUND, "m4a"
        return (either, "mov" if head[8:12] == b"qt  " else "mp4")
    return None


def _is_text(head: bytes) -> bool:
    """Whether these bytes are text, a letter at the end perhaps cut."""
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return True
    if not head or b"\0" in head:
        return False
    shown = sum(byte >= 32 or byte in b"\t\r\n\f" for byte in head)
    begins_as_page = head.lstrip()[:15].lower().startswith((b"<!doctype", b"<html", b"%pdf"))
    return shown == len(head) and not begins_as_page
