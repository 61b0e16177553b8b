"""Roughness parameters of areal surfaces, and the command that prints and draws them."""

import numpy as np
import pytest

from ehlpetsc.commands.surface import main
from ehlpetsc.surfaces.parameters import (
    areal_parameters,
    autocorrelation,
    correlation_lengths,
    peaks,
    profile_parameters,
)

AMPLITUDE, WAVE = 1e-7, 40e-6
STEP = WAVE / 32
X = STEP * np.arange(1024)


def waves(across=WAVE):
    return AMPLITUDE * np.cos(2 * np.pi * X / WAVE) * np.cos(2 * np.pi * X / across)[:, np.newaxis]


@pytest.fixture(scope="module")
def found():
    """Parameters of a product of cosines."""
    return areal_parameters(waves(), STEP, STEP)


def test_heights_and_texture_of_a_product_of_cosines_on_any_spacings(found):
    assert found["Sa"] == pytest.approx(AMPLITUDE * (2 / np.pi) ** 2, rel=1e-2)
    assert found["Sq"] == pytest.approx(AMPLITUDE / 2, rel=1e-12)
    assert found["Ssk"] == pytest.approx(0.0, abs=1e-12)
    assert found["Sku"] == pytest.approx(9 / 4, rel=1e-12)
    assert found["Sdr"] == pytest.approx(found["Sdq"] ** 2 / 2, rel=1e-2)
    # the autocorrelation is cos(k tx) cos(k ty): 0.2 along x, and along the diagonal
    k = 2 * np.pi / WAVE
    assert found["Sal"] == pytest.approx(np.arccos(0.2) / k, rel=5e-3)
    assert found["Str"] == pytest.approx(np.arccos(0.2) / np.sqrt(2) / np.arccos(np.sqrt(0.2)), rel=1e-2)
    every_other = areal_parameters(waves()[::2], STEP, 2 * STEP)
    for name in ("Sa", "Sq", "Ssk", "Sku", "Sdq", "Sal", "Str"):
        assert every_other[name] == pytest.approx(found[name], rel=1e-2, abs=1e-12)


def test_gradient_of_a_product_of_cosines_and_of_few_rows():
    found = areal_parameters(waves(2 * WAVE)[:256], STEP, STEP)
    assert found["Sdq"] == pytest.approx(AMPLITUDE * np.pi / WAVE * np.hypot(1.0, 0.5), rel=6e-3)
    z = 1e-3 * X[:40] + 2e-3 * STEP * np.arange(4)[:, np.newaxis]
    assert areal_parameters(z, STEP, STEP)["Sdq"] == pytest.approx(np.hypot(1e-3, 2e-3), rel=1e-9)


@pytest.mark.parametrize("points", [8, 6])
def test_gradient_of_few_points_a_wave(points):
    x = WAVE / points * np.arange(30 * points)
    z = np.broadcast_to(AMPLITUDE * np.sin(2 * np.pi * x / WAVE), (24, len(x)))
    exact = np.sqrt(2) * np.pi * AMPLITUDE / WAVE
    assert areal_parameters(z, x[1], STEP)["Sdq"] == pytest.approx(exact, rel=1e-2)
    assert areal_parameters(z.T, STEP, x[1])["Sdq"] == pytest.approx(exact, rel=1e-2)


def test_volumes_extremes_and_ten_point_height():
    z = 3e-6 * np.random.default_rng(1).permutation(np.linspace(0.0, 1.0, 10_000)).reshape(100, 100)
    found = areal_parameters(z, STEP, STEP)
    assert found["Sz"] == pytest.approx(3e-6, rel=1e-12)
    assert (found["Vmp"], found["Vvv"]) == pytest.approx((3e-6 * 0.1**2 / 2, 3e-6 * 0.2**2 / 2), rel=3e-3)
    y, x = np.mgrid[:120, :160]
    z = 1e-3 * np.cos(x) * np.cos(y)
    centres = [(20, 20), (20, 80), (20, 140), (60, 20), (100, 80), (100, 140), (60, 80), (60, 140), (100, 20)]
    heights = [10.0, 9.0, 8.0, 7.0, 6.0, 5.0, -10.0, -8.0, -3.0]
    for (row, column), height in zip(centres, heights, strict=True):
        z += height * np.exp(-((y - row) ** 2 + (x - column) ** 2) / 40.0)
    z[20, 26] = z[20, 25] + 0.3  # a summit, no hill of its own
    found = areal_parameters(z, 1.0, 1.0)
    assert found["S10z"] == pytest.approx((10 + 9 + 8 + 7 + 6) / 5 + (10 + 8 + 3) / 3, rel=2e-3)
    assert len(peaks(z, 1.0)) == 6 and len(peaks(z, 0.1)) == 7


@pytest.mark.parametrize("shape", [(40, 50), (4, 50), (40, 5), (7, 7)])
def test_developed_area_of_a_plane(shape):
    z = 0.3 * STEP * np.arange(shape[1]) + 0.4 * STEP * np.arange(shape[0])[:, np.newaxis]
    assert areal_parameters(z, STEP, STEP)["Sdr"] == pytest.approx(np.sqrt(1.25) - 1.0, rel=1e-12)


def test_curvature_of_a_paraboloid_a_cylinder_and_a_wave():
    x, y = STEP * np.arange(50), 2 * STEP * np.arange(40)[:, np.newaxis]
    found = areal_parameters(150.0 * x**2 + 50.0 * y**2, STEP, 2 * STEP)["curv"]
    assert found == pytest.approx((300.0 + 100.0) / 2, rel=1e-6)
    assert areal_parameters(150.0 * x**2 + 0.0 * y, STEP, 2 * STEP)["curv"] == pytest.approx(150.0, rel=1e-6)
    wave = 1e-7 * np.cos(2 * np.pi * np.arange(800) / 80.0)
    k = 2 * np.pi / (80.0 * STEP)
    assert profile_parameters(wave, STEP)["curv"] == pytest.approx(1e-7 * k**2 / np.sqrt(2.0), rel=2e-3)


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0, 135.0, 172.0])
@pytest.mark.parametrize("stretch", [1.0, 2.0])
def test_texture_direction_is_that_of_the_lay(angle, stretch):
    normal, y = np.radians(angle + 90.0), stretch * STEP * np.arange(200)[:, np.newaxis]
    z = np.cos(2 * np.pi / (8 * STEP) * (np.cos(normal) * X[:300] + np.sin(normal) * y))
    found = areal_parameters(z, STEP, stretch * STEP)["Std"]
    assert abs((found - angle + 90.0) % 180.0 - 90.0) <= 1.0


def test_autocorrelation_and_textures_longer_than_half_the_map():
    ridges = np.broadcast_to(np.cos(2 * np.pi * X / WAVE), (64, len(X)))
    found = areal_parameters(ridges, STEP, STEP)
    assert found["Sal"] == pytest.approx(np.arccos(0.2) * WAVE / (2 * np.pi), rel=5e-3)
    assert np.isnan(found["Str"])
    assert np.isnan(correlation_lengths(np.ones((8, 8)) + 1e-3 * np.eye(8), STEP, STEP)).all()
    z = np.random.default_rng(1).standard_normal((7, 9))
    z -= z.mean()
    found = autocorrelation(z)
    assert found.shape == (7, 9) and found[3, 4] == pytest.approx(1.0)
    pairs = np.mean(z[2:, :-3] * z[:-2, 3:])
    assert found[3 + 2, 4 - 3] == pytest.approx(pairs / np.mean(z**2))


@pytest.mark.parametrize("height", [0.0, 1.234567e-7, 3.3e-3, -7.7])
def test_rounding_errors_of_equal_heights_have_no_shape(height):
    of_map = areal_parameters(np.full((40, 50), height), STEP, STEP)
    of_profile = profile_parameters(np.full(60, height), STEP)
    assert of_map["Sq"] == of_profile["Rq"] == 0.0
    assert np.isnan([of_map[name] for name in ("Ssk", "Sku", "Sal", "Str")]).all()
    assert np.isnan([of_profile["Rsk"], of_profile["Rku"]]).all()


SMOOTH = {
    "equal": (np.full((40, 60), 1.234567e-7), []),
    "plane": (1e-7 + 1e-3 * X[:60] + 2e-9 * np.arange(40)[:, np.newaxis], ["--no-picture"]),
    "paraboloid": (
        30 * X[:60] ** 2 + 4e-9 * np.arange(40)[:, None] ** 2,
        ["--set", "form=2", "--no-picture"],
    ),
}


@pytest.mark.parametrize(("z", "words"), SMOOTH.values(), ids=SMOOTH)
@pytest.mark.filterwarnings("error")
def test_the_command_gives_the_reason_for_parameters_of_a_smooth_map(tmp_path, capsys, z, words):
    np.save(tmp_path / "map.npy", z)
    assert main([str(tmp_path / "map.npy"), "--set", f"spacing={STEP!r}", *words]) == 0
    _, note, *shown = capsys.readouterr().out.splitlines()[:19]
    assert note == "all heights are equal, or on the form subtracted: smooth"
    values = {line.split()[0]: line.split()[1] for line in shown}
    assert [name for name, value in values.items() if value == "nan"] == ["Ssk", "Sku", "Sal", "Str", "Std"]
    assert all(("; none: no height differs" in line) == ("nan" in line) for line in shown)
    assert values["Sk"] == values["Sq"] == "0.0000"


def test_the_command_prints_draws_and_explains_a_map_and_writes_its_spectra(tmp_path, capsys):
    path = tmp_path / "map.npy"
    np.save(path, waves()[:128, :256] + 1e-3 * X[:256])
    assert main([str(path), "--set", f"spacing={STEP!r}"]) == 0
    shown = (out := capsys.readouterr().out).splitlines()
    assert shown[0] == f"{path}: 0.3188 x 0.1588 mm, 256 x 128 points 1.25 um and 1.25 um apart"
    values = {line.split()[0]: float(line.split()[1]) for line in shown[1:-1]}
    assert values["Sq"] == pytest.approx(1e6 * AMPLITUDE / 2, rel=0.01)  # without the plane
    assert values["Sku"] == pytest.approx(9 / 4, rel=0.02) and 0.7 < values["Str"] < 1.0
    assert shown[-1] == str(picture := tmp_path / "map.surface.png") and picture.stat().st_size > 1e4
    assert (
        "Std        nan °   direction of the lay against the rows, towards Y; none: no lay, as Str is " in out
    )
    np.save(tmp_path / "map.npy", np.broadcast_to(np.cos(2 * np.pi * X / WAVE), (64, len(X))))
    assert main([str(tmp_path / "map.npy"), "--set", f"spacing={STEP!r}", "--no-picture"]) == 0
    *_, shown, direction = capsys.readouterr().out.splitlines()
    assert direction.split()[:2] == ["Std", "90.0000"]
    assert shown.startswith("Str        nan ") and shown.endswith(
        "; none: the autocorrelation stays above 0.2 up to half the map in some direction"
    )
    np.save(tmp_path / "map.npy", waves()[:256])
    words = [tmp_path / "map.npy", "--set", f"spacing={STEP!r}", "--no-picture", "--csv", tmp_path / "a.csv"]
    assert main([str(word) for word in words]) == 0
    heading, *lines = (tmp_path / "a.csv").read_text().splitlines()
    assert heading.endswith("power spectral density [m^3],direction")
    for direction in ("along", "across"):
        cells = [line.split(",") for line in lines if line.endswith(direction)]
        q, density = np.array([cell[1:3] for cell in cells], dtype=float).T
        assert np.sum(density) * q[0] / np.pi == pytest.approx(np.var(waves()[:256]), rel=0.02)
