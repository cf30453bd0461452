"""A test is skipped for want of its engine only: a skip must never hide a fault."""

import pytest

from simcompare.engine import engines
from simcompare.errors import EngineBroken, EngineMissing
from tests import present


@pytest.mark.parametrize(
    "error",
    [EngineMissing("toy", "toy_module", ""), ModuleNotFoundError("?", name="toy_module")],
)
def test_what_an_absent_engine_makes_fail_is_skipped_by_its_name(monkeypatch, error):
    monkeypatch.setitem(present.ABSENT, "toy_module", "toy")
    with pytest.raises(pytest.skip.Exception) as caught, present.skipping_without_its_engine():
        raise error
    assert str(caught.value) == "toy is not installed"


@pytest.mark.parametrize(
    "error",
    [
        EngineMissing("toy", "another_module", ""),
        ModuleNotFoundError("?", name="another_module"),
        EngineBroken("toy cannot be imported"),
        ImportError("?", name="toy_module"),
        AssertionError("toy"),
    ],
)
def test_nothing_else_is(monkeypatch, error):
    monkeypatch.setitem(present.ABSENT, "toy_module", "toy")
    with pytest.raises(type(error)) as caught, present.skipping_without_its_engine():
        raise error
    assert caught.value is error


def test_no_engine_is_absent_that_can_be_loaded():
    for name in present.ABSENT.values():
        with pytest.raises(EngineMissing):
            engines.get(name).load()
    assert present.INSTALLED, "there is nothing to test"
