"""ROS logs: ROS 1 bags, ROS 2 bags (a folder, a ``.db3`` or an ``.mcap`` file), one stream a topic.

Numbers keep the names of their fields (``angular_velocity.x``). Their time is ``header.stamp``, or
the time of receipt where there is none. Messages are defined in the bag itself, or else by ROS.
"""

from __future__ import annotations

from pathlib import Path

from simcompare.errors import InputError
from simcompare.hardware import joints
from simcompare.hardware.logs.bags import folder, mcap, reader, ros1, sqlite
from simcompare.hardware.logs.bags.container import Connection, State
from simcompare.hardware.logs.bags.stream import finish
from simcompare.hardware.logs.bags.topic import EPOCH_NS, Topic
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawLog
from simcompare.model.recording import WARNING, Repair

TITLE = "a ROS bag (ROS 1, ROS 2 SQLite or MCAP)"

_MAX_TEXTS = 100
_BILLION = 1_000_000_000

Key = tuple[str, str, str, str]


def recognises(head: Head) -> int:
    """By the first bytes, or by the files of a folder."""
    if head.start.startswith((ros1.MAGIC, mcap.MAGIC)):
        return 100
    if head.start.startswith(sqlite.MAGIC):
        return 95 if b"topics" in head.start and b"messages" in head.start else 0
    if not head.start:
        top = [name for name in head.members if "/" not in name]
        if any(name.endswith((".db3", ".mcap", ".db3.zstd", ".mcap.zstd")) for name in top):
            return 95
    return 0


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all topics that hold numbers.

    Raises:
        InputError: it is no bag, or none of its topics can be read.
    """
    state = State()
    topics: dict[Key, Topic] = {}
    # by identity: to compare connections would cost more than to decode their messages
    direct: dict[int, tuple[Connection, Topic]] = {}
    origin = None
    messages = folder.messages if path.is_dir() else reader.of_file(path)
    for connection, time_ns, data in messages(path, state):
        if origin is None:
            # a clock that does not count from 1970 keeps its own zero
            origin = time_ns // _BILLION * _BILLION if time_ns > EPOCH_NS else 0
        known = direct.get(id(connection))
        if known is None:
            state.joints |= _described(connection, data)
            key = (connection.topic, connection.kind, connection.encoding, connection.schema)
            distribution = state.about.get("ros_distro", "")
            topic = topics.setdefault(key, Topic(connection, distribution, origin))
            topic.publishers.add(connection.publisher)
            known = direct[id(connection)] = (connection, topic)
        known[1].add(time_ns, data)
    return _log(path, state, topics)


def _described(connection: Connection, data: bytes) -> dict[str, str]:
    """Kinds of joints, where a message is the description of the robot."""
    if not connection.topic.endswith("robot_description") or not connection.kind.endswith(
        "/String"
    ):
        return {}
    # a text stands behind its length; CDR has four bytes before it
    start = 8 if connection.encoding == "cdr" else 4
    return joints.described(data[start:].decode("utf-8", "replace"))


def _log(path: Path, state: State, topics: dict[Key, Topic]) -> RawLog:
    log = RawLog([], repairs=_damaged(state), joints=state.joints, about=dict(state.about))
    for topic, name in _named(topics):
        finish(topic, name, _missing(state, topic), log)
    silent = {c.topic for c in state.connections} - {key[0] for key in topics}
    log.ignored |= {_name(topic): "holds no messages" for topic in sorted(silent)}
    log.about = {key: text for key, text in log.about.items() if text}
    if not log.streams:
        raise InputError(str(path), _reasons(state, log))
    return log


def _named(topics: dict[Key, Topic]) -> list[tuple[Topic, str]]:
    """Every topic with its name; the type is in it where a topic has several."""
    names = [_name(key[0]) for key in topics]
    unique = [
        name if names.count(name) == 1 else f"{name}:{key[1]}"
        for name, key in zip(names, topics, strict=True)
    ]
    return list(zip(topics.values(), unique, strict=True))


def _name(topic: str) -> str:
    return topic.strip("/") or "topic"


def _missing(state: State, topic: Topic) -> str:
    """What is missing at the end of a topic."""
    expected = state.expected.get(topic.connection.topic, 0)
    if expected > topic.count and not state.truncated:
        return f"metadata.yaml counts {expected} messages; {topic.count} are there"
    return state.truncated


def _damaged(state: State) -> list[Repair]:
    shown = [
        Repair("damaged_record", WARNING, text, count=1) for text in state.damaged[:_MAX_TEXTS]
    ]
    more = len(state.damaged) - len(shown)
    if more:
        shown.append(
            Repair("damaged_record", WARNING, f"{more} more records are damaged", count=more)
        )
    return shown


def _reasons(state: State, log: RawLog) -> list[str]:
    """Why nothing of a bag can be used, topic by topic."""
    reasons = [f"topic {name}: {why}" for name, why in list(log.ignored.items())[:_MAX_TEXTS]]
    reasons += [repair.text for repair in log.repairs if repair.severity == WARNING]
    if state.truncated:
        reasons.append(state.truncated)
    return reasons or ["holds no messages and no topics; record it again"]
