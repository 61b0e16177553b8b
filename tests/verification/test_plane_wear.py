"""Wear and plastic deformation in points and strips: strips are the line, worn volume is k times the work."""

import numpy as np
import pytest
from support import roelands_oil

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

K = 1e-15  # m^2/N
RIDGE = {
    "title": "one asperity",
    "contact": {
        "radius": 0.0191,
        "load": 527e3,
        "material": "SAE4340",
        "model": "mixed",
        "asperity_height": 20e-9,
        "boundary_friction": 0.1,
        "yield_pressure": 2e9,
    },
    "fluid": roelands_oil(0.005, 11.1e-9, eyring_stress=10e6),
    "motion": {"entrainment_speed": 1.0, "slide_roll_ratio": 0.5},
    "mesh": {"inlet": -1.3, "outlet": 1.4, "points_per_half_width": 20},
    "surface": {
        "1": {"synthetic": {"kind": "ridge", "amplitude": 1e-6, "wavelength": 60e-6, "position": 80e-6}}
    },
    "wear": {"coefficient": [K, 3 * K]},
    "time": {"travel": 1.1, "courant": 1.0},
}


def solved(case, *keys, **options):
    simulation = Simulation(load(case, list(keys)), options=options)
    return simulation, list(simulation)


@pytest.fixture(scope="module")
def line():
    return solved(RIDGE, snes_atol=1e-13)


def test_an_asperity_of_a_strip_yields_and_wears_as_in_a_line(line):
    strip = solved(RIDGE, "mesh.width=0.3", snes_atol=1e-13)
    (of_line, states), (of_strip, others) = line, strip
    assert len(states) == len(others)
    for name in ("plastic_deformation", "wear"):
        depths = (s.dimensionless.records[name].depth for s in (of_line, of_strip))
        for alone, rows in zip(*depths, strict=True):
            assert alone.first == rows.first and alone.depth.max() > 0.0
            np.testing.assert_allclose(rows.depth - alone.depth, 0.0, atol=1e-9 * alone.depth.max())
    for name in ("set_volume", "wear_volume", "contact_share", "friction"):
        assert others[-1].scalars[name] == pytest.approx(states[-1].scalars[name], rel=1e-9)


POINT = RIDGE | {
    "contact": RIDGE["contact"] | {"radius": [0.0125, 0.0125], "load": 20.0, "yield_pressure": 1.2e9},
    "mesh": {"inlet": -1.5, "outlet": 1.4, "points_per_half_width": 12, "width": 3.0},
    "surface": {
        "1": {
            "synthetic": {
                "kind": "ridge",
                "amplitude": 0.4e-6,
                "wavelength": 60e-6,
                "wavelength_across": 60e-6,
                "position": 60e-6,
            }
        }
    },
}


@pytest.mark.parametrize(
    "layer", [{"asperity_height": 20e-9}, {"boundary_film": 20e-9}], ids=["layer", "rigid"]
)
def test_volumes_of_a_point_are_integrals_over_its_area(layer):
    """Worn volume k times pressure times sliding; plastic deformation the sum of its steps."""
    contact = {key: value for key, value in POINT["contact"].items() if key != "asperity_height"}
    simulation, states = solved(POINT | {"contact": contact | layer})
    s, records = simulation.scales, simulation.dimensionless.records
    cell = s.grid.spacings[0] * s.grid.spacings[1]
    work = sum((state.contact_pressure * (s.u1 - s.u2) * state.dt).sum() * cell for state in states[1:])
    assert work > 0.0
    assert states[-1].wear_volume == pytest.approx(4.0 * K * work, rel=1e-9)
    one, two = records["wear"].depth
    assert two.volume == pytest.approx(3.0 * one.volume, rel=1e-12)
    added = sum(state.dimensionless.records["plastic_deformation"].added.sum() for state in states)
    assert added > 0.0
    assert states[-1].set_volume == pytest.approx(added * cell, rel=1e-9)
    rows = records["plastic_deformation"].depth.surface_1.depth
    assert rows.shape[0] == s.grid.shape[0]
    assert rows.max(axis=1).argmax() == s.grid.shape[0] // 2
    np.testing.assert_allclose(rows, rows[::-1], atol=1e-3 * rows.max())


@pytest.mark.parametrize("share", [4.0, 8.0])
def test_a_ball_far_beyond_yield_is_flattened_at_its_hardness(share):
    r"""Uniform pressure H over a circle of :math:`\pi c^2H=F`, in which the plastic depth closes the gap.

    In the middle :math:`c^2/(2R)-(2-4/\pi)Hc/E^*`, elastic deflection by Johnson (1985), eq. 3.29.
    """
    half, radius = 1.3 * np.sqrt(2.0 * share / 3.0), 1e-4
    contact = {"radius": [radius, radius], "load": 0.1, "material": "SAE4340"}
    contact |= {"model": "mixed", "boundary_film": 1e-9}
    mesh = {"inlet": -half, "outlet": half, "width": 2.0 * half, "points_per_half_width": 24}
    case = {"title": "asperity", "contact": contact, "mesh": mesh}
    hardness = Simulation(load(case)).scales.p0 / share
    simulation, [state] = solved(case, f"contact.yield_pressure={hardness}")
    s, added = (
        simulation.scales,
        state.dimensionless.records["plastic_deformation"].added.reshape(state.pressure.shape),
    )
    c = np.sqrt(contact["load"] / (np.pi * hardness))
    depth = 0.5 * c**2 / radius - (2.0 - 4.0 / np.pi) * hardness * c / (0.5 * s.E)
    assert state.pressure.max() == pytest.approx(hardness, rel=1e-12)
    assert added.max() == added[added.shape[0] // 2, added.shape[1] // 2] == pytest.approx(depth, rel=0.003)
