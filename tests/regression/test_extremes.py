"""Programs of the benchmarks: the table of extremes, and errors over run time."""

import math

import numpy as np
import pytest
from benchmarks import accuracy
from benchmarks.extremes import extremes, table
from benchmarks.extremes_plane import FLOODED, MAX_DISTANCE, drawn

from ehlpetsc.case.loading import load
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales


@pytest.mark.slow
def test_short_table_of_extremes(tmp_path):
    rows = table(extremes(short=True), tmp_path / "extremes.csv")
    assert len(rows) > 25 and [row for row in rows if row["converged"] != "yes"] == []
    for row in rows:
        assert float(row["h_min_um"]) >= 0.0 and math.isfinite(float(row["p_max_GPa"]))
        assert float(row["load_error"]) < 1e-6
    assert len((tmp_path / "extremes.csv").read_text().splitlines()) == len(rows) + 1


@pytest.mark.parametrize("far, count", [(False, 105), (True, 40)])
@pytest.mark.parametrize("model", [None, "compliant"])
def test_every_row_of_the_whole_table_loads(far, count, model):
    whole = extremes(far=far, model=model)
    assert len({(line.axis, line.value) for line in whole}) == len(whole) == count
    for line in whole:
        case = load(line.base, line.overrides)
        own = any(word.startswith("contact.model") for word in line.overrides[2:])
        assert model is None or own or case.contact.asperity_height == 10e-9


def test_hypercube_of_points_is_as_drawn_and_flooded():
    cases = drawn(60)
    assert min(case.p0 for case in cases) < 0.11e9 and max(case.p0 for case in cases) > 2.9e9
    for extreme in cases:
        case = extreme.case(16, 0.25)
        scales = Scales.of(case)
        assert (scales.p0, scales.moes_l) == pytest.approx((extreme.p0, extreme.L), rel=1e-6)
        assert scales.b / scales.a == pytest.approx(extreme.ratio**0.64, rel=0.1)
        gap = 0.5 * (case.mesh.inlet**2 - 1.0)
        assert gap >= FLOODED * expected_film(case, scales) or case.mesh.inlet <= -MAX_DISTANCE
        assert scales.grid.n < 100_000


def measured(error, contact=0.0):
    x, more = np.linspace(-1.5, 1.5, 31), 1.0 + error
    film = 0.2 * more * np.ones(31)
    scalars = {"h_min": 0.1 * more, "h_c": 0.2 * more, "p_max": 1e9 * (1.0 - error), "contact": contact}
    return scalars | {"x": x, "h": film, "damage": np.nan}


def test_errors_are_relative_and_local():
    found = accuracy.errors(measured(0.02, 1.1), measured(0.0, 1.0))
    assert found == pytest.approx(
        {"h_min": 0.02, "h_c": 0.02, "p_max": 0.02, "film": 0.02, "contact": 0.1, "damage": np.nan},
        nan_ok=True,
    )


def test_uncertainty_of_second_order_is_a_third_of_the_last_change():
    found = accuracy.uncertainty(measured(0.0), measured(0.03), measured(0.15))
    assert found["h_c"] == pytest.approx(0.03 / 3.0)
