"""Comparing results: equal, different and incomparable ones."""

import numpy as np
import pytest
from support.made_results import P0, A, make_result

from ehlpetsc.analysis.compare import compare, main
from ehlpetsc.results.reader import read_result


@pytest.fixture
def result(tmp_path):
    return make_result(tmp_path / "one.h5")


def differences(one, other):
    with read_result(one) as a, read_result(other) as b:
        return {d.name: d for d in compare(a, b)}


def run(capsys, *arguments):
    """Exit status, output and error output of the command."""
    status = main([str(a) for a in arguments])
    return status, *capsys.readouterr()


def test_equal_results_compare_bitwise_equal(tmp_path, result, capsys):
    status, text, _ = run(capsys, result, make_result(tmp_path / "two.h5"), "--rtol", 0)
    assert status == 0
    assert text.splitlines()[-1].startswith("same")
    assert "steps/load" in text and "DIFFERENT" not in text


def test_difference_has_size_and_position(tmp_path, result, capsys):
    other = make_result(tmp_path / "two.h5", factor=1 + 1e-4)
    found = differences(result, other)
    pressure = found["pressure"]
    assert pressure.max / pressure.scale == pytest.approx(1e-4, rel=1e-3)
    assert pressure.scale == pytest.approx(1.4 * P0, rel=1e-2)
    assert abs(pressure.x) < 0.2 * A
    assert 0 < pressure.rms < pressure.max
    assert found["film_thickness"].max == 0
    status, text, _ = run(capsys, result, other)
    assert status == 1
    assert text.splitlines()[-1].startswith("different: pressure; steps/p_max")
    assert run(capsys, result, other, "--rtol", 2e-4)[0] == 0


def test_finer_mesh_and_time_step_are_compared_at_common_nodes(tmp_path):
    """Nodes and times of the coarser are among those of the finer, so nothing is lost by interpolation."""
    coarse = make_result(tmp_path / "one.h5", nodes=161, steps=41)
    found = differences(coarse, make_result(tmp_path / "two.h5", nodes=321, steps=81))
    for name in ("pressure", "film_thickness", "shear_stress_2", "void_fraction"):
        assert found[name].max <= 1e-12 * found[name].scale, name
    assert found["steps/load"].max == 0
    assert "in_contact" not in found and "steps/contacts" not in found  # numbers of the mesh


def test_nan_in_one_result_is_a_difference(tmp_path, result, capsys):
    """Friction is left out of both, which is the same; a nan in the pressure of one is not."""
    assert differences(result, result)["steps/friction"].max == 0
    status, text, _ = run(capsys, result, make_result(tmp_path / "two.h5", factor=np.nan), "--rtol", 1)
    assert status == 1
    assert "different: pressure;" in text
