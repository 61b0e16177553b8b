"""Lives with oil, heat, yielding, a compliant layer, changing conditions and gears, on short meshes."""

import numpy as np
import pytest
from support import CASES, COARSE_LIFE

from ehlpetsc import Simulation
from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load
from ehlpetsc.life import run_life
from ehlpetsc.life.driver import check_case

OIL = {"viscosity": 0.0002, "law": "roelands", "pressure_viscosity": 11.1e-9, "roelands_z": 0.568}
OIL |= {"roelands_pressure": 0.1962e9, "density": "incompressible", "eyring_stress": 10e6}
SHORT = {
    "time.travel": 3.6,
    "fluid": OIL,
    "mesh.points_per_half_width": 8,
    "surface.1.scale": 1.0,
    "surface.2.scale": 1.0,
    "wear.coefficient": 1e-16,
}
HEAT = {"heat": {"bulk_temperature": 363.0}}
LAYER = {"contact.asperity_height": 100e-9}
YIELDING = {"contact.yield_pressure": 2e9}
SWINGING = {
    "operation": {"time": [0.0, 2e-4, 4e-4], "load": [500e3, 400e3, 527e3], "speed_1": [5.0, 6.0, 5.5]}
}
# teeth of a softer material: a wide contact passes a flank in few steps
GEARS = {
    "contact.youngs_modulus": [20e9, 20e9],
    "contact.poisson_ratio": [0.3, 0.3],
    "contact.material": None,
    "contact.asperity_height": None,
    "contact.asperity_stiffness": None,
    "fluid": None,
    "heat": None,
    "mesh.inlet": -1.5,
    "mesh.points_per_half_width": 8,
    "time.courant": 1.0,
    "output.every": 1,
    "output.precision": "float64",
    "post": {"depths": [0.0, 0.05], "fatigue_strength": 1e9, "fatigue_ductility": 0.5, "b": -0.1, "c": -0.6},
    "wear": {"coefficient": 1e-16},
    "life": {"passes": 1e9, "partners": 2},
}


@pytest.mark.parametrize("keys", [{}, YIELDING, HEAT | LAYER | YIELDING])
def test_a_life_runs_with_oil_and_every_effect(keys, tmp_path):
    case = load(COARSE_LIFE, SHORT | {"life.passes": 1e9} | keys)
    life = run_life(case, tmp_path / "a.life.h5", most=3, unresolved=True)
    assert len(life.rows) == 3 and life.done > 3
    last = life.rows[-1]
    assert 0.0 < last["friction"] < 0.2 and 0.0 < last["contact_share"] < 1.0
    assert last["wear_volume_1"] > 0.0 and last["damage_1"] > 0.0
    assert bool(life.plastic[-1]) == ("contact.yield_pressure" in keys)


def test_a_life_runs_under_changing_conditions(tmp_path):
    case = load(COARSE_LIFE, SHORT | {"fluid": None, "life.passes": 1e9} | SWINGING)
    life = run_life(case, tmp_path / "a.life.h5", most=2, unresolved=True)
    assert life.rows[-1]["wear_volume_1"] > 0.0 and len(life.bodies[-1][0].s) > 2


def test_surfaces_that_turn_back_are_refused():
    turning = {
        "operation": {"time": [0.0, 1e-4, 2e-4], "speed_1": [5.0, 0.0, -5.0], "speed_2": [5.0, 0.0, -5.0]}
    }
    keys = {"mesh.points_per_half_width": 10, "mesh.inlet": -1.3, "mesh.outlet": 1.3} | turning
    with pytest.raises(CaseError, match=r"life\.toml: .*one way"):
        check_case(load(COARSE_LIFE, keys))


def test_teeth_wear_along_their_flanks_as_load_and_sliding_say(tmp_path):
    r"""Of a point of the pinion that passes a narrow contact :math:`dz_1=k\,w\,|u_1-u_2|/u_1`; none at C."""
    case = load(CASES / "fzg.toml", GEARS)
    life = run_life(case, tmp_path / "a.life.h5", most=1, unresolved=True)
    row, operation, scales = life.rows[0], Simulation(case).operation, Simulation(case).scales
    assert row["solved"] == 2
    time = np.linspace(0.0, operation.duration, 2001)
    found = [operation.at(t) for t in time]
    rate = np.array([one.load * abs(one.sliding) for one in found])
    total = float(np.sum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time)))
    k, teeth = case.wear.coefficient[0], case.gears.pair.teeth
    pinion, wheel = life.bodies[-1]
    assert pinion.volume == pytest.approx(k * total * row["passes"], rel=0.005)
    assert wheel.volume == pytest.approx(2 * teeth[0] / teeth[1] * k * total * row["passes"], rel=0.005)
    # along the flank: arc length from A by the pinion's way
    arc = case.conditions.profile_offsets[0] + np.array([operation.travelled(t)[0] for t in time])
    expected = np.interp(-pinion.s[::-1], arc, k * rate / [one.u1 for one in found])[::-1]
    window = np.ones(9) / 9.0
    smooth = [np.convolve(z, window, "valid") for z in (pinion.wear / row["passes"], expected)]
    at_ends = 2 * int(scales.a / (pinion.s[1] - pinion.s[0]))
    inside = slice(at_ends, -at_ends)
    assert np.abs(smooth[0] - smooth[1])[inside].max() < 0.15 * smooth[1].max()
    pitch = np.abs(-pinion.s - float(case.gears.pair.flank_arcs(case.gears.pair.points["C"])[0])).argmin()
    assert pinion.wear[pitch] < 0.2 * pinion.wear.max()
