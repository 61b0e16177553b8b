"""Laws of a surface over its life: jumps, ageing cells, micropits, strips; its file, line and picture."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import erf
from support import CASES, COARSE_LIFE, ROOT, roelands_oil
from support.made_results import save_life

from ehlpetsc.base.errors import CaseError, OutputError
from ehlpetsc.case.loading import load
from ehlpetsc.commands.life import main
from ehlpetsc.effects.depths import PlasticRecord
from ehlpetsc.life import laws, read_life, run_life
from ehlpetsc.life.body import MAX_EXTRAPOLATION, MAX_FALL, LifeBody, Rates
from ehlpetsc.life.driver import _Life, check_case, line_of
from ehlpetsc.life.history import LifeHistory, stored_or_new
from ehlpetsc.life.jumps import Jumps
from ehlpetsc.life.one_pass import NO_DEPTH, OfBody, deepest
from ehlpetsc.life.positions import Positions, number_of_positions, with_shift
from ehlpetsc.life.remarks import wear_lines
from ehlpetsc.life.rounds import Round
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import lives
from ehlpetsc.results.post_result import SmoothContact
from ehlpetsc.surfaces.motion.body_field import BodyField, BodyFields

EDGES = np.array([0.0, 1.0, 2.0, 4.0])


def jumps(wear_jump=0.05, damage_jump=0.1, passes=1000, break_out="connected"):
    keys = {"passes": passes, "damage_jump": damage_jump, "break_out": break_out}
    return Jumps(SimpleNamespace(wear_jump=0.25 * wear_jump, **keys), 4.0)  # of a roughness rq of 4


def round_of(rates):
    """A round whose rates follow from a body alone, the same for both."""
    return SimpleNamespace(rates=lambda bodies: tuple(map(rates, bodies)), yielded=0.0, passes=[None])


def jump(wear=0.0, added=0.0, damage=0.0, left=1000):
    """Length of a jump at these rates."""
    one = body()._replace(damage=np.full((3, 8), damage))
    rates = Rates(np.append(np.zeros(7), wear), np.full((3, 8), added), 0.0)
    return jumps(passes=left, break_out="none").jump((one, one), round_of(lambda body: rates), 0)[1]


def test_jump_ends_at_the_allowed_wear_or_damage():
    assert jump(wear=0.05 / 64) == 64
    assert jump(added=0.1 / 32) == 32
    assert jump(wear=0.05 / 64, added=0.1 / 32) == 32
    assert jump() == 1000, "nothing changes: all the rest at once"
    assert jump(wear=1.0) == 1, "one pass at least"
    assert jump(added=0.01, damage=1.0) == 1000, "cells that have failed do not count"


@pytest.mark.parametrize("worn", [0.0, 0.5])
def test_jump_ends_where_wear_exposes_failed_cells(worn):
    damage = np.zeros((3, 8))
    damage[1] = 1.0
    one = body()._replace(damage=damage, wear=np.full(8, worn))
    rates = Rates(np.full(8, 1e-3), np.zeros((3, 8)), 0.0)
    bodies, jump, _ = jumps(wear_jump=5.0, passes=1400).jump((one, one), round_of(lambda body: rates), 0)
    assert jump == 1001 - 1000 * worn and bodies[0].pit == pytest.approx(2.0 - 1.001)


def test_round_has_a_position_for_each_partner_and_the_largest_pressure_on_its_columns():
    gears = SimpleNamespace(pair=SimpleNamespace(partners=24))
    for partners, pair, positions in ((30, gears, 24), (3, gears, 3), (30, None, 30)):
        life, time = SimpleNamespace(partners=partners), SimpleNamespace(pass_shift=1e-5)
        assert number_of_positions(SimpleNamespace(time=time, life=life, gears=pair)) == positions
    passes = []
    for peak in (1e9, 3e9, 2e9):
        pressure = np.array([9e9, *np.linspace(0.0, peak, 8), 9e9])  # beside the columns too
        ends = SimpleNamespace(s=np.arange(-1.0, 9.0), pressure=pressure)
        figures = {"p_max": 9e9, "friction_coefficient": 1e-9 * peak}
        passes.append(SimpleNamespace(bodies=(ends, ends), figures=figures))
    found = Round(passes, 1.0).figures((body(), body()))
    assert found["p_max"] == 3e9 and found["friction"] == pytest.approx(2.0)


@pytest.mark.parametrize("slope", [-3e-4, 0.0, 2e-3])
def test_passes_to_reach_a_sum(slope):
    assert laws.sum_over(laws.passes_to(0.7, 0.05, slope), 0.05, slope) == pytest.approx(0.7, rel=1e-13)


def test_rates_are_extrapolated_without_change_of_sign_and_no_rate_reaches_nothing():
    rates = Rates(np.array([3.0, 1.0, 1.0]), np.zeros((1, 3)), 2.0)
    found = rates.continued((np.array([2.0, 0.9, 9.0]), np.zeros((1, 3)), 2.0), 10, column_area=0.1)
    assert found.slopes[0] == pytest.approx([0.1, 0.01, -MAX_FALL / (MAX_EXTRAPOLATION * 10)])
    assert found.after(20)[0] == pytest.approx([80.0, 22.0, 15.0])
    assert found.wear + 10 * MAX_EXTRAPOLATION * found.slopes[0] == pytest.approx([5.0, 1.2, 0.5])
    beyond = 20 * 1.5 + 200 * (1.5 - 0.81) / 10  # the columns
    assert found.after(20)[2] == pytest.approx(0.1 * 117.0 + beyond)
    assert laws.passes_to(0.7, 0.0, 0.0) == np.inf and laws.passes_to(0.7, 0.05, -2e-3) == np.inf


def test_wear_and_damage_converge_at_second_order():
    """Rates that wear lets fall: dw/dt = exp(-w), hence w = ln(1 + t), and D = -ln(1 - w/3)."""

    def rates(one):
        rate = 1e-3 * np.exp(-one.wear)
        return Rates(rate, np.tile(rate / (3.0 - one.wear), (3, 1)), float(rate.sum()))

    errors = []
    for part in (1.0, 0.5, 0.25):
        bodies, done, before = (body(), body()), 0, 0
        while done < 5000:
            all_jumps = jumps(0.2 * part, 0.1 * part, passes=5000, break_out="none")
            bodies, before, _ = all_jumps.jump(bodies, round_of(rates), done, before)
            done += before
        exact = np.log(6.0)
        ends = bodies[0].wear[0] - exact, bodies[0].damage[2, 0] + np.log(1.0 - exact / 3.0)
        errors.append(np.abs(ends))
    assert errors[0] == pytest.approx([0.0, 0.0], abs=0.03)
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.4)


def test_first_pit_is_independent_of_the_allowed_jump():
    def rates(one):
        added = 1e-5 * np.exp(-0.2 * laws.cell_depths(EDGES, one.recession)) * np.arange(1, 9)
        return Rates(np.zeros(8), np.nan_to_num(added), 0.0)

    ends = []
    for allowed in (0.1, 0.03):
        bodies, done = (body(), body()), 0
        while not bodies[0].pits:
            bodies, jump, _ = jumps(damage_jump=allowed, passes=100_000).jump(bodies, round_of(rates), done)
            done += jump
        ends.append((done, *bodies[0].pit))
    assert ends[0] == ends[1]
    assert ends[0][0] == int(np.exp(0.1) / 8e-5) + 1
    assert bodies[0].pit == pytest.approx([0.0] * 6 + [1.0 - 3.0**-0.5, 1.0])  # and the wall beside it
    assert bodies[0].failed[0, -1] == pytest.approx(np.exp(0.1) / 8e-5, rel=1e-12)


def test_cells_reach_the_depth_recede_with_the_surface_and_take_damage_between_depths():
    edges = laws.cell_edges(0.5, 100.0)
    assert edges[0] == 0.0 and edges[-1] == 100.0
    assert np.diff(edges)[: laws.FINE_CELLS] == pytest.approx(0.5)
    assert np.diff(edges)[-1] / np.diff(edges)[-2] == pytest.approx(laws.CELL_GROWTH, rel=0.02)
    depths = laws.cell_depths(EDGES, np.array([0.0, 0.5, 1.0, 3.0]))
    expected = [[0.5, 0.25, np.nan, np.nan], [1.5, 1.0, 0.5, np.nan], [3.0, 2.5, 2.0, 0.5]]
    assert depths == pytest.approx(np.array(expected), nan_ok=True)
    depths, damage = np.array([0.0, 1.0, 3.0]), np.array([[1e-4], [1e-2], [0.0]])
    at = np.array([[0.0], [0.5], [1.0], [2.0], [3.0], [3.1], [np.nan]])
    found = laws.damage_at(depths, damage, at)
    assert found[:, 0] == pytest.approx([1e-4, 1e-3, 1e-2, 5e-3, 0.0, 0.0, 0.0], rel=1e-12)


def test_failed_cells_break_out_if_connected_to_the_surface_or_with_all_above():
    damage = np.zeros((3, 5))
    damage[0, 1] = damage[1, 1] = damage[1, 2] = 1.0  # at the surface, and beside it below
    damage[2, 4] = 1.0  # inside the body
    assert laws.broken_out(damage, EDGES, np.zeros(5), "connected").tolist() == [0.0, 2.0, 2.0, 0.0, 0.0]
    lowered = np.array([0.0, 2.5, 0.0, 0.0, 2.5])
    assert laws.broken_out(damage, EDGES, lowered, "connected").tolist() == [0.0, 2.5, 0.0, 0.0, 4.0]
    damage[:2, 3] = 0.97, 0.94
    assert laws.broken_out(damage, EDGES, np.zeros(5), "connected").tolist() == [0.0, 2.0, 2.0, 0.0, 0.0], (
        "none failed"
    )
    damage[0, 2] = 0.96
    assert laws.broken_out(damage, EDGES, np.zeros(5), "connected").tolist() == [0.0, 2.0, 2.0, 1.0, 0.0]
    pitted = body(4)._replace(is_pitted=np.array([True, True, False, True]))
    assert pitted.pits == 2
    damage = np.zeros((3, 4))
    damage[1, 1] = damage[2, 2] = 1.0  # inside the body
    damage[2, 1], damage[1, 3] = 0.96, 0.97  # weakened: below a failed cell, and alone
    assert laws.broken_out(damage, EDGES, np.zeros(4), "above").tolist() == [0.0, 4.0, 4.0, 0.0]
    assert laws.broken_out(damage, EDGES, np.zeros(4), "connected").tolist() == [0.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("columns", [41, 161])
def test_pits_are_as_wide_on_any_mesh(columns):
    """A cell that fails at a depth of 4 breaks out with all below 30 degrees above it."""
    width, middle = 20.0 / (columns - 1), columns // 2
    bottom = np.full(columns, 0.5)  # worn before
    bottom[middle] = 4.0
    depth = laws.with_walls(bottom, np.full(columns, 0.5), (width,))
    assert depth[middle] == 4.0 and depth[0] == 0.5
    assert width * np.count_nonzero(depth > 0.5) == pytest.approx(2 * 3.5 * 3.0**0.5, abs=width)


def body(columns=8):
    return LifeBody.new(np.arange(columns) * 1.0, np.zeros(columns), EDGES)


def of_pass(damage, depth=0.01, columns=8):
    faces = np.arange(columns + 1) - 0.5
    none = BodyField(0.25, 0, np.zeros(0))
    worn = none.add(faces, np.full(columns, depth))
    rows = np.array([np.full(columns, damage), np.full(columns, 0.1 * damage)])
    return OfBody(np.arange(columns) * 1.0, np.array([0.0, 4.0]), rows, np.zeros(columns), (none, worn))


def test_cells_worn_before_failure_do_not_fail():
    """A cell at Z fails before it is gone where the sum over its way to the surface reaches 1."""
    ends = {}
    for depth in (0.01, 0.2):
        one = body()
        for _ in range(12):
            rates = Rates(*one.rates(of_pass(0.02, depth)), 8.0 * depth)
            one = one.after(rates, 1, 0, True)
        ends[depth] = one
    assert ends[0.2].wear == pytest.approx(12 * 0.2) and ends[0.2].volume == pytest.approx(12 * 1.6)
    assert ends[0.2].largest_damage < ends[0.01].largest_damage
    slow = ends[0.01]
    rates = Rates(*slow.rates(of_pass(0.02, 0.01)), 0.08)
    pitted, counted = (slow.after(rates, 100, 12, breaks) for breaks in ("above", "none"))
    assert pitted.is_pitted.all() and pitted.pits == 1 and pitted.pit.min() > 0.0
    assert counted.is_pitted.all() and not counted.pit.any(), "failed cells are counted alone"


def test_surfaces_outside_the_computed_length_have_mean_wear_and_stretches_whole_columns():
    one = body()._replace(wear=np.arange(8.0))
    field = one.gap_field((2.0, 5.0), (-3.0, 12.0))
    faces = np.array([-3.0, 1.5, 2.5, 3.5, 4.5, 5.5, 12.0])
    assert field.means(faces) == pytest.approx([3.5, 2.0, 3.0, 4.0, 5.0, 3.5])
    pitted = one._replace(pit=np.where(np.arange(8) == 4, 9.0, 0.0)).gap_field((2.0, 5.0), (-3.0, 12.0))
    assert pitted.means(faces) == pytest.approx([3.5, 2.0, 3.0, 13.0, 5.0, 3.5]), "a pit makes no step there"
    one = body()._replace(s=1e-5 * np.arange(8.0))
    assert np.flatnonzero(one.columns_within((2.2e-5, 4.8e-5))).tolist() == [2, 3, 4, 5]
    assert np.flatnonzero(one.columns_within((2.3e-5, 4.7e-5))).tolist() == [3, 4]
    assert one.faces() == pytest.approx(1e-5 * (np.arange(9.0) - 0.5))


def test_life_file_round_trip_and_refusal_of_nan(tmp_path):
    life, path = LifeHistory("text", "title"), tmp_path / "a.life.h5"
    strip = LifeBody.new(np.arange(5.0), np.ones((3, 5)), EDGES, np.arange(3.0))
    for passes in (10, 30):
        plastic = {"depth": np.arange(3.0 * (passes - 10)).reshape(3, -1), "first": passes}  # none at first
        bodies = body(), strip._replace(volume=1.0 + passes)
        life.add({"passes": passes, "jump": 10, "friction": 0.1}, bodies, plastic)
    save_life(life, path)
    found = read_life(path)
    assert found.rows == life.rows and found.done == 30 and found.case == "text"
    for one, other in zip(found.bodies[1], life.bodies[1], strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))
    for one, other in zip(found.plastic, life.plastic, strict=True):
        assert one["first"] == other["first"] and np.array_equal(one["depth"], other["depth"])
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(OutputError):
        read_life(path)
    stored, path = LifeHistory(load(COARSE_LIFE).text, "title"), tmp_path / "a.life.h5"
    one = body()
    stored.add({"passes": 10, "jump": 10}, (one, one._replace(damage=np.nan * one.damage)), {})
    save_life(stored, path)
    kept = path.read_bytes()
    with pytest.raises(OutputError, match=r"a.life.h5: damaged \(surface/2/damage contains nan\)"):
        stored_or_new(load(COARSE_LIFE), path, overwrite=False)
    assert path.read_bytes() == kept


@pytest.mark.parametrize("change", [("passes = 1e6", "passes = 2000000.0 # longer"), ("1e-19", "0.1E-18")])
def test_longer_or_annotated_life_is_continued(change, tmp_path):
    text, path = COARSE_LIFE.read_text().replace('"../..', f'"{ROOT}'), tmp_path / "a.life.h5"
    (tmp_path / "a.toml").write_text(text)
    stored = LifeHistory(load(tmp_path / "a.toml").text, "title")
    stored.add({"passes": 10, "jump": 10}, (body(), body()), {})
    save_life(stored, path)
    assert change[0] in text
    (tmp_path / "a.toml").write_text(text.replace(*change))
    continued = stored_or_new(load(tmp_path / "a.toml"), path, overwrite=False)
    assert continued.done == 10 and "".join(change[1]) in continued.case
    other = load(tmp_path / "a.toml", {"wear.coefficient": 2e-19})
    with pytest.raises(OutputError, match="another case"):
        stored_or_new(other, path, overwrite=False)


def test_life_on_an_unresolved_profile_is_refused(tmp_path):
    with pytest.raises(CaseError, match=r"surface.1: .*95.8 %.*points_per_half_width = 98"):
        run_life(COARSE_LIFE, tmp_path / "a.life.h5")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "file, keys, text",
    [
        ("table1_mixed.toml", {}, "no \\[life\\] table"),
        ("table1_smooth.toml", {"life.passes": 10.0}, "rough"),
        ("table1_mixed.toml", {"life.passes": 10.0, "output.every": 2}, "output.every = 1"),
    ],
)
def test_case_without_a_life_is_refused(file, keys, text):
    with pytest.raises(CaseError, match=text):
        check_case(load(CASES / file, keys))


def test_solver_meets_pits_without_waves_below_the_short_cutoff():
    """Filtered as the profile is, on any columns: the same pit on columns half as wide has the same edges."""
    fields = []
    for width in (1.0, 0.5):
        s = np.arange(0.5 * width, 200.0, width)
        pit = np.where(np.abs(s - 100.0) < 10.0, 5.0, 0.0)
        one = LifeBody.new(s, np.zeros(s.size), EDGES)._replace(pit=pit)
        fields.append(one.gap_field((s[0], s[-1]), (s[0], s[-1]), short_cutoff=40.0))
    coarse, fine = (field.means(np.arange(2.0, 199.0)) for field in fields)
    assert coarse == pytest.approx(fine, abs=0.02)
    width = 40.0 * np.sqrt(np.log(2.0) / np.pi)  # of the Gaussian weight exp[-pi (x/width)^2]/width
    assert coarse.max() == pytest.approx(5.0 * erf(np.sqrt(np.pi) * 10.0 / width), rel=2e-3)
    assert np.abs(np.diff(coarse)).max() == pytest.approx(5.0 / width, rel=0.05)
    assert coarse.sum() == pytest.approx(100.0)


def made_life(pits=0, rows=2):
    """A life of a body that is worn from row to row."""
    found = LifeHistory('contact = { material = ["100Cr6", "16MnCr5"] }', "title")
    for row in range(1, rows + 1):
        one = LifeBody.new(np.arange(8) * 1e-5, 1e-8 * np.arange(8), 1e-7 * EDGES)
        one = one._replace(wear=np.full(8, 2e-8 * row), damage=np.full((3, 8), 0.1 * row))
        if pits:
            one = one._replace(failed=np.full((3, 8), 8e5))
        figures = {"passes": 10 * row, "jump": 10, "solved": 1, "friction": 0.1}
        for k in (1, 2):
            figures |= {f"pits_{k}": pits, f"pitted_share_{k}": 0.05 * k * pits, f"ra_{k}": one.ra}
            figures |= {f"damage_{k}": 0.1 * row, f"smooth_life_{k}": 5e5 * k, f"smooth_depth_{k}": 4e-5}
            figures[f"wear_volume_{k}"] = 1e-12 * row
        found.add(figures, (one._replace(failed=2.0 * one.failed), one), {})  # the first one fails later
    return found


def test_line_of_a_round_names_its_figures_and_no_picture_is_drawn_unasked(tmp_path):
    figures = dict(entry.split("=") for entry in line_of(made_life(pits=2, rows=3), 3.4).split())
    assert figures.pop("friction") == "0.1000" and figures.pop("wall") == "3s"
    expected = {"solved": 3, "passes": 30, "D1": 0.3, "D2": 0.3, "pitted1": 0.1, "pitted2": 0.2}
    expected |= {"worn1": 3e-12, "worn2": 3e-12}
    assert {name: float(value) for name, value in figures.items()} == expected
    save_life(made_life(), tmp_path / "a.life.h5")
    assert main([str(tmp_path / "a.life.h5"), "--no-picture"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["a.life.h5"]


def test_picture_names_the_steels_of_the_stored_case(tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(lives.style, "save", lambda figure, path: drawn.append(figure))
    lives.draw(made_life(), tmp_path / "a.png")
    smooth = "smooth contact: fails after 5e+05 passes 40 µm deep and 1e+06 passes 40 µm deep"
    assert drawn[0]._suptitle.get_text() == f"title (100Cr6, 16MnCr5)\n{smooth}"
    worn = next(axes for axes in drawn[0].axes if axes.get_ylabel() == "worn [µm²]")
    assert [line.get_linestyle() for line in worn.lines] == ["-", "--"], "surface 1 shows through"


def short_case(keys):
    """A case whose points pass the contact, but those of the slow surface with its profile on the ramp."""
    ground, layer = {"kind": "ground", "ra": 1e-7, "correlation": 4e-5}, {"asperity_height": 2e-8}
    case = {
        "title": "short",
        "contact": {"radius": 0.0191, "load": 400e3, "material": "16MnCr5", "model": "mixed"} | layer,
        "fluid": roelands_oil(0.004, 15e-9),
        "motion": {"entrainment_speed": 3.0, "slide_roll_ratio": 0.4},
        "mesh": {"inlet": -1.8, "outlet": 1.4, "points_per_half_width": 12},
        "surface": {str(k): {"synthetic": ground | {"seed": 2 + k}} for k in (1, 2)},
        "time": {"travel": 4.81, "courant": 2.0, "pass_shift": 0.0},
        "wear": {"coefficient": 1e-15},
        "life": {"passes": 1e5, "partners": 2, "max_solved": 3},
    }
    return load(case, keys)


@pytest.mark.parametrize(
    "keys, side",
    [
        ({}, 2),
        ({"motion.slide_roll_ratio": -0.4}, 1),
        ({"time.pass_shift": 3e-4}, 2),
        ({"time.travel": 3.0}, 2),
    ],
)
def test_travel_too_short_is_named_before_a_pass_is_solved(tmp_path, keys, side):
    shown = []
    allowed = r"time.travel = [\d.]+, allowed: (6.[456]|8) or more"
    with pytest.raises(CaseError, match=f"surface {side}: .*{allowed}"):
        run_life(short_case(keys), tmp_path / "a.h5", unresolved=True, show=shown.append)
    assert shown == [] and not list(tmp_path.glob("*pass*"))


def test_rates_of_a_round_are_means_and_body_2_of_gears_has_its_own_passes():
    passes = [
        SimpleNamespace(bodies=(of_pass(damage), of_pass(2.0 * damage)), yielded=0.0)
        for damage in (0.01, 0.03)
    ]
    first, second = Round(passes, 0.5).rates((body(), body()))
    alone = [Round([one], 0.5).rates((body(), body()))[0].damage for one in passes]
    np.testing.assert_allclose(first.damage, np.mean(alone, axis=0), rtol=1e-12)
    np.testing.assert_allclose(second.damage, first.damage, rtol=1e-12)
    np.testing.assert_allclose(first.wear, 0.01, rtol=1e-12)
    np.testing.assert_allclose(second.wear, 0.005, rtol=1e-12)
    assert second.volume == pytest.approx(0.5 * first.volume, rel=1e-12)


def test_columns_of_a_strip_have_a_width_across_and_along():
    strip = LifeBody.new(np.array([2.0, 2.5, 3.0]), np.zeros((4, 3)), EDGES)._replace(
        y=np.array([1.0, 4.0, 7.0, 10.0])
    )
    assert strip.widths == (3.0, 0.5) and body().widths == (1.0,)
    assert strip.column_area == pytest.approx(0.125)


def test_lines_on_wear_state_both_rates_and_the_change_of_damage_in_the_last_round():
    class Rows(SimpleNamespace):
        def __call__(self, name):
            return {"damage_1": np.array([0.1, 0.5, 0.52]), "damage_2": np.array([0.1, 0.5, 0.45])}[name]

    life = Rows(rows=[{"contact_share": 0.2}] * 3, limiting_wear=lambda k: 10.0 * k)
    wear = SimpleNamespace(coefficient=(1e-17, 3e-17), load_coefficient=None)
    case = SimpleNamespace(wear=wear, life=SimpleNamespace(break_out="none"))
    rate_1, limit_1, _, limit_2 = wear_lines(life, case)
    assert (
        "k = 1e-17 m^2/N of the load of the solids, 2e-18 of the whole load; the solids carry 20 %" in rate_1
    )
    assert "from k = 1e-16 m^2/N on; D changed by 4 % in" in limit_1
    assert "from k = 6e-16 m^2/N on; D changed by -10 % in" in limit_2
    assert (
        next(
            wear_lines(
                life,
                SimpleNamespace(
                    wear=SimpleNamespace(coefficient=None, load_coefficient=(2e-18,)), life=case.life
                ),
            )
        )
        == rate_1
    )


@pytest.mark.parametrize("done, shares", [(100, [0.2, 0.5, 1.0]), (800, [0.8, 0.8, 1.0])])
def test_the_share_shown_is_that_of_the_solved_passes_or_of_the_life(done, shares):
    shown = []
    one = {"_line": SimpleNamespace(reach=shown.append), "ranks": SimpleNamespace(groups=2), "_passes": 1}
    one["history"] = SimpleNamespace(solved=2, done=done)
    one["case"], one["jumps"] = SimpleNamespace(life=SimpleNamespace(max_solved=10)), jumps(passes=1000)
    for passes, of_pass_done in ((0, 0.0), (1, 0.5), (9, 0.5)):
        _Life._show_share(SimpleNamespace(**one | {"_passes": passes}), of_pass_done)
    assert shown == shares


def test_columns_that_meet_partners_do_not_depend_on_rounding():
    found, spacing = [], Scales.of(short_case({})).spacing
    for rounding in (-1e-13, 1e-13):
        keys = {"time.pass_shift": 5.0 * spacing * (1.0 + rounding), "life.partners": 3}
        found.append(Positions(case := short_case(keys), Scales.of(case))._margins)
    assert found[0] == found[1] == (10, -5)


def test_the_yield_of_a_pass_is_the_largest_depth_of_either_body_and_not_their_sum():
    old = BodyField(1e-6, 0, np.full(6, 2e-9))
    new = old._replace(depth=old.depth + 1e-9 * np.array([0.0, 1.0, 5.0, 2.0, 0.0, 0.0]))
    less = old._replace(depth=old.depth + 1e-9 * np.array([0.0, 3.0, 3.0, 3.0, 0.0, 0.0]))
    wider = BodyField(1e-6, -1, np.append(3e-9, new.depth))  # a cell more
    assert deepest([(old, new), (old, less)]) == deepest([(old, less), (old, new)]) == pytest.approx(5e-9)
    assert deepest([(old, wider), (old, old)]) == pytest.approx(5e-9)
    assert deepest([(old, old), (NO_DEPTH, NO_DEPTH)]) < 1e-20


@pytest.mark.parametrize("ratio, side", [(2.0, 2), (-2.0, 1)])
def test_a_surface_at_rest_has_no_life(tmp_path, ratio, side):
    with pytest.raises(
        CaseError, match=f"surface {side} is where it began .* needs points that pass"
    ) as refusal:
        run_life(short_case({"motion.slide_roll_ratio": ratio}), tmp_path / "a.h5", unresolved=True)
    assert len(refusal.value.faults) == 1 and not list(tmp_path.glob("*pass*"))


def test_travel_that_is_allowed_is_enough():
    for shift, travel in ((0.0, 6.5), (3e-4, 8.0)):
        case = short_case({"time.travel": travel, "time.pass_shift": shift})
        Positions(case, Scales.of(case)).check_travel()


def test_partners_drift_by_default_and_meet_in_no_former_position():
    case = short_case({"time.pass_shift": None, "life.partners": 3})
    assert case.time.pass_shift is None
    case = with_shift(case)
    scales = Scales.of(case)
    assert case.time.pass_shift == pytest.approx(
        0.5 * (3.0 - 5.0**0.5) * scales.a
    )  # one less the golden fraction
    positions = Positions(case, scales)
    places = np.array([positions.places(number) for number in range(30)])
    gaps = np.diff(np.sort(places.ravel()))
    assert gaps.min() > 0.01 and gaps.max() < 0.1, "evenly spread over three shifts"
    assert places[:, 0].max() < 1.0 and np.diff(places, axis=1) == pytest.approx(1.0)
    fixed = short_case({"life.partners": 3})
    assert Positions(fixed, scales).places(7) == [0.0]


def test_columns_of_body_2_are_met_in_every_round_and_have_the_mean_of_the_passes_that_meet_them():
    for shift in (2e-4, -2e-4):
        case = short_case({"time.pass_shift": shift, "life.partners": 3, "time.travel": 9.0})
        positions = Positions(case, Scales.of(case))
        dx = positions.scales.spacing
        met = np.arange(60) * dx
        one = OfBody(met, np.array([0.0, 1e-5]), np.ones((2, 60)), np.zeros(60), (None, None))
        two = positions.new_body(one, SmoothContact(np.arange(2.0), np.zeros(2)), 1)
        for number in range(8):
            passes = []
            for place in positions.places(number):
                begin, end = positions._stretch(two, 1, place)
                assert end - begin == pytest.approx(59 * dx)
                s = begin + np.arange(60) * dx
                none = BodyField(0.25 * dx, 0, np.zeros(0))
                worn = none.add(np.array([s[0] - 2.0 * dx, s[-1] + 2.0 * dx]), np.array([2e-9]))
                of_body = one._replace(s=s, damage=np.full((2, 60), 3e-6), depth=(none, worn))
                passes.append(SimpleNamespace(bodies=(of_body, of_body)))
            rates = Round(passes, 1.0, drifts=True).rates((two, two))[1]
            assert rates.damage == pytest.approx(3e-6, rel=1e-6), "of every column, whoever meets it"
            assert rates.wear == pytest.approx(2e-9, rel=1e-6)


def aged(k, passes):
    """History of a surface whose wear smooths it: dw/dt = k exp(-w), dD/dt = exp(-3 w)/100."""

    def rates(one):
        smooth = np.exp(-one.wear)
        return Rates(k * smooth, np.tile(0.01 * smooth**3, (3, 1)), 0.0)

    history, bodies, done, before = LifeHistory("", ""), (body(), body()), 0, 0
    one = jumps(0.02, 0.01, passes=passes, break_out="none")
    while done < passes:
        bodies, before, _ = one.jump(bodies, round_of(rates), done, before)
        done += before
        history.add({"passes": done, "damage_1": bodies[0].largest_damage}, bodies, {})
    return history


def test_a_life_without_break_outs_serves_every_wear_rate():
    """D(N; k) = F(kN)/k, and the limiting rate is that at which the largest D is 1."""
    slow, fast = aged(1e-3, 4000), aged(2e-3, 2000)
    assert 2.0 * fast.rows[-1]["damage_1"] == pytest.approx(slow.rows[-1]["damage_1"], rel=5e-3)
    limit = 1e-3 * slow.limiting_wear(1)
    assert limit == pytest.approx((1.0 - 5.0**-2) * 0.01 / 2, rel=5e-3)  # D = (1 - (1 + kN)^-2) 0.01/(2 k)
    ends = aged(limit, round(4.0 / limit)).rows[-1]["damage_1"]
    assert ends == pytest.approx(1.0, rel=5e-3)


def solved(broken_out=0, count=1, yielded=0.0, jump=40):
    return {"broken_out": broken_out, "solved": count, "yielded": yielded, "jump": jump}


def test_slopes_begin_anew_where_rates_are_discontinuous():
    one, allowed = SimpleNamespace(passes=[None], yielded=0.0, drifts=False), jumps()
    assert allowed.continuous_passes([solved()], one) == 40
    assert allowed.continuous_passes([], one) == 0, "nothing before"
    assert allowed.continuous_passes([solved(broken_out=1)], one) == 0
    assert allowed.continuous_passes([solved(broken_out=1), solved()], one) == 40, "the last row counts"
    assert allowed.continuous_passes([solved(count=2)], one) == 0, "other positions"
    assert allowed.continuous_passes([solved(yielded=1.0)], one) == 0
    one.drifts = True
    assert allowed.continuous_passes([solved()], one) == 0


def test_a_point_that_yields_in_two_positions_keeps_the_larger_depth():
    def record(first, depths):
        field = BodyField(1e-6, first, np.array(depths))
        none = BodyField(1e-6, 0, np.zeros(0))
        return PlasticRecord(BodyFields(field, none), np.zeros(3), BodyFields(none, none))

    passes = [
        SimpleNamespace(plastic=record(2, [1e-8, 3e-8, 2e-8])),
        SimpleNamespace(plastic=record(3, [2e-8, 4e-8, 1e-8])),
    ]
    found = Round(passes, 1.0).plastic.depth.surface_1
    assert found.first == 2 and found.depth == pytest.approx([1e-8, 3e-8, 4e-8, 1e-8])


STRIP_EDGES = np.array([0.0, 1.0, 2.0, 4.0, 8.0])
COLUMNS = 24


def of_strip_pass(rows, seed):
    """A pass of random wear and damage, the same in all rows."""
    rng, s = np.random.default_rng(seed), np.arange(COLUMNS) * 1.0
    worn, depths = rng.uniform(size=COLUMNS) * 1e-3, np.array([0.0, 1.5, 6.0])
    damage = 1e-3 * rng.uniform(size=(3, COLUMNS)) ** 6
    if rows:
        worn, damage = np.tile(worn, (rows, 1)), np.repeat(damage[:, None], rows, axis=1)
    none = BodyField(0.25, 0, np.zeros((*(rows,) * bool(rows), 0)))
    return OfBody(s, depths, damage, np.zeros(COLUMNS), (none, none.add(np.arange(COLUMNS + 1) - 0.5, worn)))


def life(rows, rule):
    """Bodies after some rounds, in which cells break out."""
    shape = *(rows,) * bool(rows), COLUMNS
    one = LifeBody.new(np.arange(COLUMNS) * 1.0, np.zeros(shape), STRIP_EDGES, np.arange(rows) * 0.7)
    keys = {"passes": 100_000, "damage_jump": 0.5, "wear_jump": 1.0, "break_out": rule}
    jumps, bodies, done, before = Jumps(SimpleNamespace(**keys), 1.0), (one, one), 0, 0
    for seed in range(12):
        passes = [
            SimpleNamespace(bodies=(of_strip_pass(rows, seed), of_strip_pass(rows, seed + 50)), yielded=0.0)
        ]
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
        np.arange(40) * 1.0, rng.normal(size=(rows, 40)), STRIP_EDGES, np.arange(rows) * 1.0
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
    one = LifeBody.new(np.arange(40) * 1.0, np.zeros((6, 40)), STRIP_EDGES, np.arange(6) * 1.0)
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
            row |= {f"smooth_life_{k}": 1e6, f"smooth_depth_{k}": 4e-5}
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
