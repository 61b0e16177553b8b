"""Areal surfaces in motion: heights at nodes, direction, ridges, rows of ranks, strips."""

import numpy as np
import pytest
from support import CASES

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.case import loading as case
from ehlpetsc.case.checking import values_of
from ehlpetsc.case.tables.surface import PROFILE
from ehlpetsc.physics.scales import Scales
from ehlpetsc.surfaces.motion.roughness import Passage, Roughness, RoughSurface
from ehlpetsc.surfaces.samples import areal_samples
from ehlpetsc.surfaces.synthetic import white_noise
from ehlpetsc.surfaces.topography import ContinuedSpline, Topography, cell_faces

A = 100e-6  # half-width, m
WIDTH = 3.0 * A
X_NODES, DX = np.linspace(-2.0 * A, 2.0 * A, 81, retstep=True)
DY = WIDTH / 48
Y_NODES = (np.arange(48) - 23.5) * DY
AT_REST = Passage(0.0, False, X_NODES[0], X_NODES[-1], 0.1 * A, 0.0)
FORWARD = Passage(2.0, True, X_NODES[0], X_NODES[-1], 0.1 * A, 10 * A)
BACKWARD = FORWARD._replace(speed=-2.0)
ENTERED = 40 * A  # far beyond the ramp


def made(is_strip=False, scale=1.0, direction=None, width=WIDTH, **synthetic):
    keys = {"synthetic": synthetic, "scale": scale} | ({"direction": direction} if direction else {})
    return areal_samples(None, values_of(PROFILE, keys), width, is_strip)


def random_map(shape=(41, 61), step=5e-6, **options):
    z = np.random.default_rng(4).standard_normal(shape) * 1e-7
    return Topography(step * np.arange(shape[1]), step * np.arange(shape[0]), z, **options)


def gap(topography, passage=AT_REST, travelled=0.0, y=Y_NODES):
    surface = RoughSurface(topography, passage, cell_faces(y, DY))
    return Roughness(surface, None).phi_after(X_NODES, (travelled, 0.0), DX).reshape(len(y), -1)


def wave_heights(k, centres, cell):
    """Means over cells less a 24th of their second difference."""
    kept = np.sinc(k * cell / (2 * np.pi)) * (1.0 + np.sin(k * cell / 2) ** 2 / 6)
    return np.cos(k * centres) * kept


@pytest.mark.parametrize(("passage", "sign"), [(FORWARD, 1.0), (BACKWARD, -1.0)])
def test_nodes_have_the_heights_of_a_wave(passage, sign):
    wave = made(kind="sine", amplitude=1e-7, wavelength=30e-6, wavelength_across=75e-6)
    for travelled in (ENTERED, ENTERED + 0.37 * DX, 1e4 * A):
        begin = X_NODES[0] if sign > 0 else X_NODES[-1]
        along = wave_heights(2 * np.pi / 30e-6, X_NODES - sign * travelled - begin, DX)
        expected = -1e-7 * np.multiply.outer(wave_heights(2 * np.pi / 75e-6, Y_NODES, DY), along)
        np.testing.assert_allclose(gap(wave, passage, sign * travelled), expected, atol=1e-12)


def test_a_period_has_the_mean_height_and_a_strip_the_middle_of_the_map():
    surface = random_map(along="periodic", across="periodic")
    z = surface.z.copy()
    z[-1], z[:, -1] = z[0], 0.0
    z[:, -1] = z[:, 0]
    rows = ContinuedSpline(surface.Y, z, "periodic").means(np.linspace(-1e-4, 1e-4, 8))
    means = ContinuedSpline(surface.X, rows.T, "periodic").means(np.linspace(0.4e-4, 3.4e-4, 6))
    assert means.shape == (5, 7)
    assert means.mean() == pytest.approx(z[:-1, :-1].mean(), rel=1e-9)
    measured = random_map((81, 21), middle=200e-6)
    strip = measured.periodic_over(400e-6)
    np.testing.assert_allclose(strip.Y[[0, -1]], (100e-6, 300e-6))
    np.testing.assert_allclose(strip.z, measured.z[20:61], rtol=0, atol=1e-20)


def test_a_profile_is_a_ridge_as_in_a_line_contact():
    loaded = case.load(CASES / "table1_rough.toml")
    scales = Scales.of(loaded)
    line = Roughness.of(loaded, scales)
    strip = case.load(CASES / "table1_rough.toml", ["mesh.width=0.2"])
    areal = Roughness.of(strip, Scales.of(strip))
    assert areal.rq == pytest.approx(line.rq, rel=1e-12)
    x = scales.x * scales.a
    for time in (0.0, 1e-4, 3e-4):
        travelled = scales.u1 * time, scales.u2 * time
        rows = areal.phi_after(x, travelled, scales.spacing).reshape(-1, len(x))
        alone = line.phi_after(x, travelled, scales.spacing)
        np.testing.assert_allclose(rows, np.broadcast_to(alone, rows.shape), rtol=0, atol=1e-21)


def test_ranks_with_some_rows_have_the_same_heights_and_surfaces_enter_from_both_ends():
    whole = gap(random_map(), FORWARD, ENTERED)
    parts = [gap(random_map(), FORWARD, ENTERED, Y_NODES[own]) for own in (slice(0, 17), slice(17, 48))]
    np.testing.assert_allclose(np.concatenate(parts), whole, rtol=0, atol=1e-20)
    forward, backward = (gap(random_map(), p, d) for p, d in ((FORWARD, 7 * A), (BACKWARD, -7 * A)))
    np.testing.assert_allclose(backward, forward[::-1, ::-1], rtol=0, atol=1e-19)
    heights = gap(random_map(), FORWARD, 2.0 * A)  # has entered half of the domain
    assert not heights[:, X_NODES > DX].any()
    assert np.abs(heights[:, X_NODES < -0.2 * A]).max() > 1e-7


@pytest.fixture(scope="module")
def lay():
    return made(kind="ground", ra=1e-7, correlation=60e-6, correlation_across=15e-6, seed=3, direction=30.0)


@pytest.mark.parametrize("passage", [FORWARD, BACKWARD, AT_REST])
def test_the_lay_has_the_same_direction_in_any_motion(lay, passage):
    z = gap(lay, passage, np.sign(passage.speed) * ENTERED)
    along_y, along_x = np.gradient(z, DY, DX)
    tensor = np.array([[np.mean(along_x**2), np.mean(along_x * along_y)], [0.0, np.mean(along_y**2)]])
    # the lay is where the gradient is least
    lay_angle = 0.5 * np.degrees(np.arctan2(2 * tensor[0, 1], tensor[0, 0] - tensor[1, 1])) + 90.0
    assert lay_angle % 180.0 == pytest.approx(30.0, abs=6.0)


@pytest.mark.parametrize("passage", [FORWARD, BACKWARD])
def test_the_middle_of_a_map_runs_along_the_middle_of_the_contact(passage):
    z = np.zeros((41, 61))
    z[13] = 1e-7  # a ridge along x
    surface = Topography(5e-6 * np.arange(61), 5e-6 * np.arange(41), z, across="zero", middle=13 * 5e-6)
    across = -gap(surface, passage, np.sign(passage.speed) * ENTERED)[:, 40]
    assert across.sum() * DY == pytest.approx(1e-7 * 5e-6, rel=0.05)
    assert across @ Y_NODES / across.sum() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("part", [0.3, 0.9, 1.0, 2.0, 3.7])
def test_a_map_is_cut_to_the_period_of_a_strip_without_a_seam(part):
    measured = random_map((81, 21), middle=150e-6)
    width = part * 400e-6
    strip = measured.periodic_over(width)
    extent = strip.Y[-1] - strip.Y[0]
    images = width / (2 * extent)
    assert images == pytest.approx(round(images), abs=1e-9) and extent <= 400e-6 * (1 + 1e-9)
    faces = strip.middle + np.linspace(-0.5, 1.5, 129) * width
    rows = strip.row_means(faces)
    np.testing.assert_allclose(rows[:, :64], rows[:, 64:], rtol=0, atol=1e-19)
    fine = ContinuedSpline(strip.Y, strip.z[:, 3], "mirrored")
    jump = fine(np.array([-0.5, 0.5]) * width + strip.middle + 1e-10)
    assert jump[0] == pytest.approx(jump[1], abs=1e-15)


def test_waves_that_do_not_fit_are_refused_and_those_not_resolved_counted():
    wave = {"kind": "sine", "amplitude": 1e-7, "wavelength": 30e-6}
    with pytest.raises(ProfileError, match=r"^wavelength_across = 8e-05 m; .* 0\.0003 m, .* 7\.5e-05 m$"):
        made(True, **wave, wavelength_across=80e-6)
    fitting = made(True, **wave, wavelength_across=75e-6)
    faces = np.linspace(0.0, 2.0, 33) * WIDTH
    rows = fitting.row_means(faces)
    np.testing.assert_allclose(rows[:, :16], rows[:, 16:], atol=1e-19)
    wave = made(kind="sine", amplitude=1e-7, wavelength=30e-6, wavelength_across=75e-6)
    assert wave.unresolved_variance(7e-6, 18e-6) < 1e-3
    assert wave.unresolved_variance(8e-6, 18e-6) > 0.999
    assert wave.unresolved_variance(7e-6, 19e-6) > 0.999
    ridge = made(kind="sine", amplitude=1e-7, wavelength=30e-6)
    assert ridge.unresolved_variance(7e-6, 1.0) < 1e-3 < 0.999 < ridge.unresolved_variance(8e-6, 1.0)
    with pytest.raises(ProfileError, match="^direction = 30: .*ground.*self-affine"):
        made(kind="sine", amplitude=1e-7, wavelength=30e-6, direction=30.0)
    with pytest.raises(ProfileError, match="^[0-9]+ x [0-9]+ points; allowed: at most 4000000 "):
        made(kind="self-affine", sq=2e-7, hurst=0.8, roll_off=1e-3, short_cutoff=1e-6, seed=1)


def test_ridges_are_endless_and_dents_round_and_periodic_in_a_strip():
    ridge = {"kind": "ridge", "amplitude": 1e-6, "wavelength": 50e-6, "position": 200e-6}
    assert np.ptp(gap(made(**ridge)), axis=0).max() == 0.0
    short = -gap(made(**ridge, wavelength_across=120e-6))[:, 40]
    expected = np.exp(-((2 * Y_NODES / 120e-6) ** 2))
    np.testing.assert_allclose(short / short.max(), expected / expected.max(), atol=2e-3)
    dent = {"kind": "dent", "amplitude": 1e-6, "wavelength": 100e-6, "position": 200e-6}
    heights = -gap(made(**dent))
    x, y = X_NODES - X_NODES[0] - 200e-6, Y_NODES
    inner = np.abs(np.add.outer(y**2, x**2) - (20e-6) ** 2) < (8e-6) ** 2  # of a ring
    assert -1e-6 < heights.min() < -0.95e-6 and np.ptp(heights[inner]) < 0.06e-6
    in_strip = made(True, **dent)
    rows = in_strip.row_means(np.linspace(-0.5, 1.5, 33) * WIDTH)
    np.testing.assert_allclose(rows[:, :16], rows[:, 16:], atol=1e-19)
    between = np.exp(-((2 * 0.5 * WIDTH / 100e-6) ** 2))  # of two dents
    np.testing.assert_allclose(in_strip.z[0].min(), -2e-6 * between, rtol=1e-6)


def test_self_affine_and_ground_surfaces_have_their_heights_stretch_and_period():
    keys = {"kind": "self-affine", "sq": 2e-7, "hurst": 0.8, "roll_off": 40e-6, "short_cutoff": 10e-6}
    isotropic = made(**keys, seed=1).parameters
    assert isotropic["Sq"] == pytest.approx(2e-7, rel=1e-12) and isotropic["Str"] > 0.8
    stretched = made(**keys, seed=1, peklenik=4.0).parameters
    assert stretched["Str"] == pytest.approx(0.25, abs=0.06)
    assert made(**keys, seed=1, scale=-2.0).sq == pytest.approx(4e-7, rel=1e-12)
    surface = made(is_strip=True, **keys, seed=1)
    assert surface.sq == pytest.approx(2e-7, rel=1e-12)
    assert surface.Y[-1] - surface.Y[0] == pytest.approx(WIDTH, rel=1e-12)
    assert surface.across == surface.along == "periodic"
    keys = {"kind": "ground", "ra": 1e-7, "correlation": 10e-6, "correlation_across": 30e-6, "seed": 2}
    surface = made(**keys, skewness=-1.0)
    assert surface.parameters["Sa"] == pytest.approx(1e-7, rel=1e-9)
    assert surface.parameters["Ssk"] == pytest.approx(-1.0, abs=1e-6)
    normal = made(**keys).parameters
    # exp(-(lag/l)^2) falls to 0.2 at l sqrt(ln 5)
    assert normal["Sal"] == pytest.approx(10e-6 * np.sqrt(np.log(5.0)), rel=0.08)
    assert normal["Str"] == pytest.approx(1.0 / 3.0, abs=0.06)


AFFINE = {"kind": "self-affine", "sq": 2e-7, "hurst": 0.8, "roll_off": 40e-6, "short_cutoff": 10e-6}
GROUND = {"kind": "ground", "ra": 1e-7, "correlation": 30e-6, "correlation_across": 10e-6, "skewness": -1.0}
RANDOM = [AFFINE, AFFINE | {"peklenik": 0.5, "direction": 30.0}, GROUND]


def heights_around_the_middle(surface, half=0.25 * WIDTH):
    rows = surface.row_means(np.linspace(-half, half, 65)).T
    return ContinuedSpline(surface.X, rows.T, surface.along)(np.arange(0.0, 8 * A, 2e-6))


@pytest.mark.parametrize("keys", RANDOM)
def test_a_random_surface_of_a_point_is_one_at_any_width(keys):
    narrow, wide = (made(**keys, seed=1, width=factor * WIDTH) for factor in (1.0, 1.7))
    np.testing.assert_array_equal(narrow.z, wide.z)
    assert np.abs(narrow.z - made(**keys, seed=2).z).max() > narrow.sq


@pytest.mark.parametrize("keys", RANDOM)
def test_strips_of_two_widths_have_one_surface_around_their_middle(keys):
    strip = heights_around_the_middle(made(True, **keys, seed=1))
    for factor, least in ((1.0 + 1e-6, 0.999999), (1.06, 0.98), (1.7, 0.98)):
        other = heights_around_the_middle(made(True, **keys, seed=1, width=factor * WIDTH))
        assert np.corrcoef(strip.ravel(), other.ravel())[0, 1] > least
    point = heights_around_the_middle(made(**keys, seed=1))
    assert np.corrcoef(strip.ravel(), point.ravel())[0, 1] > 0.98


@pytest.mark.parametrize("keys", RANDOM)
def test_the_last_digits_of_a_length_do_not_change_a_random_surface(keys):
    surface = made(True, **keys, seed=1)
    lengths = {"roll_off", "short_cutoff", "correlation", "correlation_across"} & set(keys)
    for changes in ({name: keys[name] * (1 + 4e-16)} for name in lengths):
        other = made(True, **keys | changes, seed=1, width=WIDTH * (1 + 4e-16))
        assert other.z.shape == surface.z.shape
        np.testing.assert_allclose(other.z, surface.z, rtol=0, atol=1e-9 * surface.sq)


def test_a_longer_period_of_a_surface_extends_a_shorter_one():
    noise = [np.fft.irfft2(white_noise(shape, 7), shape) for shape in ((20, 30), (31, 44))]
    rows = np.arange(-10, 10)  # around y = 0
    np.testing.assert_allclose(noise[0][rows], noise[1][rows, :30], atol=1e-13)
    part = white_noise((20, 30), 7, 19.0)  # of a period of 19 rows
    np.testing.assert_allclose(
        np.fft.irfft(part[0], 30), noise[1][np.arange(-9, 10), :30].sum(axis=0), atol=1e-12
    )
    np.testing.assert_allclose(white_noise((20, 30), 7, 19.0 + 1e-9), part, atol=1e-3)


@pytest.mark.parametrize(
    "keys",
    [
        "surface.1={synthetic={kind='sine', amplitude=1e-7, wavelength=1e-4, wavelength_across=1e-4}}",
        "surface.1={synthetic={kind='ground', ra=1e-7, correlation=1e-5, seed=1, correlation_across=1e-4}}",
        "surface.1.direction=90",
        "surface.1={z=[[0, 1, 0, 1], [1, 0, 1, 0], [0, 1, 0, 1], [1, 0, 1, 1]], spacing=1e-6}",
    ],
)
def test_keys_of_maps_are_refused_in_a_line_contact(keys):
    with pytest.raises(case.CaseError, match=r"surface\.1\.\S*(_across|direction|z): of strip, point, "):
        case.load(CASES / "table1_rough.toml", [keys])
