"""Comparison with other programs, benchmarks/peers: installed programs agree, others are named."""

import sys
from pathlib import Path
from typing import Any

import pytest

PEERS = Path(__file__).parents[1] / "benchmarks" / "peers"
sys.path.insert(0, str(PEERS))
table: Any = pytest.importorskip("table")


@pytest.mark.parametrize("program", table.PROGRAMS)
def test_a_program_that_is_installed_finds_the_settlement_and_the_two_points_that_lift(program: str) -> None:
    """On 20 × 20 elements programs are within 2 % of the settlement of slab A, 4.229 mm; reactions balance the load."""
    on_soil, on_points = (table.solved(program, case, 20) for case in "AB")
    if isinstance(on_soil, str):
        assert on_soil.endswith("is not installed.") or on_soil.endswith("does not exist.")
        pytest.skip(on_soil)
    assert on_soil["settlement"] == pytest.approx(4.229e-3, rel=0.02)
    assert on_soil["pressure"] == pytest.approx(126.86e3, rel=0.02)
    assert 0.90 < on_soil["contact"] < 0.94
    lifted = [at for at, reaction in enumerate(on_points["reactions"]) if reaction == 0]
    assert lifted == [2, 8]
    assert sum(on_points["reactions"]) == pytest.approx(700e3, rel=1e-5)


def test_a_program_that_is_missing_is_named_and_the_table_goes_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(table.PROGRAMS, "getfem", ("getfem_slab.py", "/nowhere/python3"))
    monkeypatch.setattr(sys, "argv", ["table.py", "--elements", "20", "--programs", "getfem", "signorini"])
    table.main()
    out = capsys.readouterr().out
    assert out.count("getfem: /nowhere/python3 does not exist.") == 2
    assert out.count("| signorini |") == 2
