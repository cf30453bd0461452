"""Impacts drawn from sound, stopwatches, videos and tables; what is missed or spurious is told."""

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.fitting.bounces import arcs, records, tables
from simcompare.fitting.bounces.reading import from_recording, from_times
from simcompare.fitting.bounces.tables import from_rebounds, from_table
from simcompare.hardware.recordings import bounce_table
from simcompare.model.plain import plain
from simcompare.results.records.fit_parts import finite
from simcompare.verbs.import_log import import_log
from tests.bounces import IN_AIR, TRUTH, drop_words, filmed, filmed_samples, recording, times_of

EVENTS = times_of(count=7)


# ---- sound and stopwatches ----------------------------------------------------------------------


def test_impacts_that_were_heard_keep_their_own_uncertainties():
    u = np.linspace(1e-4, 2e-4, 7)
    log = recording(events=[("impact", t, s) for t, s in zip(EVENTS, u, strict=True)])
    (drop,) = from_recording(log)
    assert drop.times_s.tolist() == EVENTS.tolist()
    assert drop.u_s.tolist() == u.tolist()
    assert drop.numbers == (1, 2, 3, 4, 5, 6, 7)
    assert (drop.kind, drop.source, drop_words(drop)) == ("sound", "log.csv", [])


def test_other_events_are_no_impacts():
    events = [("impact", t, 1e-4) for t in EVENTS] + [("clap", 0.1, 1e-4), ("clap", 9.0, 1e-4)]
    (drop,) = from_recording(recording(events=events))
    assert drop.times_s.tolist() == EVENTS.tolist()


def test_a_collision_table_of_phyphox_gives_its_bounces(tmp_path):
    path = tmp_path / "collision.csv"
    cells = ",".join(f'"Bounce {k} (s)","Height {k} (m)"' for k in range(5))
    values = ",".join(f"{t:.6f},{0.5:.3f}" for t in EVENTS[:5])
    path.write_text(f"{cells}\n{values}\n")
    (drop,) = from_recording(import_log(path))
    assert np.diff(drop.times_s) == pytest.approx(np.diff(EVENTS[:5]), abs=2e-6)
    assert drop.kind == "stopwatch"
    assert not drop.u_known


def test_an_acoustic_stopwatch_gives_start_and_stops(tmp_path):
    path = tmp_path / "watch.csv"
    heads = ",".join(['"Start (s)"', *(f'"Stop {k} (s)"' for k in range(1, 5))])
    path.write_text(heads + "\n" + ",".join(f"{t:.6f}" for t in EVENTS[:5]) + "\n")
    (drop,) = from_recording(import_log(path), u_s=2e-4)
    assert np.diff(drop.times_s) == pytest.approx(np.diff(EVENTS[:5]), abs=2e-6)
    assert drop.u_s.tolist() == [2e-4] * 5


# ---- missed and spurious impacts ----------------------------------------------------------------


@pytest.mark.parametrize("values", [TRUTH, IN_AIR, {**TRUTH, "exponent": 0.1}])
@pytest.mark.parametrize("missed", [2, 4, 6])
def test_a_flight_that_lasts_twice_as_long_is_a_missed_impact(values, missed):
    times = np.delete(times_of(values, 8), missed - 1)
    (drop,) = from_times(times, 1e-4)
    assert drop.missed == (missed,)
    assert drop.numbers == tuple(n for n in range(1, 9) if n != missed)
    assert drop.dropped == ()
    assert drop_words(drop) == [f"impact {missed} was not recorded"]


@pytest.mark.parametrize("values", [TRUTH, IN_AIR])
@pytest.mark.parametrize("part", [0.12, 0.5, 0.8])
@pytest.mark.parametrize("flight", [0, 2, 5])
def test_a_knock_within_a_flight_is_left_out_by_number_and_reason(values, flight, part):
    times = times_of(values, 8)
    knock = times[flight] + part * (times[flight + 1] - times[flight])
    (drop,) = from_times(np.insert(times, flight + 1, knock), 1e-4)
    assert drop.times_s.tolist() == times.tolist()
    (out,) = drop.dropped
    assert (out.number, out.time_s) == (flight + 2, knock)
    assert out.reason.startswith("within a flight, ")
    assert out.reason.endswith(f"after impact {flight + 1} ({part:.0%})")


def test_a_clap_before_and_a_knock_after_are_left_out():
    times = times_of(count=8)
    (drop,) = from_times([times[0] - 0.11, *times, times[-1] + 0.5], 1e-4)
    assert drop.times_s.tolist() == times.tolist()
    assert [d.number for d in drop.dropped] == [1, 10]
    assert [d.reason for d in drop.dropped] == ["before the first bounce", "after the last bounce"]


def test_a_missed_and_a_spurious_impact_are_told_together():
    times = np.delete(times_of(count=9), 3)
    knock = times[6] + 0.06
    (drop,) = from_times(np.sort(np.append(times, knock)), 1e-4)
    assert drop.missed == (4,)
    assert [d.time_s for d in drop.dropped] == [knock]


def test_a_late_onset_among_many_is_left_out():
    times = times_of(count=11)
    times[5] += 0.03 * (times[6] - times[5])
    (drop,) = from_times(times, 1e-4)
    assert [d.number for d in drop.dropped] == [6]
    assert drop.missed == (6,)


@pytest.mark.parametrize("stated", [True, False])
def test_clean_impacts_are_never_left_out(stated):
    """Forty balls, also such that fall slowly, for which drag and e(v) go together."""
    generator = np.random.default_rng(7)
    for _ in range(40):
        values = {
            **TRUTH, "restitution": generator.uniform(0.5, 0.94),
            "exponent": generator.choice([0.0, 0.01, 0.03, 0.06, 0.1]),
            "drop_height_m": generator.uniform(0.2, 2.0),
            "terminal_speed_m_s": generator.choice([6.0, 9.0, 14.0, 30.0, np.inf]),
        }  # fmt: skip
        times = times_of(values, int(generator.integers(5, 13)))
        u = 10 ** generator.uniform(np.log10(5e-6), -3)
        # impacts that come faster than they can be told apart are none that anybody hears
        times = times[: max(4, 1 + int(np.sum(np.diff(times) > max(8e-3, 6 * u))))]
        heard = times + generator.normal(0, u, len(times))
        (drop,) = from_times(heard, u if stated else None)
        assert drop.numbers == tuple(range(1, len(times) + 1)), values


def test_noise_beyond_what_is_stated_is_no_reason_to_leave_impacts_out():
    times = times_of(count=8) + np.random.default_rng(4).normal(0, 1e-3, 8)
    (drop,) = from_times(times, 1e-4)
    assert len(drop.times_s) == 8


def test_drops_after_each_other_are_taken_apart():
    first, second = times_of(count=6), times_of({**TRUTH, "drop_height_m": 0.7}, 5)
    drops = from_times([*first, *(second + first[-1] + 3)], 1e-4)
    assert [len(d.times_s) for d in drops] == [6, 5]
    knock = second[1] + first[-1] + 3.2
    drops = from_times(np.sort([*first, *(second + first[-1] + 3), knock]), 1e-4)
    assert drop_words(drops[0]) == []
    assert drop_words(drops[1]) == [
        f"impact 9 at {knock:.4f} s was left out: within a flight, 200.0 ms after impact"
        f" 2 ({0.2 / (second[2] - second[1]):.0%})"
    ]


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([], "0 impacts were found; two at least"),
        ([1.0], "1 impact was found; two at least"),
        ([1.0, 2.0, 1.5], r"impact 3 at 1.5 s is not after impact 2 at 2 s"),
        ([1.0, 2.0, np.nan], "missing or infinite"),
        (
            [0.0, 0.3, 0.8, 1.5, 2.5],
            "(no four|only 3) of the 5 impacts follow each other as those of a",
        ),
    ],
)
def test_what_is_no_series_of_bounces_is_refused_in_words(times, message):
    with pytest.raises(InputError, match=message):
        from_times(times, 1e-4, source="a.wav")


def test_a_metronome_is_no_ball():
    with pytest.raises(
        InputError, match=r"become shorter by a steady factor; found flights of 0\.5"
    ):
        from_times(np.arange(12) * 0.5, 1e-4)


# ---- height against time ------------------------------------------------------------------------


def test_arcs_meet_at_the_impacts_without_knowing_the_floor():
    truth = times_of(count=4)
    errors = []
    for seed in range(20):
        drop = filmed(seed=seed)
        assert drop.numbers == tuple(range(1, len(drop.numbers) + 1))
        errors.append((drop.times_s[:4] - truth) / drop.u_s[:4])
        assert drop.u_s[:4].max() < 1e-3
    assert 0.7 < np.std(errors) < 1.3
    assert abs(np.mean(errors)) < 0.35


def test_apexes_are_heights_above_where_the_arcs_meet():
    drop = filmed(seed=3)
    assert drop.height_numbers[:4] == (0, 1, 2, 3)
    expected = 0.85 ** (2 * np.arange(4))
    assert drop.heights_m[:4] == pytest.approx(expected, abs=6e-3)


def test_frames_before_the_release_are_left_out_and_told():
    drop = filmed(seed=1)
    held = [d for d in drop.dropped if d.reason == "before the ball falls"]
    assert [d.number for d in held] == list(range(1, len(held) + 1))
    assert abs(held[-1].time_s - 0.3) < 0.05


def test_a_misplaced_mark_is_left_out_and_told():
    time, height = filmed_samples(seed=2)
    height[30] += 0.08
    drop = arcs.from_heights(time, height, 3e-3)
    (out,) = [d for d in drop.dropped if "off the flight" in d.reason]
    assert out.number == 31
    assert out.reason.startswith("8") or out.reason.startswith("7")


def test_frames_in_which_nothing_was_seen_are_told():
    time, height = filmed_samples(seed=2)
    height[40:42] = np.nan
    drop = arcs.from_heights(time, height, 3e-3)
    assert [d.number for d in drop.dropped if d.reason == "nothing seen"] == [41, 42]


def test_bounces_lower_than_the_noise_end_what_is_used_and_are_told():
    drop = filmed({**TRUTH, "restitution": 0.6}, fps=120, seconds=4.0)
    left_out = [one for one in drop.dropped if one.reason == "bounces no higher than the noise"]
    # 0.6^8 m is 17 mm and used; 0.6^12 m is 2 mm, far below three times the 3 mm of noise
    assert 4 <= drop.track.flight.max() <= 5
    assert left_out[0].time_s > drop.track.time_s[-1]


def test_a_fast_camera_gives_more_flights():
    assert len(filmed(fps=240, u_m=1e-3, seconds=4.5).times_s) > len(filmed(seconds=4.5).times_s)


def test_height_is_found_by_its_name():
    time, height = filmed_samples()
    log = recording({"a": (time, {"x_m": (height * 0, "m", None), "y_m": (height, "m", 3e-3)})})
    (drop,) = from_recording(log)
    assert drop.kind == "video track"
    assert drop.u_known


@pytest.fixture
def tracked(tmp_path):
    """An export of Tracker in a unit of length, and when its clock began."""

    def make(per_metre):
        time, height = filmed_samples(seed=5)
        pairs = zip(time, per_metre * height, strict=True)
        rows = "\n".join(f"{t:.6f}\t0.0\t{y:.6f}" for t, y in pairs)
        (tmp_path / "ball.txt").write_text(f"ball\nt\tx\ty\n{rows}\n")
        return tmp_path / "ball.txt", time[0]

    return make


def test_a_tracker_export_becomes_flights_in_metres(tracked):
    path, begin = tracked(1.0)
    (drop,) = from_recording(import_log(path))
    # the recording's clock begins with its first sample
    assert drop.times_s[:3] + begin == pytest.approx(times_of(count=3), abs=2e-3)
    assert drop_words(drop)[-1] == (
        "Tracker writes no units: lengths were taken as metres, and times as seconds"
    )


@pytest.mark.parametrize("per_metre", [100.0, 39.37, 0.001])
def test_tracker_lengths_that_do_not_fall_as_metres_are_refused_with_the_cure(tracked, per_metre):
    path, _ = tracked(per_metre)
    with pytest.raises(InputError, match="y as metres falls with") as error:
        from_recording(import_log(path))
    line = error.value.faults[0].split('"')[1]
    assert line == "channels: {height: {column: y, unit: cm}}"


def test_a_unit_in_a_mapping_is_no_assumption(tracked):
    path, begin = tracked(100.0)
    mapping = path.parent / "map.yaml"
    mapping.write_text("channels: {height: {column: y, unit: cm}}")
    (drop,) = from_recording(import_log(path, mapping=mapping))
    assert drop.times_s[:3] + begin == pytest.approx(times_of(count=3), abs=2e-3)
    assert not any("Tracker" in note for note in drop.notes)


@pytest.mark.parametrize(
    ("height", "message"),
    [
        (lambda t: 0 * t, "no impact is seen"),
        (lambda t: -np.abs(np.sin(3 * t)), "counted downwards"),
        (
            lambda t: np.where(t < 0.1, 1.0, np.nan),
            "6 samples of height; a bounce needs at least 8",
        ),
    ],
)
def test_a_height_without_bounces_is_refused_in_words(height, message):
    time = np.arange(0, 3, 1 / 60)
    with pytest.raises(InputError, match=message):
        arcs.from_heights(time, height(time), 1e-3)


def test_a_recording_of_something_else_is_refused_with_what_it_holds():
    log = recording({"imu": ([0, 1, 2], {"acceleration_x_m_s2": ([1, 2, 3], "m/s**2", None)})})
    with pytest.raises(InputError, match=r"no impacts and no height; found.*acceleration_x_m_s2"):
        from_recording(log)


def test_two_heights_must_be_told_apart():
    time, height = filmed_samples()
    held = {"left_height_m": (height, "m", None), "right_height_m": (height, "m", None)}
    with pytest.raises(InputError, match=r"left_height_m, a/right_height_m\. Write the line"):
        from_recording(recording({"a": (time, held)}))


# ---- tables -------------------------------------------------------------------------------------


def test_a_bounce_table_gives_rebounds_and_the_drop(tmp_path):
    path = tmp_path / "ball.csv"
    path.write_text("# drop_height: 100 cm\nbounce,rebound_height_cm,u_rebound_height_cm\n"
                    "1,72.3,0.2\n2,52.2,0.2\n4,27.2,0.2\n")  # fmt: skip
    drop = from_table(bounce_table.read(path, {"rebound_height": "m"}))
    assert drop.height_numbers == (0, 1, 2, 4)
    assert drop.heights_m == pytest.approx([1.0, 0.723, 0.522, 0.272])
    assert drop.u_heights_m == pytest.approx([5e-4, 2e-3, 2e-3, 2e-3])
    assert drop.missed == (3,)
    assert any("no stated uncertainty" in note for note in drop.notes)


def test_a_table_without_heights_says_what_it_holds(tmp_path):
    path = tmp_path / "ball.csv"
    path.write_text("bounce,restitution\n1,0.88\n")
    with pytest.raises(InputError, match="holds restitution, but none of impact_time, interval"):
        tables.read(path)


@pytest.mark.parametrize(
    ("heights", "message"),
    [
        ([0.5], "1 height; two at least"),
        ([0.5, -0.1], "rebound 2: -0.1 m is not a height above the floor"),
        ([0.5, 0.7], "rebound 2: 0.7 m is higher than the 0.5 m before it"),
    ],
)
def test_heights_that_cannot_be_are_refused(heights, message):
    with pytest.raises(InputError, match=message):
        from_rebounds(heights, 1e-3)


def test_impacts_become_plain_values():
    knock = EVENTS[2] + 0.1
    (drop,) = from_times(np.sort([*EVENTS, knock]))
    found = plain(finite(records.drop_of(drop)))
    assert found["u_s"] == [None] * 7
    assert found["dropped"][0]["number"] == 4
    assert found["numbers"] == [1, 2, 3, 4, 5, 6, 7]
