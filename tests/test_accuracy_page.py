"""docs/accuracy.md: the output of its program and the error of the moment are those of the page."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[1] / "docs" / "accuracy.md").read_text("utf-8")


def test_the_program_of_the_page_prints_what_the_page_shows(capsys: pytest.CaptureFixture[str]) -> None:
    program, shown = re.findall(r"```(?:python)?\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(program, "accuracy.md", "exec"), {})
    printed = capsys.readouterr().out
    certificates = r"certificate: (\S+)"
    assert re.sub(certificates, "", printed) == re.sub(certificates, "", shown)
    assert all(float(figure) < 1e-11 for figure in re.findall(certificates, printed))
    coarse, fine = re.findall(r"foot: (\S+) ± (\S+)", printed)
    assert float(coarse[0]) == pytest.approx(0.6 * float(fine[0]), rel=0.03)
    assert abs(float(coarse[0]) - float(fine[0])) < float(coarse[1])
