"""Arithmetic of the studies: extrapolation, errors, inlets, last words, draws."""

import random

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from support import is_line_with

from ehlpetsc.case.loading import load
from ehlpetsc.errors import ExitStatus, PostError
from ehlpetsc.physics.scales import Scales
from ehlpetsc.post.stresses.body_points import body_points, passage
from ehlpetsc.study.__main__ import main as study
from ehlpetsc.study.accuracy import picture
from ehlpetsc.study.accuracy.errors import MEASURES, Measures, errors, uncertainty
from ehlpetsc.study.accuracy.plan import plan
from ehlpetsc.study.accuracy.table import NAMES
from ehlpetsc.study.cases import TABLE_1, inlet_of, load_of
from ehlpetsc.study.diagnosis import diagnosis
from ehlpetsc.study.extremes import cases
from ehlpetsc.study.random_cases import draw
from ehlpetsc.study.runs import TIMED_OUT, Outcome, check_damage, greatest_damage, last_message
from ehlpetsc.study.setting import MESH, RANKS, STEP


def figures(error, contact=0.0):
    x, more = np.linspace(-1.5, 1.5, 31), 1 + error
    return Measures(x, 0.2 * more * np.ones(31), 0.1 * more, 0.2 * more, 1e9 * (1 - error), contact)


@pytest.fixture
def table_1(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(TABLE_1)
    return path


@pytest.mark.parametrize("words", [[], ["--contact"]])
def test_unwritable_folder_is_refused_before_any_run(table_1, words, capsys, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: False)
    assert study([str(table_1), *words, "-o", "somewhere"]) == ExitStatus.BAD_INPUT
    message = capsys.readouterr()
    assert is_line_with(message.err, "somewhere.csv: ", "another -o")
    assert message.out == ""


@pytest.mark.parametrize("words", [["--extremes"], ["--random", "2"]])
def test_unwritable_table_is_reported(tmp_path, words, capsys):
    stem = tmp_path / "none" / "table"
    assert study([*words, "-o", str(stem)]) == ExitStatus.BAD_INPUT
    assert is_line_with(capsys.readouterr().err, f"{stem}.csv: ", "No such file or directory")


@pytest.mark.parametrize("words", [[], ["--contact"]])
def test_study_table_never_overwrites_case_input(tmp_path, words, capsys):
    profile = tmp_path / "gear.csv"
    profile.write_text("".join(f"{0.5e-6 * k},{1e-7 * (k % 7)}\n" for k in range(4000)))
    case = tmp_path / "case.toml"
    case.write_text(TABLE_1 + '\n[surface.1]\nfile = "gear.csv"\n')
    before = profile.read_bytes()
    assert study([str(case), *words, "-o", str(tmp_path / "gear")]) == 2
    assert is_line_with(capsys.readouterr().err, "gear.csv: ", f"({profile})", " -o")
    assert profile.read_bytes() == before
    assert study([str(tmp_path / "none.toml"), *words]) == 2
    assert "none.toml" in capsys.readouterr().err


def test_errors_are_relative_to_the_reference():
    found = errors(figures(0.01), figures(0.0))
    assert found["h_min"] == pytest.approx(0.01)
    assert found["h_c"] == pytest.approx(0.01)
    assert found["p_max"] == pytest.approx(0.01)
    assert found["film"] == pytest.approx(0.01)
    assert np.isnan(found["contact"]) and np.isnan(found["damage"])
    assert errors(figures(0.0, 1.1), figures(0.0, 1.0))["contact"] == pytest.approx(0.1)


@pytest.mark.parametrize("order", [1.0, 2.0])
def test_uncertainty_is_the_error_of_a_reference_of_known_order(order):
    error = 1e-4
    estimate = uncertainty(*(figures(error * 2.0 ** (order * level)) for level in range(3)))
    assert estimate["h_min"] == pytest.approx(error, rel=0.01)


def test_study_varies_one_setting_and_ends_with_a_finer_reference(table_1):
    case = load(table_1, ["time.travel=1.0"])
    references, runs = plan(case, (50, 100), (0.5, 1.0), (2,))
    assert references[0].values[MESH] == 200 and references[0].values[STEP] == 0.25
    assert [r.values[MESH] for r in references] == [200, 100, 50]
    base = runs[0].values
    for setting in runs[1:]:
        changed = {key for key in {*base, *setting.values} if base.get(key) != setting.values.get(key)}
        assert changed <= {setting.varied}
    assert {r.label for r in runs if r.varied == RANKS} == {1, 2}


def test_a_steady_case_has_no_time_steps_to_vary(table_1):
    _, runs = plan(load(table_1), (50, 100), (0.5,), (2,))
    assert not any(r.varied == STEP for r in runs)
    assert NAMES[STEP] == "time step"


def test_inlet_is_flooded_and_grows_with_film_thickness():
    assert inlet_of(527e3, 0.002, 5.0) == -2.5
    assert inlet_of(527e3, 1.0, 5.0) < inlet_of(527e3, 0.1, 5.0) < -2.5


def test_load_of_table_1_from_its_pressure():
    assert load_of(0.999455e9) == pytest.approx(527e3, rel=1e-4)


def test_last_message_is_the_solver_message():
    words = "step 3: no. Last good state: x"
    printed = f"a\nehlpetsc: not converged: {words}\nresult: f.h5\nehlpetsc: not converged steps=2\n"
    assert last_message(printed) == words
    assert last_message("") == ""


@pytest.mark.parametrize("words", [[], ["--contact"]])
def test_short_travel_for_damage_is_refused_before_any_run(table_1, words, capsys, monkeypatch):
    for place in ("accuracy.table", "contact"):
        monkeypatch.setattr(f"ehlpetsc.study.{place}.run", lambda *_, **__: pytest.fail("it ran"))
    short = ["--damage", "--set", "mesh.inlet=-1.2", "--set", "mesh.outlet=1.3", "--set", "time.travel=1.0"]
    short += ["--set", "motion.slide_roll_ratio=0.25"]
    assert study([str(table_1), *words, *short]) == ExitStatus.BAD_INPUT
    surface, needed = ("1", "2.52") if words else ("2", "3.24")  # (2.5 + 1/50), over 0.875/1.125
    assert is_line_with(
        capsys.readouterr().err, "--damage", "1 a", f"surface {surface}", "2.5 a", f"time.travel = {needed}"
    )


def test_damage_study_needs_time_and_a_moving_surface(table_1):
    with pytest.raises(PostError, match=r"^--damage: .* \[time\] "):
        check_damage(load(table_1), "2", 100)
    with pytest.raises(PostError, match="^--damage: surface 2 .*rest"):
        check_damage(load(table_1, ["time.travel=9.0", "motion.slide_roll_ratio=2.0"]), "2", 100)


@pytest.mark.parametrize("mesh", [13, 50, 200])
@pytest.mark.parametrize("ratio", [0.0, 0.25, -1.0, 3.0])
def test_minimum_travel_for_damage_passes_one_point(table_1, mesh, ratio):
    """As post-processing has it, which counts from the frame at time 0; a tenth less lets none."""
    for share, passes in ((1.0, True), (0.9, False)):
        width, slow = 2.53, abs(1.0 - ratio / 2.0)
        travel = share * (width + 1.0 / mesh) * max(slow, abs(1.0 + ratio / 2.0)) / slow + 1e-9
        chosen = ["mesh.inlet=-1.2", "mesh.outlet=1.33", f"mesh.points_per_half_width={mesh}"]
        case = load(table_1, [*chosen, f"motion.slide_roll_ratio={ratio}", f"time.travel={travel}"])
        scales = Scales.of(case)
        x, time = scales.x * scales.a, np.array([0.0, scales.duration])
        s = body_points(x, scales.dx, [scales.u1 * time, scales.u2 * time])
        assert passage(s, x, scales.dx, scales.u2 * time).complete.any() == passes
        if passes:
            check_damage(case, "2", mesh)
        else:
            with pytest.raises(PostError, match="more"):
                check_damage(case, "2", mesh)


def test_uncounted_damage_is_reported(table_1, tmp_path, capsys, monkeypatch):
    """A file that is damaged, say: post-processing says why."""
    result = tmp_path / "run.h5"
    with h5py.File(result, "w") as file:
        file["x"] = [0.0]
    monkeypatch.setattr("ehlpetsc.study.accuracy.table.run", lambda *_, **__: Outcome(0, "", result=result))
    monkeypatch.setattr(
        "ehlpetsc.study.accuracy.table.measures", lambda path, damage: greatest_damage(path, "2")
    )
    command = [str(table_1), "--set", "time.travel=9.0", "--damage", "-o", str(tmp_path / "table")]
    assert study(command) == ExitStatus.BAD_INPUT
    (message,) = capsys.readouterr().err.splitlines()
    assert is_line_with(message, "ehlpetsc.study: no damage: ", f"{result}: an HDF5 ")


def test_diverged_reference_is_reported(table_1, tmp_path, capsys, monkeypatch):
    failed = Outcome(ExitStatus.NOT_CONVERGED, "step 3: no")
    monkeypatch.setattr("ehlpetsc.study.accuracy.table.run", lambda *_, **__: failed)
    assert study([str(table_1), "-o", str(tmp_path / "table")]) == ExitStatus.NOT_CONVERGED
    assert is_line_with(capsys.readouterr().err, "reference", "step 3: no")


def test_diagnosis_names_contact_properties(table_1):
    outcome = Outcome(ExitStatus.NOT_CONVERGED, "SNES stopped", steps=4, h_min=5e-10, p_max=9e9)
    found = diagnosis(outcome, table_1, ["fluid.law=barus", "fluid.pressure_viscosity=60e-9"])
    for part in ("oil is solid", "9.0 GPa", "0.5 nm", "SNES stopped"):
        assert part in found
    assert "coarse" not in found
    slow = diagnosis(outcome, table_1, ["motion.entrainment_speed=0.01"])
    assert "coarse" in slow and "points_per_half_width=" in slow
    assert "time limit" in diagnosis(Outcome(TIMED_OUT, steps=4), table_1, [])


@pytest.mark.parametrize("model", [None, "direct", "mixed", "compliant"])
def test_forty_rows_are_far_out_of_range(tmp_path, model):
    path, found = tmp_path / "case.toml", cases(far=True, model=model)
    assert len(found) == len({(line.axis, line.value) for line in found}) == 40
    for line in found:
        path.write_text(line.text)
        case = load(path, line.overrides)
        own = "boundary film" in line.value
        law = "mixed" if own else model or "direct"
        assert case.contact.law == law, line
    axes = {line.axis.removeprefix("far ") for line in found}
    assert axes == {"load", "speed", "oil", "solids", "films", "mesh", "rough", "sliding"}


def test_random_cases_use_both_contact_models():
    drawn = [draw(random.Random(seed))[1][-1] for seed in range(40)]
    assert {"contact.model=direct", "contact.model=mixed"} == set(drawn)


def test_random_cases_load_and_are_reproducible(tmp_path):
    path = tmp_path / "case.toml"
    for seed in range(60):
        text, overrides = draw(random.Random(seed))
        assert draw(random.Random(seed)) == (text, overrides)
        path.write_text(text)
        case = load(path, overrides)
        assert 0.0005 <= case.fluid.viscosity <= 1.0 and 0.01 <= case.motion.entrainment_speed <= 50.0


def test_study_picture_shows_errors_over_both_costs(tmp_path, monkeypatch):
    """Runs that failed are left out; the case as it is has a star, the reference's own error a line."""
    figures, save = [], Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda *args, **how: (figures.append(args[0]), save(*args, **how)))
    rows = [
        {"varied": "reference", "value": 1, "converged": "yes", "wall_s": 9.0, "newton": 50, "h_min": 1e-5},
        {"varied": "", "value": "as it is", "converged": "yes", "wall_s": 1.0, "newton": 9, "h_min": 1e-3},
        {"varied": "mesh", "value": 100, "converged": "yes", "wall_s": 0.8, "newton": 8, "h_min": 2e-3},
        {"varied": "mesh", "value": 50, "converged": "yes", "wall_s": 0.3, "newton": 7, "h_min": 1e-2},
        {"varied": "mesh", "value": 200, "converged": "exit 3", "wall_s": 0.0, "newton": 0, "h_min": np.nan},
    ]
    rows = [{**dict.fromkeys(MEASURES, np.nan), **row} for row in rows]
    picture.draw(rows, tmp_path / "study.png", "title")
    assert (tmp_path / "study.png").read_bytes().startswith(b"\x89PNG")
    (figure,) = figures
    assert len(figure.axes) == 2  # h_min alone has figures: one column
    for axis, costs, case in zip(figure.axes, ([0.3, 0.8], [7, 8]), (1.0, 9), strict=True):
        mesh, star, uncertainty = axis.lines
        np.testing.assert_allclose(mesh.get_xydata(), np.column_stack([costs, [1e-2, 2e-3]]))
        np.testing.assert_allclose(star.get_xydata(), [[case, 1e-3]])
        np.testing.assert_allclose(uncertainty.get_ydata(), 1e-5)
        assert axis.get_xscale() == axis.get_yscale() == "log"


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (9.0, 26.0, [10, 15, 20]),
        (8.0, 110.0, [10, 20, 30, 50, 100]),
        (2.0, 3000.0, [10, 100, 1000]),
        (0.5, 2e6, [1, 100, 1e4, 1e6]),
        (31.0, 37.0, [32, 34, 36]),
        (100.2, 100.9, [100.2, 100.4, 100.6, 100.8]),
    ],
)
def test_axis_labels_are_few_and_round(low, high, expected):
    found = picture.ticks(low, high)
    assert 2 <= len(found) <= picture.MAX_TICKS
    assert found == pytest.approx(expected)


def test_axis_labels_do_not_overlap(tmp_path, monkeypatch):
    from matplotlib.figure import Figure

    drawn = []  # laid out, not written
    monkeypatch.setattr(
        Figure, "savefig", lambda figure, *_, **__: drawn.append(figure) or figure.draw_without_rendering()
    )
    names = ("h_min", "damage")  # their panels are as wide as those of more
    for low, high in ((10.0, 25.0), (10.0, 95.0), (3.0, 2500.0), (31.0, 37.0)):
        rows = [("reference", "", 9 * high), ("", "as it is", low)]
        rows += [("mesh", k, cost) for k, cost in enumerate(np.geomspace(low, high, 4))]
        errors = dict.fromkeys(MEASURES, np.nan) | dict.fromkeys(names, 1e-3) | {"converged": "yes"}
        table = [dict(varied=v, value=k, wall_s=c, newton=100 * c, **errors) for v, k, c in rows]
        picture.draw(table, tmp_path / "p.png", "title")
        assert drawn[-1].axes
        for axes in drawn[-1].axes:
            left, right = axes.get_xlim()
            shown = [label for label in axes.get_xticklabels() if left <= label.get_position()[0] <= right]
            boxes = [label.get_window_extent() for label in shown]
            assert len(boxes) >= 2
            assert all(one.x1 < other.x0 for one, other in zip(boxes, boxes[1:], strict=False))
            low, high = axes.get_ylim()
            shown = [label for label in axes.get_yticklabels() if low <= label.get_position()[1] <= high]
            boxes = [label.get_window_extent() for label in shown]
            assert len(boxes) >= 2
            assert all(one.y1 < other.y0 for one, other in zip(boxes, boxes[1:], strict=False))
