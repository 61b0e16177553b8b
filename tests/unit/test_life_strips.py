"""Life of a strip: its equal rows are a line's columns, walls of pits in all directions, removed volume."""

from types import SimpleNamespace

import numpy as np
import pytest
from support import COARSE_LIFE

from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load
from ehlpetsc.life import laws
from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.history import LifeHistory
from ehlpetsc.life.one_pass import OfBody
from ehlpetsc.life.rounds import Jumps, Round
from ehlpetsc.pictures import lives
from ehlpetsc.surfaces.motion.body_field import BodyField

EDGES = np.array([0.0, 1.0, 2.0, 4.0, 8.0])
COLUMNS = 24


def of_pass(rows, seed):
    """A pass of random wear and damage, the same in all rows."""
    rng, s = np.random.default_rng(seed), np.arange(COLUMNS) * 1.0
    worn, depths = rng.uniform(size=COLUMNS) * 1e-3, np.array([0.0, 1.5, 6.0])
    damage = 1e-3 * rng.uniform(size=(3, COLUMNS)) ** 6
    if rows:
        worn, damage = np.tile(worn, (rows, 1)), np.repeat(damage[:, None], rows, axis=1)
    none = BodyField(0.25, 0, np.zeros((*(rows,) * bool(rows), 0)))
    return OfBody(s, depths, damage, (none, none.add(np.arange(COLUMNS + 1) - 0.5, worn)))


def life(rows, rule):
    """Bodies after some rounds, in which cells break out."""
    shape = *(rows,) * bool(rows), COLUMNS
    one = LifeBody.new(np.arange(COLUMNS) * 1.0, np.zeros(shape), EDGES, np.arange(rows) * 0.7)
    keys = {"passes": 100_000, "damage_jump": 0.5, "wear_jump": 1.0, "break_out": rule}
    jumps, bodies, done, before = Jumps(SimpleNamespace(**keys), 1.0), (one, one), 0, 0
    for seed in range(12):
        passes = [SimpleNamespace(bodies=(of_pass(rows, seed), of_pass(rows, seed + 50)), yielded=0.0)]
        bodies, before, _ = jumps.jump(bodies, Round(passes, 1.0), done, before)
        done += before
    return bodies


@pytest.mark.parametrize("rule", ["above", "connected", "none"])
def test_equal_rows_of_a_strip_have_the_life_of_a_line(rule):
    for line, strip in zip(life(0, rule), life(3, rule), strict=True):
        assert line.is_pitted.any() and strip.pits == line.pits
        assert line.pit.any() == (rule != "none")
        for name in ("wear", "pit", "damage", "failed", "is_pitted"):
            expected = np.expand_dims(getattr(line, name), -2)
            assert np.array_equal(getattr(strip, name), np.broadcast_to(expected, getattr(strip, name).shape))
        assert strip.volume == pytest.approx(line.volume, rel=1e-12)
        field, of_line = (one.gap_field((3.0, 20.0), (-4.0, 30.0)) for one in (strip, line))
        assert field.depth == pytest.approx(np.tile(of_line.depth, (3, 1)), rel=1e-13)


def test_pit_of_one_cell_is_a_cone_on_any_columns():
    """Its volume is pi d^3 for a depth d and walls of 30 degrees; beyond the last row is the first."""
    for width, rows in ((1.0, 48), (0.5, 96)):
        recession = np.zeros((rows, 120))
        bottom = recession.copy()
        bottom[1, 60] = 10.0
        depth = laws.with_walls(bottom, recession, (width, width))
        slope = 3.0**-0.5
        assert depth[1, 60] == 10.0 and depth[0, 60] == depth[2, 60] == pytest.approx(10.0 - slope * width)
        assert depth[-1, 60] == pytest.approx(10.0 - 2.0 * slope * width)
        assert depth[1, 61] == depth[0, 60]
        assert width**2 * depth.sum() == pytest.approx(np.pi * 10.0**3, rel=2e-3)
    bottom = np.zeros((2, 9))
    bottom[0, 4] = 3.0
    depth = laws.with_walls(bottom, np.zeros((2, 9)), (1.0, 1.0))
    assert depth[1, 4] == pytest.approx(3.0 - 3.0**-0.5)
    assert depth[1, 5] == pytest.approx(3.0 - 3.0**-0.5 * 2.0**0.5)


def test_pits_and_failed_cells_are_connected_across_the_period():
    mask = np.zeros((5, 6), bool)
    mask[[0, 4], 2] = mask[2, 4] = True
    assert laws.regions(mask, True)[1] == 2 and laws.regions(mask, False)[1] == 3
    damage = np.zeros((2, 4, 6))
    damage[0, 0, 3], damage[1, 3, 3] = 1.0, 0.96  # the lower one is weakened, not below the failed one
    damage[1, 0, 3] = 0.97
    found = laws.broken_out(damage, np.array([0.0, 1.0, 2.0]), np.zeros((4, 6)), "connected")
    assert found[0, 3] == found[3, 3] == 2.0 and np.count_nonzero(found) == 2


def test_solver_gets_what_the_body_has_lost():
    rows, rng = 8, np.random.default_rng(2)
    one = LifeBody.new(
        np.arange(40) * 1.0, rng.normal(size=(rows, 40)), EDGES, np.arange(rows) * 1.0
    )._replace(wear=rng.uniform(size=(rows, 40)) * 0.5)
    recession = one.recession
    bottom = np.where(rng.uniform(size=(rows, 40)) > 0.97, 3.0, recession)
    pit = laws.with_walls(bottom, recession, one.widths) - one.wear
    one = one._replace(pit=pit)
    assert pit.min() == 0.0 < pit.max()
    inner = one.gap_field((0.0, 39.0), (0.0, 39.0)).means(one.faces())
    assert inner == pytest.approx(one.height - one.profile, abs=1e-12)
    for body in life(6, "above"):
        lost, broken_out = (depth.sum() / 6 for depth in (body.height - body.profile, body.pit))
        assert min(broken_out, body.volume) > 1.0
        assert lost == pytest.approx(body.volume + broken_out, rel=1e-12)


def test_solver_meets_pits_of_a_strip_without_short_waves_across():
    one = LifeBody.new(np.arange(40) * 1.0, np.zeros((6, 40)), EDGES, np.arange(6) * 1.0)
    pit = np.zeros((6, 40))
    pit[2, 20] = 1.0
    found = one._replace(pit=pit).gap_field((0.0, 39.0), (0.0, 39.0), short_cutoff=6.0).means(one.faces())
    assert found.sum() == pytest.approx(1.0, abs=2e-2) and found.max() < 0.2
    assert found[1] == pytest.approx(found[3]) and found[5] == pytest.approx(found[5][::-1], abs=0.02)
    pit[:, 20] = 1.0
    found = one._replace(pit=pit).gap_field((0.0, 39.0), (0.0, 39.0), short_cutoff=6.0).means(one.faces())
    assert np.ptp(found, axis=0).max() < 1e-15


def test_picture_of_a_strip_has_maps_of_damage_and_of_pits(tmp_path, monkeypatch):
    stored = LifeHistory('contact = { material = "100Cr6" }', "title")
    for passes, bodies in ((10, life(3, "none")), (40, life(3, "above"))):
        row = {"passes": passes, "jump": 10, "friction": 0.1}
        for k, one in enumerate(bodies, 1):
            row |= {f"pitted_share_{k}": one.pitted_share, f"ra_{k}": one.ra, f"wear_volume_{k}": one.volume}
        stored.add(row, bodies, {})
    drawn = []
    monkeypatch.setattr(lives.style, "save", lambda figure, path: drawn.append(figure))
    lives.draw(stored, tmp_path / "a.png")
    titles = [axes.get_title() for axes in drawn[0].axes]
    body = stored.bodies[-1][1]
    assert "surface 1, 10 passes" in titles[0] and titles[7].startswith(f"{body.pits} pits, ")
    shown = drawn[0].axes[5].collections[0].get_array()
    layer = lives.worst_layer(body)
    assert np.array_equal(np.ma.getmaskarray(shown).ravel(), ~body.is_there[layer].ravel())
    assert np.allclose(np.ravel(drawn[0].axes[7].collections[0].get_array()), 1e6 * body.pit.ravel())


def test_points_have_no_life():
    with pytest.raises(CaseError, match="of line and strip contacts, and this is a point"):
        load(COARSE_LIFE, {"contact.radius": [0.02, 0.02], "contact.load": 100.0})
