"""Pictures of several results and of heat: every kind in a file, Stribeck and traction curves, passes."""

import contextlib

import h5py
import numpy as np
import pytest
from matplotlib.image import imread
from support.made_results import change_case, make_result, with_solids

from ehlpetsc.base.errors import OutputError
from ehlpetsc.commands.plot import FIGURES, arguments, main
from ehlpetsc.pictures import series as drawing
from ehlpetsc.results.index import open_all
from ehlpetsc.results.reader import read_result

pytestmark = pytest.mark.usefixtures("coarse_pictures")
SPEEDS = (0.001, 0.02, 0.5, 5.0, 20.0)
OPTIONS = arguments().parse_args(["x"])
HEAT = {"heat.bulk_temperature": 350.0}
RATIOS = (0.1, 0.5, 1.0, 2.0)
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
    """Friction that rises without heat and has its maximum at 1.0 with it, at two speeds."""
    paths = []
    for speed in (5.0, 25.0):
        for ratio, warm in zip(RATIOS, (0.004, 0.008, 0.009, 0.006), strict=True):
            paths.append(member(tmp_path / f"cold_{speed:g}_{ratio}.h5", ratio, 0.01 * ratio, speed=speed))
            paths.append(member(tmp_path / f"warm_{speed:g}_{ratio}.h5", ratio, warm, HEAT, speed))
    return paths


def test_traction_curves(series):
    [axes] = drawn("traction", series).axes
    lines = {line.get_label(): line for line in axes.get_lines() if not line.get_label().startswith("_")}
    kinds = "no bulk temperature", "bulk temperature = 350"
    assert set(lines) == {f"{how},\nentrainment speed = {u}" for u in (5, 25) for how in kinds}
    cold, warm = (lines[f"{how},\nentrainment speed = 5"] for how in kinds)
    np.testing.assert_allclose(warm.get_xdata(), RATIOS)
    np.testing.assert_allclose(cold.get_ydata(), 0.01 * np.array(RATIOS))
    assert [text.get_text() for text in axes.texts] == 2 * ["0.0090 at 1"]  # none at the end of a curve


def test_published_correlations_beside_one_traction_curve(tmp_path):
    paths = [member(tmp_path / f"{ratio}.h5", ratio, 0.1 * ratio) for ratio in (0.1, 0.5)]
    lines = {line.get_label(): line for line in drawn("traction", paths).axes[0].get_lines()}
    low, high = lines["Xu & Kahraman 2007"].get_ydata()
    assert 0.0 < low < high  # grows with sliding at little heat
    low, high = lines["Benedict & Kelley 1961"].get_ydata()
    assert low - high == pytest.approx(0.0127 * np.log10(5.0))


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
    paths = [member(tmp_path / f"{k}.h5", 0.25, 0.01, HEAT if k % 2 else "", 1.0 + k) for k in range(5)]
    with contextlib.ExitStack() as stack:
        found = drawing.curves(open_all(paths, stack), drawing.SPEED)
    assert {name: list(speeds) for name, (speeds, _) in found.items()} == {
        "no bulk_temperature": [1.0, 3.0, 5.0],
        "bulk_temperature = 350": [2.0, 4.0],
    }


def yielded(path, depth):
    """A pass whose surface 2 is indented where it is high."""
    with h5py.File(with_solids(make_result(path, speed=50.0, rough=True)), "r+", libver="latest") as file:
        count, z = file["steps/time"].size, file["surface/2/z"][:]
        for name, last in (("set_volume", depth * 1e-4), ("contact_length", 1e-5), ("retries", 0.0)):
            if name not in file["steps"]:
                file["steps"].create_dataset(name, data=np.linspace(0.0, last, count), maxshape=(None,))
        file["surface/2/set"] = depth * (z > 0.0)
    return path


def test_running_in_shows_heights_and_plastic_area_of_all_passes(tmp_path):
    paths = [yielded(tmp_path / f"{k}.h5", 1e-8 * k) for k in (1, 2, 3)]
    heights, area, *_ = drawn("running_in", paths).axes
    before, first, last = (line.get_ydata() for line in heights.lines)
    assert np.max(before - first) == pytest.approx(0.01) and np.max(before - last) == pytest.approx(0.03)
    np.testing.assert_allclose(area.lines[0].get_xydata(), [[1, 1.0], [2, 2.0], [3, 3.0]])
    with pytest.raises(OutputError, match="one pass alone"):
        drawn("running_in", paths[:1])


@pytest.mark.parametrize("kind", [None, *FIGURES, "report"])
def test_every_kind_of_picture_is_written(tmp_path, kind):
    if kind == "running_in":
        paths = [yielded(tmp_path / f"{k}.h5", 1e-8 * k) for k in (1, 2)]
    elif kind == "traction":
        paths = [member(tmp_path / f"{ratio}.h5", ratio, 0.1 * ratio) for ratio in (0.1, 0.5)]
    elif kind == "stribeck":
        paths = [with_solids(make_result(tmp_path / f"{u}.h5", speed=u, rough=True)) for u in (40.0, 50.0)]
    else:
        paths = [heated(tmp_path / "a.h5", 21)]
    output = tmp_path / ("p.html" if kind == "report" else "p.png")
    words = [f"--{kind.replace('_', '-')}"] if kind else []
    assert main([*map(str, paths), *words, "-o", str(output)]) == 0
    assert kind == "report" or imread(output)[..., :3].std() > 0.02  # not blank


@pytest.fixture
def stribeck_series(tmp_path):
    """Share on the solids 1/(1 + u), friction between 0.12 of the solids and 0.03."""
    paths = []
    for speed in SPEEDS:
        share = 1.0 / (1.0 + 5.0 * speed)
        path = make_result(tmp_path / f"u{speed}.h5", speed=speed, nodes=41, steps=81)
        paths.append(with_solids(path, share, 0.03 + 0.09 * share))
    return paths


def test_stribeck_curve_has_means_and_scatter(stribeck_series):
    found = drawing.curves([read_result(path) for path in stribeck_series], drawing.SPEED)
    [(speeds, results)] = found.values()
    assert list(speeds) == list(SPEEDS)
    share = 1.0 / (1.0 + 5.0 * speeds)
    mean, low, high = drawing.time_statistics(results, "friction_coefficient")
    np.testing.assert_allclose(mean, 0.03 + 0.09 * share, rtol=0.02)
    # of a cosine of amplitude 0.2 5 and 95 % lie at 0.2 cos(0.05 pi)
    np.testing.assert_allclose(high / mean, 1 + 0.2 * np.cos(0.05 * np.pi), atol=0.02)
    np.testing.assert_allclose(low / mean, 1 - 0.2 * np.cos(0.05 * np.pi), atol=0.02)
    figure = drawn("stribeck", stribeck_series)
    for axes, name in zip(figure.axes, drawing.QUANTITIES, strict=True):
        means = drawing.time_statistics(results, name)[0]
        np.testing.assert_allclose(axes.lines[0].get_xydata(), np.column_stack([SPEEDS, means]))


@pytest.mark.parametrize("share", [0.0, 1e-3])
def test_stribeck_axes_are_hersey_number_and_logarithmic_fraction(tmp_path, share):
    paths = [make_result(tmp_path / f"u{u:g}.h5", speed=u, nodes=41, steps=81) for u in (1.0, 10.0)]
    for path in paths:
        change_case(with_solids(path, share, 0.05), {"contact.load": 5e5})
    figure = drawing.draw_stribeck([read_result(path) for path in paths], None)
    (above,) = figure.axes[0].child_axes
    figure.draw_without_rendering()
    ratio = np.array(above.get_xlim()) / figure.axes[0].get_xlim()
    assert "Hersey" in above.get_xlabel() and ratio == pytest.approx(0.005 / 5e5)  # viscosity over load
    assert figure.axes[1].get_yscale() == ("log" if share else "linear")


@pytest.mark.parametrize("share", [None, 0.0, 1e-3])
def test_every_entry_of_a_stribeck_legend_has_a_visible_line(tmp_path, share):
    """Also of smooth steady results, without solids, without a gap ratio, without scatter."""
    paths = [member(tmp_path / f"u{u:g}.h5", 0.25, 0.05, {"time": {}}, u) for u in (1.0, 10.0)]
    for path in paths if share is not None else ():
        with_solids(path, share, 0.05)
    figure = drawing.draw_stribeck([read_result(path) for path in paths], None)
    figure.draw_without_rendering()
    legends = filter(None, (axes.get_legend() for axes in figure.axes))
    entries = [text.get_text() for legend in legends for text in legend.get_texts()]
    assert "solids alone\n(boundary_friction)" in entries and "steady" in entries
    assert not {"smooth contact", "mean over time"} & set(entries) and "%" not in "".join(entries)
    for axes in figure.axes:
        low, high = axes.get_ylim()
        for line in axes.lines:
            assert low <= np.min(line.get_ydata()) <= np.max(line.get_ydata()) <= high, line.get_label()


def test_hersey_numbers_of_a_point_say_whose_load_per_length(tmp_path):
    paths = [make_result(tmp_path / f"u{u:g}.h5", speed=u, nodes=41, steps=1) for u in (1.0, 10.0)]
    for path in paths:
        change_case(path, {"contact.radius": [0.02, 0.02], "contact.load": 50.0, "time": {}})
    (above,) = drawn("stribeck", paths).axes[0].child_axes
    assert above.get_xlabel().endswith("over load per length in the middle of the dry contact")


def test_stribeck_means_start_when_the_contact_is_filled(tmp_path):
    """The slower surface, 0.88 u, from -2.5 a to a, and the ramp: 40 us are too short for 5 m/s."""
    speeds = (5.0, 40.0, 50.0)
    paths = [make_result(tmp_path / f"{u}.h5", speed=u, nodes=41, steps=41, rough=True) for u in speeds]
    results = [read_result(path) for path in paths]
    [(found, lasting)] = drawing.curves(results, drawing.SPEED).values()
    assert list(found) == [40.0, 50.0]
    assert np.isnan(drawing.time_statistics(lasting, "contact_share")).all()
    assert "ended too early: 5.0.h5" in drawn("stribeck", paths)._suptitle.get_text()
    with pytest.raises(OutputError, match=r"series over motion\.entrainment_speed"):
        drawing.curves(results[:2], drawing.SPEED)
