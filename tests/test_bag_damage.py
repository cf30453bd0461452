"""ROS bags whose descriptions are damaged: nothing is lost in silence."""

from __future__ import annotations

import pytest

from simcompare.errors import InputError
from tests.ros_bags import (
    COUNT,
    MCAP,
    SQLITE,
    START_NS,
    Bag,
    faults,
    imu_topic,
    load,
    range_message,
)

pytest.importorskip("rosbags")


def test_a_topic_whose_definition_is_damaged_is_lost_in_words(tmp_path):
    bag = Bag(tmp_path, MCAP)
    path = bag.write({"/imu": imu_topic(bag), "/range": range_topic(bag)})
    (file,) = path.glob("*.mcap")
    data = file.read_bytes()
    line = b"geometry_msgs/Quaternion orientation\n"
    file.write_bytes(data.replace(line, b"\xff" * len(line)))
    log = load(path)
    assert [one.name for one in log.streams] == ["range"]
    (told,) = [repair for repair in log.repairs if repair.rule == "topic_lost"]
    assert (told.severity, told.stream, told.count) == ("warning", "imu", COUNT)
    assert "the definition of sensor_msgs/msg/Imu cannot be read" in told.text


def range_topic(bag):
    rows = [(ns, range_message(bag, ns, 1.0)) for ns in range(START_NS, START_NS + COUNT)]
    return "sensor_msgs/msg/Range", rows


def test_a_description_that_is_no_list_of_names_is_refused(tmp_path):
    bag = Bag(tmp_path, SQLITE)
    path = bag.write({"/imu": imu_topic(bag)})
    file = path / "metadata.yaml"
    text = file.read_text()
    file.write_text(
        text.replace("relative_file_paths:\n  - ", "relative_file_paths:\n  - [a]\n  - ")
    )
    assert "relative_file_paths holds something else than names" in faults(
        path / "metadata.yaml", lambda _: load(path)
    )
    file.write_text(text + "# " + "x" * (1 << 22))
    with pytest.raises(InputError, match="no description of a bag"):
        load(path)
