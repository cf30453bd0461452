"""Sound recordings: the waveform as it was written, and onsets of impacts on synthetic truth."""

import struct

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.logs import audio_, importers
from simcompare.hardware.mapping import NOTHING, of_tree
from simcompare.hardware.sensors import sound_onsets
from simcompare.model.recording import Provenance

soundfile = pytest.importorskip("soundfile")
RATE = 48000


def bounces(seed, *, snr=10.0, echo=False, count=8, restitution=0.85, rate=RATE, loudness=0.3):
    """Clicks of one ball: decaying sines whose amplitude and intervals fall as e^n, in white noise.

    Args:
        seed: of pitch, decay, times and noise.
        snr: peak of the weakest click over the rms of the noise (10 is 20 dB).
        echo: each click comes again, half as loud, 5 to 28 ms later.
    """
    random = np.random.default_rng(seed)
    times = 0.35 + np.concatenate(([0.0], np.cumsum(0.5 * restitution ** np.arange(count - 1))))
    times += random.uniform(0, 1e-3, count)
    pitch = np.exp(random.uniform(np.log(500), np.log(6000)))
    decay = np.exp(random.uniform(np.log(1e-3), np.log(1e-2)))
    clock = np.arange(round((times[-1] + 0.4) * rate)) / rate
    amplitude = restitution ** np.arange(count)
    peak = np.max(_click(np.arange(0, 5e-3, 1e-6), pitch, decay))
    sound = np.zeros(len(clock))
    for time, size in zip(times, amplitude, strict=True):
        sound += size / peak * _click(clock - time, pitch, decay)
        if echo:
            late = time + random.uniform(5e-3, 28e-3)
            sound += 0.5 * size / peak * _click(clock - late, pitch, decay)
    sound += random.normal(0, amplitude[-1] / snr, len(clock))
    return loudness * sound, times


def _click(time, pitch, decay):
    later = np.maximum(time, 0)
    return np.exp(-later / decay) * np.sin(2 * np.pi * pitch * later)


def found_in(sound, rate=RATE):
    return sound_onsets.onsets(lambda first, end: sound[first:end], len(sound), rate)


def judged(found, times):
    """Errors without the common delay, number of missed and of false onsets."""
    at = np.array([onset.time_s for onset in found])
    near = [int(np.argmin(np.abs(at - time))) for time in times]
    hit = [(k, time) for k, time in zip(near, times, strict=True) if abs(at[k] - time) < 2e-3]
    errors = np.array([at[k] - time for k, time in hit])
    return (
        errors - np.median(errors),
        len(times) - len(hit),
        len(found) - len({k for k, _ in hit}),
    )


def write(path, sound, **more):
    soundfile.write(path, sound, RATE, **more)
    return path


def read(path, mapping=NOTHING):
    return importers.read(path, importers.recognise(path), mapping)


@pytest.mark.parametrize(("echo", "seeds"), [(False, 200), (True, 60)], ids=["dry", "echoes"])
def test_onsets_at_20_decibel_are_right_within_a_tenth_of_a_millisecond_over_many_seeds(
    echo, seeds
):
    worst, missed, false = 0.0, 0, 0
    for seed in range(seeds):
        sound, times = bounces(seed, echo=echo)
        errors, lost, extra = judged(found_in(sound), times)
        worst = max(worst, float(np.abs(errors).max()))
        missed, false = missed + lost, false + extra
    assert (missed, false) == (0, 0)
    # measured: 0.017 ms dry, 0.020 ms with echoes
    assert worst < 0.03e-3


def test_the_stated_uncertainty_covers_the_errors():
    scaled = []
    for seed in range(40):
        sound, times = bounces(seed)
        found = found_in(sound)
        scaled += list(judged(found, times)[0] / [onset.u_s for onset in found])
    assert 0.3 < np.std(scaled) < 1.2


def test_ringing_of_a_steel_plate_is_not_counted_twice():
    clock = np.arange(2 * RATE) / RATE
    random = np.random.default_rng(1)
    sound = random.normal(0, 1e-3, len(clock))
    # two close tones beat every 40 ms and ring for half a second
    for pitch in (2100.0, 2125.0):
        sound += 0.3 * _click(clock - 0.5, pitch, 0.15)
    assert [round(onset.time_s, 3) for onset in found_in(sound)] == [0.5]


@pytest.mark.parametrize("color", [0.0, 0.5, 1.0], ids=["white", "pink", "brown"])
def test_noise_alone_holds_no_impact(color):
    random = np.random.default_rng(7)
    spectrum = np.fft.rfft(random.normal(size=20 * RATE))
    frequency = np.fft.rfftfreq(20 * RATE, 1 / RATE)
    frequency[0] = frequency[1]
    noise = np.fft.irfft(spectrum / frequency**color)
    assert found_in(0.1 * noise / noise.std()) == []


def test_digital_silence_holds_no_impact_and_is_no_obstacle():
    sound, times = bounces(3, snr=1e9)
    sound[np.abs(sound) < 1e-6] = 0.0
    errors, missed, false = judged(found_in(sound), times)
    assert (missed, false) == (0, 0)
    assert np.abs(errors).max() < 0.02e-3
    assert found_in(np.zeros(RATE)) == []


def test_an_impact_on_the_border_of_two_pieces_is_found_once(monkeypatch):
    sound, times = bounces(5)
    whole = [onset.time_s for onset in found_in(sound)]
    # the second click falls on the border
    monkeypatch.setattr(sound_onsets, "_CHUNK", round(times[1] * RATE))
    pieces = [onset.time_s for onset in found_in(sound)]
    assert pieces == pytest.approx(whole, abs=2e-5)


@pytest.mark.parametrize(
    ("suffix", "subtype", "step"),
    [
        ("wav", "PCM_U8", 2**-7), ("wav", "PCM_16", 2**-15), ("wav", "PCM_24", 2**-23),
        ("wav", "PCM_32", 2**-31), ("wav", "FLOAT", 2**-23), ("wav", "DOUBLE", 1e-15),
        ("flac", "PCM_16", 2**-15), ("flac", "PCM_24", 2**-23),
    ],
)  # fmt: skip
def test_every_coding_gives_the_waveform_in_parts_of_full_scale(tmp_path, suffix, subtype, step):
    sound, times = bounces(11, snr=30.0)
    log = read(write(tmp_path / f"b.{suffix}", sound, subtype=subtype))
    (stream,) = log.streams
    (column,) = stream.columns
    assert (column.name, column.unit) == ("sound", "1")
    assert stream.increment_s == 1 / RATE
    assert np.abs(column.values - sound).max() <= step
    assert len(log.events) == len(times)
    assert all(event.name == "impact" and 0 < event.u_s < 1e-4 for event in log.events)
    assert subtype in log.about["coding"]
    assert "50 ppm" in log.about["clock"]


def test_the_value_of_an_event_is_its_peak(tmp_path):
    sound, times = bounces(2, snr=100.0)
    log = read(write(tmp_path / "b.wav", sound, subtype="FLOAT"))
    peaks = [event.value for event in log.events]
    assert peaks == pytest.approx(0.3 * 0.85 ** np.arange(len(times)), rel=0.1)


def test_of_two_channels_the_one_with_less_noise_gives_the_onsets(tmp_path):
    sound, times = bounces(4)
    random = np.random.default_rng(0)
    both = np.column_stack([random.normal(0, 0.1, len(sound)), sound])
    log = read(write(tmp_path / "b.wav", both, subtype="PCM_24"))
    assert [column.name for column in log.streams[0].columns] == ["left", "right"]
    assert log.repairs[0].channel == "right"
    assert len(log.events) == len(times)


def test_a_rate_in_the_mapping_file_overrules_the_header(tmp_path):
    sound, _ = bounces(6)
    path = write(tmp_path / "b.wav", sound)
    true = RATE * 1.001
    log = read(path, of_tree({"time": {"rate_Hz": true}}, "map"))
    plain = read(path)
    ratio = np.array([b.time_s / a.time_s for a, b in zip(log.events, plain.events, strict=True)])
    assert ratio == pytest.approx(1.001, rel=1e-9)
    assert log.streams[0].increment_s == 1 / true


def test_a_sound_becomes_a_recording_with_events(tmp_path):
    sound, times = bounces(8)
    log = read(write(tmp_path / "b.wav", sound))
    made = condition(log, NOTHING, Provenance("b.wav", "", 0, "audio", "1", "strict"))
    assert made.streams["log"].channels["sound"].unit == "1"
    assert made.streams["log"].time_s[-1] == pytest.approx((len(sound) - 1) / RATE)
    assert [event.time_s for event in made.events] == pytest.approx(times, abs=1e-4)
    assert "impacts" in made.provenance.repairs[0].text


def test_a_truncated_file_is_named_with_the_byte(tmp_path):
    sound, _ = bounces(9)
    path = write(tmp_path / "b.wav", sound)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    log = read(path)
    half = len(whole) // 2
    assert f"byte {half}" in log.streams[0].truncated
    assert f"{len(whole) - half} bytes" in log.streams[0].truncated
    assert len(log.streams[0]) == (half - 44) // 2


def test_a_truncated_flac_keeps_what_is_whole(tmp_path):
    sound, _ = bounces(9)
    path = write(tmp_path / "b.flac", sound)
    path.write_bytes(path.read_bytes()[:-20000])
    log = read(path)
    assert 0 < len(log.streams[0]) < len(sound)
    assert "promises" in log.streams[0].truncated
    assert np.abs(log.streams[0].columns[0].values - sound[: len(log.streams[0])]).max() < 1e-4


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"RIFF\x10\0\0\0WAVEfmt ", "cannot be read as a sound recording"),
        (b"fLaC" + bytes(100), "cannot be read as a sound recording"),
    ],
)
def test_what_is_no_sound_is_refused_in_one_sentence(tmp_path, content, says):
    path = tmp_path / "b.wav"
    path.write_bytes(content)
    with pytest.raises(InputError, match=says):
        read(path)


def test_a_header_without_sound_is_refused(tmp_path):
    path = write(tmp_path / "b.wav", np.zeros(0))
    with pytest.raises(InputError, match="holds 0 samples"):
        read(path)


def test_a_slow_signal_in_a_sound_file_is_refused(tmp_path):
    path = tmp_path / "b.wav"
    soundfile.write(path, np.zeros(100), 500)
    with pytest.raises(InputError, match="2000 Hz"):
        read(path)


def test_a_recorder_that_was_switched_off_makes_no_promise(tmp_path):
    sound, times = bounces(9)
    path = write(tmp_path / "b.wav", sound)
    whole = bytearray(path.read_bytes())
    whole[40:44] = struct.pack("<I", 0xFFFFFFFF)
    path.write_bytes(whole)
    log = read(path)
    assert log.streams[0].truncated == ""
    assert len(log.events) == len(times)


def test_only_sound_is_recognised(tmp_path):
    (tmp_path / "a.avi").write_bytes(b"RIFF\x10\0\0\0AVI LIST")
    assert audio_.recognises(importers.head_of(tmp_path / "a.avi")) == 0


def test_a_rate_that_no_sound_has_is_refused_before_its_windows_are_made(tmp_path):
    path = tmp_path / "b.wav"
    soundfile.write(path, np.zeros(100), RATE)
    data = bytearray(path.read_bytes())
    data[24:28] = struct.pack("<I", 10**9)
    path.write_bytes(data)
    with pytest.raises(InputError, match=r"1e\+09 samples in a second; .* 2000 Hz to 2 MHz"):
        read(path)


def test_many_channels_are_read_in_small_pieces(tmp_path, monkeypatch):
    path = tmp_path / "b.wav"
    soundfile.write(path, np.zeros((3000, 64)), RATE)
    asked = []
    read_ = soundfile.SoundFile.read
    monkeypatch.setattr(
        soundfile.SoundFile, "read",
        lambda self, frames, **more: asked.append(frames) or read_(self, frames, **more),
    )  # fmt: skip
    assert len(read(path).streams[0].columns) == 64
    assert max(asked) * 64 <= audio_._BLOCKS[0]
