"""Values: sentinels, holes, wraps and clipping are found in the very rows; good data are left."""

from __future__ import annotations

import os
import warnings
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from simcompare.errors import InputError
from simcompare.hardware import raw as raw_module
from simcompare.hardware.mapping import of_tree
from simcompare.hardware.raw import RawColumn
from tests import corruption
from tests.corruption import DEFECTS, OF_VALUES, clean, conditioned, found, row, rows_of, values

REPAIRED = [name for name in OF_VALUES if DEFECTS[name]().severity != "fault"]
REFUSED = [name for name in OF_VALUES if DEFECTS[name]().severity == "fault"]


@pytest.mark.parametrize("name", REPAIRED)
def test_a_defect_of_values_is_recorded_with_its_exact_rows(name):
    damaged = DEFECTS[name]()
    recording = conditioned(damaged.stream, mapping=damaged.mapping)
    (repair,) = found(recording, damaged.rule)
    assert rows_of(repair) == damaged.rows
    assert (repair.severity, repair.channel) == (damaged.severity, damaged.channel)
    assert (repair.count, repair.stream) == (len(damaged.rows), "log")
    assert corruption.defects_in(recording) == [damaged.rule, *damaged.tells]


@pytest.mark.parametrize("name", REPAIRED)
def test_strict_mode_refuses_what_would_be_repaired_and_names_the_row(name):
    damaged = DEFECTS[name]()
    with pytest.raises(InputError) as error:
        conditioned(damaged.stream, "strict", damaged.mapping)
    message = str(error.value)
    assert f"({damaged.rule}; refused by --strict)" in message
    first = damaged.rows[0]
    assert f"row {first}" in message or f"rows {first} to" in message
    if damaged.channel:
        assert f"column '{damaged.channel}'" in message


@pytest.mark.parametrize("mode", ["strict", "repair"])
@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_repaired_is_refused_and_row_and_column_named(name, mode):
    damaged = DEFECTS[name]()
    with pytest.raises(InputError) as error:
        conditioned(damaged.stream, mode, damaged.mapping)
    message = str(error.value)
    assert message.startswith(f"test.csv: line {damaged.rows[0]}, column '{damaged.channel}': ")
    assert f"({damaged.rule})" in message


def many_holes(name):
    """A good log of which one column misses every fifteenth value."""
    stream = clean()
    values(stream, name)[30:1990:15] = np.nan
    return stream


def test_a_channel_of_many_holes_is_left_out_and_named():
    recording = conditioned(many_holes("sine"))
    channels = recording.streams["log"].channels
    assert {one.raw for one in channels.values()} == {"slope", "walk", "amplitude"}
    (told,) = found(recording, "missing_values")
    assert (told.severity, told.channel, told.count) == ("warning", "sine", 131)
    assert told.text == (
        "131 values are missing here and there (6.5 % of the samples, more than 5 %): the channel"
        " is not sound, so it was left out"
    )
    (left_out,) = [one for one in recording.provenance.conversions if one.raw == "sine"]
    assert (left_out.channel, left_out.reason) == ("", told.text.split(":")[0])


def test_strict_mode_refuses_a_channel_of_many_holes():
    with pytest.raises(InputError, match=r"^test.csv: column 'sine', row 34 and 130 more: 131 "):
        conditioned(many_holes("sine"), "strict")


def test_a_channel_of_many_holes_is_refused_where_the_mapping_wants_it():
    wanted = of_tree({"channels": {"sine": {"column": "sine", "unit": "V"}}}, "map")
    with pytest.raises(InputError, match=r"^test.csv: line 34, column 'sine': .*the mapping file"):
        conditioned(many_holes("sine"), mapping=wanted)


def test_a_log_of_nothing_but_many_holes_is_refused():
    stream = many_holes("sine")
    stream.columns = stream.columns[:2]
    with pytest.raises(InputError, match=r"^test.csv: column 'sine': 131 values are missing"):
        conditioned(stream)


def test_a_camera_loses_a_body_and_its_gaps_stay_gaps():
    stream = many_holes("sine")
    stream.column("sine").unit = "cm"
    made = conditioned(stream).streams["log"].channels["sine_m"].values
    assert np.array_equal(np.isnan(made), np.isnan(values(stream, "sine")))


@pytest.mark.parametrize("name", REPAIRED)
def test_good_samples_are_the_same_to_the_bit(name):
    damaged = DEFECTS[name]()
    stream = conditioned(damaged.stream, mapping=damaged.mapping).streams["log"]
    true_time = values(damaged.truth, "t")
    assert np.array_equal(stream.time_s, true_time - true_time[0])
    touched = {line - row(0) for line in damaged.rows} | set(damaged.lost)
    for column in damaged.truth.columns[1:]:
        made = next(c for c in stream.channels.values() if c.raw == column.name)
        good = np.ones(len(made.values), dtype=bool)
        if column.name == damaged.channel and damaged.rule not in ("counter_wrap", "signed_number"):
            good[list(touched)] = False
        assert np.array_equal(made.values[good], column.values[good])


@pytest.mark.parametrize("name", REPAIRED)
def test_the_period_of_the_sine_changes_by_less_than_its_uncertainty(name):
    damaged = DEFECTS[name]()
    before, u_before = _period(conditioned(damaged.truth).streams["log"])
    after, u_after = _period(conditioned(damaged.stream, mapping=damaged.mapping).streams["log"])
    assert abs(after - before) <= np.hypot(u_before, u_after)
    assert abs(after - corruption.PERIOD_S) <= 3 * u_after


def _period(stream):
    """Period by linear least squares around the true one, without saturated samples."""
    rate, t = 2 * np.pi / corruption.PERIOD_S, stream.time_s
    channel = stream.channels["sine_V"]
    table = np.stack([np.sin(rate * t), np.cos(rate * t), t * np.cos(rate * t)], axis=1)
    good = np.isfinite(channel.values)
    if channel.saturated is not None:
        # samples beside those marked may be cut as well, in stretches too short to be told
        good &= ~channel.saturated & (np.abs(channel.values) < 0.79)
    y, table = channel.values[good], table[good]
    best, *_ = np.linalg.lstsq(table, y, rcond=None)
    scatter = np.std(y - table @ best)
    u = scatter * np.sqrt(np.linalg.inv(table.T @ table)[2, 2])
    return 2 * np.pi / (rate + best[2]), 2 * np.pi / rate**2 * u


def test_what_is_missing_is_nan_and_never_0():
    damaged = DEFECTS["sentinel"]()
    sine = conditioned(damaged.stream).streams["log"].channels["sine_V"].values
    assert np.isnan(sine[damaged.lost]).all()
    assert np.isfinite(sine).sum() == 2000 - len(damaged.lost)


def test_interpolated_values_are_right_within_the_stated_uncertainty():
    damaged = DEFECTS["short_holes"]()
    recording = conditioned(damaged.stream)
    (repair,) = found(recording, "interpolated")
    samples = [line - row(0) for line in damaged.rows]
    off = recording.streams["log"].channels["sine_V"].values[samples]
    off = off - values(damaged.truth, "sine")[samples]
    assert np.abs(off).max() < 3 * repair.after["u"]
    assert repair.after["u"] < 0.005
    assert (repair.before["missing"], repair.after["missing"]) == (6, 0)


def test_interpolated_values_are_less_sure_than_measured_ones():
    damaged = DEFECTS["short_holes"]()
    damaged.stream.column("sine").u = 0.002
    recording = conditioned(damaged.stream)
    u = recording.streams["log"].channels["sine_V"].u
    samples = [line - row(0) for line in damaged.rows]
    assert u[149] == 0.002
    assert (u[samples] > 0.003).all()


def test_noise_is_not_interpolated():
    stream = clean()
    stream.column("walk").values = np.random.default_rng(1).normal(size=2000)
    values(stream, "walk")[700] = np.nan
    recording = conditioned(stream)
    assert corruption.defects_in(recording) == ["missing_values"]
    assert np.isnan(recording.streams["log"].channels["walk_V"].values[700])


def test_a_switch_is_not_interpolated():
    stream = clean()
    stream.column("walk").values = np.repeat([0.0, 1.0, 0.0, 1.0], 500)
    values(stream, "walk")[500] = np.nan
    recording = conditioned(stream)
    assert np.isnan(recording.streams["log"].channels["walk_V"].values[500])


def test_nothing_is_interpolated_beside_a_gap_of_the_clock():
    stream = clean()
    values(stream, "sine")[700] = np.nan
    recording = conditioned(corruption.without(stream, [702, 703, 704]))
    assert corruption.defects_in(recording) == ["time_gap", "missing_values"]


def test_a_channel_that_is_sampled_more_slowly_is_left_as_it_is():
    stream = clean()
    sine = values(stream, "sine")
    sine[np.arange(2000) % 10 != 3] = np.nan
    recording = conditioned(stream, "strict")
    made = recording.streams["log"].channels["sine_V"].values
    assert np.isfinite(made).sum() == 200
    assert found(recording, "sparse_channel")[0].channel == "sine"


def test_a_channel_that_begins_late_is_left_as_it_is():
    stream = clean()
    values(stream, "sine")[:300] = np.nan
    recording = conditioned(stream)
    assert corruption.defects_in(recording) == ["missing_at_ends"]
    assert rows_of(found(recording, "missing_at_ends")[0]) == [row(i) for i in range(300)]


def test_a_derivative_that_is_missing_at_its_two_ends_is_no_defect():
    stream = clean()
    values(stream, "sine")[[0, -1]] = np.nan
    recording = conditioned(stream, "strict")
    assert found(recording, "missing_at_ends")[0].severity == "info"


def test_a_long_outage_is_marked_but_the_rest_may_be_used():
    stream = clean()
    values(stream, "sine")[800:1100] = np.nan
    recording = conditioned(stream)
    assert corruption.defects_in(recording) == ["missing_values"]
    assert "more than 10 in a row" in found(recording, "missing_values")[0].text


def test_a_channel_without_values_is_refused_where_the_mapping_wants_it():
    stream = clean()
    values(stream, "sine")[:] = np.nan
    assert found(conditioned(stream), "empty_channel")[0].severity == "info"
    mapping = of_tree({"channels": {"sine": {"column": "sine", "unit": "V"}}}, "map")
    with pytest.raises(InputError, match="column 'sine': holds no values at all"):
        conditioned(stream, mapping=mapping)


def test_rows_that_hold_nothing_are_no_samples():
    stream = clean()
    for column in stream.columns:
        column.values[[500, 1999]] = np.nan
    made = conditioned(stream)
    assert corruption.defects_in(made) == ["time_gap"]  # one of them was in the middle
    assert rows_of(found(made, "empty_row")[0]) == [row(500), row(1999)]
    assert len(made.streams["log"].time_s) == 1998


@pytest.mark.parametrize("mark", [-999.0, -9999.0, 8191.0, 32767.0, 65535.0, 255.0, 1e30])
def test_usual_sentinels_are_found_far_outside_all_other_values(mark):
    stream = clean()
    values(stream, "sine")[[77, 1500]] = mark
    (repair,) = found(conditioned(stream), "sentinel")
    assert rows_of(repair) == [row(77), row(1500)]
    assert repair.before["value"] == mark


@pytest.mark.parametrize("mark", [-999.0, 8191.0, 65535.0, 255.0])
def test_the_same_numbers_within_the_range_of_a_channel_are_values(mark):
    stream = clean()
    stream.column("walk").values = np.round(1e5 * np.sin(np.arange(2000) / 300))
    values(stream, "walk")[100] = mark
    assert corruption.defects_in(conditioned(stream)) == []


def test_a_command_that_is_255_for_long_is_a_value():
    stream = clean()
    command = np.zeros(2000)
    command[500:1500] = 255.0
    command[200:400] = np.arange(200) % 17
    stream.column("walk").values = command
    assert corruption.defects_in(conditioned(stream)) == []


def test_a_column_of_nothing_but_a_sentinel_is_named():
    stream = clean()
    stream.column("walk").values = np.full(2000, -9999.0)
    recording = conditioned(stream)
    assert corruption.defects_in(recording) == ["constant_sentinel"]
    assert (recording.streams["log"].channels["walk_V"].values == -9999).all()


def test_saturated_samples_are_marked_and_their_values_left():
    damaged = DEFECTS["at_limits"]()
    channel = conditioned(damaged.stream).streams["log"].channels["sine_V"]
    assert np.flatnonzero(channel.saturated).tolist() == [line - row(0) for line in damaged.rows]
    assert np.array_equal(channel.values, values(damaged.stream, "sine"))


def test_limits_of_the_mapping_are_limits_of_the_raw_values():
    stream = clean()
    stream.column("sine").values = np.clip(values(stream, "sine"), -0.9, 0.9) * 1000
    mapping = of_tree(
        {"channels": {"sine": {
            "column": "sine", "unit": "V", "scale": 1e-3, "limits": [-900, 900]}}}, "map"
    )  # fmt: skip
    channel = conditioned(stream, mapping=mapping).streams["log"].channels["sine_V"]
    assert channel.saturated.sum() == len(DEFECTS["at_limits"]().rows)


def test_two_samples_at_the_end_of_the_range_may_be_a_true_peak():
    stream = clean()
    stream.column("walk").values = np.sin(np.arange(2000) * 1.1)
    stream.column("walk").limits = (-5.0, 5.0)
    values(stream, "walk")[[400, 401, 900]] = 5.0
    assert corruption.defects_in(conditioned(stream)) == []


def test_a_converter_of_12_bits_at_its_end_is_saturated():
    stream = clean()
    level = np.round(2048 + 2500 * np.sin(np.arange(2000) / 60))
    stream.column("walk").values = np.clip(level, 0, 4095)
    channel = conditioned(stream).streams["log"].channels["walk_V"]
    over = level > 4095
    assert channel.saturated[over].all()
    assert not channel.saturated[level < 4095].any()


def test_a_wrap_within_a_gap_is_said_to_be_unsure():
    stream = clean()
    turned = np.floor(100 + 150.0 * np.arange(2000))
    stream.columns.append(RawColumn("encoder", np.mod(turned, 65536), "1"))
    recording = conditioned(corruption.without(stream, np.arange(1000, 1300)))
    assert "counter_wrap_in_gap" in corruption.defects_in(recording)


def test_a_square_wave_of_8_bits_is_no_counter():
    stream = clean()
    stream.column("walk").values = np.where(np.arange(2000) // 50 % 2, 255.0, 0.0)
    assert corruption.defects_in(conditioned(stream)) == []


def test_random_bytes_are_no_counter():
    stream = clean()
    stream.column("walk").values = np.random.default_rng(1).integers(0, 256, 2000).astype(float)
    assert corruption.defects_in(conditioned(stream)) == []


@pytest.mark.parametrize(
    ("said", "raw", "expected"),
    [
        ({"unit": "deg", "u": 0.5}, None, np.radians(0.5)),
        ({"unit": "deg", "u": 0.5, "scale": 0.01, "sign": -1}, 7.0, np.radians(0.5)),
        ({"unit": "deg", "scale": 0.01}, 7.0, np.radians(0.07)),
        ({"unit": "deg", "scale": -2.0}, 7.0, np.radians(14.0)),
        ({"unit": "deg"}, None, None),
    ],
)
def test_uncertainty_is_in_the_unit_of_who_gives_it(said, raw, expected):
    """The mapping's is in the mapping's unit; that of the log in the unit of the raw values."""
    stream = clean()
    stream.column("sine").u = raw
    mapping = of_tree({"channels": {"angle": {"column": "sine", **said}}}, "map")
    u = conditioned(stream, mapping=mapping).streams["log"].channels["angle_rad"].u
    assert u == (None if expected is None else pytest.approx(expected))


def test_one_column_may_become_two_channels():
    mapping = of_tree(
        {"channels": {
            "angle": {"column": "sine", "unit": "deg"},
            "height": {"column": "sine", "unit": "mm", "offset": 1.0}}}, "map"
    )  # fmt: skip
    stream = clean()
    made = conditioned(stream, mapping=mapping).streams["log"].channels
    assert np.allclose(made["angle_rad"].values, np.radians(values(stream, "sine")))
    assert np.allclose(made["height_m"].values, 1e-3 * (values(stream, "sine") + 1))


def test_two_columns_that_would_become_one_channel_are_told_apart():
    stream = clean()
    stream.columns[2].name = "Sine"
    made = conditioned(stream)
    assert [c.raw for c in made.streams["log"].channels.values()].count("Sine") == 1
    assert made.streams["log"].channels["sine_2_V"].raw == "Sine"


def test_a_column_without_a_unit_is_left_out_with_the_line_that_keeps_it():
    stream = clean()
    stream.columns[2].unit = ""
    made = conditioned(stream)
    (left,) = [c for c in made.provenance.conversions if not c.channel]
    assert (left.raw, left.reason) == ("slope", "no unit is known")
    again = clean()
    again.columns[2].unit = ""
    kept = conditioned(again, mapping=of_tree(yaml.safe_load(left.cure), "map"))
    assert kept.streams["log"].channels["slope"].unit == "1"


def test_a_column_without_a_unit_is_refused_by_strict():
    stream = clean()
    stream.columns[2].unit = ""
    with pytest.raises(InputError, match=r"'slope': no unit is known.*channels: {slope: "):
        conditioned(stream, mode="strict")


def test_long_columns_give_the_same_in_small_blocks(monkeypatch):
    whole = {}
    for name in REPAIRED:
        damaged = DEFECTS[name]()
        whole[name] = conditioned(damaged.stream, mapping=damaged.mapping)
    monkeypatch.setattr(raw_module, "BLOCK", 97)
    for name, expected in whole.items():
        damaged = DEFECTS[name]()
        recording = conditioned(damaged.stream, mapping=damaged.mapping)
        assert recording.provenance.repairs == expected.provenance.repairs
        for key, channel in recording.streams["log"].channels.items():
            other = expected.streams["log"].channels[key]
            assert np.array_equal(channel.values, other.values, equal_nan=True)


def _walk(count, chance):
    return np.cumsum(chance.normal(size=count))


def _sine(count, chance):
    return np.sin(np.arange(count) * 10 ** chance.uniform(-3, 0.4) + chance.uniform(0, 6))


def _noisy_sine(count, chance):
    return _sine(count, chance) + 10 ** chance.uniform(-6, 0) * chance.normal(size=count)


def _constant(count, chance):
    return np.full(count, chance.choice([0.0, 1.0, 255.0, 65535.0, 3.3, chance.normal()]))


def _step(count, chance):
    low, high = chance.choice([0.0, 1.0, 255.0, 5.0, 4095.0, chance.normal()], 2, replace=False)
    edges = np.sort(chance.integers(0, count + 1, chance.integers(1, 6)))
    levels = np.searchsorted(edges, np.arange(count), side="right") % 2
    return np.where(levels == 1, high, low)


def _ramp_and_hold(count, chance):
    return np.clip(np.arange(count) * chance.uniform(0.001, 0.3) - 5, 0, chance.uniform(1, 50))


def _coarse(count, chance):
    made = chance.choice([_walk, _sine, _noisy_sine])(count, chance)
    step = np.ptp(made) / chance.integers(2, 300) if np.ptp(made) > 0 else 1.0
    return np.round(made / step) * step


def _counts(count, chance):
    made = chance.choice([_walk, _sine, _noisy_sine])(count, chance)
    return np.round(made * 10 ** chance.uniform(0, 5))


def _decay(count, chance):
    t = np.arange(count)
    rate = chance.uniform(0.01, 0.5)
    return np.exp(-t * 10 ** chance.uniform(-4, -1)) * np.cos(rate * t) + chance.normal()


def _charging(count, chance):
    return 5 * (1 - np.exp(-np.arange(count) / chance.uniform(1, 300)))


def _held_then_released(count, chance):
    """A pendulum in the hand at an encoder's resolution, then swinging."""
    at = chance.integers(0, count)
    t = np.maximum(np.arange(count) - at, 0)
    swing = 1.6 * np.cos(chance.uniform(0.01, 0.4) * t) * np.exp(-t / 500)
    return np.round(swing / 1.5e-4) * 1.5e-4


def _count_up(count, chance):
    return np.arange(count, dtype=float) + chance.integers(0, 1000)


SIGNALS = (
    _walk, _sine, _noisy_sine, _constant, _step, _ramp_and_hold, _coarse, _counts, _decay,
    _charging, _held_then_released, _count_up,
)  # fmt: skip


@settings(max_examples=400)
@given(st.sampled_from(SIGNALS), st.integers(2, 3000), st.integers(0, 10**6))
def test_good_values_are_never_called_defective(signal, count, seed):
    x = signal(count, np.random.default_rng(seed))
    recording = conditioned(corruption.of_columns(np.arange(count) / 100, x=x))
    assert corruption.defects_in(recording) == []
    assert np.array_equal(recording.streams["log"].channels["x_V"].values, x)


@settings(max_examples=100)
@given(
    st.sampled_from([-999.0, -9999.0, 9999.0, 1e30]), st.lists(st.integers(0, 999), min_size=1,
    max_size=40, unique=True), st.integers(0, 10**6),
)  # fmt: skip
def test_sentinels_anywhere_become_missing_and_are_named(mark, samples, seed):
    stream = clean(1000, seed=seed)
    values(stream, "slope")[samples] = mark
    recording = conditioned(stream)
    assert rows_of(found(recording, "sentinel")[0]) == [row(i) for i in sorted(samples)]
    made = recording.streams["log"].channels["slope_V"].values
    assert not (made == mark).any()
    good = np.setdiff1d(np.arange(1000), samples)
    assert np.array_equal(made[good], values(stream, "slope")[good])


@settings(max_examples=60)
@given(st.sampled_from([8, 16, 32]), st.integers(0, 10**6), st.booleans())
def test_counters_that_wrap_are_unwrapped_to_the_bit(bits, seed, signed):
    chance = np.random.default_rng(seed)
    range_ = 2.0**bits
    speed = range_ / 40
    steps = speed * np.sin(np.arange(3000) / chance.uniform(200, 600) + chance.uniform(0, 6))
    turned = np.round(chance.uniform(0, range_ / 2) + np.cumsum(steps))
    low = -range_ / 2 if signed else 0.0
    wrapped = np.mod(turned - low, range_) + low
    stream = clean(3000)
    stream.columns.append(RawColumn("encoder", wrapped, "1"))
    made = conditioned(stream).streams["log"].channels["encoder"].values
    shift = turned[0] - made[0]
    assert np.array_equal(made + shift, turned)
    assert shift % range_ == 0


@pytest.mark.skipif(not os.environ.get("SIMCOMPARE_DATA"), reason="SIMCOMPARE_DATA is not set")
def test_the_load_of_a_real_servo_is_signed_and_its_angles_are_left_alone():
    import json

    folder = Path(os.environ["SIMCOMPARE_DATA"]) / "servo_pendulum_xl330/xl330_raw"
    entries = json.loads((folder / "2026-01-15_10h28m10.json").read_text())["entries"]
    columns = {k: [float(e[k]) for e in entries] for k in ("position", "load", "input_volts")}
    recording = conditioned(corruption.of_columns([e["timestamp"] for e in entries], **columns))
    assert corruption.defects_in(recording) == ["signed_number"]
    load = recording.streams["log"].channels["load_V"].values
    assert (load.min(), load.max()) == (-328, 335)


@pytest.mark.parametrize("stated", [None, 0.01])
def test_what_was_interpolated_is_less_sure_wherever_the_uncertainty_comes_from(stated):
    stream = clean()
    values(stream, "sine")[500] = np.nan
    mapping = {"channels": {"sine": {"column": "sine", "unit": "mV", "u": 10.0, "sign": -1}}}
    stream.column("sine").u = None if stated is None else stated * 1000
    stream.column("sine").unit = "mV"
    channel = (
        conditioned(stream, mapping=of_tree(mapping if stated is None else {}, "map"))
        .streams["log"]
        .channels["sine_V"]
    )
    (told,) = found(conditioned(_with_hole("sine", 500)), "interpolated")
    assert channel.u[499] == pytest.approx(0.01)
    assert channel.u[500] == pytest.approx(np.hypot(0.01, told.after["u"] / 1000))


def _with_hole(name, sample):
    stream = clean()
    values(stream, name)[sample] = np.nan
    return stream


def test_an_uncertainty_that_is_not_known_stays_so():
    assert conditioned(_with_hole("sine", 500)).streams["log"].channels["sine_V"].u is None


def test_a_missing_value_of_any_bit_pattern_does_not_hide_a_mark():
    stream = clean(500)
    values = stream.columns[1].values
    values[7:9] = -999.0
    # signalling; as the last of them, it is the extreme that NumPy finds
    values[-1:] = np.array([0x7FF0_0000_0000_0001], np.uint64).view(float)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        made = conditioned(stream)
    (told,) = found(made, "sentinel")
    assert told.count == 2
