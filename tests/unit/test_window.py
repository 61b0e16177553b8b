"""Windows of rollers: the smooth roller again, finer rows, images of far ends, what is refused."""

import copy

import numpy as np
import pytest
from support import roelands_oil

import ehlpetsc
from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.plane.deflection import Convolution, Transposition
from ehlpetsc.elasticity.kernel import Mesh
from ehlpetsc.elasticity.terms.free_ends import of_quarter_spaces
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures.frames.choice import Choice
from ehlpetsc.run import checkpoint
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.run.simulation import Simulation

L, R, W = 4e-3, 6e-3, 800.0
DRY = {
    "title": "a window of a roller",
    "contact": {"radius": R, "length": L, "load": W, "material": "100Cr6", "tilt": 5e-4},
    "mesh": {"inlet": -2.4, "outlet": 2.0, "points_per_half_width": [10, 40]},
}
DRY["contact"]["profile"] = {"kind": "circular", "radius": 0.02, "straight": 3e-3}
OIL = {
    "fluid": roelands_oil(0.02, 2e-8),
    "motion": {"entrainment_speed": 3.0, "slide_roll_ratio": 0.1},
}
END, MIDDLE = {"from": -2e-3, "to": -1e-3}, {"from": -0.5e-3, "to": 0.5e-3}


def tables(oil=None, window=None, points=(10, 40), coarsening=(1, 1), **more):
    case = copy.deepcopy(DRY) | (oil or {}) | more
    case["mesh"]["points_per_half_width"] = list(points)
    if window:
        case["mesh"]["window"] = window | {"coarsening": list(coarsening)}
    return case


def solved(*args, **options):
    simulation = Simulation(load(tables(*args, **options)))
    return simulation.scales.grid, simulation.advance()


@pytest.mark.parametrize("oil", [{}, OIL], ids=["dry", "in oil"])
def test_smooth_window_is_the_smooth_roller(oil):
    oil = oil | {"petsc": {"snes_atol": 1e-11}}  # a further iteration of the window changes nothing
    whole, state = solved(oil)
    for window, to_ends in ((END, (0, 60)), (MIDDLE, (30, 30))):
        grid, found = solved(oil, window)
        assert grid.shape[0] == 20 and grid.to_ends == to_ends
        rows = slice(to_ends[0], to_ends[0] + 20)
        np.testing.assert_allclose(grid.y, whole.y[rows], rtol=1e-13)
        np.testing.assert_allclose(found.pressure, state.pressure[rows], atol=1e-12 * state.p_max)
        np.testing.assert_allclose(found.film_thickness, state.film_thickness[rows], atol=1e-18, rtol=1e-12)
        assert found.load == pytest.approx(state.pressure[rows].sum() * whole.node_size, rel=1e-12)
        assert found.load_error < 1e-14


def test_window_on_finer_rows_is_a_finer_roller():
    """Loaded end of a roller, whose films need rows of 13 um; load of the window by rows of 50 um."""
    window = {"from": -2e-3, "to": -1.4e-3}
    _, state = solved(OIL, points=(10, 160))
    grid, found = solved(OIL, window, (10, 160), (1, 4))
    part = slice(0, grid.shape[0])
    _, coarse = solved(OIL)
    errors = [one.film_thickness.min() / state.h_min - 1.0 for one in (found, coarse)]
    assert abs(errors[0]) < 3e-3 < 0.1 < abs(errors[1])
    assert found.p_max == pytest.approx(state.pressure[part].max(), rel=3e-3)


def test_images_of_a_window_are_those_of_the_roller_around_it():
    before, rows, behind, n_x, steps = 3, 5, 7, 6, (0.05, 0.03)
    pressure = np.random.default_rng(4).random((rows, n_x))
    long = np.zeros((before + rows + behind, n_x))
    long[before : before + rows] = pressure
    meshes = Mesh((rows, n_x), steps, False, 1e-4, (before, behind)), Mesh(long.shape, steps, False, 1e-4)
    of_window, of_roller = (
        Convolution(of_quarter_spaces(mesh, 0.3), False, Transposition()) for mesh in meshes
    )
    expected = of_roller(long.ravel()).reshape(long.shape)[before : before + rows]
    np.testing.assert_allclose(of_window(pressure.ravel()), expected.ravel(), rtol=1e-12)


def test_maps_of_roughness_begin_in_the_middle_of_a_window():
    z = np.add.outer(np.arange(41.0), np.zeros(9))  # a step a row of 20 um
    surface = {"surface": {"1": {"z": z.tolist(), "spacing": 2e-5, "scale": 1e-9}}}
    simulation = Simulation(load(tables({}, {"from": 1e-3, "to": 1.4e-3}, **surface)))
    heights = simulation.roughness.phi_after(np.zeros(3), (0.0, 0.0)).reshape(8, 3)[:, 0]
    np.testing.assert_allclose(np.diff(heights), -2.5e-9, rtol=1e-3)
    assert abs(heights.mean()) < 1e-15


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mesh": {"window": {"from": 1e-3, "to": 0.5e-3}}}, "mesh.window.from = 0.001: allowed"),
        ({"mesh": {"window": {"from": 1e-3, "to": 3e-3}}}, "allowed: on the roller, from -0.002 to 0.002 m"),
        ({"mesh": {"window": {"from": 1e-3, "to": 2e-3, "coarsening": [1, 3]}}}, "multiples of mesh.window"),
        ({"mesh": {"window": {"from": 1e-3, "to": 2e-3, "coarsening": [1, 20]}}}, "multiples of mesh.window"),
        ({"mesh": {"window": END, "points_per_half_width": 10}}, "points_per_half_width = 10: allowed: two"),
        ({"contact": {"length": None}, "mesh": {"window": END}}, "mesh.window: needs contact.length"),
        (
            {"contact": {"tilt": None, "self_aligning": True}, "mesh": {"window": END}},
            "contact.self_aligning",
        ),
    ],
)
def test_faults_of_windows_are_named(changes, message):
    case = tables()
    for name, table in changes.items():
        case[name] = {key: value for key, value in (case[name] | table).items() if value is not None}
    with pytest.raises(CaseError) as error:
        Simulation(load(case))
    assert message in str(error.value)


def test_window_is_said_before_the_run():
    text = explain(load(tables(OIL, END, (20, 160), (2, 4))))
    assert "a roller, radius 0.006 m, length 4 mm" in text
    assert "Window: y = -2 to -1 mm; the smooth roller beside it on 45 x 80 nodes" in text
    assert "rows of the smooth roller" not in text
    text = explain(load(tables(OIL, MIDDLE, (20, 160), (2, 10))))
    assert "rows of the smooth roller beside the window are 125 um apart" in text
    assert Scales.of(load(tables(OIL, END))).moes_m == Scales.of(load(tables(OIL))).moes_m


def test_picture_of_a_window_has_maps_and_sections_over_its_rows(tmp_path):
    result = ehlpetsc.solve(tables({}, END), output=tmp_path / "window.h5", options={})
    figure = Choice([result], [0], (-1.6, 1.4)).draw()
    pressure, film, along, films = figure.axes[:4]
    assert pressure.get_ylabel() == "y [mm]" and pressure.get_ylim() == pytest.approx((-2.0, -1.0))
    np.testing.assert_allclose(along.lines[0].get_xdata(), 1e3 * result.y)
    assert along.lines[1].get_ydata().max() == pytest.approx(1e-9 * result.pressure.max())
    w = result.load_per_length() * L / W
    edge = pressure.lines[1].get_xdata()
    np.testing.assert_allclose(edge[w > 0.0], np.sqrt(w[w > 0.0]), rtol=1e-12)
    assert "edge_factor" not in result.scalars and result.attrs["kind"] == "window"


@pytest.mark.parametrize("window", [None, END], ids=["roller", "window"])
def test_rough_roller_continues_from_a_restart_file_as_if_it_had_not_stopped(window, tmp_path):
    wave = {"kind": "sine", "amplitude": 5e-8, "wavelength": 1e-4, "wavelength_across": 4e-4}
    rough = {"surface": {"1": {"synthetic": wave}}, "time": {"travel": 0.4}}
    case = load(tables(OIL, window, (10, 20), **rough))
    whole = Simulation(case)
    for state in whole:
        if state.step == 2:
            checkpoint.save(tmp_path / "roller.restart.h5", whole, whole.state.in_contact, {"newton": 1})
    again = Simulation(case)
    found, notes = checkpoint.load(tmp_path / "roller.restart.h5", case, again.scales)
    again.resume(found.state, found.baseline)
    *_, last = again
    assert notes == [] and last.step == whole.state.step == 4
    np.testing.assert_array_equal(last.pressure, whole.state.pressure)
    np.testing.assert_array_equal(last.film_thickness, whole.state.film_thickness)


def test_window_of_a_roller_without_a_solution_is_refused_in_a_sentence():
    with pytest.raises(CaseError, match="case: the smooth roller beside the mesh: steady start: .*MAX_IT"):
        Simulation(load(tables(OIL, END, (8, 20))), options={"snes_max_it": 1})
