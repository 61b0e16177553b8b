"""Archard's wear: the worn volume is k times the integral of p_c |u1 - u2|, whatever the roughness."""

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import CaseError, load
from ehlpetsc.effects.depths import wear_depth
from ehlpetsc.run.simulation import Simulation

SHORT = ["mesh.points_per_half_width=40", "mesh.inlet=-1.5", "mesh.outlet=1.3", "time.travel=2.0"]
K = 1e-15  # m^2/N


def worn(*keys, after=None):
    simulation = Simulation(load(CASES / "table1_mixed.toml", [*SHORT, *keys]), after=after)
    return simulation, list(simulation)


@pytest.mark.parametrize("scale", [0.5, 1.0])
def test_worn_volume_is_the_integral_of_the_solids_pressure_times_sliding(scale):
    keys = [f"surface.{side}.scale={scale}" for side in ("1", "2")]
    simulation, states = worn(f"wear.coefficient=[{K}, {3 * K}]", *keys)
    sliding, dx = simulation.scales.u1 - simulation.scales.u2, simulation.scales.dx
    work = sum(state.contact_pressure.sum() * dx * sliding * state.dt for state in states[1:])
    assert work > 0.0
    assert states[-1].wear_volume == pytest.approx(4.0 * K * work, rel=1e-10)
    one, two = simulation.dimensionless.records["wear"].depth
    assert two.volume == pytest.approx(3.0 * one.volume, rel=1e-12)
    assert one.volume == pytest.approx(K * work, rel=1e-10)


def test_wear_is_passed_on_to_the_next_pass():
    first, states = worn(f"wear.coefficient={K}", "time.passes=2")
    second, again = worn(f"wear.coefficient={K}", "time.passes=2", after=first)
    assert again[0].wear_volume == pytest.approx(states[-1].wear_volume, rel=1e-14)
    assert again[-1].wear_volume > again[0].wear_volume
    shares = [np.mean([s.contact_share for s in run]) for run in (states, again)]
    assert shares[1] < shares[0], "asperities that have worn carry less"
    assert second.pass_number == 2


def test_no_wear_without_sliding():
    assert wear_depth(K, np.ones(3) * 1e9, 0.0, 1e-6).tolist() == [0.0, 0.0, 0.0]
    assert wear_depth(K, np.array([1e9]), -2.0, 1e-6)[0] == pytest.approx(2e-12)


@pytest.mark.parametrize(
    "case, coefficient",
    [
        ("table1_rough.toml", K),
        ("table1_smooth.toml", K),
        ("table1_mixed.toml", 1.0),
        ("table1_mixed.toml", [K]),
    ],
)
def test_invalid_wear_is_refused(case, coefficient):
    with pytest.raises(CaseError, match="wear"):
        load(CASES / case, [f"wear.coefficient={coefficient}"])
