"""A ball in a film: followed, measured by a clicked length, and fitted."""

from __future__ import annotations

import json

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.lab import video
from simcompare.lab.work import perform
from tests import lab_films

pytest.importorskip("cv2", reason="OpenCV comes with the extra [web]", exc_type=ImportError)
#: two points half a metre apart in these films
HALF_A_METRE = [[10, 60], [10, 60 + lab_films.METRE_PX / 2]]


def came(folder, name: str = "source.mp4", **how):
    film = lab_films.film(folder / name, **how)
    return perform("film", {"path": str(film)})


@pytest.mark.parametrize(
    "how",
    [
        {"noise": 6.0, "shadow": True},
        {"rate_hz": 30.0, "exposure": 0.9, "seconds": 2.4, "name": "source.avi"},
    ],
    ids=["noise and shadow", "blur"],
)
def test_restitution_of_a_filmed_ball_is_right_within_a_hundredth(tmp_path, how) -> None:
    found = came(tmp_path, **how)
    json.dumps(found, allow_nan=False)
    assert (found["width"], found["height"]) == (lab_films.WIDTH, lab_films.HEIGHT)
    assert found["frame"].startswith("data:image/jpeg;base64,")
    drop = video.scaled(tmp_path, HALF_A_METRE, 0.5)["drop"]
    assert drop["middle"] == pytest.approx(0.8, rel=0.01)
    assert drop["drop_height_m"] == pytest.approx(0.5, rel=0.01)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"second": True}, "two balls or more"),
        ({"ball": False, "seconds": 0.6}, "no moving ball is seen"),
        ({"seconds": 0.1}, "has 6 pictures"),
        ({"shake": 30.0, "seconds": 0.6}, "the camera was moved"),
    ],
)
def test_film_without_one_ball_is_refused_in_words(tmp_path, how, said) -> None:
    with pytest.raises(InputError, match=said):
        came(tmp_path, **how)


def test_what_is_no_film_is_refused(tmp_path) -> None:
    path = tmp_path / "source.mp4"
    path.write_bytes(b"\0\0\0\x20ftypisom" + np.random.default_rng(1).bytes(5000))
    with pytest.raises(InputError, match="cannot be read as a film"):
        video.received(path)


@pytest.fixture(scope="module")
def group(tmp_path_factory):
    folder = tmp_path_factory.mktemp("group")
    (folder / "recordings" / "0a").mkdir(parents=True)
    came(folder / "recordings" / "0a")
    return folder


def test_filmed_ball_is_fitted_in_engines(group) -> None:
    asked = {"folder": str(group), "recording": "0a"}
    told = perform("scale", {**asked, "points": HALF_A_METRE, "metres": 0.5})
    assert len(told["impacts"]) >= 4
    found = perform("fit", {**asked, "id": "f1", "scenario": "ball", "engines": ["pymunk"]})
    assert found["restitution"]["value"] == pytest.approx(0.8, rel=0.01)


@pytest.mark.parametrize(
    ("points", "metres", "said"),
    [
        ([[0, 0], [3, 4]], 0.5, "click two points"),
        ([[0, 0], [1e9, 4]], 0.5, "click two points"),
        ([[0, 0]], 0.5, "two points"),
        ("rm -rf", 0.5, "two points"),
        (None, 0.5, "two points"),
        (HALF_A_METRE, -1, "-1 m is not within"),
        (HALF_A_METRE, "1", "finite number"),
    ],
)
def test_length_that_is_none_is_refused(group, points, metres, said) -> None:
    asked = {"folder": str(group), "recording": "0a", "points": points, "metres": metres}
    with pytest.raises(InputError, match=said):
        perform("scale", asked)
