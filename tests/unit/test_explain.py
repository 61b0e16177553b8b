"""explain: figures of a case, size and run time, warnings; lines at the end of a run about its validity."""

import csv
import os
import re
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES, ROOT, is_line_with

from ehlpetsc.api import solve
from ehlpetsc.base.errors import ExitStatus
from ehlpetsc.case import loading as case
from ehlpetsc.case.loading import load
from ehlpetsc.commands.explain import main
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast import cost as forecast
from ehlpetsc.run.forecast import speed
from ehlpetsc.run.forecast.cost import file_size
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.run.forecast.limits import limits
from ehlpetsc.run.forecast.mesh_error import (
    DAMAGE_ERRORS,
    FRICTION_ERRORS,
    NODES,
    OPPOSED_ERRORS,
    SHARE_RATIOS,
    WAVE_ERRORS,
    expected_errors,
    wave_error,
)
from ehlpetsc.run.forecast.validity import heat_warnings, warnings
from ehlpetsc.run.solve import SpeedMeter
from ehlpetsc.surfaces.motion.roughness import Roughness

MIXED = ("mesh.points_per_half_width=100", "time.travel=3", "mesh.inlet=-1.5")


def lines(name, *overrides):
    return explain(case.load(CASES / name, overrides)).splitlines()


def of(settings):
    return [f"{key}={value}" for key, value in settings.items()]


def starting(found, word):
    return [line for line in found if line.startswith(word)]


def test_the_pressure_viscosity_coefficient_of_a_grade_is_shown():
    oil = {
        "fluid": {
            "grade": "ISO VG 100",
            "temperature": 343.15,
            "law": "roelands",
            "density": "incompressible",
        }
    }
    loaded = case.load(CASES / "table1_smooth.toml", oil)
    (film,) = starting(explain(loaded).splitlines(), "Film: ")
    alpha = 1e9 * loaded.fluid.pressure_viscosity
    assert 15.0 < alpha < 25.0 and f"pressure-viscosity coefficient {alpha:.3g} 1/GPa; " in film


def test_explain_figures_oil_friction_and_start_of_cases():
    text = "\n".join(lines("table1_rough.toml"))
    parts = ["a = 0.335682 mm", "p0 = 0.999455 GPa", "M = 56.53, L = 3.70", "801 nodes", "1603 unknowns"]
    parts += ["1067 steps", "surfaces 1, 2 at 5.625, 4.375 m/s", "Ra 0.0785 um", "contact likely"]
    assert [part for part in parts if part not in text] == []
    (line,) = starting(lines("table1_smooth.toml"), "Solids: ")
    default = "0.1, the default of contact.boundary_friction, where they touch"
    assert line == f"Solids: coefficient of friction {default}"
    for name, keys in (("table1_rough.toml", ()), ("table1_smooth.toml", ["motion.slide_roll_ratio=0.0"])):
        assert starting(lines(name, *keys), "Solids: ") == []
    (line,) = starting(lines("traction.toml"), "Oil fva3: ")
    assert line.endswith("Wingertszahn et al., Lubricants 11 (2023) 369, table A1")
    begun = starting(lines("table1_rough.toml", "time.start='rough'"), "Start: ")
    assert begun == ["Start: rough, after a ramp before time 0"]


@pytest.mark.parametrize(("name", "count"), [("dry_rough.toml", 1), ("dry_hertz.toml", 0), ("ball.toml", 0)])
def test_ridges_of_a_line_contact_are_named(name, count):
    ridges = "Lay: in a line contact all waves are ridges across the motion"
    assert len(starting(lines(name), ridges)) == count


def test_expected_errors_are_those_of_the_page_of_accuracy():
    folder = ROOT / "tests" / "benchmarks"
    stored: dict[str, list[float]] = {}
    loads = [ratio - 1.0 for ratio in SHARE_RATIOS]
    for name, _, error in list(csv.reader((folder / "waves.csv").read_text().splitlines()))[1:]:
        stored.setdefault(name, []).append(abs(float(error)))
    page = (folder / "ACCURACY.md").read_text()
    lines_of = {name: errors for name, errors in stored.items() if name.startswith("line")}
    opposed = [errors for name, errors in lines_of.items() if "roll 4" in name]
    others = [errors for name, errors in lines_of.items() if "roll 4" not in name]
    assert np.max(others, axis=0) == pytest.approx(WAVE_ERRORS)
    assert np.max(opposed, axis=0) == pytest.approx(OPPOSED_ERRORS)
    for faster, row in ((1.0, WAVE_ERRORS), (2.0, WAVE_ERRORS), (3.0, OPPOSED_ERRORS)):
        assert [wave_error(n, faster) for n in NODES] == pytest.approx(row)
    assert wave_error(32, 6.0) == pytest.approx(OPPOSED_ERRORS[3])  # waves of the film half as long
    assert WAVE_ERRORS[3] < wave_error(16, 2.5) < OPPOSED_ERRORS[3]
    for name, row, table in (
        ("mixed, layer: friction", "friction", FRICTION_ERRORS),
        ("mixed, layer: share", "load on the solids, over the converged one", loads),
    ):
        assert stored[name] == pytest.approx(table), name
        (line,) = [line for line in page.splitlines() if line.startswith(f"| {row} |")]
        printed = [abs(float(word)) for word in re.findall(r"\| ([+-]?[\d.]+)", line)]
        errors = [value - 1.0 if table is loads else 0.01 * value for value in printed]
        assert errors == pytest.approx([table[k] for k in (1, 3, 4)]), name
    damage = [line.split("|")[3:5] for line in page.splitlines() if line.startswith("| | damage |")]
    largest = np.abs([[0.01 * float(cell.strip(" %")) for cell in row] for row in damage]).max(axis=0)
    assert len(damage) == 7 and largest == pytest.approx([DAMAGE_ERRORS[1], DAMAGE_ERRORS[3]])


def test_first_page_rounds_the_expected_errors_of_meshes():
    """On 8, 16 and 32 nodes, each within half a unit of its last digit."""
    page = (ROOT / "README.md").read_text()
    rows = {
        "error of waves of film and pressure": (100.0, WAVE_ERRORS),
        "the same of surfaces that move against each other": (100.0, OPPOSED_ERRORS),
        "error of friction in mixed contact": (100.0, FRICTION_ERRORS),
        "load on the solids there": (1.0, SHARE_RATIOS),
    }
    for name, (factor, table) in rows.items():
        (line,) = [line for line in page.splitlines() if line.startswith(f"| {name}")]
        printed = re.findall(r"\| ([\d.]+)(?= %? ?\|)", line)
        assert len(printed) == 3
        for text, value in zip(printed, [factor * table[k] for k in (1, 3, 4)], strict=True):
            unit = 10.0 ** -len(text.partition(".")[2])
            assert float(text) == pytest.approx(value, abs=0.5001 * unit), name


def test_mesh_errors_of_a_layer_and_of_rigid_solids():
    strip = ["mesh.points_per_half_width=50", "surface.1.synthetic.short_cutoff=40e-6"]
    (line,) = starting(lines("fzg_strip.toml", *strip), "Mesh error: ")
    waves, friction, damage = (
        f"{100 * row[1]:.2g} %" for row in (WAVE_ERRORS, FRICTION_ERRORS, DAMAGE_ERRORS)
    )
    assert line == (
        f"Mesh error: {waves} of the waves of film and pressure; in mixed contact {friction} in friction, "
        f"+-{damage} in damage, {SHARE_RATIOS[1]:.2g} times the load on the solids above 0.001 of the load"
    )
    (line,) = starting(lines("running_in.toml"), "Waves of surface 1: ")
    assert line.endswith("; 8.04 nodes to the shortest one, 27 um")
    (line,) = starting(lines("running_in.toml", "motion.slide_roll_ratio=4.0"), "Mesh error: ")
    assert line.startswith(f"Mesh error: {100 * wave_error(8.04, 3.0):.2g} % of the waves")
    (line,) = starting(lines("table1_mixed.toml"), "Mesh error")
    assert line.endswith("load and length of contact of rigid solids shrink with every finer mesh")
    layer = load(CASES / "stribeck.toml").contact
    coarse = expected_errors(16, 1.0, layer, inlet_is_resolved=False)
    assert (
        f"more than {100 * FRICTION_ERRORS[3]:.2g} % in friction" in coarse and "resolve the inlet" in coarse
    )


def test_waves_of_a_profile_without_a_shortest_one_are_found_in_its_heights():
    (line, _) = starting(lines("table1_rough.toml"), "Waves of surface ")
    found = re.search(r"1 % of the height variance is in waves under ([\d.]+) um, ([\d.]+) nodes", line)
    length, nodes = map(float, found.groups())
    spacing = 335.682 / 200
    assert nodes == pytest.approx(length / spacing, rel=2e-3)
    (coarse,) = starting(lines("table1_rough.toml"), "Mesh error")
    given = load(CASES / "table1_rough.toml")
    heights = Roughness.of(given, Scales.of(given)).side("1").given
    assert (
        heights.unresolved_variance(0.24e-6 * length) < 0.01 < heights.unresolved_variance(0.26e-6 * length)
    )
    assert ("at least" in coarse) == (nodes < 6)
    assert starting(lines("ridge.toml"), "Waves of surface ")
    assert not starting(lines("table1_smooth.toml"), "Waves of surface ")


def test_steps_of_changing_conditions_and_the_travel_that_post_processing_needs():
    gears = case.load(CASES / "fzg.toml", ())
    heading = forecast.banner(gears, Scales.of(gears), None, 1)[1]
    assert " 3170 steps; 1 rank" in heading
    steady = case.load(CASES / "table1_smooth.toml", ())
    assert " unknowns, steady; 1 rank" in forecast.banner(steady, Scales.of(steady), None, 1)[1]
    assert starting(lines("fzg.toml"), "Time: ")[0].endswith("; 3170 steps")
    cam = lines("cam.toml")  # steps by the error of the film, 382 in the run
    assert starting(cam, "Time: ")[0].endswith("; at most 11308 steps")
    assert "; result file: at most " in starting(cam, "Run time ")[0]
    short = {"time.travel": 3.0, "mesh.inlet": -2.5, "mesh.outlet": 1.5, "motion.slide_roll_ratio": 0.5}
    (line,) = starting(lines("table1_rough.toml", *of(short)), "Post-processing")
    assert "no point of either surface passes the whole mesh, 4 a" in line and "time.travel = 7 is" in line
    (line,) = starting(lines("table1_rough.toml", *of(short | {"time.travel": 5.0})), "Post-")
    assert "no point of surface 2 passes" in line
    assert not any("Post-" in line for line in lines("table1_rough.toml", *of(short | {"time.travel": 7.0})))


@pytest.mark.parametrize(
    "overrides", [["time.travel=0.75"], ["time.travel=3.0", "output.precision='float32'"]]
)
def test_predicted_result_size_within_a_quarter(tmp_path, overrides):
    c = case.load(CASES / "table1_rough.toml", ["mesh.points_per_half_width=50", *overrides])
    solve(c, tmp_path / "r.h5", progress=False)
    assert file_size(c, Scales.of(c)) == pytest.approx((tmp_path / "r.h5").stat().st_size, rel=0.25)


def test_coarse_mesh_and_stationary_roughness_are_warnings_where_not_noise():
    c = case.load(CASES / "fig6.toml")
    assert [line.split(":")[0] for line in warnings(c, Scales.of(c))] == ["surface.1", "surface.2"]
    wave = "surface.2.synthetic={kind='sine',amplitude=1e-7,wavelength=1e-4}"
    still = starting(lines("table1_smooth.toml", wave), "Warning")
    assert len(still) == 1 and "surface.2 with [motion] but without [time]" in still[0]
    c = case.load(CASES / "dry_rough.toml")
    assert warnings(c, Scales.of(c)) == []
    base = ["motion.entrainment_speed=1"]
    for points, warned in ((300, False), (30, True)):
        c = case.load(CASES / "table1_smooth.toml", [*base, f"mesh.points_per_half_width={points}"])
        assert any("coarse" in line and "inlet" in line for line in warnings(c, Scales.of(c))) == warned
    lines_shown = next(line for line in warnings(c, Scales.of(c)) if "coarse" in line and "inlet" in line)
    needed = int(re.search(r"points_per_half_width = (\d+)", lines_shown)[1])
    c = case.load(CASES / "table1_smooth.toml", [*base, f"mesh.points_per_half_width={needed - 1}"])
    assert not any("coarse" in line and "inlet" in line for line in warnings(c, Scales.of(c)))


@pytest.mark.parametrize(
    "name, overrides, newton",
    [  # iterations that the runs of these took
        ("table1_rough.toml", (), 3873),
        ("table1_mixed.toml", MIXED, 1385),
        ("ridge.toml", ("mesh.points_per_half_width=100", "time.travel=2", "mesh.inlet=-1.5"), 332),
        ("table1_rough.toml", ("mesh.points_per_half_width=50", "time.travel=4"), 611),
    ],
)
def test_predicted_iterations_within_a_factor_of_one_and_a_half(name, overrides, newton):
    c = case.load(CASES / name, overrides)
    scales = Scales.of(c)
    expected = forecast.iterations(c, scales, Roughness.of(c, scales))
    assert newton / 1.5 < expected < 1.5 * newton


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["contact.radius=12"], r"p0 = 0\.0399 GPa: .* 0\.1 to 10 GPa; radius = 12"),
        (["fluid.viscosity=15"], r"film, 49\.5 um, .* 336 um: viscosity = 15 Pa s"),
        (["fluid.law='barus'"], r'^fluid\.reference_viscosity, fluid\.roelands_pressure: .* law = "barus"'),
        (
            ["fluid={oil='fva3', pressure_viscosity=1e-8}"],
            r'^fluid\.pressure_viscosity = 1e-08: not used by law = "modulus", whose constants give 2\.2',
        ),
        (["fluid.density='incompressible'"], r'^fluid\.gamma, fluid\.lambda: .* density = "incompressible"$'),
    ],
)
def test_implausible_magnitudes_and_unused_constants_are_warnings(overrides, words):
    c = case.load(CASES / "table1_smooth.toml", overrides)
    assert any(re.search(words, line) for line in warnings(c, Scales.of(c)))


@pytest.mark.parametrize("level", [False, True])
def test_tilted_profile_warning_names_the_key(level):
    x = 1e-6 * np.arange(4001)
    z = 5e-6 * x / x[-1] + 0.4e-6 * np.sin(x / 5e-6)
    surface = {"surface": {"1": {"x": x.tolist(), "z": z.tolist(), "level": level}}}
    c = case.load(CASES / "table1_smooth.toml", surface | {"time": {"travel": 6.0}})
    found = [line for line in warnings(c, Scales.of(c)) if "straight line" in line]
    if level:
        assert found == []
    else:
        share = 5.0**2 / 12 / (5.0**2 / 12 + 0.4**2 / 2)
        assert found[0].startswith(f"surface.1: {100 * share:.0f} % ")
        assert "5 um over 4 mm" in found[0] and "level = true" in found[0]


def test_memory_of_a_large_map_is_that_of_reading_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.save("map.npy", np.random.default_rng(0).normal(0.0, 1e-8, (400, 500)))
    tables = case.load(CASES / "ball.toml", {"surface.1": None})._tables
    expected = []
    for surface in ({}, {"1": {"file": "map.npy", "spacing": 1e-6}}):
        ball = case.load(tables | {"surface": surface})
        scales = Scales.of(ball)
        expected.append(forecast.memory(scales, Roughness.of(ball, scales)))
    assert expected[1] - expected[0] == pytest.approx(70 * 400 * 500)
    assert f"memory: about {1e-6 * expected[1]:.0f} MB" in explain(ball)
    assert expected[0] == pytest.approx(230e6 + 2000 * scales.grid.n)  # without heat


def test_explain_refuses_what_a_run_refuses(capsys):
    coarse = ["contact.load=2.1e6", "motion.entrainment_speed=0.005"]
    words = [word for key in coarse for word in ("--set", key)]
    assert main([str(CASES / "table1_smooth.toml"), *words]) == 2
    out, err = capsys.readouterr()
    assert "Mesh: " in out and is_line_with(err, "which leaves no film")
    series = ["series.key='fluid.viscosity'", "series.values=[0.01, 0.02]", "time.passes=2"]
    words = [word for key in series for word in ("--set", key)]
    assert main([str(CASES / "table1_rough.toml"), *words]) == 2
    assert is_line_with(capsys.readouterr().err, "[series] and time.passes: ", "one of them at a time")


WITHIN = {"p_max": 1.2e9, "oil_pressure": 1.2e9, "mass_error": 1e-7, "nodes_below_1nm": 0}


def limit_lines(name="table1_smooth", overrides=(), boundary_friction=None, **changed):
    case = load(CASES / f"{name}.toml", overrides)
    scales = Scales.of(case)
    return limits(case, scales, Roughness.of(case, scales), WITHIN | changed, boundary_friction)


def test_no_limit_line_within_the_limits():
    assert limit_lines(oil_pressure=5e9) == []  # 5e5 Pa s
    assert limit_lines() == [] and limit_lines("table1_rough") == [] and limit_lines("dry_hertz") == []


@pytest.mark.parametrize(
    "changed, parts",
    [
        ({"p_max": 6.65e9}, ["pressure: ", " 6.65 GPa"]),
        ({"oil_pressure": 9e9}, ["viscosity: 5.0e+08"]),
        ({"mass_error": 0.44}, ["oil balance: ", " 44 % of "]),
        ({"nodes_below_1nm": 7}, ["film: 7 times "]),
    ],
)
def test_each_limit_line_has_its_figure(changed, parts):
    (line,) = limit_lines(**changed)
    assert line.startswith(parts[0]) and parts[-1] in line


def test_friction_beyond_that_of_oils_has_a_limit_line():
    heat = ["heat.bulk_temperature=363.0"]
    (line,) = limit_lines(overrides=heat, friction_coefficient=-1.25)
    assert line.startswith("friction: ") and " 1.25, " in line
    assert limit_lines(overrides=heat, friction_coefficient=0.12) == []
    rubbing = [*heat, "contact.model=mixed", "contact.boundary_film=10e-9", "contact.boundary_friction=0.2"]
    assert limit_lines(overrides=rubbing, friction_coefficient=0.19) == []
    heat = ["heat.bulk_temperature=363.0"]
    assert limit_lines(overrides=heat, boundary_friction=0.3, friction_coefficient=0.25) == []
    (line,) = limit_lines(overrides=heat, boundary_friction=0.1, friction_coefficient=0.25)
    assert line.startswith("friction: a coefficient of 0.25")


SLIDES = "motion={entrainment_speed=1.0,slide_roll_ratio=0.5}"
MIXED_FILM = ["contact.model=mixed", "contact.boundary_film=10e-9"]


@pytest.mark.parametrize(
    "name, keys, totals, share",
    [
        ("table1_smooth", MIXED_FILM, {"contact_share": 0.031}, "3.1 % of the load"),
        ("table1_smooth", [], {"contacts": 8000, "step": 9}, "%.3g %% of the Hertz contact"),
        ("dry_hertz", [SLIDES], {}, "100 % of the load"),
    ],
)
def test_friction_of_solids_that_is_left_out_has_a_limit_line(name, keys, totals, share):
    heat = [*keys, "heat.bulk_temperature=363.0"]
    points = 2 * load(CASES / f"{name}.toml").mesh.points_per_half_width
    share = share % (8e5 / points / 10) if "%%" in share else share
    (line,) = limit_lines(name, heat, **totals)
    assert line.startswith(f"friction: the solids carry up to {share}") and " of 0.1, the default" in line
    assert limit_lines(name, [*heat, "contact.boundary_friction=0.0"], **totals) == []
    assert limit_lines("table1_smooth", MIXED_FILM + heat[-1:], contact_share=0.009) == []
    if name != "dry_hertz":  # nothing slides
        assert limit_lines(name, [*heat, "motion.slide_roll_ratio=0.0"], **totals) == []


def test_unresolved_asperities_and_a_flattened_layer_have_limit_lines():
    found = limit_lines("table1_rough", ["mesh.points_per_half_width=50"])
    for side, line in zip("12", found, strict=True):
        assert line.startswith(f"mesh: surface.{side}: ") and " 51.1 % of its height variance " in line
    (line,) = limit_lines("stribeck", h_min=1.3e-9)
    assert line.startswith("layer: flattened from 132 nm to a film of 1.3 nm")
    assert limit_lines("stribeck", h_min=1.4e-9) == []


@pytest.mark.parametrize(
    (
        "share",
        "films",
        "is_enclosed",
    ),  # computed: a layer of 10 nm at 1 mm/s and at 5 m/s; Stribeck case, 1 m/s
    [(0.0795, 533.0, True), (0.001, 3.0, False), (0.48, 2.93, False), (0.98, 20.0, False)],
)
def test_enclosed_oil_that_carries_most_of_the_load_has_a_limit_line(share, films, is_enclosed):
    means = {"contact_share": share, "lambda_ratio": 0.0016, "mean_gap_ratio": 0.0016 * films}
    means["h_min"] = 1e-8
    found = starting(limit_lines("stribeck", **means), "enclosed oil: ")
    assert len(found) == is_enclosed
    if is_enclosed:
        assert " 92 % of the load in a mean film 464 times the smooth one" in found[0]
        assert 'asperity_height = "measured"' in found[0]


HEAT = "heat.bulk_temperature=363.0"


def warned(name, *keys):
    case = load(CASES / f"{name}.toml", keys)
    return heat_warnings(case, Scales.of(case))


def limited(name, friction, *keys):
    found = limit_lines(name, keys, friction_coefficient=friction)
    return [line for line in found if line.startswith("heat")]


def test_damage_case_has_a_heat_warning():
    [line] = warned("table1_damage")
    flash = float(line.split(" K ")[0].split()[-1])
    assert 60.0 < flash < 110.0  # the mean of its surfaces is 50 to 60 K above bulk
    assert warned("table1_damage", HEAT) == []
    [line] = limited("table1_damage", 0.036)
    assert "79 K" in line
    assert limited("table1_damage", 0.036, HEAT) == []


@pytest.mark.parametrize("name", ["table1_smooth", "table1_rough", "waviness", "moes", "dry_hertz"])
def test_slow_or_rolling_contacts_have_no_heat_warning(name):
    assert warned(name) == []
    assert limited(name, 0.0114) == []


def run_time(points=20):
    c = load(CASES / "table1_smooth.toml", {"mesh.points_per_half_width": points})
    return starting(explain(c).splitlines(), "Run time on one rank: ")[0]


def test_run_time_is_that_of_earlier_runs_on_this_machine(tmp_path, monkeypatch):
    monkeypatch.setenv(speed.CACHE, str(tmp_path / "new"))
    assert run_time().startswith("Run time on one rank: no estimate yet, ")
    c = load(CASES / "ridge.toml")
    meter = SpeedMeter(SimpleNamespace(case=c, scales=Scales.of(c)))
    for step, wall in ((0, 60.0), (1, 1.0), (2, 2.0)):  # code is compiled in the start
        meter.write(SimpleNamespace(step=step, scalars={"wall": wall, "newton": 4}))
    meter.close(ExitStatus.NOT_CONVERGED)
    assert "no estimate" in run_time()
    meter.close(ExitStatus.DONE)
    amount = forecast.work("line", Scales.of(c).grid.n, 8, 2)
    assert speed.expected_seconds("line", amount) == pytest.approx(3.0)
    assert "about" in run_time() and speed.expected_seconds("plane", amount) is None
    for seconds in (9.0, 1.0, 1.0):  # of four the second: one slow run changes nothing
        speed.keep("line", seconds, amount)
    assert speed.expected_seconds("line", 2.0 * amount) == pytest.approx(2.0)
    short = SpeedMeter(SimpleNamespace(case=c, scales=Scales.of(c)))
    short.write(SimpleNamespace(step=1, scalars={"wall": 0.1, "newton": 400}))
    for _ in range(5):
        short.close(ExitStatus.DONE)
    assert speed.expected_seconds("line", 2.0 * amount) == pytest.approx(2.0)


SPOILED = ["", "{", "[1.0]", '{"line": 3}', '{"line": ["x"]}', '{"line": [-1.0, 0.0]}', None]


@pytest.mark.parametrize("text", SPOILED)
def test_cache_that_is_spoiled_or_cannot_be_written_is_no_fault(tmp_path, monkeypatch, text):
    monkeypatch.setenv(speed.CACHE, str(tmp_path))
    if text is None:
        monkeypatch.setenv(speed.CACHE, os.devnull)
    else:
        (tmp_path / "speed.json").write_text(text)
    assert "no estimate yet" in run_time()
    speed.keep("line", 3.0, 3.0)
    assert speed.expected_seconds("line", 2.0) == (None if text is None else 2.0)
