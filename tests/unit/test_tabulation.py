"""Tables over conditions: refinement, interpolation, fits of traction curves."""

import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

from ehlpetsc.analysis.table_files import masta_text
from ehlpetsc.analysis.tabulation import Axis, tabulate
from ehlpetsc.analysis.traction_fits import fitted_stribeck, fitted_traction, stribeck, traction
from ehlpetsc.base.errors import UsageError

AXES = (Axis("speed", "m/s", 0.5, 20.0), Axis("pressure", "Pa", 0.5e9, 1.2e9))


def power_law(points):
    return np.array(
        [[0.02 * u**-0.3 * (p / 1e9) ** 0.5, 1e-7 * u**0.7 * (p / 1e9) ** -0.1] for u, p in points]
    )


def test_powers_of_a_logarithmic_axis_need_no_more_lines():
    table = tabulate(AXES, ("friction", "film"), power_law, 0.03)
    assert [len(line) for line in table.lines] == [3, 3]
    assert table.lines[0][1] == pytest.approx(np.sqrt(10.0), rel=1e-5)
    assert table.errors.max() < 0.03
    np.testing.assert_allclose(table.at([(3.0, 0.85e9)]), power_law([(3.0, 0.85e9)]), rtol=0.01)


def test_lines_gather_where_values_bend():
    def bend(points):
        return np.array([[1.0 + np.tanh(8.0 * (np.log(u) - 1.5))] for u, p in points])

    table = tabulate(AXES, ("share",), bend, 0.03)
    line = np.log(table.lines[0])
    assert len(table.lines[1]) == 3 < len(line)
    assert np.diff(line).argmin() == pytest.approx(np.searchsorted(line, 1.5), abs=3)
    others = [(float(u), 0.7e9) for u in np.geomspace(0.6, 19.0, 50)]
    assert np.abs(table.at(others) - bend(others)).max() < 0.06


def test_every_point_is_computed_once():
    asked = []

    def counted(points):
        asked.extend(points)
        return power_law(points)

    tabulate(AXES, ("friction", "film"), counted, 0.001)
    assert len(asked) == len(set(asked))


def test_script_of_masta_reads_the_table_at_the_pressure_of_a_mesh(monkeypatch):
    """Of a mesh with 0.85 GPa at 3.16228 m/s, on lines of the table."""
    mastapy, gears, materials = map(ModuleType, ("mastapy", "mastapy.gears", "mastapy.gears.materials"))
    properties = {}
    mastapy.masta_property = lambda name, description: lambda function: properties.setdefault(name, function)
    materials.ScriptCoefficientOfFrictionCalculator = SimpleNamespace
    for module in (mastapy, gears, materials):
        monkeypatch.setitem(sys.modules, module.__name__, module)

    def friction(points):
        return np.array([[power_law([(u, p)])[0, 0] * abs(s) * 350.0 / t] for u, p, s, t in points])

    axes = *AXES, Axis("slide_roll", "1", 0.05, 0.1), Axis("temperature", "K", 330.0, 370.0)
    table = tabulate(axes, ("friction_coefficient",), friction, 0.03)
    exec(masta_text(table, "Gears", "0.1", 231e9), {})
    mesh = SimpleNamespace(
        normal_load=0.02 * 2.0 * np.pi * 0.01 * 0.85e9**2 / 231e9,
        contact_length=0.02,
        combined_radius_of_curvature=0.01,
        entrainment_velocity=3.16228,
        sliding_velocity=-0.075 * 3.16228,
    )
    found = properties["Friction by ehlpetsc"](mesh)
    assert found == pytest.approx(friction([(3.16228, 0.85e9, 0.075, 350.0)])[0, 0], rel=1e-4)


def test_noise_ends_in_a_sentence():
    random = np.random.default_rng(1)
    with pytest.raises(UsageError, match="narrower ranges"):
        tabulate(AXES, ("noise",), lambda points: random.uniform(1.0, 2.0, (len(points), 1)), 0.03)


def test_traction_curve_gives_back_its_constants():
    """A curve with its maximum of 0.06 at 0.8 m/s, falling to 0.04."""
    slip = np.geomspace(0.01, 10.0, 30)
    x = brentq(lambda x: 0.04 * np.exp(-x) / (x - 1.0) - 0.02, 1.01, 20.0)
    c = x / 0.8
    constants = np.array([-0.04, -0.04 * c / (1.0 - x), c, 0.04])
    found = fitted_traction(slip, traction(slip, constants))
    assert found[:4] == pytest.approx((0.0, 0.04, 0.06, 0.8), rel=1e-3)
    assert found.misfit < 1e-5


def test_traction_that_rises_all_over_is_read_back_from_its_printed_constants():
    slip = np.geomspace(0.01, 3.0, 12)
    friction = 0.012 * np.arcsinh(slip / 0.02)  # Eyring's oil
    found = fitted_traction(slip, friction)
    kappa_0, kappa_inf, kappa_m, u_m = (float(f"{value:.6g}") for value in found[:4])
    ratio = (kappa_m - kappa_inf) / (kappa_inf - kappa_0)
    y = brentq(lambda y: np.exp(-y) / (y - 1.0) - ratio, 1.0001, 20.0)
    c = y / u_m
    read = traction(
        slip, np.array([kappa_0 - kappa_inf, (kappa_inf - kappa_0) * c / (y - 1.0), c, kappa_inf])
    )
    assert np.sqrt(np.mean((read - friction) ** 2)) / friction.max() == pytest.approx(found.misfit, rel=0.01)
    assert 0.01 < found.misfit < 0.12


def test_stribeck_curve_gives_back_its_constants():
    speed = np.geomspace(0.01, 10.0, 30)
    found = fitted_stribeck(speed, stribeck(speed, np.array([0.12, 0.02, 0.3, 1.4, 0.001])))
    assert found[:5] == pytest.approx((0.12, 0.02, 0.3, 1.4, 0.001), rel=1e-3)
