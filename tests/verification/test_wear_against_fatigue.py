"""Surfaces over their life: Miner's sum, Archard's volume, wear against fatigue, jumps, restart."""

import numpy as np
import pytest
from support import CASES, COARSE_LIFE

from ehlpetsc import Simulation, read_result
from ehlpetsc.case.loading import load
from ehlpetsc.life import laws, read_life, run_life
from ehlpetsc.life.positions import CELL_SIZE
from ehlpetsc.post.run import Job
from ehlpetsc.post.run import run as post
from ehlpetsc.results.post_result import PostResult

SHORT = {"mesh.points_per_half_width": 10, "time.travel": 3.6, "surface.1.scale": 1.0, "surface.2.scale": 1.0}

PITTED = 1.02e6  # passes after which both surfaces have a few pits


def case(keys):
    return load(COARSE_LIFE, SHORT | keys)


@pytest.mark.parametrize("criterion", ["von-mises", "fatemi-socie"])
def test_cells_without_wear_fail_after_one_over_damage_passes(criterion, tmp_path):
    """By the criterion of [post], which post computes as well."""
    keys = {"post.criterion": criterion, "wear": None, "life.break_out": "none"}
    keys |= {"life.damage_jump": 0.5, "life.passes": 1e12}
    scene = Simulation(case(keys)).scene
    edges = laws.cell_edges(CELL_SIZE * scene.rq, 6 * CELL_SIZE * scene.rq)
    depths = [0.0, *(0.5 * (edges[1:] + edges[:-1]) / scene.scales.a), edges[-1] / scene.scales.a]
    lines: list[str] = []
    options = {"most": 3, "unresolved": True, "show": lines.append}
    life = run_life(case(keys | {"post.depths": depths}), tmp_path / "a.life.h5", **options)
    assert [f" {criterion} 1" in line for line in lines if "by criterion" in line] == [True, True]
    post(Job(str(tmp_path / "a.life.pass.h5"), str(tmp_path / "a.post.h5"), precision="float64"))
    found = PostResult(tmp_path / "a.post.h5")
    failed, damages = 0, found.damage if criterion == "von-mises" else found.criteria[criterion]
    for name, body in zip(("1", "2"), life.bodies[-1], strict=True):
        columns = np.abs(found.s[:, None] - body.s).argmin(axis=0)
        damage = damages[name][1:-1, columns]
        known = np.isfinite(body.failed[: len(damage)])
        failed += np.count_nonzero(known)
        assert body.failed[: len(damage)][known] == pytest.approx(1.0 / damage[known], rel=1e-9)
        assert body.damage[: len(damage)] == pytest.approx(life.done * damage, rel=1e-9)
        assert not body.wear.any() and body.volume == 0.0
    assert failed >= 3


def test_worn_volume_is_k_times_load_times_sliding(tmp_path):
    passes, k = 40_000, (1e-18, 3e-18)
    one = case({"wear.coefficient": list(k), "life.passes": passes, "life.wear_jump": 0.02})
    life = run_life(one, tmp_path / "a.life.h5", unresolved=True)
    scales = Simulation(one).scales
    sliding = passes * abs(scales.u1 - scales.u2) * scales.duration
    assert len(life.rows) >= 3 and life.done == passes
    for body, coefficient in zip(life.bodies[-1], k, strict=True):
        # the steps end within a step's length after the travel asked for, and the mesh holds the load
        assert body.volume == pytest.approx(coefficient * one.contact.load * sliding, rel=1e-6)


def test_worn_volume_of_a_life_is_k_times_the_work_of_the_solids(tmp_path):
    """The integral of their load times the sliding distance; of the whole load if k is given of it."""
    oil = {"viscosity": 0.0002, "law": "roelands", "pressure_viscosity": 11.1e-9, "density": "incompressible"}
    keys = {"fluid": oil | {"eyring_stress": 10e6}, "mesh.points_per_half_width": 8, "life.passes": 1e9}
    for wear in ({"coefficient": 1e-18}, {"load_coefficient": 1e-19}):
        one, lines = case(keys | {"wear": wear}), []
        life = run_life(
            one, tmp_path / "a.life.h5", most=1, unresolved=True, overwrite=True, show=lines.append
        )
        with read_result(tmp_path / "a.life.pass.h5") as result:
            share, dt = (result.steps(name)[1:] for name in ("contact_share", "dt"))
            load_of_step = result.steps("load")[1:]
            sliding = abs(result.attrs["u1"] - result.attrs["u2"])
        of_load = np.where("load_coefficient" in wear, 1.0, share)
        work = (of_load * load_of_step * sliding * dt).sum()
        for body in life.bodies[0]:
            assert body.volume_rate == pytest.approx(next(iter(wear.values())) * work, rel=1e-9)
        (line,) = (line for line in lines if line.startswith("wear, surface 1"))
        assert f"k = {1e-18 if 'coefficient' in wear else 1e-19 / life.rows[0]['contact_share']:.3g} " in line


def test_wear_dominates_at_a_high_rate_and_fatigue_at_a_low_rate(tmp_path):
    """As in Morales-Espejel and Brizmer (2011): mild wear takes off the layer in which micropits begin."""
    ends = {}
    for k, most in ((1e-15, 3), (1e-20, 2)):
        keys = {"wear.coefficient": k, "life.damage_jump": 0.5, "life.wear_jump": 0.2, "time.travel": 6.0}
        keys["mesh.points_per_half_width"] = 12
        ends[k] = run_life(case(keys), tmp_path / f"{k}.life.h5", most=most, unresolved=True)
    polished, pitted = ends[1e-15], ends[1e-20]
    new = polished.bodies[0][0]
    new = new._replace(wear=np.zeros_like(new.wear))
    assert polished.rows[-1]["ra_1"] < 0.95 * new.ra
    assert max(polished("damage_1")) < 0.1 and polished.rows[-1]["pits_1"] == 0
    assert pitted.rows[-1]["pits_1"] >= 1 and pitted.rows[-1]["pitted_share_1"] > 0.0


# a narrow contact of 88 um, whose mesh puts 18 nodes into the shortest wave
RESOLVED = {"contact.radius": 0.005, "contact.load": 140e3, "mesh.points_per_half_width": 64}
RESOLVED |= {"surface.1.short_cutoff": 25e-6, "surface.2.short_cutoff": 25e-6, "time.travel": 4.2}
RESOLVED["post.depths"] = [0.0, 0.005, 0.02, 0.04, 0.06]  # beyond the worst one


def first_round(keys, path, unresolved=False):
    """Largest damage of a pass in each body, and wear of a pass over k, means of the columns."""
    life = run_life(load(COARSE_LIFE, {"life.wear_jump": 0.2, **keys}), path, most=1, unresolved=unresolved)
    bodies, coefficients = life.bodies[0], load(COARSE_LIFE, keys).wear.coefficient
    wear = [body.wear_rate.mean() / k for body, k in zip(bodies, coefficients, strict=True)]
    return [body.damage_rate.max() for body in bodies], wear


def test_rough_partner_damages_the_smoother_surface(tmp_path):
    """Figure 7 of Morales-Espejel and Brizmer (2011): the smooth surface of the pair (b) suffers most.

    Heights in the proportions of their figure 8: 1.0 and 0.05, 0.26 and 0.05, 0.5 and 0.5.
    """
    pairs = {"unequal": (0.45, 0.0225), "smooth": (0.117, 0.0225), "rough": (0.225, 0.225)}
    found = {}
    for name, (one, other) in pairs.items():
        keys = RESOLVED | {"surface.1.scale": one, "surface.2.scale": other}
        found[name], _ = first_round(keys, tmp_path / f"{name}.life.h5")
    (rough, smooth), others = found["unequal"], found["smooth"] + found["rough"]
    assert smooth > 2.0 * rough, "7b against 7c"
    assert smooth > 3.0 * max(others), "7b against 7a and 7d"


def test_thicker_film_protects_from_damage_and_wear(tmp_path):
    """Figure 10 of Morales-Espejel and Brizmer (2011): damage without wear falls with the film over Rq."""
    fluid = {"viscosity": 0.004, "law": "roelands", "pressure_viscosity": 15e-9}
    fluid |= {"density": "dowson-higginson", "eyring_stress": 6e6}
    keys = {"fluid": fluid, "mesh.inlet": -2.0, "contact.asperity_height": 20e-9}
    # a stiff layer; a soft one leaves the damage to single asperities
    keys, found = keys | {"contact.asperity_stiffness": 1.0}, []
    for speed in (0.2, 1.0, 2.0):
        given = keys | {"motion.entrainment_speed": speed}
        found.append(first_round(given, tmp_path / f"{speed}.life.h5", True))
    damage, wear = np.array(found).transpose(1, 0, 2)
    assert max(damage[0]) > 2.0 * max(damage[1]) > 8.0 * max(damage[2])
    assert (wear[0] > 1.2 * wear[1]).all() and (wear[1] > 1.2 * wear[2]).all()


def test_pits_and_wear_are_independent_of_the_jump(tmp_path):
    ends = []
    for part in (1.0, 0.5):
        keys = {"life.wear_jump": 0.2 * part, "life.damage_jump": 0.4 * part, "wear.coefficient": 1e-19}
        life = run_life(case(keys | {"life.passes": PITTED}), tmp_path / f"{part}.life.h5", unresolved=True)
        ends.append((life, life.rows[-1]))
    (life, full), (other, half) = ends
    assert len(other.rows) > len(life.rows) and full["pitted_share_1"] + full["pitted_share_2"] > 0.0
    for name in ("pitted_share_1", "pitted_share_2"):
        assert half[name] == full[name], name
    for name in ("wear_volume_1", "wear_volume_2", "damage_1", "damage_2"):
        assert half[name] == pytest.approx(full[name], rel=0.01), name
    assert other.first_failure == pytest.approx(life.first_failure, rel=0.01)


def test_continued_life_equals_an_uninterrupted_one(tmp_path):
    keys = {
        "wear.coefficient": 1e-18,
        "life.passes": 1e9,
        "time.pass_shift": 50e-6,
        "life.partners": 2,
        "time.travel": 4.4,
    }
    one = case(keys | {"contact.yield_pressure": 2e9, "life.damage_jump": 0.5})
    once = run_life(one, tmp_path / "once.life.h5", most=3, unresolved=True)
    stopped = tmp_path / "stopped.life.h5"
    for most in (1, 1, 1):
        again = run_life(one, stopped, most=most, unresolved=True)
    for life in (again, read_life(stopped)):
        assert life("passes").tolist() == once("passes").tolist()
        for both, others in zip(life.bodies, once.bodies, strict=True):
            for body, other in zip(both, others, strict=True):
                assert body.wear == pytest.approx(other.wear, rel=1e-9)
                assert body.damage == pytest.approx(other.damage, rel=1e-9)
    assert len(once.bodies[0][1].s) > len(once.bodies[0][0].s) - 20


def test_yield_pressure_that_no_pass_reaches_leaves_a_life_as_it_is(tmp_path):
    """Also the first round solves all positions of surface 2."""
    keys, lives = {"time.pass_shift": 50e-6, "life.partners": 2, "time.travel": 4.4}, []
    for yielding in ({}, {"contact.yield_pressure": 1e11}):
        path = tmp_path / f"{len(lives)}.life.h5"
        lives.append(run_life(case(keys | yielding), path, most=2, unresolved=True))
    elastic, hard = lives
    assert hard("solved").tolist() == elastic("solved").tolist() == [2, 2]
    assert hard("passes") == pytest.approx(elastic("passes"), rel=1e-6)
    for name in ("damage_1", "damage_2", "wear_volume_2"):
        assert hard(name) == pytest.approx(elastic(name), rel=1e-6), name


@pytest.mark.parametrize("name, keys", [("wear_and_pits", {}), ("micropitting", {"mesh.width": 0.5})])
def test_exchanged_surfaces_with_exchanged_speeds_exchange_wear_and_damage(name, keys, tmp_path):
    """The number of a body means nothing: the other one is rough, and its speed the other's."""
    waves = {"kind": "self-affine", "sq": 0.1e-6, "hurst": 0.8, "roll_off": 60e-6, "short_cutoff": 20e-6}
    keys = keys | {"mesh.points_per_half_width": 8, "time.travel": 5.0, "time.pass_shift": 0.0}
    keys |= {"life.max_solved": 1, "life.break_out": "none", "life.damage_jump": 1.0}
    keys |= {"post.depths": [0.0, 0.02, 0.1]}
    lives = []
    for rough, smooth, ratio in (("1", "2", 0.25), ("2", "1", -0.25)):
        surfaces = {f"surface.{rough}.synthetic": waves | {"seed": 1}, f"surface.{smooth}": None}
        one = load(CASES / f"{name}.toml", keys | surfaces | {"motion.slide_roll_ratio": ratio})
        lives.append(run_life(one, tmp_path / f"{rough}.life.h5", unresolved=True))
    for body, other in zip(lives[0].bodies[0], reversed(lives[1].bodies[0]), strict=True):
        for values, others in ((body.damage, other.damage), (body.wear, other.wear)):
            assert values.max() > 0.0 and np.abs(values - others).max() <= 1e-9 * values.max()
        assert body.damaged_share(lives[0].done) == other.damaged_share(lives[1].done)
    rough, smooth = lives[0].bodies[0]
    assert smooth.damage.max() > 1.2 * rough.damage.max()  # bodies that differ are exchanged


def test_each_row_of_a_strip_under_ridges_has_the_life_of_the_line(tmp_path):
    """By a stress that has one value a point: the search for the worst plane has other planes in a strip."""
    keys = {"surface.1.synthetic": {"kind": "sine", "amplitude": 0.2e-6, "wavelength": 40e-6}}
    keys |= {"mesh.points_per_half_width": 8, "time.travel": 6.0, "petsc.snes_atol": 1e-12}
    keys |= {"life.max_solved": 1, "life.damage_jump": 1.0, "post.depths": [0.0, 0.02, 0.1]}
    keys |= {"post.criterion": "von-mises", "time.start": "smooth"}
    line, strip = (
        run_life(load(CASES / "wear_and_pits.toml", keys | width), tmp_path / f"{k}.life.h5", unresolved=True)
        for k, width in enumerate(({}, {"mesh.width": 0.3}))
    )
    for alone, rows in zip(line.bodies[0], strip.bodies[0], strict=True):
        assert rows.damage.shape[1] > 1
        np.testing.assert_allclose(rows.wear, np.broadcast_to(alone.wear, rows.wear.shape), rtol=1e-9)
        np.testing.assert_allclose(rows.damage - alone.damage[:, None], 0.0, atol=1e-9 * alone.damage.max())
        assert alone.damage.max() > 0.0 and alone.volume == pytest.approx(rows.volume, rel=1e-9)
