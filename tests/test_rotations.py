"""Rotations of recordings, held against scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from simcompare.model import rotations

angle = st.floats(-3.0, 3.0)
vector = st.tuples(angle, angle, angle).map(np.array)


def scipy_of(wxyz):
    return Rotation.from_quat(np.roll(wxyz, -1))


@given(vector)
def test_a_quaternion_is_the_rotation_of_its_vector(v):
    (q,) = rotations.quaternions_of(v[None, :])
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-14)
    expected = Rotation.from_rotvec(v).as_matrix()
    assert rotations.matrix_of(q) == pytest.approx(expected, abs=1e-12)


@given(vector)
def test_vector_and_quaternion_are_inverse(v):
    (q,) = rotations.quaternions_of(v[None, :])
    for sign in (1, -1):  # q and -q are the same rotation
        back = rotations.rotation_vector_of(sign * q)
        assert Rotation.from_rotvec(back).as_matrix() == pytest.approx(
            scipy_of(q).as_matrix(), abs=1e-12
        )


@given(v=vector, x=vector)
def test_vectors_are_turned_from_body_to_world(v, x):
    (q,) = rotations.quaternions_of(v[None, :])
    (turned,) = rotations.rotate(q[None, :], x[None, :])
    assert turned == pytest.approx(scipy_of(q).apply(x), abs=1e-12)


def test_a_quarter_turn_about_z_takes_x_to_y():
    (q,) = rotations.quaternions_of(np.array([[0.0, 0.0, np.pi / 2]]))
    assert q == pytest.approx([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    assert rotations.rotate(q[None, :], np.array([[1.0, 0, 0]]))[0] == pytest.approx([0, 1, 0])


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-160, 1e-8])
def test_rotations_too_small_to_be_seen_keep_their_direction(size):
    (q,) = rotations.quaternions_of(np.array([[size, 0.0, 0.0]]))
    assert q[0] == pytest.approx(1.0)
    assert rotations.rotation_vector_of(q) == pytest.approx([size, 0, 0], rel=1e-9)


def test_whole_recordings_are_turned_row_by_row():
    rng = np.random.default_rng(1)
    v, x = rng.normal(size=(2, 50, 3))
    turned = rotations.rotate(rotations.quaternions_of(v), x)
    assert turned == pytest.approx(Rotation.from_rotvec(v).apply(x), abs=1e-12)
