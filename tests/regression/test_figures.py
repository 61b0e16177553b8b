"""The paper's figures of contact in short forms: what each of them shows must hold.

The mesh is coarser and the roughness has only just come into the contact; the figures of the full lengths are
in cases/paper.md.
"""

import json
import sys
from contextlib import ExitStack

import numpy as np
import pytest
from support import ROOT
from support.running import run, settings

from ehlpetsc.results.index import in_order, open_all
from ehlpetsc.results.reader import read_result

sys.path.append(str(ROOT / "cases" / "paper"))
import collisions
import contacts
import entrapment

pytestmark = pytest.mark.slow
SHORT = ["mesh.inlet=-1.4", "mesh.outlet=1.3"]
# Steps of one node of the faster surface, whose unfiltered asperities are a node or two wide and would be
# other ones between the nodes; slide/roll ratios of 0.25 and 0.1.
NODE, NODE_OF_FIG3 = f"time.courant={1 / 1.125}", f"time.courant={1 / 1.05}"


def series(folder, name, points, travel, values, *more):
    """Run a short form; its index."""
    mesh = [] if points is None else [f"mesh.points_per_half_width={points}"]
    sets = settings(*SHORT, *more, *mesh, f"time.travel={travel}", f"series.values={json.dumps(values)}")
    done = run(ROOT / "cases" / f"{name}.toml", *sets, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / f"{name}.series.json"


def thin_ones_and_collisions(stack, index):
    results, values, _ = collisions.open_series([index], stack)
    return results, values, collisions.find(results)


@pytest.fixture(scope="module")
def figure_4(tmp_path_factory):
    values = [0.010, 0.007, 0.0055, 0.004, 0.001]
    return series(tmp_path_factory.mktemp("fig4"), "fig4", 160, 1.7, values, NODE)


def test_film_reaches_zero_at_the_extrapolated_viscosity(figure_4):
    """Figure 4 (i): six contact points or more, film falling to zero without steepening."""
    with ExitStack() as stack:
        results, values, found = thin_ones_and_collisions(stack, figure_4)
        points = collisions.breakdowns(found)
        assert len(points) >= 6
        last = [collisions.slope_jumps(values, c.film, c.first)[-1] for c in points]
        assert np.mean(np.array(last) <= 0.0) >= 0.8
        # but for what smooth films do against viscosity, the slopes before hardly grow either
        smooth = [float(result.steps("h_min")[0]) for result in results]
        before = np.concatenate([collisions.slope_jumps(smooth, c.film, c.first)[:-1] for c in points])
        assert np.median(before) < 0.03 and before.max() < 0.2


def test_pressure_grows_after_contact(figure_4):
    """Figure 4 (ii): six of seven on this mesh, the seventh falls from 1.19 to 1.16 GPa; on a/200 all 103."""
    with ExitStack() as stack:
        _, _, found = thin_ones_and_collisions(stack, figure_4)
        after = [c.pressure[c.first :] for c in collisions.breakdowns(found)]
        changes = [np.diff(pressure) / pressure[:-1] for pressure in after]
        assert sum(np.prod(1 + change) > 1 for change in changes) >= len(changes) - 1
        assert np.mean(np.concatenate(changes) > 0) >= 0.75


def test_contacts_persist_at_lower_viscosity(figure_4):
    """Figures 1 and 2: contacts develop from those at higher viscosity."""
    with ExitStack() as stack:
        results, _, found = thin_ones_and_collisions(stack, figure_4)
        for c in found:
            first = c.touching.index(True)
            assert all(c.touching[first:]), c
        lengths = [contacts.contact_length(result) for result in results]
        assert lengths == sorted(lengths)


def test_little_contact_at_high_speed(figure_4, tmp_path):
    """Figure 3: at 25 m/s contact comes at lower viscosities than at 5 m/s."""
    index = series(tmp_path, "fig3", 160, 1.7, [0.007, 0.004, 0.001], NODE_OF_FIG3)
    with ExitStack() as stack:
        fast, values, found = thin_ones_and_collisions(stack, index)
        slow, slow_values, _ = thin_ones_and_collisions(stack, figure_4)
        assert found and all(c.touching[-1] for c in found)
        for value, result in zip(values, fast, strict=True):
            other = slow[slow_values.index(value)]
            assert contacts.contact_length(result) < contacts.contact_length(other)


def test_meshes_agree_on_collisions(tmp_path):
    """Figures 6 and 7: the same collisions on two meshes, and contacts of one order.

    With as light a contact as this the finer mesh has fewer, as Holmes et al. say of lighter interaction.
    """
    index = series(tmp_path, "fig6", None, 1.3, [100, 200])
    with ExitStack() as stack:
        coarse, fine = in_order(open_all([index], stack))
        assert np.isin(coarse.time.round(12), fine.time.round(12)).mean() > 0.9  # stored frames coincide
        found = collisions.find([coarse, fine])
        shared = [c for c in found if all(c.touching)]
        assert len(shared) >= 2 and len(shared) >= 0.4 * len(found)
        assert 0.4 < contacts.mean_rate(fine) / contacts.mean_rate(coarse) < 1.8


def test_entrapment_between_two_contacts(tmp_path):
    """Figure 5, in steps of two nodes of the faster surface and up to the collision alone."""
    short = settings("mesh.outlet=1.2", "time.travel=1.5", f"time.courant={2 / 1.125}")
    done = run(ROOT / "cases" / "fig5.toml", *short, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with read_result(tmp_path / "fig5.h5") as result:
        best = entrapment.find(result)[0]
        assert best.excess > 2.0  # over the higher of both contacts
        assert result.x[best.peak] / result.attrs["a"] == pytest.approx(-0.95, abs=0.003)
        film = result.frame("film_thickness", best.frame)[best.left : best.right + 1]
        assert film[0] == film[-1] == 0.0 and film[1:-1].min() > 0.0
        assert len(entrapment.instants(result, best)) == 4
