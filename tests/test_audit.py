"""What was set is what the engine holds, or the run fails and says where."""

from __future__ import annotations

import math

import pytest

from simcompare.errors import ReadBackMismatch
from simcompare.model.audit import Audit


def test_equal_values_pass_and_are_kept_in_order():
    audit = Audit("toy")
    audit.add("ball.mass_kg", 1.0, "mass", (1.0, 1.0), "kg")
    audit.add("gravity_m_s2.z", 0.0, "g", (0.0, -0.0), "m/s²", "why")
    rows = audit.finish()
    assert [row.quantity for row in rows] == ["ball.mass_kg", "gravity_m_s2.z"]
    assert rows[1].note == "why"


def test_every_difference_is_named_with_both_values():
    audit = Audit("toy")
    audit.add("ball.mass_kg", 1.0, "mass", (1.0, 2.0), "kg")
    audit.add("ball.radius_m", 1.0, "radius", (1.0, 1.0), "m")
    audit.add("ball.friction", 0.5, "mu", (0.5, 0.0), "1")
    with pytest.raises(ReadBackMismatch) as error:
        audit.finish()
    assert len(error.value.rows) == 2
    assert error.value.exit_code == 3
    for part in ("toy", "ball.mass_kg", "mass = 1.0", "2.0 kg", "mu = 0.5"):
        assert part in str(error.value)


def test_rounding_of_the_engine_is_allowed_for_as_far_as_it_was_said():
    single = 0.1 * (1 + 5e-8)
    loose, tight = Audit("toy", relative=1e-6), Audit("toy")
    for audit in (loose, tight):
        audit.add("q", 0.1, "q", (0.1, single), "1")
    assert len(loose.finish()) == 1
    with pytest.raises(ReadBackMismatch):
        tight.finish()


def test_what_cannot_be_read_or_was_left_alone_is_no_mismatch():
    audit = Audit("toy")
    audit.add("a", 1.0, "a", (1.0, None), "1", "cannot be read")
    audit.add("b", 1.0, "b", (None, 5.0), "1", "default")
    assert [row.read_value for row in audit.finish()] == [None, 5.0]


@pytest.mark.parametrize("read", [math.nan, math.inf, -1.0])
def test_a_value_that_turned_into_nonsense_is_a_mismatch(read):
    audit = Audit("toy")
    audit.add("q", 1.0, "q", (1.0, read), "1")
    with pytest.raises(ReadBackMismatch):
        audit.finish()


def test_an_infinite_limit_that_was_taken_is_no_mismatch():
    audit = Audit("toy")
    audit.add("hinge.limit", None, "upper", (math.inf, math.inf), "rad")
    assert len(audit.finish()) == 1


def test_numbers_of_any_kind_become_plain_floats():
    import numpy as np

    audit = Audit("toy")
    audit.add("q", np.float32(0.5), "q", (np.int64(1), np.float32(1)), "1")
    (row,) = audit.finish()
    assert [type(v) for v in (row.scenario_value, row.set_value, row.read_value)] == [float] * 3
