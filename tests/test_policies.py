"""Policies as files, and how well they do: NumPy alone, all faults of a file, intervals."""

import contextlib
import itertools
import math

import numpy as np
import pytest

from simcompare.errors import InputError, NoSuchFile
from simcompare.learning import policy

RNG = np.random.default_rng(3)


def made(*sizes, **changes):
    layers = [(RNG.normal(size=(b, a)), RNG.normal(size=b)) for a, b in itertools.pairwise(sizes)]
    mean, deviation = RNG.normal(size=sizes[0]), RNG.uniform(0.5, 2, sizes[0])
    whole = {
        "mean": mean,
        "deviation": deviation,
        "layers": layers,
    }
    return policy.Policy(**{**whole, **changes})


def test_a_policy_is_layers_with_tanh_between_them():
    net = made(3, 4, 2)
    seen = np.array((0.1, -0.2, 0.3))
    (w, b), (v, c) = net.layers
    standard = (seen - net.mean) / net.deviation
    expected = v @ np.tanh(w @ standard + b) + c
    np.testing.assert_allclose(net(seen), np.clip(expected, -1, 1), atol=1e-12)
    assert np.abs(net(1e9 * seen)).max() <= 1


def test_a_file_brings_back_what_was_saved(tmp_path):
    net = made(5, 8, 8, 2, recipe={"seed": 3, "engine": "toy"})
    net.save(tmp_path / "net.npz")
    back = policy.load(str(tmp_path / "net.npz"), 5, 2)
    assert back.recipe == {"seed": 3, "engine": "toy"}
    seen = RNG.normal(size=5)
    # single precision: 24 bits of each of a few dozen products
    np.testing.assert_allclose(back(seen), net(seen), atol=1e-5)


def test_a_policy_of_another_environment_is_told_all_at_once(tmp_path):
    made(5, 8, 3).save(tmp_path / "net.npz")
    with pytest.raises(InputError) as caught:
        policy.load(tmp_path / "net.npz", 7, 2)
    said = str(caught.value)
    assert len(caught.value.faults) == 4
    assert "net.npz" in said
    assert "mean has shape (5,); the observation of the environment has 7" in said
    assert "layer 0 has weights (8, 5) and biases (8,); expected (8, 7) and (8,)" in said
    assert "layer 1 has weights (3, 8) and biases (3,); expected (2, 8) and (2,)" in said
    assert "take a policy that was learnt in this environment" in said


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"mean": np.full(5, np.nan)}, "mean: not all numbers are finite"),
        ({"deviation": np.zeros(5)}, "deviation: not all numbers are above 0"),
    ],
)
def test_numbers_that_a_policy_cannot_have_are_told(tmp_path, changes, words):
    made(5, 4, 2, **changes).save(tmp_path / "net.npz")
    with pytest.raises(InputError, match=words):
        policy.load(tmp_path / "net.npz", 5, 2)


def test_what_is_no_policy_is_told(tmp_path):
    with pytest.raises(NoSuchFile):
        policy.load(tmp_path / "none.npz", 5, 2)
    (tmp_path / "text.npz").write_text("not an archive")
    with pytest.raises(InputError, match="is no policy"):
        policy.load(tmp_path / "text.npz", 5, 2)
    np.savez(tmp_path / "other.npz", mean=np.zeros(5))
    with pytest.raises(InputError, match="deviation, weight_0: not in the file"):
        policy.load(tmp_path / "other.npz", 5, 2)
    np.save(tmp_path / "array.npy", np.zeros(5))
    with pytest.raises(InputError, match="is no policy"):
        policy.load(tmp_path / "array.npy", 5, 2)
    # objects would be code that a file brings along
    np.savez(tmp_path / "code.npz", mean=np.array([print], dtype=object))
    with pytest.raises(InputError, match="is no policy"):
        policy.load(tmp_path / "code.npz", 5, 2)


@pytest.mark.parametrize(
    ("at", "byte"),
    [(8, 1), (10, 99)],  # of an entry in the archive's directory: locked, compressed unknown
)
def test_a_damaged_archive_is_no_policy(tmp_path, at, byte):
    made(5, 4, 2).save(tmp_path / "net.npz")
    whole = bytearray((tmp_path / "net.npz").read_bytes())
    whole[whole.find(b"PK\x01\x02") + at] = byte
    (tmp_path / "net.npz").write_bytes(whole)
    with pytest.raises(InputError, match="is no policy"):
        policy.load(tmp_path / "net.npz", 5, 2)


@pytest.mark.parametrize("place", range(60, 400, 20))
def test_bytes_that_were_changed_give_a_policy_or_a_fault(tmp_path, place):
    made(5, 4, 2).save(tmp_path / "net.npz")
    whole = bytearray((tmp_path / "net.npz").read_bytes())
    whole[place] ^= 255
    (tmp_path / "net.npz").write_bytes(whole)
    with contextlib.suppress(InputError):
        assert policy.load(tmp_path / "net.npz", 5, 2)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"mean": np.array(["a"] * 5)}, "mean: expected real numbers, found <U1"),
        ({"mean": np.zeros(5, complex)}, "mean: expected real numbers, found complex128"),
        ({"recipe": np.array("[1]")}, r"is no policy \(its recipe is \[1\]\)"),
        ({"recipe": np.array("[" * 100_000)}, "is no policy"),
        ({"recipe": np.array('{"seed": 1.5, "sensors": "a", "engine": 3}')}, "3 faults"),
    ],
)
def test_arrays_of_other_kinds_are_told(tmp_path, values, words):
    made(5, 4, 2).save(tmp_path / "net.npz")
    with np.load(tmp_path / "net.npz") as file:
        held = dict(file.items())
    np.savez(tmp_path / "net.npz", **held | values)
    with pytest.raises(InputError, match=words):
        policy.load(tmp_path / "net.npz", 5, 2)


def test_wilson_s_interval_is_the_published_one():
    trials = pytest.importorskip("simcompare.learning.trials", exc_type=ImportError)
    # R. G. Newcombe, Statistics in Medicine 17 (1998) 857, table I: 81 of 263, and 0 of 20
    assert trials.wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert trials.wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=5e-5)
    assert trials.wilson(0, 0) == (0.0, 1.0)
    low, high = trials.wilson(20, 20)
    assert (low, high) == (pytest.approx(1 - 0.1611, abs=5e-5), 1.0)
    assert not math.isnan(low)
