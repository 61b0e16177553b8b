"""Domain and mesh too small for the contact: a warning or refused before a run, an error after it."""

import numpy as np
import pytest
from support import CASES, self_affine

import ehlpetsc
from ehlpetsc.case.keys import template
from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.films import brewe_rigid_film
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.shape import CYLINDER
from ehlpetsc.physics.film_formulas import (
    expected_film,
    film_left_by_inlet,
    film_on_mesh,
    inlet_opening,
    load_outside,
    points_for_opening,
    rolling_left_by_inlet,
    rolling_outside,
    smooth_films,
)
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast.domain import domain_faults, domain_warnings, strip_warnings
from ehlpetsc.run.forecast.validity import warnings
from ehlpetsc.stepping.convergence_check import check_ends
from ehlpetsc.surfaces.motion.roughness import Roughness

SMOOTH = CASES / "table1_smooth.toml"
SLOW = {"contact.load": 2.1e6, "motion.entrainment_speed": 0.005}


def of(overrides, case=SMOOTH, about=domain_warnings):
    case = load(case, overrides)
    return list(about(case, Scales.of(case)))


def test_cases_and_templates_have_no_domain_warning(tmp_path):
    for path in CASES.glob("*.toml"):
        case = load(path)
        found = domain_warnings(case, Scales.of(case)) + domain_faults(case, Scales.of(case))
        if path.stem == "roller_end":  # its subject
            assert len(found) == 1 and "contact reaches the end of the roller, y = -6 mm:" in found[0]
        else:
            assert found == [], path
    (tmp_path / "strip.toml").write_text(template("strip"))
    for path in [*CASES.glob("*.toml"), tmp_path / "strip.toml"]:
        assert of({}, path, strip_warnings) == []
    assert of({}, STRIP, strip_warnings) == []  # ridges by intention


STRIP = {
    "title": "ground across",
    "contact": {"radius": 0.01, "load": 1e5, "youngs_modulus": 206e9, "poisson_ratio": 0.3},
    "fluid": {"oil": "fva3", "temperature": 343.15},
    "motion": {"entrainment_speed": 2.0, "slide_roll_ratio": 0.1},
    "mesh": {"inlet": -4.0, "outlet": 1.5, "width": 0.5, "points_per_half_width": 16},
    "surface": {"1": {"synthetic": {"kind": "ground", "ra": 1e-7, "seed": 3, "correlation": 40e-6}}},
    "time": {"travel": 0.2, "start": "rough"},
}
ACROSS = {"surface.1.synthetic.correlation_across": 150e-6}
AFFINE = self_affine(1e-7, 100e-6, 30e-6)


@pytest.mark.parametrize(
    ("overrides", "words", "width"),
    [
        (ACROSS, "4 correlation lengths across, 0.6 mm", 5.7),
        (ACROSS | {"surface.1.direction": 90.0}, "across, 0.16 mm", 1.6),
        ({"surface.1.synthetic": AFFINE}, "the roll-off wavelength across, 0.1 mm", 1.0),
        ({"surface.1.synthetic": AFFINE | {"peklenik": 0.25}}, "across, 0.4 mm", 3.8),
    ],
)
def test_a_strip_too_narrow_for_its_roughness_has_ridges(overrides, words, width):
    (line,) = of(overrides, STRIP, strip_warnings)
    assert words in line and f"mesh.width = {width:g} or more" in line
    wide = load(STRIP, overrides | {"mesh.width": width})
    assert list(strip_warnings(wide, Scales.of(wide))) == []
    uniform = []
    for case in (load(STRIP, overrides), wide):
        z = Roughness.of(case, Scales.of(case)).surface_1.given.z
        uniform.append(z.mean(axis=0).var() / z.var())
    assert uniform[1] < 0.51 < 0.8 < uniform[0]


def film(**overrides):
    changed = {"mesh.points_per_half_width": 100} | {k.replace("__", "."): v for k, v in overrides.items()}
    return ehlpetsc.solve(load(SMOOTH, changed)).steps.film_central[0]


@pytest.mark.parametrize("inlet", [-1.05, -1.2, -1.5])
def test_film_of_a_near_inlet_equals_the_solver_result(inlet):
    case = load(SMOOTH)
    expected = film_left_by_inlet(expected_film(case, Scales.of(case)), -inlet)
    found = film(mesh__inlet=inlet) / film(mesh__inlet=-4.0)
    assert expected == pytest.approx(found, abs=0.08)


def test_rolling_friction_before_the_mesh_is_that_of_a_farther_inlet():
    """Of a light Newtonian contact: an inlet of 3 a and the one that the warning of it asks for."""
    light = {"contact.load": 60e3, "motion.slide_roll_ratio": 0.0, "mesh.inlet": -3.0}
    light |= {"fluid.eyring_stress": None, "mesh.outlet": 2.0, "mesh.points_per_half_width": 40}
    (line,) = (line for line in of(light, about=warnings) if "rolling" in line)
    assert line.startswith("mesh.inlet = -3: up to 44 % of the rolling friction ")
    asked = float(line.split("mesh.inlet = ")[2].split()[0])
    assert asked < -16.0
    near, far = (load(SMOOTH, light | {"mesh.inlet": inlet}) for inlet in (-3.0, asked))
    assert not any("rolling" in line for line in warnings(far, Scales.of(far)))
    film = expected_film(near, Scales.of(near))
    expected = rolling_left_by_inlet(film, 3.0) / rolling_left_by_inlet(film, -asked)
    friction = [ehlpetsc.solve(case).steps.friction[0] for case in (near, far)]
    # pressure thickens the oil near by
    assert 0.8 < (1.0 - friction[0] / friction[1]) / (1.0 - expected) < 1.0


def light_ball(size, **keys):
    """Ball with M = 0.87, L = 15 on a mesh of `size` half-widths before and beside it."""
    ball = {
        "title": "light ball",
        "contact": {"radius": [0.01, 0.01], "load": 0.5, "youngs_modulus": 206e9, "poisson_ratio": 0.3},
        "fluid": {"oil": "fva3", "temperature": 313.15},
        "motion": {"entrainment_speed": 1.0},
        "mesh": {"inlet": -size, "outlet": 1.5, "width": 2.0 * size, "points_per_half_width": 4},
    }
    return load(ball, {key.replace("__", "."): value for key, value in keys.items()})


def test_film_of_a_light_ball_on_a_mesh_that_is_too_small_equals_the_solver_result():
    films, left = [], []
    for size in (8.0, 32.0):
        case = light_ball(size)
        scales = Scales.of(case)
        x, y = scales.grid.axes[1], scales.grid.axes[0]
        with ehlpetsc.solve(case) as result:
            film = result.film_thickness[-1].reshape(scales.grid.shape)
        films.append(film[np.abs(y).argmin(), np.abs(x).argmin()])
        left.append(film_on_mesh(case, scales, size * scales.a, size * scales.b)[1])
    assert films[0] / films[1] == pytest.approx(left[0] / left[1], rel=0.2)
    flooded = smooth_films(scales, case.fluid, scales.conditions)[0]
    assert flooded == pytest.approx(films[1] / left[1], rel=0.12)


def test_warnings_of_inlet_width_and_mesh_give_what_is_sufficient():
    (line,) = of({}, light_ball(8.0)._tables)
    assert "mesh.inlet = -8 and mesh.width = 16 are too near" in line and "leave 24 % of its film" in line
    (line,) = of({"contact.load": 2.0}, light_ball(8.0)._tables)  # central pressure 122 MPa, far out 44
    inlet = float(line.split("mesh.inlet = ")[2].split()[0])
    width = float(line.split("mesh.width = ")[2].split()[0])
    far = {"contact.load": 2.0, "mesh.inlet": inlet, "mesh.width": width}
    assert -90.0 < inlet < -70.0 and of(far, light_ball(8.0)._tables) == []
    assert of(far | {"mesh.width": 8.0}, light_ball(8.0)._tables) != []
    case = light_ball(8.0, contact__load=2.0)
    scales = Scales.of(case)
    note = f"would add {rolling_outside(scales, 8.0 * scales.a, 8.0 * scales.b):.2g} N"
    assert any(note in line for line in of({}, case._tables, warnings))
    heavy = {"contact.load": 30.0, "mesh.inlet": -4.0, "mesh.width": 5.0, "mesh.points_per_half_width": 16}
    assert of(heavy, light_ball(8.0)._tables) == []
    (line,) = of({"mesh.inlet": -1.05})
    assert line.startswith("mesh.inlet = -1.05 ") and " 43 % " in line
    further = float(line.split("mesh.inlet = ")[2].split()[0])
    assert -2.5 < further < -1.8 and of({"mesh.inlet": further}) == []
    (line,) = of(SLOW | {"mesh.points_per_half_width": 400})
    assert " 1.9 films " in line
    points = int(line.split("points_per_half_width = ")[1].split(";")[0])
    assert of(SLOW | {"mesh.points_per_half_width": points}) == []
    (line,) = of(SLOW, about=domain_faults)
    assert line.startswith(f"{SMOOTH}: mesh.points_per_half_width = 200: ") and " 5.3 films " in line
    with pytest.raises(ehlpetsc.CaseError, match=r"points_per_half_width = 200: .* 5\.3 films"):
        ehlpetsc.Simulation(load(SMOOTH, SLOW))


def test_rigid_films_and_loads_of_ellipses_by_their_sources():
    """128 alpha (phi L U/W)^2 of the article; all of Kapitza's load lies outside a mesh without extent."""
    for ratio in (0.5, 1.0, 4.0):
        case = light_ball(8.0, contact__radius=[0.01, 0.01 * ratio])
        scales = Scales.of(case)
        film = scales.R * np.sqrt(2.0 * scales.eta0 * scales.u / (scales.E * scales.R))
        film *= brewe_rigid_film(scales.moes_m, ratio)
        load_of_it = load_outside(scales, film, 1e-9, 1e-9)
        assert load_of_it == pytest.approx(0.5, rel=1e-3)
        assert load_outside(scales, film, 1e-3, 1e-3) < 0.9 * load_of_it


def test_film_on_a_mesh_too_coarse_for_the_inlet_is_as_predicted():
    slow = {"motion__entrainment_speed": 0.1, "mesh__inlet": -1.5}
    case = load(SMOOTH, {"motion.entrainment_speed": 0.1})
    expected = expected_film(case, Scales.of(case))
    fine = film(**slow, mesh__points_per_half_width=800)
    for opening, low, high in ((0.25, 0.02, 0.08), (1.0, 0.25, 0.5)):
        points = round(points_for_opening(expected, opening))
        assert inlet_opening(expected, points) == pytest.approx(opening, rel=0.05)
        assert low < 1.0 - film(**slow, mesh__points_per_half_width=points) / fine < high


def test_contact_or_pressure_at_the_ends_is_an_error():
    """A dent of 50 um: without oil its flanks carry at the ends of the mesh."""
    dent = {"kind": "dent", "amplitude": 50e-6, "wavelength": 600e-6, "position": 340e-6}
    changed = {"mesh.inlet": -1.01, "mesh.outlet": 1.01, "surface": {"2": {"synthetic": dent}}}
    with pytest.raises(ehlpetsc.NotConverged, match=r"solids .* inlet, x = -1\.01 a: .* mesh\.inlet "):
        ehlpetsc.solve(load(CASES / "dry_hertz.toml", changed))
    grid = Grid((np.linspace(-2.0, 1.2, 5),), (1e-4,), (1.0,), (CYLINDER,), 0.5 * np.pi)
    dry = np.zeros(5, bool)
    check_ends(grid, np.array([0.0, 0.5, 1.0, 0.3, 0.0]), dry)
    check_ends(grid, np.array([0.0, 0.5, 1.0, 0.3, 0.0099]), dry)
    with pytest.raises(ehlpetsc.NotConverged, match=r"^0\.01 p0 .* x = 1\.2 a: .* mesh\.outlet "):
        check_ends(grid, np.array([0.0, 0.5, 1.0, 0.3, 0.0102]), dry)
    with pytest.raises(ehlpetsc.NotConverged, match=r"^0\.3 p0 .* x = 1\.2 a: .* mesh\.outlet "):
        check_ends(grid, np.array([0.0, 0.5, 1.0, 1.0, 0.3]), dry)
