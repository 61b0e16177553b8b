"""Pictures of heat: traction curves, temperatures, Stribeck curves with and without it."""

import contextlib
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from support.made_results import change_case, make_result

from ehlpetsc.pictures.command import FIGURES
from ehlpetsc.pictures.friction_curves import curves_by_contact
from ehlpetsc.results.index import open_all

HEAT = {"heat.bulk_temperature": 350.0}
RATIOS = (0.1, 0.5, 1.0, 2.0)
OPTIONS = SimpleNamespace(step=None, time=None, around=None, width=None)
RISES = {"film_temperature": 40.0, "temperature_1": 10.0, "temperature_2": 20.0}


def drawn(kind, paths):
    with contextlib.ExitStack() as stack:
        return FIGURES[kind][0](open_all(paths, stack), OPTIONS)


def member(path, ratio, friction, heat=(), speed=5.0):
    make_result(path, steps=1, speed=speed)
    change_case(path, {"motion.slide_roll_ratio": ratio, **dict(heat)})
    with h5py.File(path, "r+", libver="latest") as file:
        file["steps/friction_coefficient"][:] = friction
    return path


@pytest.fixture
def series(tmp_path):
    """Friction that rises without heat and has its largest value at 1.0 with it, at two speeds."""
    paths = []
    for speed in (5.0, 25.0):
        for k, ratio in enumerate(RATIOS):
            names = (tmp_path / f"{kind}_{speed:g}_{ratio}.h5" for kind in ("cold", "warm"))
            paths += [member(next(names), ratio, 0.01 * ratio, speed=speed)]
            paths += [member(next(names), ratio, (0.004, 0.008, 0.009, 0.006)[k], HEAT, speed)]
    return paths


def test_traction_curves(series):
    [axes] = drawn("traction", series).axes
    lines = {line.get_label(): line for line in axes.get_lines() if not line.get_label().startswith("_")}
    kinds = "isothermal", "with heat"
    assert set(lines) == {f"entrainment speed = {u}, {how}" for u in (5, 25) for how in kinds}
    cold, warm = (lines[f"entrainment speed = 5, {how}"] for how in kinds)
    np.testing.assert_allclose(warm.get_xdata(), RATIOS)
    np.testing.assert_allclose(cold.get_ydata(), 0.01 * np.array(RATIOS))
    assert [text.get_text() for text in axes.texts] == 2 * ["0.0090 at 1"]  # none at the end of a curve
    assert cold.get_linestyle() == "--"


def heated(path, steps):
    change_case(make_result(path, steps=steps), HEAT)
    with h5py.File(path, "r+", libver="latest") as file:
        shape, dome = file["pressure"].shape, np.maximum(1.0 - (file["x"][:] / file.attrs["a"]) ** 2, 0.0)
        for name, rise in RISES.items():
            values = np.broadcast_to(350.0 + rise * dome, shape)
            file.create_dataset(name, data=values, maxshape=(None, shape[1]), chunks=(1, shape[1]))
            file["steps"].create_dataset(f"{name}_mean", data=np.full(steps, rise), maxshape=(None,))
    return path


@pytest.mark.parametrize("steps, panels", [(1, 3), (21, 5)])
def test_temperatures(steps, panels, tmp_path):
    figure = drawn("temperatures", [heated(tmp_path / "a.h5", steps)])
    assert len(figure.axes) == panels  # the map and its colours only over time
    highest = [line.get_ydata().max() for line in figure.axes[2].get_lines()]
    np.testing.assert_allclose(highest, 350.0 + np.array(list(RISES.values())), rtol=1e-3)
    if steps > 1:
        assert figure.axes[-1].get_ylabel() == "temperature of\nsurface 2 [K]"


def test_stribeck_curves_with_and_without_heat(tmp_path):
    paths = [member(tmp_path / f"{k}.h5", 0.25, 0.01, HEAT if k % 2 else "") for k in range(4)]
    with contextlib.ExitStack() as stack:
        found = {label: len(members) for label, members in curves_by_contact(open_all(paths, stack)).items()}
    assert found == {"direct contact, isothermal": 2, "direct contact, with heat": 2}
