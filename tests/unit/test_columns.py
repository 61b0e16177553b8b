"""Work over the nodes that ranks divide by columns: the same bits as on one rank."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from support import CASES
from support.points import point

from ehlpetsc.case.loading import load
from ehlpetsc.effects.scene import Scene
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation

LINE = {"mesh.points_per_half_width": 20, "time.travel": 0.3}


def line():
    """Two measured surfaces in mixed contact."""
    return load(CASES / "table1_mixed.toml", LINE)


def rough_point():
    """Wavy surface that slides under an Eyring oil, from the first step in the whole contact."""
    case = point(50.0, 5.0, 8, {"motion.slide_roll_ratio": 0.3, "fluid.eyring_stress": 5e6}, 3.0)
    a = Scales.of(load(case)).a
    wave = {"kind": "sine", "amplitude": 5e-9, "wavelength": a, "wavelength_across": a}
    return load(case | {"surface": {"1": {"synthetic": wave}}, "time": {"travel": 0.3, "start": "rough"}})


@pytest.mark.parametrize("case", [line, rough_point])
def test_columns_computed_apart_are_those_of_the_whole_mesh_bit_for_bit(case, monkeypatch):
    whole = list(Simulation(case()))[-1]
    asked = []

    def apart(scene, compute):
        n = scene.scales.grid.shape[-1]
        cuts = [0, n // 3, n // 2, n]
        parts = [compute(slice(*ends)) for ends in zip(cuts, cuts[1:], strict=False)]
        asked.append({part.shape[-1] for part in parts})
        return np.concatenate(parts, axis=-1)

    monkeypatch.setattr(Scene, "over_columns", apart)
    divided = list(Simulation(case()))[-1]
    assert len(asked) >= 3 * divided.step > 0  # heights, guess and shear of each step
    for name, field in whole.fields.items():
        np.testing.assert_array_equal(divided.fields[name], field, err_msg=name)
    assert {k: v for k, v in divided.scalars.items() if k != "wall"} == {
        k: v for k, v in whole.scalars.items() if k != "wall"
    }
