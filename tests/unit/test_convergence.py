"""Limit, order and error bar by three meshes; the command that runs them."""

import csv
import itertools

import numpy as np
import pytest
from support import CASES, is_line_with
from support.running import SHORT, run, settings

from ehlpetsc.analysis.convergence import (
    NO_ORDER,
    NOT_MONOTONE,
    SPOT_ORDER,
    extrapolated,
    limit,
    limit_of,
    observed_order,
)

NODES = (8, 12, 16)


def values(order, factor=1.0, nodes=NODES):
    return [2.0 + factor * float(n) ** -order for n in nodes]


@pytest.mark.parametrize("order", [0.7, 1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("nodes", [NODES, (50, 75, 100), (10, 11, 40)])
def test_exact_data_give_their_order_and_limit(order, nodes):
    given = values(order, -3.0, nodes)
    assert observed_order(nodes, given) == pytest.approx(order, abs=1e-6)
    assert extrapolated(nodes, given, order) == pytest.approx(2.0, abs=1e-12)
    found = limit(nodes, given)
    assert found.order == pytest.approx(order, abs=1e-6) and found.is_extrapolated
    if 1.0 <= order <= 2.0:
        assert found.value == pytest.approx(2.0, abs=1e-9)
    assert abs(found.value - 2.0) <= found.bar


def test_values_without_an_order_keep_that_of_the_finest_mesh_and_their_range():
    for given, remark in (((1.0, 1.2, 1.1), NOT_MONOTONE), ((1.0, 1.1, 1.3), NO_ORDER)):
        found = limit(NODES, given)
        assert np.isnan(found.order) and found.remark == remark
        assert found.value == given[-1] and found.bar == pytest.approx(max(given) - min(given))
    assert limit(NODES, values(6.0)).remark == NO_ORDER
    equal = limit(NODES, (1.0, 1.0 + 1e-9, 1.0))
    assert equal.value == 1.0 and equal.bar < 1e-8 and equal.remark == "equal"
    assert np.isnan(observed_order(NODES, (1.0, 1.0, 1.1)))


def test_the_bar_covers_an_error_of_two_orders():
    """Errors of orders 1 and 2 of either share, one sign: the observed order is between them."""
    for first, second in itertools.product((0.1, 0.5, 1.0), (0.5, 5.0)):
        given = [1.0 + first / n + second / n**2 for n in NODES]
        found = limit(NODES, given)
        assert 1.0 < found.order < 2.0
        assert abs(found.value - 1.0) < found.bar < abs(given[0] - 1.0)


def test_the_bar_of_spots_covers_what_mixed_contact_showed():
    """Means of compliant_mixed.toml on 8, 12, 16 nodes a wave; limits by 16 and 32."""
    for given, reference, within in (
        ((0.017227, 0.016172, 0.015646), 0.01481, 0.005),  # friction
        ((0.02017, 0.01372, 0.01029), 0.00477, 0.03),  # load on the solids
    ):
        found = limit(NODES, given, SPOT_ORDER)
        assert 0.8 < found.order < 1.1
        assert found.value == pytest.approx(reference, rel=within)
        assert abs(found.value - reference) < found.bar


def test_the_bar_of_damage_reaches_to_the_finest_mesh():
    """Of compliant_mixed.toml and of a layer of 50 nm on 8, 12, 16 nodes a wave, over the limit by 16, 32."""
    for given, error in (((0.8757, 0.9468, 0.9801), 0.0372), ((1.0676, 1.0301, 1.0087), -0.0235)):
        found = limit_of("damage_1 z/a=0.05", NODES, given, SPOT_ORDER)
        assert found.value - 1.0 == pytest.approx(error, abs=1e-4)
        assert abs(error) < found.bar == pytest.approx(abs(found.value - given[-1]))


COARSE = settings(
    *SHORT,
    "mesh.points_per_half_width=10",
    "time.travel=0.6",
    "series={key='fluid.viscosity',values=[0.01,0.005]}",
)
NAMES = ("friction_coefficient", "film_central", "h_min", "p_max")


def test_a_series_on_three_meshes_is_computed_once(tmp_path):
    words = ["converge", CASES / "table1_rough.toml", *COARSE, "-o", "out.csv"]
    done = run(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "out.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["case"] for row in rows} == {"viscosity = 0.01", "viscosity = 0.005"}
    assert set(NAMES) <= {row["quantity"] for row in rows}
    for row in rows:
        assert all(float(row[f"on {n}"]) for n in (10, 15, 20))
        assert float(row["bar"]) >= 0.0
        assert bool(row["order"]) != bool(row["remark"])
        if row["quantity"] in ("h_min", "p_max"):
            assert row["remark"] == "of single nodes: no order" and row["extrapolated"] == row["on 20"]
    assert (tmp_path / "out.png").stat().st_size > 10_000
    written = [path.stat().st_mtime_ns for path in sorted(tmp_path.glob("out_*.h5"))]
    assert len(written) == 6
    again = run(*words, cwd=tmp_path)
    assert again.returncode == 0 and "0 of them to compute" in again.stdout
    assert [path.stat().st_mtime_ns for path in sorted(tmp_path.glob("out_*.h5"))] == written


def test_a_table_of_other_programs_is_kept(tmp_path):
    (tmp_path / "p.csv").write_text("0,1e-7\n1e-6,2e-7\n")
    done = run("converge", CASES / "dry_hertz.toml", "-o", "p.csv", "--no-picture", cwd=tmp_path)
    assert done.returncode == 2
    assert is_line_with(done.stderr, "p.csv: exists, and its first line is not that of this table; ")
    assert (tmp_path / "p.csv").read_text() == "0,1e-7\n1e-6,2e-7\n"


def test_damage_is_among_the_quantities(tmp_path):
    sets = settings("mesh.inlet=-1.4", "mesh.outlet=1.3", "mesh.points_per_half_width=8", "time.travel=3.6")
    sets += settings("post.depths=[0.2]")
    done = run("converge", CASES / "table1_damage.toml", *sets, "--damage", "--no-picture", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = (tmp_path / "table1_damage.converge.csv").read_text().splitlines()
    damage = [row.split(",")[2:5] for row in rows if row.startswith(",damage_")]
    assert damage and all(float(value) > 0.0 for row in damage for value in row)
    assert not list(tmp_path.glob("*.png"))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["table1_rough.toml", "--nodes", "8", "16", "12"], "--nodes 8 16 12: allowed: three that increase"),
        (
            ["table1_smooth.toml", "--nodes", "8", "12", "16"],
            "--nodes: to the shortest wave, but both surfaces",
        ),
        (["table1_smooth.toml", "--set", "fluid.viscosty=1"], "fluid.viscosty = 1: unknown key; "),
        (["table1_smooth.toml", "-o", "out.txt"], "out.txt"),
    ],
)
def test_a_mistyped_command_is_one_sentence(tmp_path, words, message):
    done = run("converge", CASES / words[0], *words[1:], cwd=tmp_path)
    assert done.returncode == 2 and is_line_with(done.stderr, message), done.stderr
    assert not list(tmp_path.iterdir())
