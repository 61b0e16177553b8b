"""An effect with a scalar of state and a key is one file and one line; effects on oil and friction."""

import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES
from support.driving import Scene
from support.running import BARE, SCRIPT

from ehlpetsc.effects.effect import Effect

EFFECT = '''
from dataclasses import replace
from typing import NamedTuple

from ehlpetsc.effects.effect import Effect
from ehlpetsc.base.declarations import KeyTable, Required
from ehlpetsc.base.declarations import StepScalar


class Supply(NamedTuple):
    film: float


class Starving(Effect):
    """Oil film at the inlet that each half-width of travel makes thinner by a fraction."""

    name = "starving"
    record = Supply
    table = KeyTable("starving", "left out: constant supply", {"loss": Required("in a half-width", "", 0, 1)})
    scalars = {"supply": StepScalar("m", "oil film at the inlet", over_run="last")}

    def start(self, before=None):
        return Supply(0.15e-6)

    def inputs(self, record, inputs, step):
        return replace(inputs, inlet_film=self.after(record, step) / self.scene.scales.h)

    def accept(self, record, solution, step):
        return Supply(self.after(record, step))

    def after(self, record, step):
        travelled = abs(step.conditions.entrainment) * (step.dt or 0.0) / self.scene.scales.a
        return record.film * (1.0 - self.scene.case.starving.loss) ** travelled

    def observe(self, record, solution, step):
        return {}, {"supply": record.film}
'''
RUN = """
import ehlpetsc.effects as effects
from starving import Starving
effects.EFFECTS = (*effects.EFFECTS, Starving)
import sys, ehlpetsc
from ehlpetsc.case import key_page
assert "in a half-width" in key_page.keys()
case = ehlpetsc.load(sys.argv[1], {"starving": {"loss": 0.3}, "time": {"travel": 2.25, "courant": 0.5},
    "mesh.points_per_half_width": 32, "mesh.inlet": -2.0})
result = ehlpetsc.solve(case, output="starved.h5")
supply, film = result["steps/supply"], result["steps/film_central"]
print(supply[0], supply[-1] / supply[0], film[-1] / film[0])
"""


def test_an_effect_is_one_file_and_one_line(tmp_path):
    (tmp_path / "starving.py").write_text(EFFECT)
    path = BARE | SCRIPT
    path["PYTHONPATH"] = f"{tmp_path}:{path['PYTHONPATH']}" if path.get("PYTHONPATH") else str(tmp_path)
    command = [sys.executable, "-c", RUN, str(CASES / "table1_smooth.toml")]
    done = subprocess.run(command, cwd=tmp_path, env=path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    first, left, film = map(float, done.stdout.split()[-3:])
    assert first == pytest.approx(0.15e-6)
    assert left == pytest.approx(0.7**2, rel=0.05)  # the faster surface travels 1.125 as far
    assert film < 0.995


class Additive(Effect):
    """Oil twice as thick, and solids twice as rough to rub."""

    name = "additive"

    def inputs(self, record, inputs, step):
        fluid = inputs.fluid and inputs.fluid.copy(update={"viscosity": 2.0 * inputs.fluid.viscosity})
        return replace(inputs, fluid=fluid, boundary_friction=2.0 * inputs.boundary_friction)

    @classmethod
    def is_in(cls, case):
        return True


def started(name, effects, *keys):
    scene = Scene(name, *keys)
    for effect in effects:
        scene.stepper.effects.append(effect)
        scene.simulation._records[effect.name] = effect.start()
    return scene.simulation.advance()


def test_effects_change_oil_and_friction_one_after_the_other():
    """Two effects that double the viscosity: the friction is that of the oil four times as thick."""
    keys = ["mesh.points_per_half_width=32", "mesh.inlet=-2.5", "fluid.law=barus"]
    more = Additive(SimpleNamespace())
    more.name = "more"
    found = started("table1_smooth.toml", [Additive(SimpleNamespace()), more], *keys, "fluid.viscosity=0.005")
    thick = started("table1_smooth.toml", [], *keys, "fluid.viscosity=0.02")
    np.testing.assert_allclose(found.film_thickness, thick.film_thickness, rtol=1e-5)
    np.testing.assert_allclose(found.shear_stress_2, thick.shear_stress_2, rtol=1e-4)


def test_an_effect_changes_the_boundary_friction():
    keys = ["contact.boundary_friction=0.1", "motion={entrainment_speed=1.0,slide_roll_ratio=0.5}"]
    plain = started("dry_hertz.toml", [], *keys)
    found = started("dry_hertz.toml", [Additive(SimpleNamespace())], *keys)
    np.testing.assert_allclose(found.shear_stress_2, 2.0 * plain.shear_stress_2)
