"""Files of earlier versions of the program: read, drawn and post-processed as those of today.

``tests/data/older`` holds one of each kind as it was written: first.h5 by the first version that wrote
results, the others by the last one that called the surfaces fast and slow.
"""

import gzip
import json
from pathlib import Path

import numpy as np
import pytest

from ehlpetsc.analysis import compare, ensemble
from ehlpetsc.errors import OutputError
from ehlpetsc.names import former_name
from ehlpetsc.pictures.command import main as plot
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.restart_file import load_restart
from ehlpetsc.results.running_in import statistics
from ehlpetsc.results.totals import Totals

OLDER = Path(__file__).parents[1] / "data" / "older"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("older")
    for packed in OLDER.glob("*.gz"):
        (place / packed.stem).write_bytes(gzip.decompress(packed.read_bytes()))
    return place


@pytest.mark.parametrize(
    "name, nodes, frames, h_min, p_max",
    [
        ("first", 81, 21, 1.22442469458847e-07, 995391961.6026919),
        ("passes.pass1", 29, 26, 1.9278808206945573e-08, 1.1e9),
        ("series_viscosity_0.01", 41, 1, 1.8892659271021292e-07, 992612951.3065178),
    ],
)
def test_older_results_are_read(folder, name, nodes, frames, h_min, p_max):
    with read_result(folder / f"{name}.h5") as result:
        result.check()
        assert result.pressure.shape == (frames, nodes) and result.attrs["status"] == "done"
        assert result.steps("h_min").min() == h_min
        assert result.steps("p_max").max() == pytest.approx(p_max, rel=1e-12)
        for side in ("2", "1"):
            profile = result.profile(side)
            if profile is not None:
                s, z, speed = profile
                assert s.shape == z.shape and speed > 0.0 and (np.diff(s) > 0.0).all()


def test_older_plastic_deformation_is_read(folder):
    with read_result(folder / "passes.pass1.h5") as result:
        assert result.steps("set_volume")[-1] == pytest.approx(5.1040340802532066e-11, rel=1e-12)
        row = json.loads((folder / "passes.passes.json").read_text())["passes"][0]
        for side in ("1", "2"):
            found = statistics(result, side)
            assert (
                found["deepest"] == pytest.approx(row[former_name(side)]["deepest"], rel=1e-12)
                and found["deepest"] > 0.0
            )


def test_scalars_are_read_under_current_and_former_names(folder):
    with read_result(folder / "passes.pass1.h5") as result:
        thin = result.steps.nodes_below_1nm
        np.testing.assert_array_equal(result.steps.molecular_films, thin)
        np.testing.assert_array_equal(result["steps/nodes_below_1nm"][:], thin)
        assert "nodes_below_1nm" in result.scalars and "molecular_films" not in result.scalars
        assert Totals.of_result(result).values["nodes_below_1nm"] == thin.sum()


@pytest.mark.parametrize(
    "command, words",
    [
        (plot, ["first.h5"]),
        (plot, ["first.h5", "--map"]),
        (plot, ["passes.pass1.h5", "--report"]),
        (plot, ["passes.passes.json", "--running-in"]),
        (plot, ["series.series.json"]),
        (compare.main, ["first.h5", "first.h5"]),
        (ensemble.main, ["series.series.json"]),
    ],
)
def test_every_command_accepts_older_results(folder, monkeypatch, capsys, command, words):
    monkeypatch.chdir(folder)
    assert command(words) == 0, capsys.readouterr().err


def test_older_restart_file_is_refused_by_version(folder):
    with pytest.raises(OutputError, match=r"direct\.restart\.h5: .* version 2, .* \d$"):
        load_restart(folder / "direct.restart.h5")
