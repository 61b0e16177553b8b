"""The page of two minutes: its commands run as they are and give its answers."""

import os
import re
import subprocess

import pytest
from support import CASES, ROOT

PAGE = (CASES / "two_minutes.md").read_text(encoding="utf-8")


def answers(question):
    """Middle and ends of the band in the row of a question."""
    (row,) = re.findall(rf"^\| {question}.*$", PAGE, re.MULTILINE)
    _, _, middle, band, *_ = row.split("|")
    return [float(number) for number in (middle, *band.split("to"))]


@pytest.mark.slow
def test_commands_of_the_page_give_its_answers(tmp_path):
    (commands,) = re.findall(r"```\n(cp .*?)```", PAGE, re.DOTALL)
    command = tmp_path / "bin" / "ehlpetsc"
    command.parent.mkdir()
    command.write_text('#!/bin/sh\nexec python3 -m ehlpetsc "$@"\n')
    command.chmod(0o755)
    (tmp_path / "cases").symlink_to(CASES)
    environment = os.environ | {
        "PATH": os.pathsep.join([str(command.parent), os.environ["PATH"]]),
        "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]),
    }
    done = subprocess.run(
        ["bash", "-ec", commands], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
    )
    (rq,) = re.findall(r"Rq +([\d.]+) um", done.stdout)
    assert f"Rq {float(rq):.3f} um" in PAGE
    for name, question in (
        ("mean friction coefficient", "friction coefficient"),
        ("mean share of the load on the solids", "share of the load"),
        ("mean film", "mean film"),
    ):
        (values,) = re.findall(rf"^{name} ([\d., ]+)", done.stdout, re.MULTILINE)
        low, middle, high = (float(value) for value in values.split(","))
        assert [middle, low, high] == pytest.approx(answers(question), rel=0.02), name
    used = [
        float(value)
        for value in re.findall(r"^z/a=0.5 .* 2: .* dang-van=([\d.]+)", done.stdout, re.MULTILINE)
    ]
    assert used == pytest.approx(3 * [answers("Dang Van")[0]], rel=0.01)
