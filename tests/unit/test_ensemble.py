"""Ensembles over seeds: which runs belong together, means and deviations, table and picture."""

import csv
import json

import h5py
import numpy as np
import pytest
from support import CASES
from support.made_results import change_case, make_result, with_solids

from ehlpetsc.__main__ import main as program
from ehlpetsc.analysis.summary import ensemble_table, ensembles, run_scalars
from ehlpetsc.base.errors import OutputError
from ehlpetsc.commands.summary import main as summary
from ehlpetsc.results.index import files_of
from ehlpetsc.results.means import bootstrap_bounds, both_fill
from ehlpetsc.results.reader import read_result

GROUND = {"kind": "ground", "ra": 1e-7, "correlation": 1e-5}
SHARES = (0.20, 0.26, 0.31, 0.22, 0.29, 0.24)


def made(folder, speeds=(5.0,), seeds=range(1, 7)):
    """Results of a grid over speeds and seeds; the share on the solids depends on both."""
    paths = []
    for speed in speeds:
        for seed, share in zip(seeds, SHARES, strict=False):
            path = make_result(folder / f"u{speed:g}_s{seed}.h5", speed=speed, rough=True)
            with_solids(path, share / speed)
            change_case(path, {"surface.2.synthetic": GROUND | {"seed": seed}})
            paths.append(str(path))
    return paths


def opened(paths):
    return [read_result(path) for path in paths]


def test_members_that_differ_in_seeds_form_one_ensemble(tmp_path):
    found = ensembles(opened(made(tmp_path, (5.0, 1.0))))
    assert list(found) == ["entrainment_speed = 5", "entrainment_speed = 1"]
    assert all(values.shape == (6,) for one in found.values() for values in one.values())


def test_results_without_common_conditions_are_refused(tmp_path, capsys):
    assert summary(["--ensemble", *made(tmp_path, (5.0, 1.0), [1])]) == 2
    (message,) = capsys.readouterr().err.splitlines()
    assert message.startswith("ehlpetsc summary: 2 results ") and not list(tmp_path.glob("*.csv"))


def test_run_statistics_are_time_means_extremes_and_damage_quantiles(tmp_path):
    (path, *_) = made(tmp_path, [50.0])
    with read_result(path) as result:
        figures = run_scalars(result)
        filled = both_fill(result, result.steps("time"))
        share = result.steps("contact_share")[filled]
        assert 5 < filled.sum() < 41
        assert figures["contact_share"] == pytest.approx(share.mean())
        assert figures["h_min"] == result.steps("h_min")[filled].min()
        assert figures["p_max"] == result.steps("p_max")[filled].max()
    assert "dt" not in figures and "wall" not in figures
    (path, *_) = made(tmp_path, seeds=[1])
    with h5py.File(path) as result, h5py.File(path.replace(".h5", ".post.h5"), "w") as file:
        file.attrs.update(a=1e-3, case=result.attrs["case"])
        file["damage/s"], file["damage/z_over_a"] = np.arange(102.0), [0.01]
        file["damage/2"] = [[*np.linspace(0.0, 1.0, 101), np.nan]]
        file["damage/2_complete"] = [1] * 101 + [0]
        file["smooth/depth"], file["smooth/damage/2"] = [0.0, 1e-3, 2e-3], [1e-9, 2e-9, 1e-9]
        for name in ("highest", "mean", "flash"):
            file[f"temperature/2_{name}"] = [*np.linspace(20.0, 120.0, 101), np.nan]
    with read_result(path) as result:
        figures = run_scalars(result)
    for q in (0.5, 0.9, 0.99):
        assert figures[f"damage_2 z/a=0.01 q={q:g}"] == pytest.approx(q)
    assert figures["share_2 D>0.1"] == pytest.approx(90 / 101)
    assert figures["flash_temperature_2 largest"] == pytest.approx(120.0)
    assert figures["flash_temperature_2 q=0.5"] == pytest.approx(70.0)
    rows = ensemble_table(opened([path]))
    assert {unit for _, name, unit, *_ in rows if "flash" in name} == {"K"}


def test_ensemble_table_of_a_series(tmp_path, capsys):
    made(tmp_path, (5.0, 1.0))
    files = [{"file": path.name} for path in sorted(tmp_path.glob("*.h5"))]
    index = tmp_path / "e.series.json"
    index.write_text(json.dumps({"members": files}))
    assert summary(["--ensemble", str(index)]) == 0
    lines = capsys.readouterr().out.splitlines()
    rows = {(row["ensemble"], row["scalar"]): row for row in csv.DictReader(lines)}
    row = rows["entrainment_speed = 1", "contact_share"]
    assert int(row["runs"]) == 6
    assert float(row["mean"]) == pytest.approx(np.mean(SHARES), rel=0.02)
    assert float(row["deviation"]) == pytest.approx(np.std(SHARES, ddof=1), rel=0.02)
    assert float(row["min"]) < float(row["mean"]) < float(row["max"])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_bootstrap_bounds_are_those_of_the_mean(seed):
    values = np.random.default_rng(seed).normal(3.0, 0.5, size=40)
    error = values.std() / np.sqrt(40)
    low, high = bootstrap_bounds(values)
    assert (low, high) == pytest.approx(values.mean() + 1.645 * error * np.array([-1.0, 1.0]), rel=0.01)
    assert high - low == pytest.approx(2 * 1.645 * error, rel=0.05)
    assert bootstrap_bounds(values) == (low, high)
    assert np.isnan(bootstrap_bounds(values[:1])).all()


def test_ensemble_of_strips_has_lives_of_the_worst_points(tmp_path):
    paths = made(tmp_path, seeds=[1, 2, 3])
    s, y = np.arange(50.0), np.arange(4.0)
    for factor, path in enumerate(paths, 1):
        damage = np.linspace(1e-6, 2e-4, 200).reshape(4, 50) * factor
        with h5py.File(path) as result, h5py.File(path.replace(".h5", ".post.h5"), "w") as file:
            file.attrs.update(a=1e-3, case=result.attrs["case"])
            file["damage/s"], file["damage/y"], file["damage/z_over_a"] = s, y, [0.0, 0.01]
            file["damage/2"] = np.stack([damage[::-1] / 10.0, damage])
            file["damage/2_complete"] = np.ones(50)
            file["smooth/depth"], file["smooth/damage/2"] = [0.0, 1e-3, 2e-3], [1e-9, 2e-9, 1e-9]
            file["smooth/criteria/fatemi_socie/2_damage"] = [1e-9, 2e-9, 1e-9]
            file["criteria/fatemi_socie/2_damage"] = np.stack([2.0 * damage, damage])
            file["criteria/dang_van/2_utilisation"] = np.stack([damage, damage])
    with read_result(paths[0]) as result:
        found = run_scalars(result)
    assert found["damage_2 z/a=0.01 largest"] == pytest.approx(2e-4)
    assert found["life_2 worst"] == pytest.approx(5000.0)
    ranked = np.linspace(1e-6, 2e-4, 200)
    assert found["smooth_life_2"] == pytest.approx(5e8) and found["smooth_depth_2"] == pytest.approx(1e-3)
    assert found["share_2 D>0.1"] == 0.0 == found["fatemi-socie share_2 D>0.1"]
    for share in (0.01, 0.1):
        assert found[f"life_2 q={share:g}"] == pytest.approx(1.0 / np.quantile(ranked, 1.0 - share))
        key = f"fatemi-socie life_2 q={share:g}"
        assert found[key] == pytest.approx(0.5 * found[f"life_2 q={share:g}"])
    assert "dang-van utilisation_2 z/a=0 q=0.99" in found and "dang-van life_2 worst" not in found
    head, *rows = ensemble_table(opened(paths))
    row = next(dict(zip(head, row, strict=True)) for row in rows if row[1] == "life_2 worst")
    lives = 5000.0 / np.arange(1, 4)
    assert (row["unit"], row["runs"]) == ("passes", 3)
    assert float(row["mean"]) == pytest.approx(lives.mean(), rel=1e-5)
    assert lives.min() <= float(row["low"]) < float(row["mean"]) < float(row["high"]) <= lives.max()


def test_wide_table_has_a_row_for_each_result_in_si_units(tmp_path):
    paths = []
    for number, load in enumerate(('"400 N/mm"', "5e5")):
        words = ["--set", f"contact.load={load}", "--set", "mesh.points_per_half_width=10"]
        words += ["--set", "output.fields=[]", "-o"]  # scalars alone
        paths.append(str(tmp_path / f"{number}.h5"))
        assert program([str(CASES / "table1_smooth.toml"), *words, paths[-1]]) == 0
    assert summary(["--wide", *paths, "-o", str(tmp_path / "wide.csv")]) == 0
    with open(tmp_path / "wide.csv") as file:
        first, second = csv.DictReader(file)
    assert (first["result"], first["contact.load [N/m]"], second["contact.load [N/m]"]) == (
        "0.h5",
        "400000",
        "500000",
    )
    with read_result(paths[1]) as result:
        assert float(second["film_central [m]"]) == pytest.approx(result.steps("film_central")[0], rel=1e-8)


def test_index_without_files_is_refused_and_a_refused_member_left_out(tmp_path):
    """The file in the place of a refused member is the result of another case."""
    index, files = tmp_path / "a.series.json", [make_result(tmp_path / f"{name}.h5").name for name in "bc"]
    rows = [{"file": name, "state": state} for name, state in zip(files, ("done", "bad input"), strict=True)]
    index.write_text(json.dumps({"members": rows}))
    assert files_of(index) == [tmp_path / "b.h5"]
    for rows in ([{}], [{"file": 3}], 3, [1], [{"file": ""}]):
        index.write_text(json.dumps({"members": rows}))
        with pytest.raises(OutputError, match=r"a\.series\.json: not an index of ehlpetsc"):
            files_of(index)
