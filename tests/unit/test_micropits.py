"""The ensembles of `cases/micropitting.md` in the short form of their program."""

import sys

import pytest
from support import CASES

sys.path.append(str(CASES / "paper"))
import micropits

from ehlpetsc.life.history import read_life


def test_short_form_computes_once_prints_shares_and_draws(tmp_path, capsys):
    """Two lives; the smooth surface is damaged more; a second call prints the same from the files."""
    words = [str(tmp_path / "lives"), "first", "--short", "-o", str(tmp_path / "signs.png")]
    micropits.main(words)
    first = capsys.readouterr().out
    files = sorted((tmp_path / "lives").glob("*.life.h5"))
    stamps = [file.stat().st_mtime_ns for file in files]
    micropits.main(words)
    assert capsys.readouterr().out == first and "first, ten seeds, 2 seeds: surface 1 " in first
    assert [file.stat().st_mtime_ns for file in files] == stamps and len(files) == 2
    assert (tmp_path / "signs.png").stat().st_size > 10_000
    lives = [read_life(file) for file in files]
    early, late = (micropits.shares(lives, passes) for passes in (0.3 * micropits.PASSES, micropits.PASSES))
    assert (early[1] > early[0]).all() and (late > early).all()
    with pytest.raises(SystemExit):
        micropits.main([str(tmp_path), "frist"])
    assert "scene frist; allowed: first, second" in capsys.readouterr().err
