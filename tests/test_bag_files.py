"""Containers of ROS bags: compressed, cut off, damaged, never closed, and the real ones."""

from __future__ import annotations

import shutil
import sqlite3
import struct
import zlib

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware.logs import importers
from simcompare.hardware.mapping import NOTHING
from tests.ros_bags import (
    CONTAINERS,
    COUNT,
    MCAP,
    ROS1,
    SQLITE,
    START_NS,
    Bag,
    faults,
    imu_topic,
    joint_state,
    load,
    range_message,
    stream,
    times,
    values,
)

pytest.importorskip("rosbags")
lz4_frame = pytest.importorskip("lz4.frame")

#: whole second in which the first message of the example was received
START_OF_EXAMPLE_NS = 1_396_293_887 * 10**9


@pytest.fixture(params=CONTAINERS)
def container(request):
    return request.param


@pytest.fixture
def bag(tmp_path, container):
    return Bag(tmp_path, container)


def test_each_container_is_recognised_as_a_folder_and_as_a_bare_file(bag, container):
    path = bag.write({"/imu": imu_topic(bag)})
    assert importers.recognise(path) == "bag"
    if container != ROS1:
        bare = next(p for p in path.iterdir() if p.suffix in (".db3", ".mcap"))
        assert importers.recognise(bare) == "bag"
        assert len(stream(load(bare), "imu")) == COUNT


def test_an_sqlite_file_of_something_else_is_no_bag(tmp_path):
    path = tmp_path / "other.db3"
    with sqlite3.connect(path) as base:
        base.execute("CREATE TABLE notes (text)")
    base.close()
    with pytest.raises(InputError):
        importers.recognise(path)


@pytest.mark.parametrize("kind", ["BZ2", "LZ4"])
def test_compressed_chunks_of_ros_1_are_read(tmp_path, kind):
    from rosbags.rosbag1 import Writer

    bag = Bag(tmp_path, ROS1, set_compression=(Writer.CompressionFormat[kind],))
    assert len(stream(load(bag.write({"/imu": imu_topic(bag)})), "imu")) == COUNT


@pytest.mark.parametrize(
    ("container", "mode"),
    [(SQLITE, "FILE"), (SQLITE, "MESSAGE"), (MCAP, "FILE"), (MCAP, "MESSAGE"), (MCAP, "STORAGE")],
)
def test_compressed_bags_of_ros_2_are_read(tmp_path, container, mode):
    from rosbags.rosbag2 import CompressionFormat, CompressionMode

    compression = (CompressionMode[mode], CompressionFormat.ZSTD)
    bag = Bag(tmp_path, container, set_compression=compression)
    one = stream(load(bag.write({"/imu": imu_topic(bag)})), "imu")
    assert np.array_equal(values(one, "linear_acceleration.y"), np.arange(COUNT) / 3)


def test_a_bag_without_definitions_uses_those_of_ros_and_says_so(tmp_path):
    bag = Bag(tmp_path, SQLITE)
    path = bag.write({"/range": ("sensor_msgs/msg/Range", [
        (ns, range_message(bag, ns, 1.5)) for ns in times()
    ])})  # fmt: skip
    with sqlite3.connect(next(path.glob("*.db3"))) as base:
        base.execute("DROP TABLE message_definitions")
    base.close()
    log = load(path)
    assert stream(log, "range").column("range").values[0] == 1.5
    assert "humble" in next(r.text for r in log.repairs if r.rule == "shipped_definition")


def test_an_unknown_type_without_definition_is_left_out_with_its_name(tmp_path):
    bag = Bag(tmp_path, SQLITE)
    path = bag.write({"/imu": imu_topic(bag)})
    with sqlite3.connect(next(path.glob("*.db3"))) as base:
        base.execute("DROP TABLE message_definitions")
        base.execute("UPDATE topics SET type = 'my_robot/msg/Secret'")
    base.close()
    assert "no definition of my_robot/msg/Secret" in faults(path)


# --- what is cut off or damaged


def cut(path, keep):
    data = path.read_bytes()
    path.write_bytes(data[: keep if keep > 0 else len(data) + keep])


def long_bag(tmp_path, container):
    """A bag of several chunks, and its file."""
    from rosbags.rosbag1 import Writer

    options = {"set_compression": (Writer.CompressionFormat.LZ4,)} if container == ROS1 else {}
    bag = Bag(tmp_path, container, **options)
    path = bag.write({"/imu": imu_topic(bag, 12000)})
    if container == ROS1:
        return path, path
    return path, next(p for p in path.iterdir() if p.suffix in (".db3", ".mcap"))


@pytest.mark.parametrize("container", [ROS1, MCAP])
def test_a_truncated_bag_gives_what_is_whole_and_says_what_is_missing(tmp_path, container):
    path, file = long_bag(tmp_path, container)
    whole = stream(load(path), "imu")
    cut(file, int(file.stat().st_size * 0.7))
    found = stream(load(path), "imu")
    assert 1000 < len(found) < len(whole)
    assert "byte " in found.truncated
    same = values(whole, "linear_acceleration.y")[: len(found)]
    assert np.array_equal(values(found, "linear_acceleration.y"), same)


def test_a_truncated_sqlite_bag_is_refused_because_it_would_read_as_zeros(tmp_path):
    _, file = long_bag(tmp_path, SQLITE)
    size = file.stat().st_size
    cut(file, size - 4096)
    assert f"byte {size - 4096}" in faults(file)


def test_a_bag_cut_anywhere_gives_a_prefix_or_a_typed_error(tmp_path, container):
    path, file = long_bag(tmp_path, container)
    whole = values(stream(load(path), "imu"), "linear_acceleration.y")
    data = file.read_bytes()
    for keep in np.linspace(1, len(data) - 1, 40).astype(int):
        file.write_bytes(data[:keep])
        try:
            found = stream(load(path), "imu")
        except InputError:
            continue
        assert np.array_equal(values(found, "linear_acceleration.y"), whole[: len(found)])
        assert len(found) == len(whole) or found.truncated


def test_flipped_bytes_give_a_typed_error_or_a_record_and_never_a_traceback(tmp_path, container):
    bag = Bag(tmp_path, container)
    path = bag.write({"/imu": imu_topic(bag), "/j": ("sensor_msgs/msg/JointState", [
        (ns, joint_state(bag, ns, ["a", "b"], [1.0, 2.0])) for ns in times()
    ])})  # fmt: skip
    file = path if container == ROS1 else next(p for p in path.iterdir() if p.suffix != ".yaml")
    data = file.read_bytes()
    random = np.random.default_rng(4)
    for _ in range(150):
        bad = bytearray(data)
        for at in random.integers(0, len(data), random.integers(1, 6)):
            bad[at] = random.integers(0, 256)
        file.write_bytes(bad)
        try:
            log = importers.read(path, "bag", NOTHING)
        except InputError:
            continue
        assert all(len(c.values) == len(s) for s in log.streams for c in s.columns)


def test_a_bag_that_was_never_closed_is_read_and_marked(tmp_path):
    bag = Bag(tmp_path, ROS1)
    path = bag.write({"/imu": imu_topic(bag)})
    data = bytearray(path.read_bytes())
    at = data.index(b"index_pos=") + len(b"index_pos=")
    index = struct.unpack_from("<Q", data, at)[0]
    struct.pack_into("<Q", data, at, 0)
    path.write_bytes(data[:index])
    one = stream(load(path), "imu")
    assert len(one) == COUNT
    assert "never closed" in one.truncated


def test_a_damaged_chunk_is_passed_over_and_named_with_its_byte(tmp_path):
    path, file = long_bag(tmp_path, ROS1)
    whole = len(stream(load(path), "imu"))
    data = bytearray(file.read_bytes())
    at = data.index(b"\x04\x22\x4d\x18", len(data) // 3)  # a chunk of LZ4 begins
    data[at + 20 : at + 400] = b"\xff" * 380
    file.write_bytes(data)
    log = load(path)
    one = stream(log, "imu")
    assert 0 < len(one) < whole
    damaged = next(r for r in log.repairs if r.rule == "damaged_record")
    assert damaged.severity == "warning"
    assert "byte " in damaged.text


def record(kind, body):
    return struct.pack("<BQ", kind, len(body)) + body


def text(words):
    return struct.pack("<I", len(words)) + words.encode()


def small_mcap(chunks, compression="", spoil=None):
    """An MCAP file of Float64 messages: one chunk with a check sum for each list of numbers."""
    definition = text("float64 data\n")
    parts = [b"\x89MCAP0\r\n", record(1, text("ros2") + text("test"))]
    parts.append(
        record(
            3, struct.pack("<H", 1) + text("std_msgs/msg/Float64") + text("ros2msg") + definition
        )
    )
    parts.append(
        record(4, struct.pack("<HH", 1, 1) + text("/n") + text("cdr") + struct.pack("<I", 0))
    )
    for k, numbers in enumerate(chunks):
        inner = b"".join(
            record(5, struct.pack("<HIQQ", 1, i, START_NS + n * 10**7, 0) + b"\0\1\0\0"
                   + struct.pack("<d", n))
            for i, n in enumerate(numbers)
        )  # fmt: skip
        packed = inner
        if compression == "lz4":
            packed = lz4_frame.compress(inner)
        checksum = zlib.crc32(inner)
        if spoil == k:
            middle = len(packed) // 2
            packed = packed[:middle] + bytes([packed[middle] ^ 1]) + packed[middle + 1 :]
        body = struct.pack("<QQQI", 0, 0, len(inner), checksum) + text(compression)
        parts.append(record(6, body + struct.pack("<Q", len(packed)) + packed))
    parts.append(record(15, struct.pack("<I", 0)))
    return b"".join(parts)


@pytest.mark.parametrize("compression", ["", "lz4"])
def test_a_chunk_that_does_not_fit_its_check_sum_is_left_out_and_named(tmp_path, compression):
    path = tmp_path / "n.mcap"
    chunks = [range(0, 5), range(5, 10), range(10, 15)]
    path.write_bytes(small_mcap(chunks, compression))
    assert np.array_equal(values(stream(load(path), "n"), "data"), np.arange(15.0))
    path.write_bytes(small_mcap(chunks, compression, spoil=1))
    log = load(path)
    assert values(stream(log, "n"), "data").tolist() == [*range(5), *range(10, 15)]
    damaged = next(r for r in log.repairs if r.rule == "damaged_record")
    assert damaged.severity == "warning"
    assert "chunk at byte" in damaged.text


def test_a_chunk_that_says_it_unpacks_to_a_terabyte_is_not_unpacked(tmp_path):
    path = tmp_path / "n.mcap"
    data = small_mcap([range(5), range(5, 9)], "lz4")
    size = struct.pack("<Q", len(small_mcap([range(5)])) - len(small_mcap([[]])))
    path.write_bytes(data.replace(size, struct.pack("<Q", 1 << 40), 1))
    log = load(path)
    assert "not plausible" in next(r.text for r in log.repairs if r.rule == "damaged_record")


def test_fewer_messages_than_the_metadata_count_are_told(tmp_path):
    bag = Bag(tmp_path, SQLITE)
    path = bag.write({"/imu": imu_topic(bag)})
    with sqlite3.connect(next(path.glob("*.db3"))) as base:
        base.execute("DELETE FROM messages WHERE id > 30")
    base.close()
    assert "counts 50 messages; 30 are there" in stream(load(path), "imu").truncated


def test_a_folder_without_metadata_is_read_and_marked(tmp_path):
    bag = Bag(tmp_path, MCAP)
    path = bag.write({"/imu": imu_topic(bag)})
    (path / "metadata.yaml").unlink()
    one = stream(load(path), "imu")
    assert len(one) == COUNT
    assert "metadata.yaml" in one.truncated


def test_metadata_that_lead_out_of_the_folder_are_not_followed(tmp_path):
    bag = Bag(tmp_path, MCAP)
    path = bag.write({"/imu": imu_topic(bag)})
    shutil.move(path / "log.mcap", tmp_path / "outside.mcap")
    text = (path / "metadata.yaml").read_text()
    (path / "metadata.yaml").write_text(text.replace("log.mcap", "../outside.mcap"))
    assert "outside.mcap is missing" in faults(path, lambda p: importers.read(p, "bag", NOTHING))


@pytest.mark.parametrize(
    ("start", "said"),
    [
        (b"#ROSBAG V1.2\n" + b"\0" * 50, "V1.2"),
        (b"#ROSBAG V2.0\n", "no whole bag header"),
        (b"\x89MCAP0\r\n", "not closed"),
    ],
)
def test_a_file_that_is_only_a_beginning_is_refused(tmp_path, start, said):
    path = tmp_path / "short.bag"
    path.write_bytes(start)
    assert said in faults(path)


def test_no_code_is_made_of_the_definitions_in_a_bag(tmp_path, monkeypatch):
    from rosbags.typesys.store import Typestore

    bag = Bag(tmp_path, ROS1)
    path = bag.write({"/imu": imu_topic(bag)})

    def compile_it(*_):
        raise AssertionError("rosbags compiles the text of a definition here")

    monkeypatch.setattr(Typestore, "register", compile_it)
    monkeypatch.setattr(Typestore, "get_msgdef", compile_it)
    assert len(stream(load(path), "imu")) == COUNT


def test_a_definition_of_another_layout_is_refused_with_the_lengths(tmp_path):
    bag = Bag(tmp_path, ROS1)
    path = bag.write({"/imu": imu_topic(bag)})
    data = path.read_bytes().replace(b"float64 w\n", b"float32 w\n")
    path.write_bytes(data)
    assert "bytes; its definition" in faults(path)


# --- the real fixtures


@pytest.mark.parametrize("name", ["example.bag", "example-bz2.bag", "example-lz4.bag"])
def test_a_real_ros_1_bag_has_the_values_that_rosbags_reads(real, name):
    from rosbags.highlevel import AnyReader

    path = real / "rosbag1" / name
    log = load(path)
    wanted = {}
    with AnyReader([path]) as reader:
        for connection, ns, data in reader.messages():
            if connection.topic == "/turtle1/pose":
                message = reader.deserialize(data, connection.msgtype)
                wanted.setdefault("x", []).append(float(message.x))
                wanted.setdefault("theta", []).append(float(message.theta))
                wanted.setdefault("ns", []).append(ns)
    one = stream(log, "turtle1/pose")
    assert np.array_equal(values(one, "x"), wanted["x"])
    assert np.array_equal(values(one, "theta"), wanted["theta"])
    got = np.rint(values(one, one.time) * 1e9).astype(np.int64)
    ns = np.array(wanted["ns"])
    assert np.array_equal(got, ns - START_OF_EXAMPLE_NS)
    assert not one.truncated


def test_the_real_bag_without_messages_is_refused(real):
    assert "holds no messages" in faults(real / "rosbag1" / "no-messages.bag")


def test_a_real_mcap_of_ros_2_has_the_values_that_rosbags_reads(real):
    from rosbags.highlevel import AnyReader

    file = real / "rosbag2/resources/mcap/convert_a/rewriter_a_0.mcap"
    one = stream(load(file), "b_basictypes")
    with AnyReader([file]) as reader:
        wanted = [c for c in reader.connections if c.topic == "b_basictypes"]
        rows = [
            (ns, reader.deserialize(data, connection.msgtype))
            for connection, ns, data in reader.messages(wanted)
        ]
    assert len(rows) == len(one) == 50
    for column in one.columns[1:]:
        wanted = [float(getattr(row, column.name)) for _, row in rows]
        assert np.array_equal(column.values, wanted)
    assert values(one, one.time) == pytest.approx([ns * 1e-9 for ns, _ in rows], abs=1e-12)


@pytest.mark.parametrize("folder", ["mcap/talker", "sqlite3/talker", "mcap/wbag", "sqlite3/wbag"])
def test_real_bags_of_text_are_refused_topic_by_topic(real, folder):
    assert "holds no numbers" in faults(real / "rosbag2/resources" / folder)
