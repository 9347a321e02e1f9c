"""Invalid arrays passed to Rust raise ordinary exceptions, never a panic."""

import border
import pytest


@pytest.fixture(scope="module")
def entries():
    return border.calls(*border.example())


def test_the_calls_are_right_before_they_are_spoilt(entries) -> None:
    for call, arguments in entries:
        call(*arguments)


def test_no_panic_crosses_the_border(entries) -> None:
    others = border.strangers()
    faults = {seed: found for seed in range(3000) if (found := border.fault(seed, entries, others))}
    assert faults == {}
