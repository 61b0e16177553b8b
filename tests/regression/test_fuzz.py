"""A few draws of the fuzz command: none ends in a traceback, hang, crash or wrong answer."""

import subprocess

import pytest
from support import ROOT
from support.running import BARE, PYTHON, SCRIPT

pytestmark = pytest.mark.slow


def test_invalid_input_ends_with_a_documented_status(tmp_path):
    words = [PYTHON, ROOT / "tests" / "fuzz" / "all.py", "--seed", "3", "--options", "6"]
    done = subprocess.run(words, cwd=tmp_path, env=BARE | SCRIPT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith("options: ") and "refused " in done.stdout
    assert list(tmp_path.iterdir()) == []
