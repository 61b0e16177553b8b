"""explain: figures of a case, predicted size and run time, disabled effects, warnings."""

import csv
import re

import numpy as np
import pytest
from support import CASES, ROOT, is_line_with

from ehlpetsc.api import solve
from ehlpetsc.case import loading as case
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast import cost as forecast
from ehlpetsc.run.forecast.cost import file_size
from ehlpetsc.run.forecast.explain import (
    DAMAGE_ERRORS,
    FRICTION_ERRORS,
    SHARE_RATIOS,
    WAVE_ERRORS,
    explain,
    main,
)
from ehlpetsc.run.forecast.validity import warnings
from ehlpetsc.surfaces.motion.roughness import Roughness

MIXED = ("mesh.points_per_half_width=100", "time.travel=3", "mesh.inlet=-1.5")


def lines(name, *overrides):
    return explain(case.load(CASES / name, overrides)).splitlines()


def of(settings):
    return [f"{key}={value}" for key, value in settings.items()]


def starting(found, word):
    return [line for line in found if line.startswith(word)]


def test_explain_figures_of_the_main_case():
    text = "\n".join(lines("table1_rough.toml"))
    parts = ["a = 0.335682 mm", "p0 = 0.999455 GPa", "M = 56.53, L = 3.70", "801 nodes", "1603 unknowns"]
    parts += ["1067 steps", "surfaces 1, 2 at 5.625, 4.375 m/s", "Ra 0.0785 um", "contact likely"]
    assert [part for part in parts if part not in text] == []


def test_friction_of_solids_oil_and_start_are_named():
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
    waves = [errors for name, errors in stored.items() if name.startswith("line") and "roll 4" not in name]
    assert np.max(waves, axis=0) == pytest.approx(WAVE_ERRORS)
    for name, row, table in (
        ("mixed, layer: friction", "friction", FRICTION_ERRORS),
        ("mixed, layer: damage", "mean damage of both surfaces, 0.05 a deep", DAMAGE_ERRORS),
        ("mixed, layer: share", "load on the solids, over the converged one", loads),
    ):
        assert stored[name] == pytest.approx(table), name
        (line,) = [line for line in page.splitlines() if line.startswith(f"| {row} |")]
        printed = [abs(float(word)) for word in re.findall(r"\| ([+-]?[\d.]+)", line)]
        errors = [value - 1.0 if table is loads else 0.01 * value for value in printed]
        assert errors == pytest.approx([table[k] for k in (1, 3, 4)]), name
    strip = ["mesh.points_per_half_width=50", "surface.1.synthetic.short_cutoff=40e-6"]
    (line,) = starting(lines("fzg_strip.toml", *strip), "Mesh error: ")
    assert line == (
        "Mesh error: 7.7 % of the waves of film and pressure; "
        "in mixed contact 15 % in friction, 18 % in damage, 3.5 times the load on the solids"
    )
    (line,) = starting(lines("running_in.toml"), "Waves of surface 1: ")
    assert line.endswith("; 8.04 nodes to the shortest one, 27 um")
    (line,) = starting(lines("running_in.toml", "motion.slide_roll_ratio=4.0"), "Mesh error: ")
    assert line.startswith("Mesh error: at least 15 % of the waves")  # the film's are two thirds as long


def test_heading_of_a_gear_run_has_the_steps_of_its_changing_conditions():
    gears = case.load(CASES / "fzg.toml", ())
    heading = forecast.banner(gears, Scales.of(gears), None, 1)[1]
    assert " 3170 steps; 1 rank" in heading
    steady = case.load(CASES / "table1_smooth.toml", ())
    assert " unknowns, steady; 1 rank" in forecast.banner(steady, Scales.of(steady), None, 1)[1]
    assert starting(lines("fzg.toml"), "Time: ")[0].endswith("; 3170 steps")


@pytest.mark.parametrize(
    "overrides", [["time.travel=0.75"], ["time.travel=3.0", "output.precision='float32'"]]
)
def test_predicted_result_size_within_a_quarter(tmp_path, overrides):
    c = case.load(CASES / "table1_rough.toml", ["mesh.points_per_half_width=50", *overrides])
    solve(c, tmp_path / "r.h5", progress=False)
    assert file_size(c, Scales.of(c)) == pytest.approx((tmp_path / "r.h5").stat().st_size, rel=0.25)


def test_coarse_mesh_and_stationary_roughness_are_warnings():
    c = case.load(CASES / "fig6.toml")
    assert [line.split(":")[0] for line in warnings(c, Scales.of(c))] == ["surface.1", "surface.2"]
    still = starting(
        lines("table1_smooth.toml", "surface.2.synthetic={kind='sine',amplitude=1e-7,wavelength=1e-4}"),
        "Warning",
    )
    assert len(still) == 1 and "surface.2 with [motion] but without [time]" in still[0]
    c = case.load(CASES / "dry_rough.toml")
    assert warnings(c, Scales.of(c)) == []


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


def test_mesh_within_ten_percent_has_no_warning():
    base = ["motion.entrainment_speed=1"]
    for points, warned in ((300, False), (30, True)):
        c = case.load(CASES / "table1_smooth.toml", [*base, f"mesh.points_per_half_width={points}"])
        assert any("coarse" in line and "inlet" in line for line in warnings(c, Scales.of(c))) == warned
    lines_shown = next(line for line in warnings(c, Scales.of(c)) if "coarse" in line and "inlet" in line)
    needed = int(re.search(r"points_per_half_width = (\d+)", lines_shown)[1])
    c = case.load(CASES / "table1_smooth.toml", [*base, f"mesh.points_per_half_width={needed - 1}"])
    assert not any("coarse" in line and "inlet" in line for line in warnings(c, Scales.of(c)))


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


def test_explain_states_the_travel_that_post_processing_needs():
    short = {"time.travel": 3.0, "mesh.inlet": -2.5, "mesh.outlet": 1.5, "motion.slide_roll_ratio": 0.5}
    (line,) = starting(lines("table1_rough.toml", *of(short)), "Post-processing")
    assert "no point of either surface passes the whole mesh, 4 a" in line and "time.travel = 7 is" in line
    (line,) = starting(lines("table1_rough.toml", *of(short | {"time.travel": 5.0})), "Post-")
    assert "no point of surface 2 passes" in line
    assert not any("Post-" in line for line in lines("table1_rough.toml", *of(short | {"time.travel": 7.0})))
