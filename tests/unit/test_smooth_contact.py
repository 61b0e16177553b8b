"""The smooth contact as the control of asperities: life and depth, damaged shares, notes on depths."""

from types import SimpleNamespace

import numpy as np
import pytest
from support import COARSE_LIFE
from support.made_loads import Scene, write

from ehlpetsc.analysis.summary import damage_scalars
from ehlpetsc.case.loading import load
from ehlpetsc.commands.post import main
from ehlpetsc.life import laws, run_life
from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.remarks import depth_lines, limits
from ehlpetsc.post.fatigue.strain_life import Material, cycles_to_failure
from ehlpetsc.post.level import standard_line
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.post_result import DAMAGED, PostResult, SmoothContact, is_damaged, post_path

NU, P0 = 0.3, 0.999455e9


def static_stresses(x, z, friction):
    """sx, sz, txz in p0 under Hertz's pressure and Coulomb's traction, by Gauss and Chebyshev's rule."""
    nodes = 500
    angles = np.pi * np.arange(1, nodes + 1) / (nodes + 1)
    s, weights = np.cos(angles), np.pi / (nodes + 1) * np.sin(angles) ** 2  # of p = sqrt(1 - s^2)
    r = x[:, None] - s
    d = (r**2 + z**2) ** 2
    sx = -2 / np.pi * ((z * r**2 + friction * r**3) / d) @ weights
    sz = -2 / np.pi * ((z**3 + friction * z**2 * r) / d) @ weights
    txz = -2 / np.pi * ((z**2 * r + friction * z * r**2) / d) @ weights
    return sx, sz, txz


def life_at(z, friction):
    """Passes to D = 1 of one cycle between the extremes of each component, the worst of the three."""
    parts = static_stresses(np.linspace(-4.0, 4.0, 401), z, friction)
    lives = []
    for channel in parts:
        ends = [channel.argmax(), channel.argmin()]
        dx, dz, dt = (np.ptp(part[ends]) * np.sign(part[ends[0]] - part[ends[1]]) for part in parts)
        dy = NU * (dx + dz)
        equivalent = 0.5 * ((dx - dy) ** 2 + (dy - dz) ** 2 + (dz - dx) ** 2) + 3 * dt**2
        lives.append(cycles_to_failure(P0 * np.sqrt(equivalent), Material(), strain="neuber"))
    return min(lives)


@pytest.fixture(scope="module")
def processed(tmp_path_factory):
    """A result with ripples of both surfaces, and what the command prints."""
    path = write(tmp_path_factory.mktemp("smooth") / "a.h5", Scene(per_width=20, ratio=0.5, travel=7.0))
    return path


def test_life_and_depth_are_those_of_static_stresses(processed, capsys):
    assert main([str(processed)]) == 0
    line = next(
        line
        for line in capsys.readouterr().out.splitlines()
        if line.startswith("smooth contact, surface 1, D:")
    )
    found = dict(word.split("=") for word in line.split() if "=" in word)
    depths = np.linspace(0.3, 0.8, 26)
    lives = np.array([life_at(z, 0.05) for z in depths])
    worst = lives.argmin()
    bends = np.polyfit(depths[worst - 1 : worst + 2], 1.0 / lives[worst - 1 : worst + 2], 2)
    post = PostResult(post_path(processed))
    scalars, a = damage_scalars(post), post.a
    assert float(found["smooth_life"]) == pytest.approx(lives.min(), rel=0.02)
    assert float(found["smooth_depth"]) == pytest.approx(-0.5 * a * bends[1] / bends[0], rel=0.02)
    for name, unit in (("smooth_life", 1e-3), ("smooth_depth", 1e-2)):
        assert scalars[f"{name}_2"] == pytest.approx(float(found[name]), rel=unit)


def test_constants_are_scaled_to_the_life_of_a_test(processed, tmp_path):
    """At its pressure the smooth contact lives as in the test."""
    lives = []
    for settings in ((), (f"post.life_at=[{P0}, 3e7]", "post.criterion=fatemi-socie")):
        run(Job(str(processed), str(tmp_path / "a.h5"), settings=settings, surfaces=("1",)))
        lives.append(PostResult(tmp_path / "a.h5").smooth)
    assert lives[1]["fatemi-socie"]["1"].life == pytest.approx(3e7, rel=0.03)  # with friction, of 0.05
    assert lives[1][None]["1"].life > 2.0 * lives[0][None]["1"].life, "of both criteria"
    assert "1.1e+07 load cycles" in standard_line(1.682e9) and "above the fatigue limit" in standard_line(
        1.7e9
    )
    assert "over 5e+07" in standard_line(1.4e9) and "below" in standard_line(1.4e9)
    assert "under 100000 load" in standard_line(2.5e9)


MIRROR = {
    "surface.1": {"synthetic": {"kind": "ground", "ra": 1e-9, "correlation": 2e-4, "seed": 1}},
    "surface.2": None,
    "mesh.points_per_half_width": 12,
    "time.travel": 4.0,
    "wear": None,
    "life.break_out": "none",
    "life.damage_jump": 1.0,
    "life.passes": 1e7,
    "life.max_solved": 1,
}


@pytest.mark.parametrize("depths", [[0.0, 0.02, 0.2], [0.0, 0.1, 0.25, 0.5, 0.75, 1.0]])
def test_a_mirror_has_no_damaged_share_at_any_depths(depths, tmp_path):
    lines: list[str] = []
    case = load(COARSE_LIFE, MIRROR | {"post.depths": depths})
    life = run_life(case, tmp_path / "a.life.h5", unresolved=True, show=lines.append)
    for k, body in enumerate(life.bodies[-1], 1):
        assert body.edges[-1] == pytest.approx(depths[-1] * 0.0003366, rel=1e-3)
        assert (body.damage.max(axis=0) > DAMAGED).all(), "by the smooth contact"
        assert life(f"damaged_share_{k}")[-1] == 0.0
        assert body.damage_rate.max() * life.rows[-1][f"smooth_life_{k}"] < 1.3
    assert any(line.startswith("limit: of ") for line in lines)
    assert sum("where the smooth contact fails" in line for line in lines) == 2 * (depths[-1] < 0.5)


def test_asperities_damage_where_the_smooth_contact_hardly_does():
    assert is_damaged(np.array([0.09, 0.5, 0.5, 20.0]), np.array([0.0, 0.04, 0.06, 3.0])).tolist() == [
        False,
        True,
        False,
        False,
    ]
    edges, made = np.array([0.0, 1.0, 2.0]), np.zeros(4)
    body = LifeBody.new(np.arange(4.0), made, edges, smooth_rate=np.array([0.0, 1e-3]))
    body = body._replace(damage=np.array([[0.0, 0.2, 0.0, 0.0], [0.3, 0.0, 0.9, 0.0]]))
    assert [body.damaged_share(passes) for passes in (20, 60, 1000)] == [0.75, 0.5, 0.25]


def test_depths_that_miss_the_worst_and_pits_that_end_with_them_are_named():
    figures = {f"smooth_{name}_{k}": value for k in (1, 2) for name, value in (("life", 1e6), ("depth", 8.0))}
    bodies = [
        SimpleNamespace(depths=np.array([0.0, 1.0, last]), damage=np.array([[0.0], [2.0], [worst]]))
        for last, worst in ((9.0, 3.0), (5.0, 1.0))
    ]
    lines = list(depth_lines(bodies, figures))
    assert len(lines) == 2
    assert lines[0].startswith("limit: D of surface 1 still rises at the last of post.depths, 9 m")
    assert lines[1].startswith(
        "note: post.depths end 5 m below surface 2, where the smooth contact fails 8 m"
    )
    one = LifeBody.new(np.arange(4.0), np.zeros(4), np.array([0.0, 1.0, 2.0]))
    cut = one._replace(pit=np.array([0.0, 2.0, 1.0, 0.0]))
    whole = one._replace(pit=np.array([0.0, 1.0, 0.0, 0.0]))
    life = SimpleNamespace(rows=[figures], bodies=[(whole, cut)], done=1e6)
    assert [line.partition(":")[0] for line in limits(life)] == ["limit"]
    assert "a pit of surface 2 reaches the last cell" in next(limits(life))
    life = SimpleNamespace(rows=[figures], bodies=[(whole, whole)], done=2e6)
    assert sum("exceed the life of the smooth contact" in line for line in limits(life)) == 2


@pytest.mark.parametrize(("deepest", "change"), [(0.5, 0.03), (3.0, 0.02), (8.0, 0.01), (20.0, 0.01)])
def test_cells_end_at_the_last_depth_and_change_smoothly_with_the_roughness(deepest, change):
    """An Sq smaller by 3 % moved the deepest centre by a fifth, and D with it."""
    centres = []
    for rq in np.geomspace(0.05, 0.2, 47):  # 3 % apart
        edges = laws.cell_edges(0.25 * rq, deepest)
        assert edges[0] == 0.0 and edges[-1] == deepest and (np.diff(edges) > 0.0).all()
        centres.append(0.5 * (edges[-1] + edges[-2]))
    assert np.abs(np.diff(np.log(centres))).max() < change


def test_worst_depth_is_a_vertex_and_damage_is_interpolated():
    depths = np.linspace(0.0, 1.0, 11)
    smooth = SmoothContact(depths, 1.0 - (depths - 0.47) ** 2)
    assert smooth.depth == pytest.approx(0.47)
    expected = [0.5 * smooth.damage[2:4].sum(), smooth.damage[-1]]
    assert smooth.damage_at(np.array([0.25, 3.0])) == pytest.approx(expected)
    assert SmoothContact(depths, np.zeros(11)).life == np.inf
