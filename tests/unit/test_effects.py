"""An effect with a scalar of state and a key is one file and one line; effects on oil and friction."""

import re
import shutil
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES
from support.driving import Scene
from support.running import PYTHON, SCRIPT, called

from ehlpetsc.effects.effect import Effect

PAGE = CASES / "own_laws.md"


def call(folder, *words, **names):
    """Output of Python in a folder with the code of the page."""
    codes = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    for name, text in zip(("my_laws", "my_effects", "script"), codes, strict=True):
        law = '"fluid.law": "saturating",'
        (folder / f"{name}.py").write_text(text.replace(law, "") if name == "script" else text)
    shutil.copy(CASES / "table1_smooth.toml", folder)
    done = called([PYTHON, *words], folder, SCRIPT | names | {"XDG_CACHE_HOME": str(folder)})
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_effect_of_the_page_works_as_it_is(tmp_path):
    """The supply falls by the loss of the key, the film with it."""
    of_user = {"EHLPETSC_EFFECTS": "my_effects"}
    printed = call(tmp_path, "script.py", **of_user).rpartition("supply ")[2]
    supply, film = map(float, re.findall(r"\d\.\d+", printed))
    assert supply == pytest.approx(0.7**2, rel=0.05)  # the faster surface travels 1.125 as far
    assert film < 0.995
    assert "starving.loss: in a half-width" in call(tmp_path, "-m", "ehlpetsc", "keys", "loss", **of_user)
    assert "starved.h5" in call(tmp_path, "-m", "ehlpetsc", "summary", "starved.h5", **of_user)


@pytest.mark.slow
def test_law_of_the_page_works_as_it_is(tmp_path):
    """A law that saturates far above p0 is that of Barus; of the loops the law alone is compiled."""
    code = "from ehlpetsc.physics import laws; kind = list(laws.LAWS).index('saturating')\n"
    code += "print(*laws.ln_viscosity((kind, laws.padded((1.5e-8, 2e9))), 1e9, 300.0))"
    found = call(tmp_path, "-c", code, EHLPETSC_LAWS="my_laws").split()
    assert list(map(float, found)) == pytest.approx([10.0, 1.5e-8 / 1.5**2, 0.0])
    coarse = ["mesh.points_per_half_width=20", "mesh.inlet=-2.0"]
    words = ["-m", "ehlpetsc", "table1_smooth.toml"]
    films = []
    for law in ("barus", "saturating"):
        keys = [*coarse, f"fluid.law={law}"] + ["fluid.saturation_pressure=1e12"] * (law == "saturating")
        sets = [word for key in keys for word in ("--set", key)]
        uncompiled = {"EHLPETSC_LAWS": "my_laws", "NUMBA_DISABLE_JIT": "1"}
        printed = call(tmp_path, *words, "-o", f"{law}.h5", *sets, **uncompiled)
        films.append(float(re.search(r"h_min=(\S+)", printed)[1]))
    assert films[1] == pytest.approx(films[0], rel=0.01) and films[1] != films[0]


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
