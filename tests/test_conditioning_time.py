"""Clocks: what is wrong with them is found in the very rows, repaired, recorded, or refused."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simcompare.errors import InputError
from simcompare.hardware import raw as raw_module
from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.mapping import of_tree
from simcompare.hardware.raw import RawColumn
from tests import corruption
from tests.corruption import DEFECTS, OF_TIME, clean, conditioned, found, row, rows_of, values

REPAIRED = [name for name in OF_TIME if DEFECTS[name]().severity != "fault"]
REFUSED = [name for name in OF_TIME if DEFECTS[name]().severity == "fault"]


@pytest.mark.parametrize("name", REPAIRED)
def test_a_defect_of_the_clock_is_recorded_with_its_exact_rows(name):
    damaged = DEFECTS[name]()
    recording = conditioned(damaged.stream)
    (repair,) = found(recording, damaged.rule)
    assert rows_of(repair) == damaged.rows
    assert (repair.severity, repair.channel) == (damaged.severity, damaged.channel)
    assert repair.count == len(damaged.rows)
    assert repair.stream == "log"
    assert corruption.defects_in(recording) == [damaged.rule]


@pytest.mark.parametrize("name", REPAIRED)
def test_strict_mode_refuses_what_would_be_repaired_and_names_the_row(name):
    damaged = DEFECTS[name]()
    with pytest.raises(InputError) as error:
        conditioned(damaged.stream, "strict")
    message = str(error.value)
    assert f"({damaged.rule}; refused by --strict)" in message
    first = damaged.rows[0]
    assert f"row {first}" in message or f"rows {first} to" in message


@pytest.mark.parametrize("mode", ["strict", "repair"])
@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_repaired_is_refused_and_the_row_named(name, mode):
    damaged = DEFECTS[name]()
    with pytest.raises(InputError) as error:
        conditioned(damaged.stream, mode)
    message = str(error.value)
    assert message.startswith("test.csv: ")
    for line in damaged.rows:
        assert f"line {line}" in message
    if damaged.rule != "time_unit":
        assert f"({damaged.rule})" in message
    assert "fault" not in message  # one defect, one fault


@pytest.mark.parametrize("name", REPAIRED)
def test_values_are_the_same_to_the_bit_after_a_repair_of_the_clock(name):
    damaged = DEFECTS[name]()
    stream = conditioned(damaged.stream).streams["log"]
    kept = np.setdiff1d(np.arange(len(damaged.truth)), damaged.lost)
    for column in damaged.truth.columns[1:]:
        made = next(c for c in stream.channels.values() if c.raw == column.name)
        assert np.array_equal(made.values, column.values[kept])


@pytest.mark.parametrize("name", REPAIRED)
def test_repaired_times_are_right_within_their_uncertainty(name):
    damaged = DEFECTS[name]()
    stream = conditioned(damaged.stream).streams["log"]
    kept = np.setdiff1d(np.arange(len(damaged.truth)), damaged.lost)
    true = values(damaged.truth, "t")[kept]
    off = stream.time_s - (true - true[0])
    # where a log begins is not judged: a stamp may be that of the end of its interval
    off -= np.median(off)
    untouched = np.abs(off) < 1e-12
    if damaged.rule in (
        "time_gap",
        "sequence_gap",
        "duplicate_row",
        "duplicate_time",
        "time_order",
        "truncated",
        "stale_first_row",
    ):
        assert untouched.all()
    elif damaged.rule in ("time_outlier", "time_missing"):
        assert set(np.flatnonzero(~untouched)) <= {line - row(0) for line in damaged.rows}
        assert np.abs(off).max() < 3 * 0.02 / corruption.RATE_HZ
    else:
        assert np.std(off) <= 1.3 * stream.clock.u_s
    assert (np.diff(stream.time_s) > 0).all()


# the frames of the clock of milliseconds show other signals
@pytest.mark.parametrize("name", [name for name in REPAIRED if name != "millisecond_clock"])
def test_results_change_by_less_than_their_expanded_uncertainty(name):
    damaged = DEFECTS[name]()
    stream = conditioned(damaged.stream).streams["log"]
    truth = conditioned(damaged.truth).streams["log"]
    for result in (_slope, _period):
        (before, u_before), (after, u_after) = result(truth), result(stream)
        assert abs(after - before) <= 2 * np.hypot(u_before, u_after)
    gone = len(truth.time_s) - len(stream.time_s)
    amplitude = [s.channels["amplitude_V"].values for s in (truth, stream)]
    assert abs(amplitude[1].mean() - amplitude[0].mean()) <= 0.35 * (gone + 1e-9) / 2000


def _slope(stream):
    return _fit(stream, "slope_V", [np.ones_like(stream.time_s), stream.time_s], 1, 0.3)


def _period(stream):
    """Period by linear least squares around the true one: u of the rate comes with it."""
    rate, t = 2 * np.pi / corruption.PERIOD_S, stream.time_s
    bend = t * np.cos(rate * t)
    found_, u = _fit(stream, "sine_V", [np.sin(rate * t), np.cos(rate * t), bend], 2, rate)
    return 2 * np.pi / (rate + found_), 2 * np.pi / rate**2 * u


def _fit(stream, name, shapes, which, speed):
    table = np.stack(shapes, axis=1)
    there = np.isfinite(stream.channels[name].values)
    y, table = stream.channels[name].values[there], table[there]
    best, *_ = np.linalg.lstsq(table, y, rcond=None)
    scatter = np.std(y - table @ best)
    # an error of the clock may be shared by eight samples of a burst
    noise = np.hypot(scatter, np.sqrt(8) * speed * stream.clock.u_s)
    return best[which], noise * np.sqrt(np.linalg.inv(table.T @ table)[which, which])


def test_gaps_are_marked_in_the_stream():
    damaged = DEFECTS["gap"]()
    stream = conditioned(damaged.stream).streams["log"]
    assert stream.gaps == (99, 698, 1197)
    (repair,) = found(conditioned(damaged.stream), "time_gap")
    assert repair.after["missing"] == 7
    assert repair.after["longest_s"] == pytest.approx(0.06, rel=0.05)


def test_bursts_are_spread_and_their_jitter_becomes_uncertainty():
    recording = conditioned(DEFECTS["bursts"]().stream)
    stream = recording.streams["log"]
    assert np.diff(stream.time_s).min() > 0.005
    assert stream.clock.u_s == pytest.approx(1e-3, rel=0.15)
    assert "bursts of 8" in found(recording, "burst_time")[0].text


def test_a_pause_between_bursts_stays_a_pause():
    stream = corruption.without(clean(2500, jitter=0.0), np.arange(1000, 1500))
    time = values(stream, "t")
    chance = np.random.default_rng(3)
    last = np.minimum(np.arange(2000) // 8 * 8 + 7, 1999)
    time[:] = time[last] + np.repeat(chance.normal(0, 3e-4, 250), 8)
    recording = conditioned(stream)
    assert recording.streams["log"].gaps == (999,)
    assert np.diff(recording.streams["log"].time_s)[999] == pytest.approx(5.01, abs=0.01)


def test_rows_that_share_a_stamp_because_they_are_of_several_things_are_refused():
    time = np.repeat(np.arange(300) / 10, 3)
    body = np.tile([1.0, 2.0, 3.0], 300)
    height = np.random.default_rng(1).normal(size=900)
    with pytest.raises(InputError, match="column 'body': tells 3 things apart"):
        conditioned(corruption.of_columns(time, body=body, height=height))


def test_rows_of_one_moment_that_hold_other_columns_are_joined_without_loss():
    time = np.repeat(np.arange(300) / 10, 2)
    chance = np.random.default_rng(1)
    a, b = chance.normal(size=600), chance.normal(size=600)
    a[1::2], b[0::2] = np.nan, np.nan
    recording = conditioned(corruption.of_columns(time, a=a, b=b), "strict")
    stream = recording.streams["log"]
    assert np.array_equal(stream.channels["a_V"].values, a[0::2])
    assert np.array_equal(stream.channels["b_V"].values, b[1::2])
    assert found(recording, "joined_rows")[0].count == 300


def test_a_pause_of_a_device_at_rest_is_a_gap_and_no_jump_of_the_clock():
    stream = clean()
    for column in stream.columns[1:]:
        column.values = 1.0 + np.random.default_rng(2).normal(0, 0.01, 2000)
    values(stream, "t")[1100:] += 0.9
    recording = conditioned(stream)
    assert corruption.defects_in(recording) == ["time_gap"]
    assert recording.streams["log"].gaps == (1099,)


def test_a_true_pause_of_a_moving_device_is_a_gap_and_no_jump_of_the_clock():
    stream = corruption.without(clean(3000), np.arange(1100, 1190))
    recording = conditioned(stream)
    assert corruption.defects_in(recording) == ["time_gap"]
    assert found(recording, "time_gap")[0].after["missing"] == 90


@pytest.mark.parametrize("least", [0.0, 0.001])
def test_a_sensor_that_writes_on_change_is_silent_at_rest_and_its_clock_unchanged(least):
    """A joint that moves three times and rests between; values that do not change are not sent."""
    time = np.arange(0, 60, 0.01)
    angle = np.zeros_like(time)
    for begins, by in ((5.0, 0.8), (20.0, -0.5), (45.0, 1.1)):
        s = np.clip((time - begins) / 2.5, 0, 1)
        angle += by * s**3 * (10 - 15 * s + 6 * s**2)
    angle = np.round(angle, 4)
    sent = [0]
    for i in range(1, len(time)):
        if abs(angle[i] - angle[sent[-1]]) > least:
            sent.append(i)
    recording = conditioned(corruption.of_columns(time[sent], x=angle[sent]))
    assert np.allclose(recording.streams["log"].time_s, time[sent], rtol=0, atol=1e-9)
    assert "clock_jump" not in corruption.defects_in(recording)
    steps = np.diff(recording.streams["log"].time_s)
    # the two pauses between the motions, and the one before the first
    assert set(np.flatnonzero(steps > 1.0).tolist()) <= set(recording.streams["log"].gaps)


@pytest.mark.parametrize(
    ("speeds", "shares"), [((0.01, 0.019, 0.04), (3, 3, 3)), ((0.01, 0.02, 0.04), (6, 3, 1))]
)
def test_a_clock_of_several_speeds_loses_nothing(speeds, shares):
    """A phone that writes whenever a sensor reports."""
    chance = np.random.default_rng(7)
    step = chance.choice(speeds, 400, p=np.array(shares) / sum(shares))
    time = np.cumsum(step + chance.uniform(-0.001, 0.001, 400))
    recording = conditioned(corruption.of_columns(time, x=np.sin(time)), "strict")
    (told,) = found(recording, "irregular_clock")
    assert (told.severity, "several speeds" in told.text) == ("info", True)
    assert recording.streams["log"].gaps == ()
    assert np.allclose(recording.streams["log"].time_s, time - time[0], rtol=0, atol=1e-12)


def test_many_lost_samples_are_told_with_their_share_and_refused_by_strict():
    (told,) = found(conditioned(corruption.many_gaps().stream), "time_gap")
    assert "8.2 % of the samples" in told.text  # 165 of 2000
    with pytest.raises(InputError, match="time_gap; refused by --strict"):
        conditioned(corruption.many_gaps().stream, "strict")


def test_a_stale_first_row_alone_is_out_of_order():
    damaged = corruption.stale_first_row().stream
    with pytest.raises(InputError, match=rf"line {row(0)} alone is out of order.*; delete it"):
        conditioned(damaged, "strict")


def test_a_trace_of_microseconds_is_not_whole_minutes():
    stream = clean()
    # rounded to three digits, so that the steps are uneven
    stream.columns[0].values[:] = np.round(np.arange(len(stream)) * 3.3333e-9, 11)
    recording = conditioned(stream)
    assert "whole_seconds" not in corruption.defects_in(recording)
    assert recording.streams["log"].clock.u_s < 1e-9


def test_stamps_of_whole_seconds_are_kept_and_unsure_by_half_a_second():
    time = np.floor(np.arange(60) * 1.04)
    recording = conditioned(corruption.of_columns(time, x=np.sin(time)), "strict")
    clock = recording.streams["log"].clock
    assert np.array_equal(recording.streams["log"].time_s, time)
    assert clock.u_s == pytest.approx(1 / np.sqrt(12))
    assert clock.resolution_s == 1.0


def test_samples_that_share_a_whole_second_are_spread_over_it():
    true = np.cumsum(np.random.default_rng(3).exponential(1.5, 300))
    recording = conditioned(corruption.of_columns(np.floor(true), x=np.sin(true)))
    assert "whole_seconds" in corruption.defects_in(recording)
    made = recording.streams["log"]
    assert len(made.time_s) == 300
    off = made.time_s - true
    # each lies within the second of its stamp, so no error is longer than that
    assert np.ptp(off) <= 2.0
    assert np.std(off) <= 1.1 * made.clock.u_s  # 300 draws: the scatter is known to 4 %


def test_a_change_of_the_rate_is_no_gap():
    time = np.concatenate((np.arange(500) * 0.01, 5.0 + np.arange(500) * 0.02))
    assert corruption.defects_in(conditioned(corruption.of_columns(time, x=np.sin(time)))) == []


def test_late_samples_of_a_program_are_told_but_no_defect():
    """A loop that oversleeps once: its stamps are true, and no whole sample is missing."""
    step = np.full(2000, 0.002)
    step[[3, 900]] = 0.0035
    time = np.cumsum(step)
    recording = conditioned(corruption.of_columns(time, x=np.sin(time)), "strict")
    (late,) = found(recording, "late_sample")
    assert late.severity == "info"
    assert rows_of(late) == [row(3), row(900)]
    assert recording.streams["log"].gaps == ()


def test_irregular_stamps_of_a_bus_are_taken_as_they_are():
    """Servo readings that take 3.5 ms or, one time in five, 5.7 ms."""
    chance = np.random.default_rng(4)
    step = np.where(chance.random(1500) < 0.2, 0.0057, 0.0035) + chance.normal(0, 5e-5, 1500)
    time = np.cumsum(step)
    recording = conditioned(corruption.of_columns(time, x=np.sin(time)), "strict")
    assert [r.rule for r in recording.provenance.repairs] == ["irregular_clock"]


def test_stamps_of_a_coarse_clock_that_are_truly_uneven_are_left_and_unsure():
    chance = np.random.default_rng(5)
    time = np.round(np.cumsum(0.02 + chance.uniform(-0.006, 0.006, 1000)), 3)
    recording = conditioned(corruption.of_columns(time, x=np.sin(time)), "strict")
    clock = recording.streams["log"].clock
    assert clock.resolution_s == pytest.approx(1e-3)
    assert clock.u_s == pytest.approx(1e-3 / np.sqrt(12))
    assert np.array_equal(recording.streams["log"].time_s, time - time[0])


def test_an_even_clock_is_not_said_to_be_coarse():
    recording = conditioned(corruption.of_columns(np.arange(500) / 50, x=np.arange(500.0)))
    clock = recording.streams["log"].clock
    assert (clock.resolution_s, clock.u_s) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("unit", "factor"), [("ms", 1e3), ("us", 1e6), ("µs", 1e6), ("ns", 1e9), ("min", 1 / 60)]
)
def test_declared_units_of_time_are_obeyed(unit, factor):
    time = np.arange(500) / 50
    recording = conditioned(corruption.of_columns(time * factor, unit, x=np.sin(time)), "strict")
    assert np.allclose(recording.streams["log"].time_s, time, atol=1e-9)


@pytest.mark.parametrize("name", ["t_ms", "time (ms)", "timestamp [ms]", "t ms"])
def test_a_unit_of_time_at_the_end_of_the_name_is_obeyed(name):
    stream = corruption.of_columns(np.arange(500) * 20.0, "", x=np.sin(np.arange(500)))
    stream.columns[0].name = stream.time = name
    assert conditioned(stream).streams["log"].time_s[-1] == pytest.approx(9.98)


def test_seconds_are_taken_where_nothing_is_said_and_only_they_make_sense():
    recording = conditioned(corruption.of_columns(np.arange(500) / 50, "", x=np.arange(500.0)))
    assert "taken as seconds" in found(recording, "time_unit")[0].text
    assert recording.streams["log"].time_s[-1] == pytest.approx(9.98)


def test_a_wrong_unit_of_time_is_put_right_only_when_the_user_lets_it_be_assumed():
    stream = DEFECTS["milliseconds"]().stream
    recording = conditioned(stream, assume_units=True)
    (repair,) = found(recording, "time_unit")
    assert repair.severity == "repair"
    assert repair.after["median_dt_s"] == pytest.approx(0.01, rel=1e-3)
    assert recording.streams["log"].time_s[-1] == pytest.approx(19.99, abs=0.01)
    with pytest.raises(InputError, match="refused by --strict"):
        conditioned(stream, "strict", assume_units=True)


def test_a_unit_given_in_the_mapping_is_never_doubted():
    stream = corruption.of_columns(np.arange(500) * 5000.0, "", x=np.arange(500.0))
    mapping = of_tree({"time": {"column": "t", "unit": "s"}}, "map")
    assert conditioned(stream, mapping=mapping).streams["log"].time_s[-1] == 499 * 5000.0


def test_a_time_in_a_unit_of_something_else_is_refused():
    with pytest.raises(InputError, match="is the time but in 'deg'"):
        conditioned(corruption.of_columns(np.arange(500) / 50, "deg", x=np.arange(500.0)))


@pytest.mark.parametrize(("unit", "factor"), [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_stamps_since_1970_tell_their_unit_and_the_date(unit, factor):
    start, time = 1_700_000_000.0, np.arange(500) / 50
    recording = conditioned(corruption.of_columns((start + time) * factor, "", x=np.sin(time)))
    stream = recording.streams["log"]
    assert stream.clock.start == "2023-11-14T22:13:20.000+00:00"
    assert stream.clock.first_s == pytest.approx(start)
    assert np.abs(stream.time_s - time).max() < 3e-7
    assert f"so they are in {unit}" in found(recording, "time_unit")[0].text


def test_what_floating_point_cannot_hold_becomes_uncertainty():
    time = np.cumsum(np.random.default_rng(1).uniform(0.9e-3, 1.1e-3, 1000))
    stream = conditioned(corruption.of_columns(1.7e9 + time, x=np.sin(time))).streams["log"]
    assert stream.clock.u_s == pytest.approx(2.0**-22 / np.sqrt(12), rel=0.01)
    assert np.std(stream.time_s - (time - time[0])) < 2 * stream.clock.u_s


def test_a_log_without_times_and_with_a_rate_has_no_defects_of_time():
    stream = clean()
    stream.time, stream.increment_s, stream.start_s = None, 0.01, 3.0
    stream.columns = stream.columns[1:]
    recording = conditioned(stream, "strict")
    assert recording.streams["log"].clock.first_s == 3.0
    assert np.array_equal(recording.streams["log"].time_s, np.arange(2000) * 0.01)


def test_a_time_that_never_goes_on_is_refused():
    with pytest.raises(InputError, match="the time never goes on"):
        conditioned(corruption.of_columns(np.full(100, 3.0), x=np.arange(100.0)))


def test_a_single_sample_is_refused():
    with pytest.raises(InputError, match="at least two"):
        conditioned(corruption.of_columns([1.0], x=[2.0]))


def test_a_counter_of_8_bits_shows_lost_packets_across_its_wrap():
    stream = clean()
    count = np.arange(2000.0) % 256
    stream.columns.append(RawColumn("seq", count, "1"))
    lost = [255, 256, 1000]
    recording = conditioned(corruption.without(stream, lost))
    (gaps,) = found(recording, "sequence_gap")
    assert rows_of(gaps) == [row(255), row(998)]
    assert gaps.after["missing"] == 3


@pytest.mark.parametrize("stride", [1, 2])
def test_with_a_rate_alone_the_counter_tells_when_samples_were_taken(stride):
    """Packets of a radio that come without a time, every second one of another kind."""
    number = np.setdiff1d(np.arange(300), [100, 101, 250])
    stream = corruption.of_columns(
        number * 0.0, x=np.sin(number / 10), packet=(stride * number).astype(float)
    )
    stream.columns, stream.time = stream.columns[1:], None
    recording = conditioned(stream, mapping=of_tree({"time": {"rate_Hz": 50}}, "map"))
    assert np.allclose(recording.streams["log"].time_s, number / 50, rtol=0, atol=1e-12)
    (gap,) = found(recording, "sequence_gap")
    assert (gap.count, gap.after["missing"]) == (2, 3)
    assert recording.streams["log"].gaps == (99, 247)


def test_long_columns_give_the_same_in_small_blocks(monkeypatch, tmp_path):
    whole = {name: conditioned(DEFECTS[name]().stream) for name in REPAIRED}
    monkeypatch.setattr(raw_module, "BLOCK", 97)
    for name, expected in whole.items():
        recording = conditioned(DEFECTS[name]().stream)
        a, b = recording.streams["log"], expected.streams["log"]
        assert recording.provenance.repairs[0].rows == expected.provenance.repairs[0].rows
        assert np.allclose(a.time_s, b.time_s, rtol=0, atol=1e-11)
        assert a.gaps == b.gaps


def test_columns_on_disk_stay_on_disk(tmp_path):
    stream = corruption.DEFECTS["duplicate_row"]().stream
    for column in stream.columns:
        path = tmp_path / column.name
        column.values.tofile(path)
        column.values = np.memmap(path, dtype=float, mode="r+")
    from simcompare.hardware.conditioning.condition import condition
    from simcompare.hardware.mapping import NOTHING
    from simcompare.hardware.raw import RawLog

    recording = condition(RawLog([stream]), NOTHING, corruption.about())
    made = recording.streams["log"]
    assert isinstance(made.time_s, np.memmap)
    assert all(isinstance(c.values, np.memmap) for c in made.channels.values())
    assert len(made.time_s) == 2000


def _even(count, chance):
    return np.arange(count) / 100


def _jittery(count, chance):
    return np.arange(count) / 100 + chance.uniform(-0.002, 0.002, count)


def _variable(count, chance):
    return np.cumsum(chance.uniform(0.6, 1.4, count)) / 100


def _drifting(count, chance):
    return np.cumsum(1 / (1 + 0.4 * np.sin(np.arange(count) / chance.uniform(20, 300)))) / 100


def _late(count, chance):
    return np.cumsum(np.where(chance.random(count) < 0.01, 1.7, 1.0)) / 100


CLOCKS = (_even, _jittery, _variable, _drifting, _late)


@settings(max_examples=150)
@given(
    st.sampled_from(CLOCKS), st.integers(2, 3000), st.integers(0, 10**6),
    st.sampled_from([0.0, 12.5, 1.7e9]),
)  # fmt: skip
def test_good_clocks_are_never_called_defective(clock, count, seed, start):
    chance = np.random.default_rng(seed)
    time = start + clock(count, chance)
    x = np.cumsum(chance.normal(size=count))
    recording = conditioned(corruption.of_columns(time, x=x))
    assert corruption.defects_in(recording) == []
    stream = recording.streams["log"]
    assert np.array_equal(stream.time_s, time - time[0])
    assert np.array_equal(stream.channels["x_V"].values, x)


@settings(max_examples=60)
@given(st.integers(50, 1900), st.integers(1, 60), st.integers(0, 10**6))
def test_a_gap_anywhere_is_found_in_its_row(at, length, seed):
    stream = corruption.without(clean(2100, seed=seed), np.arange(at, at + length))
    recording = conditioned(stream)
    assert corruption.defects_in(recording) == ["time_gap"]
    assert rows_of(found(recording, "time_gap")[0]) == [row(at)]
    assert found(recording, "time_gap")[0].after["missing"] == length


@settings(max_examples=60)
@given(st.integers(50, 1900), st.floats(0.15, 1000.0), st.booleans(), st.integers(0, 10**6))
def test_a_change_of_the_clock_anywhere_is_found_in_its_row(at, by, ahead, seed):
    stream = clean(2000, seed=seed)
    values(stream, "t")[at:] += by if ahead else -by
    with pytest.raises(InputError) as error:
        conditioned(stream)
    assert f"line {row(at)}" in str(error.value)


def test_the_median_of_a_long_column_needs_no_whole_copy():
    assert sum(p.stop - p.start for p in intervals.places(10**8)) <= intervals.SAMPLED
    assert intervals.places(10**8)[-1].stop == 10**8


@pytest.mark.skipif(not os.environ.get("SIMCOMPARE_DATA"), reason="SIMCOMPARE_DATA is not set")
def test_real_clocks_are_judged_as_a_person_would():
    import pandas as pd

    folder = Path(os.environ["SIMCOMPARE_DATA"])
    imu = pd.read_csv(folder / "imu_xio/sensor_data.csv").iloc[:, :2].to_numpy()
    recording = conditioned(corruption.of_columns(imu[:, 0], x=imu[:, 1]))
    (gaps,) = found(recording, "time_gap")
    # ten times, two packets of the radio are missing
    assert (gaps.count, gaps.after["missing"]) == (10, 20)
    assert rows_of(gaps)[0] == row(1736)
    for name in ("designA0_noise_20220815", "designC1_sysid_20230629-143339"):
        arm = pd.read_csv(folder / f"double_pendulum/{name}.csv").iloc[:, :3].to_numpy()
        recording = conditioned(corruption.of_columns(arm[:, 0], a=arm[:, 1], b=arm[:, 2]))
        assert corruption.defects_in(recording) == []


@pytest.mark.parametrize("count", [40, 500])
def test_a_rounded_stamp_that_stands_twice_is_kept_and_unsure(count):
    time = np.arange(count) / 100
    time[20:] -= 0.01  # sample 20 has the stamp of the one before
    time[30:] += 0.01  # and here one is lost
    recording = conditioned(corruption.of_columns(time, x=np.sin(np.arange(count))))
    (told,) = found(recording, "whole_seconds")
    assert "multiples of 0.01 s" in told.text
    assert rows_of(told) == [row(20)]
    stream = recording.streams["log"]
    assert stream.clock.u_s == pytest.approx(0.01 / np.sqrt(12))
    # all lie within the half step to which their stamps are rounded
    assert np.abs(stream.time_s - stream.time_s[0] - time).max() < 0.005


@pytest.mark.parametrize("ahead", [1, 3])
def test_a_few_stale_rows_are_left_out_together(ahead):
    time = np.concatenate((55 + np.arange(ahead) / 100, np.arange(300) / 100))
    recording = conditioned(corruption.of_columns(time, x=np.sin(np.arange(len(time)))))
    assert len(recording.streams["log"].time_s) == 300
    (told,) = found(recording, "stale_first_row")
    assert rows_of(told) == [row(i) for i in range(ahead)]


@pytest.mark.parametrize(
    ("period_s", "word"),
    [(65.536, "16 bits"), (2.0**32 * 1e-6, "32 bits"), (2.0**32 * 1e-3, "32 bits"),
     (86_400.0, "midnight")],
)  # fmt: skip
def test_a_clock_that_begins_again_is_counted_on(period_s, word):
    true = period_s - 1.0 + np.arange(300) / 100
    recording = conditioned(corruption.of_columns(true % period_s, x=np.sin(np.arange(300))))
    (told,) = found(recording, "clock_wrap")
    assert word in told.text
    # a microsecond: 7 digits behind 4e6 s are what a float holds
    assert recording.streams["log"].time_s == pytest.approx(np.arange(300) / 100, abs=1e-6)


def test_a_run_that_begins_again_elsewhere_is_no_wrap():
    time = np.concatenate((np.arange(3000) / 100, 10 + np.arange(3000) / 100))
    with pytest.raises(InputError, match="goes back by"):
        conditioned(corruption.of_columns(time, x=np.random.default_rng(3).normal(size=6000)))


def test_rows_from_before_the_clock_was_set_are_left_out():
    time = np.concatenate((5 + np.arange(40.0), 1.7e9 + np.arange(300)))
    recording = conditioned(corruption.of_columns(time, x=np.sin(np.arange(340))))
    assert len(recording.streams["log"].time_s) == 300
    assert found(recording, "clock_set")[0].count == 40


def test_a_log_that_ends_early_names_one_and_the_same_row():
    stream = clean(100)
    stream.truncated = f"line {row(100)} ends in the middle; it was left out"
    (told,) = found(conditioned(stream), "truncated")
    assert f"after line {row(99)}: line {row(100)}" in told.text
    assert told.rows == ((row(99), row(99)),)


def test_a_column_that_increases_is_proposed_as_the_time():
    stream = clean(100)
    stream.columns[0].name, stream.time = "ticker", None
    with pytest.raises(InputError, match=r"'ticker' increases .*: time: {column: ticker, unit: s}"):
        conditioned(stream)
