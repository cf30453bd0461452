"""An angle from a track and a rate from a position, so that a video meets a pendulum."""

from __future__ import annotations

import numpy as np
import pytest

import simcompare
from simcompare.errors import InputError

LENGTH_M = 0.5
NOISE_M = 0.0005
PIVOT = (0.1, 0.7)
MAP = "derive:\n  swing: {{function: angle, of: [x, y]{more}}}\n"
VALIDATE = """validate:
  - scenario: pendulum
    parameters:
      length_m: {value: 0.5, u: 0.002, source: ruler}
      damping_N_m_s_rad: {value: 0, u: 1e-9, source: none}
      friction_N_m: {value: 0, u: 1e-9, source: none}
    start: {start_angle_rad: {channel: angle}}
    compare: {angle_rad: {channel: angle}}
"""


def swing(count=360, amplitude=0.3):
    """A small swing, nearly a sine: time and angle."""
    time = np.arange(count) / 60
    return time, amplitude * np.cos(np.sqrt(9.80665 / LENGTH_M) * time)


def track(folder, angle, time, noise=NOISE_M, flipped=False):
    chance = np.random.default_rng(4)
    x = PIVOT[0] + LENGTH_M * np.sin(angle) + chance.normal(0, noise, len(time))
    y = PIVOT[1] - LENGTH_M * np.cos(angle) + chance.normal(0, noise, len(time))
    rows = zip(time, x, -y if flipped else y, strict=True)
    text = "".join(f"{t:.6E},{a:.6E},{b:.6E}\n" for t, a, b in rows)
    (folder / "track.txt").write_text(",bob,\nt,x,y\n" + text, encoding="utf-8")
    return folder / "track.txt"


def read(folder, log, text):
    (folder / "map.yaml").write_text(text, encoding="utf-8")
    return simcompare.import_log(log, mapping=folder / "map.yaml")


@pytest.mark.parametrize(
    ("more", "flipped"),
    [("", False), (", pivot: [0.1, 0.7]", False), (', down: "+y"', True)],
)
def test_the_angle_of_a_track_about_its_pivot_is_right_within_its_uncertainty(
    tmp_path, more, flipped
):
    time, angle = swing()
    log = track(tmp_path, angle, time, flipped=flipped)
    made = read(tmp_path, log, MAP.format(more=more)).streams["swing"]
    channel = made.channels["angle_rad"]
    off = channel.values - angle
    # the noise of a place is 0.5 mm on 500 mm; 360 draws tell it to 4 %
    assert np.std(off) == pytest.approx(NOISE_M / LENGTH_M, rel=0.15)
    assert np.sqrt(np.mean(off**2)) <= 2 * channel.u
    assert np.median(made.channels["radius_m"].values) == pytest.approx(LENGTH_M, rel=0.01)


def test_an_angle_is_counted_on_through_whole_turns(tmp_path):
    time = np.arange(300) / 60
    log = track(tmp_path, 4 * time, time)
    made = read(tmp_path, log, MAP.format(more="")).streams["swing"]
    assert np.allclose(made.channels["angle_rad"].values, 4 * time, atol=0.01)  # 10 σ of a place


def test_an_arc_too_short_to_tell_its_centre_asks_for_the_pivot(tmp_path):
    time, angle = swing(amplitude=0.004)
    log = track(tmp_path, angle, time, noise=0.002)
    message = r"derive\.swing: the track is too short .*pivot: \[x, y\]"
    with pytest.raises(InputError, match=message):
        read(tmp_path, log, MAP.format(more=""))


def test_a_rate_is_the_slope_and_none_is_taken_across_a_gap(tmp_path):
    time = np.concatenate((np.arange(100), np.arange(130, 200))) * 0.01
    rows = "".join(f"{t:.2f},{t * t:.6f}\n" for t in time)
    (tmp_path / "log.csv").write_text("t (s),x (m)\n" + rows, encoding="utf-8")
    made = read(tmp_path, tmp_path / "log.csv", "derive:\n  v: {function: rate, of: [x]}\n")
    (channel,) = made.streams["v"].channels.values()
    assert made.streams["v"].channels.keys() == {"x_rate_m_s"}
    # a parabola has the slope of its chord exactly; the log has 6 decimals
    assert np.allclose(channel.values, 2 * time, atol=3e-4)
    assert channel.unit == "m/s"


def test_a_rate_of_an_angle_of_a_track_is_one_line_more(tmp_path):
    time, angle = swing()
    log = track(tmp_path, angle, time, noise=0)
    text = MAP.format(more="") + "  speed: {function: rate, of: [angle]}\n"
    rate = read(tmp_path, log, text).streams["speed"].channels["angle_rate_rad_s"]
    true = np.gradient(angle, time, edge_order=2)
    assert np.allclose(rate.values, true, atol=1e-3)  # the file has 7 digits, over 1/30 s


def test_a_track_of_a_bob_validates_a_pendulum(tmp_path):
    from scipy.integrate import solve_ivp

    time = np.arange(240) / 60
    solved = solve_ivp(
        lambda _, z: [z[1], -9.80665 / LENGTH_M * np.sin(z[0])],
        (0, 4), [0.6, 0], t_eval=time, rtol=1e-9,
    )  # fmt: skip
    log = track(tmp_path, solved.y[0], time)
    (tmp_path / "map.yaml").write_text(MAP.format(more="") + VALIDATE, encoding="utf-8")
    found = simcompare.validate(
        "pendulum", recording=log, mapping=tmp_path / "map.yaml", engine="mujoco"
    ).record.validation
    (period,) = [row for row in found.values if row.measure == "mean_period"]
    # the noise of 1 mrad moves a crossing by 0.4 ms, which two or three swings of 1.45 s average
    assert abs(period.error) < 1e-3
    wave = next(row for row in found.waveforms if row.judged)
    assert wave.rmse < 0.005  # 1 mrad of noise in the track, and in the angle it starts from
