"""Range sensors in other formats: MuJoCo reads what we read, SDF says what it cannot."""

from xml.etree import ElementTree as ET

import numpy as np
import pytest

from simcompare.engine.range_sensing import ranges, rays_of
from simcompare.exporters.twins import twin
from simcompare.scenarios import catalogue
from tests.export_scenes import scene
from tests.present import need

TURN = [0.5, 0.5, -0.5, 0.5]  # the sensor looks up along its body's z axis
BODY = [np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0]  # which itself lies along the world's x axis
SHAPE = {"type": "box", "size_m": [0.1, 0.1, 0.1]}


def looking(geometry="equal_angle", zones=8, wall=True):
    """A turned sensor on a body that is turned too, before a ball and a slanted wall."""
    bodies = {
        "carrier": {"mass_kg": 1.0, "inertia_kg_m2": [0.01] * 3, "position_m": [0.2, 0.1, 0.5],
                    "orientation_wxyz": BODY, "shapes": [SHAPE]},
        "wall": {"fixed": True, "position_m": [2.0, 0, 0],
                 "shapes": [{"type": "plane", "normal": [-0.8, 0.6, 0]}]},
        "ball": {"fixed": True, "position_m": [1.0, 0.2, 0.6],
                 "shapes": [{"type": "sphere", "radius_m": 0.2}]},
    }  # fmt: skip
    if not wall:
        del bodies["wall"]
    eye = {"type": "time_of_flight", "body": "carrier", "zones": zones, "geometry": geometry,
           "position_m": [0, 0, 0.06], "orientation_wxyz": TURN, "reach_m": 2.0}  # fmt: skip
    return scene("looking", bodies, sensors={"eye": eye})


@pytest.mark.engines("mujoco")
@pytest.mark.parametrize("zones", [4, 8])
@pytest.mark.parametrize("wall", [True, False])
@pytest.mark.parametrize("geometry", ["equal_angle", "rectilinear"])
def test_rangefinders_of_mujoco_read_our_ideal_ranges(geometry, zones, wall):
    need("mujoco")
    import mujoco

    made = looking(geometry, zones, wall)
    model = mujoco.MjModel.from_xml_string(twin(made, format="mjcf").text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    body, sensor = made.bodies["carrier"], made.sensors["eye"]
    poses = {"carrier.position_m": np.array([body.position_m]),
             "carrier.orientation_wxyz": np.array([body.orientation_wxyz])}  # fmt: skip
    ours = ranges(made, sensor, np.zeros(1), poses)[0]
    _, lengths = rays_of(sensor)
    # along the ray; both are exact on these shapes
    told = data.sensordata / lengths
    np.testing.assert_allclose(np.where(told < 0, 2.0, told), ours, atol=1e-12)
    assert (told < 0).any() == (not wall)
    assert ours.min() < 0.6 < 1.9 < ours.max()  # the ball, and past the reach
    assert not [text for text in twin(made, format="mjcf").left_out if "eye" in text]


def test_sdf_has_rays_and_says_how_far_they_are_beside_ours():
    made = twin(catalogue.load("time_of_flight").resolve(), format="sdf")
    (sensor,) = ET.fromstring(made.text).iter("sensor")
    assert sensor.get("type") == "gpu_ray"
    for way in ("horizontal", "vertical"):
        line = sensor.find(f"ray/scan/{way}")
        low, high, count = (line.findtext(k) for k in ("min_angle", "max_angle", "samples"))
        assert np.degrees(float(high)) == pytest.approx(3.5 * 5.625)
        assert (float(low), count) == (-float(high), "8")
    assert sensor.findtext("ray/range/max") == "4"
    (said,) = (text for text in made.left_out if text.startswith("sensor eye"))
    # the corner: tan z = tan 19.69°·cos 19.69° on theirs
    assert "in the corners 1.1° beside ours" in said


def test_what_sdf_cannot_say_is_named():
    made = twin(looking("rectilinear"), format="sdf")
    assert not [*ET.fromstring(made.text).iter("sensor")]
    (said,) = (text for text in made.left_out if text.startswith("sensor eye"))
    assert said.endswith("with the geometry rectilinear; rays of SDF are even in angle")


def test_urdf_names_it_as_left_out():
    made = twin(looking(), format="urdf")
    assert "sensor eye: time_of_flight of carrier" in made.left_out
