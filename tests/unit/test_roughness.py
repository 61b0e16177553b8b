"""Profiles: reading, filters, synthetic heights, motion through the contact, coarse meshes."""

from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES

from ehlpetsc.base.errors import CaseError, ProfileError
from ehlpetsc.case import loading as case
from ehlpetsc.case.checking import values_of
from ehlpetsc.case.tables.surface import PROFILE
from ehlpetsc.physics.scales import Scales
from ehlpetsc.surfaces.files.profiles import read_profile
from ehlpetsc.surfaces.filters import levelled, mean_line, without_form
from ehlpetsc.surfaces.motion.profile_checks import entry_times, mesh_warnings
from ehlpetsc.surfaces.motion.roughness import RAMP_LENGTH, Passage, Roughness, RoughSurface, directed_speeds
from ehlpetsc.surfaces.samples import samples
from ehlpetsc.surfaces.synthetic import self_affine
from ehlpetsc.surfaces.topography import Topography

ALICONA = CASES / "profiles" / "alicona_meander_profile.csv"
A = 1e-3  # half-width of the domains made here, m


def phi(rough, x, t, cell=None):
    """Contribution of both roughnesses to the gap at time t."""
    sides = rough.surface_1, rough.surface_2
    return rough.phi_after(x, [side.speed * t if side else 0.0 for side in sides], cell)


def profile(X, z, speed=1.0, moving=True, repeats=True, duration=1.0):
    passage = Passage(speed, moving, -2.5 * A, 1.5 * A, RAMP_LENGTH * A, abs(speed) * duration)
    return RoughSurface(Topography.profile(X, z, repeats), passage)


def rough(name, *overrides):
    c = case.load(CASES / name, overrides)
    scales = Scales.of(c)
    return Roughness.of(c, scales), scales


def test_measured_profiles_have_their_published_roughness():
    X, z, _ = read_profile(ALICONA)
    assert np.abs(z - z.mean()).mean() == pytest.approx(0.157e-6, abs=0.0005e-6)
    assert np.diff(X) == pytest.approx(0.5e-6)
    X, z, _ = read_profile(CASES / "profiles" / "hommel_stylus_profile.csv")
    assert X[-1] == pytest.approx(4.8e-3, rel=2e-4)
    assert np.abs(z - mean_line(X, z, 0.8e-3, "cutoff")).mean() == pytest.approx(0.018e-6, abs=0.0005e-6)


def test_rough_start_is_the_later_part_of_an_entering_profile():
    smooth, scales = rough("table1_rough.toml")
    filled, _ = rough("table1_rough.toml", "time.start='rough'")
    x = scales.x * scales.a
    ahead = x[-1] - x[0] + RAMP_LENGTH * scales.a
    for side, speed in (("1", scales.u1), ("2", scales.u2)):
        one, other = filled.side(side), smooth.side(side)
        assert one.entered(x).min() > 1.0 - 1e-12 and not other.entered(x).any()
        before = x - np.sign(speed) * ahead
        np.testing.assert_allclose(one.height(x), other.height(before), atol=1e-15)
        assert one.travelled == pytest.approx(other.travelled + ahead)


@pytest.mark.parametrize(("ratio", "left"), [(1.0, 0.5), (0.5, 1 - 2.0**-4), (4.0, 1 - 2.0 ** (-1 / 16))])
def test_the_gaussian_filter_has_the_transmission_of_iso_16610_21(ratio, left):
    # of the amplitude at wavelength ratio x cut-off, 1 - 2^-(1/ratio^2) passes the high-pass
    cutoff = 80e-6
    x = np.arange(40001) * 0.1e-6
    wave = np.cos(2 * np.pi * x / (ratio * cutoff))
    inner = slice(5000, -5000)
    kept = (wave - mean_line(x, wave, cutoff, "cutoff"))[inner]
    assert kept @ wave[inner] / (wave[inner] @ wave[inner]) == pytest.approx(left, abs=1e-4)


@pytest.mark.parametrize(("ratio", "left"), [(1.0, 0.5), (0.5, 2.0**-4), (4.0, 2.0 ** (-1 / 16))])
@pytest.mark.parametrize("cutoff", [8e-6, 0.4e-6])  # 80 and 4 spacings
def test_the_short_cutoff_has_the_transmission_of_iso_16610_21(cutoff, ratio, left):
    x = np.arange(2401) * 0.1e-6
    wave = np.cos(2 * np.pi * x / (ratio * cutoff))  # mirrored at both ends it goes on as a wave
    np.testing.assert_allclose(mean_line(x, wave, cutoff, "short_cutoff"), left * wave, atol=1e-12)


def test_invalid_filter_input_is_refused():
    x = np.array([0, 1, 3, 4, 5]) * 1e-6
    with pytest.raises(ProfileError, match="^cutoff: .*spaced"):
        mean_line(x, x, 2e-6, "cutoff")
    with pytest.raises(ProfileError, match="^cutoff = 5e-06 m; .* 4e-06 m"):
        mean_line(np.arange(5) * 1e-6, np.zeros(5), 5e-6, "cutoff")
    with pytest.raises(ProfileError, match=r"^short_cutoff = 1\.9e-06 m; .* 2e-06 m"):
        mean_line(np.arange(1, 6) * 1e-6, np.zeros(5), 1.9e-6, "short_cutoff")


def test_surface_keys_are_applied_in_order_and_ground_heights_depend_on_the_seed():
    base, _ = rough("table1_rough.toml")
    flipped, _ = rough("table1_rough.toml", "surface.1.flip=true")
    np.testing.assert_array_equal(flipped.surface_1.given.z, base.surface_1.given.z[:, ::-1])
    turned, _ = rough("table1_rough.toml", "surface.1.scale=-2")
    assert turned.surface_1.statistics["rsk"] == pytest.approx(-base.surface_1.statistics["rsk"])
    assert turned.surface_1.statistics["ra"] == pytest.approx(4 * base.surface_1.statistics["ra"])
    filtered, _ = rough("table1_rough.toml", "surface.1.cutoff=20e-6", "surface.1.level=true")
    assert filtered.surface_1.rq < 0.7 * base.surface_1.rq
    spec = "surface.2.synthetic={{kind='ground', ra=0.3e-6, correlation=25e-6, seed={}}}"
    first, again, other = (
        rough("table1_smooth.toml", spec.format(seed), travel)[0].surface_2.given.z[0]
        for seed, travel in ((1, "time.travel=2"), (1, "time.travel=9"), (2, "time.travel=2"))
    )
    np.testing.assert_array_equal(first, again)
    assert np.abs(np.corrcoef(first, other)[0, 1]) < 0.2


def test_heights_of_a_polynomial_a_ridge_and_a_ramp_at_nodes():
    # a clamped cubic spline is exact for a cubic level at both ends; beside x = 0 and l it is mirrored
    X = np.linspace(0.0, 1.0, 6) * A
    p = profile(X, 1e-7 * (3 * (X / A) ** 2 - 2 * (X / A) ** 3), moving=False)
    faces = np.arange(-0.2, 3.8, 0.11) * A
    integral = np.vectorize(_cubic_integral)(faces / A)
    means = 1e-7 * np.diff(integral) / np.diff(faces / A)
    expected = means[1:-1] - (means[2:] - 2 * means[1:-1] + means[:-2]) / 24
    np.testing.assert_allclose(p.node_height(faces - 2.5 * A), expected, rtol=1e-11)
    inside = (faces[2:-1] > 0.2 * A) & (faces[2:-1] < 0.9 * A)  # three cells on one cubic
    nodes = 0.5 * (faces[2:-1] + faces[1:-2])[inside] - 2.5 * A
    np.testing.assert_allclose(expected[inside], p.height(nodes), rtol=1e-11)
    X = np.linspace(0.4, 0.6, 101) * A
    z = 1e-7 * np.exp(-(((X / A - 0.5) / 0.02) ** 2))
    p = profile(X, z, speed=1.0, repeats=False)
    for dx in (0.01 * A, 0.33 * A):  # far coarser than the ridge: a node would miss it
        x = np.arange(-2.5 * A, 1.5 * A, dx)
        volume = -phi(Roughness(p, None), x, 1.5 * A, dx).sum() * dx
        assert volume == pytest.approx(1e-7 * 0.02 * A * np.sqrt(np.pi), rel=1e-6)
    X, z, _ = read_profile(ALICONA)
    for speed in (2.0, -2.0):
        p = profile(X, z, speed=speed)
        s = (-2.5 * A - np.linspace(-0.05, 0.3, 701) * A) if speed > 0 else np.linspace(1.4, 1.8, 801) * A
        narrow = s[:, np.newaxis] + 2e-9 * np.array([-1.5, -0.5, 0.5, 1.5])
        heights = np.array([p.node_height(cell)[0] for cell in narrow])
        np.testing.assert_allclose(heights, p.height(s), atol=1e-12)
    assert (profile(X, z).node_height(np.linspace(-2.45, 1.5, 50) * A) == 0.0).all()


@pytest.mark.parametrize(("nodes", "error"), [(8, 0.002), (16, 1.5e-4), (32, 1e-5)])
def test_waves_keep_their_heights_on_the_mesh_and_shorter_ones_alias_little(nodes, error):
    wavelength, x = 0.1 * A, np.arange(-2.0, 1.0, 0.1 / nodes) * A
    waves = profile(*wave(wavelength, 1e-7), moving=False)
    surface = Roughness(waves, None)
    heights, exact = (surface.phi_after(x, (0.0, 0.0), cell) for cell in (x[1] - x[0], None))
    np.testing.assert_allclose(heights, exact, atol=error * 1e-7)
    coarse = np.arange(-2.0, 1.0, 0.13) * A  # three quarters of a node a wave
    assert np.abs(surface.phi_after(coarse, (0.0, 0.0), 0.13 * A)).max() < 0.3e-7


def wave(wavelength, amplitude):
    """Abscissas and heights of one wave, 201 points."""
    X = np.linspace(0.0, wavelength, 201)
    return X, amplitude * np.cos(2 * np.pi * X / wavelength)


def _cubic_integral(x):
    """Of 3 x^2 - 2 x^3 on [0, 1], mirrored at both ends, from 0 to x."""
    if x < 0:
        return -_cubic_integral(-x)
    turns, rest = divmod(x, 2.0)
    back = max(rest - 1.0, 0.0)
    return turns + (rest**3 - rest**4 / 2 if not back else 1.0 - ((1 - back) ** 3 - (1 - back) ** 4 / 2))


def test_profile_enters_with_its_first_point_at_the_inlet_or_moving_back_at_the_outlet():
    X, z, _ = read_profile(ALICONA)
    p = profile(X, z, speed=2.0)
    inlet, t = -2.5 * A, 4e-4
    beyond_ramp = np.arange(0.2e-3, 0.8e-3, 0.5e-6)
    x = inlet - beyond_ramp + 2.0 * t  # where profile abscissa X stands at time t
    np.testing.assert_allclose(p.height(x - 2.0 * t), np.interp(beyond_ramp, X, z), atol=1e-15)
    assert (p.height(np.linspace(inlet + 2.0 * t, 1.5 * A, 100) - 2.0 * t) == 0.0).all()
    assert (phi(Roughness(p, p), np.linspace(-2.5, 1.5, 100) * A, 0.0) == 0.0).all()
    X, z, _ = read_profile(ALICONA)
    p = profile(X, z, speed=-2.0)
    t, at = 4e-4, np.arange(0.2e-3, 0.8e-3, 0.5e-6)
    x = 1.5 * A + at - 2.0 * t
    np.testing.assert_allclose(p.height(x + 2.0 * t), np.interp(at, X, z), atol=1e-15)
    assert (p.height(np.linspace(-2.5, 1.5, 100) * A) == 0.0).all()


def test_height_is_continuous_where_the_profile_begins_and_is_mirrored():
    X = np.arange(4000) * 0.5e-6
    p = profile(X, np.full(X.size, 1e-6))
    s = -2.5 * A - np.linspace(-0.01, 0.11, 12001) * A
    h = p.height(s)
    assert h[0] == 0.0 and h[-1] == pytest.approx(1e-6)
    slope, curvature = np.gradient(h, s), np.gradient(np.gradient(h, s), s)
    # smoothstep: slope at most 15/8 and curvature at most 10/sqrt(3) of the height over the ramp
    assert np.abs(slope).max() == pytest.approx(15 / 8 * 1e-6 / (RAMP_LENGTH * A), rel=1e-4)
    assert np.abs(curvature).max() == pytest.approx(10 / np.sqrt(3) * 1e-6 / (RAMP_LENGTH * A) ** 2, rel=1e-3)
    assert np.abs(np.diff(curvature)).max() < 0.02 * np.abs(curvature).max()
    X, z, _ = read_profile(ALICONA)
    p = profile(X, z, speed=1.0)
    d = np.linspace(0, 1e-5, 50)
    for end in (X[-1], 2 * X[-1], 3 * X[-1]):
        left, right = p.height(-2.5 * A - (end - d)), p.height(-2.5 * A - (end + d))
        np.testing.assert_allclose(left, right, atol=1e-16)
        beside = p.height(np.array([-2.5 * A - end, -2.5 * A - end + 1e-9]))
        assert abs(np.diff(beside)[0]) < 2e-3 * 1e-9  # level at the end, where slopes elsewhere reach 0.2


@pytest.mark.parametrize(("speed", "moving"), [(0.0, True), (3.0, False)])
def test_stationary_profile_covers_the_domain(speed, moving):
    X, z, _ = read_profile(ALICONA)
    p = profile(X, z, speed=speed, moving=moving)
    np.testing.assert_allclose(p.height(-2.5 * A + X), z, atol=1e-15)
    assert (p.s[0], p.s[-1]) == pytest.approx((-2.5 * A, 1.5 * A))


def test_stored_profile_equals_the_heights_used():
    r, scales = rough("table1_rough.toml")
    for p in (r.surface_1, r.surface_2):
        assert np.diff(p.s) == pytest.approx(0.5e-6)
        assert p.s[-1] == pytest.approx(scales.x[0] * scales.a)
        assert p.s[-1] - p.s[0] == pytest.approx(p.speed * scales.duration, abs=0.5e-6)
        t = scales.duration
        here = (p.s + p.speed * t > scales.x[0] * scales.a) & (p.s + p.speed * t < scales.x[-1] * scales.a)
        one = phi(Roughness(p, None), p.s[here] + p.speed * t, t)
        np.testing.assert_allclose(-one, p.z[here], atol=1e-15)


def test_ridge_case_is_its_gaussian_and_a_dent_its_negative():
    r, s = rough("ridge.toml")
    t = (2.5 + 0.4) * s.a / s.u2  # centre at x = 0
    x = np.linspace(-0.5, 0.5, 401) * s.a
    np.testing.assert_allclose(phi(r, x, t), -0.1e-6 * np.exp(-((x / s.a / 0.1) ** 2)), atol=2e-12)
    assert np.abs(phi(r, s.x * s.a, t)).max() == pytest.approx(0.1e-6)
    ridge, s = rough("ridge.toml")
    dent, _ = rough("ridge.toml", "surface.2.synthetic.kind='dent'")
    x, t = s.x * s.a, 2.9 * s.a / s.u2
    np.testing.assert_array_equal(phi(dent, x, t), -phi(ridge, x, t))
    assert rough("table1_smooth.toml")[0] is None
    r, _ = rough("ridge.toml")
    assert r.surface_1 is None and r.surface_2 is not None


def test_waves_continue_with_their_amplitude():
    wave = "surface.2.synthetic={kind='sine', amplitude=1e-7, wavelength=2e-5}"
    r, s = rough("table1_smooth.toml", wave, "time.travel=30")
    t = 20 * s.a / s.u2
    x = np.linspace(-4, 1.5, 3001) * s.a
    abscissa = s.x[0] * s.a - x + s.u2 * t
    np.testing.assert_allclose(phi(r, x, t), -1e-7 * np.cos(2 * np.pi * abscissa / 2e-5), atol=1e-13)
    assert r.surface_2.rq == pytest.approx(1e-7 / np.sqrt(2), rel=0.02)
    r, s = rough("table1_smooth.toml", "surface.2.synthetic={kind='square', amplitude=1e-7, wavelength=1e-4}")
    z = phi(r, np.linspace(-4, 1.5, 20001) * s.a, 0.0)
    assert np.abs(z).max() <= 1e-7 * (1 + 1e-6)
    assert (np.abs(z) > 0.99e-7).mean() > 0.8


def test_self_affine_profile_has_its_height_and_waves():
    """A mesh with nodes at a fifth of the shortest wave resolves all of its variance."""
    spec = "{kind='self-affine', sq='0.2 um', hurst=0.8, roll_off=80e-6, short_cutoff=8e-6, seed=3}"
    r, _ = rough("table1_smooth.toml", f"surface.2.synthetic={spec}")
    profile = r.surface_2
    assert profile.rq == pytest.approx(0.2e-6, rel=1e-9)
    assert profile.given.length == pytest.approx(200 * 80e-6, rel=1e-3)
    assert profile.given.unresolved_variance(1.6e-6) < 0.01 < profile.given.unresolved_variance(4e-6)
    falling = (1.0 - 10.0**-1.6) / 1.6  # of the variance, beside 1 of the plateau
    shorter = (0.5 + falling) / (1.0 + falling)  # than twice roll_off
    assert profile.given.unresolved_variance(40e-6) == pytest.approx(shorter, abs=0.03)


def test_the_last_digit_of_roll_off_does_not_change_a_self_affine_profile():
    keys = {"sq": 2e-7, "hurst": 0.8, "short_cutoff": 25e-6, "seed": 3}
    first, second = (
        self_affine(SimpleNamespace(**keys, roll_off=roll_off)) for roll_off in (150e-6, 150e-6 * (1 + 4e-16))
    )
    assert len(first[0]) == len(second[0]) == 12_000
    np.testing.assert_allclose(first[1], second[1], rtol=0, atol=1e-18)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("hurst=1.5, roll_off=80e-6, short_cutoff=8e-6", "hurst = 1.5: allowed: a number > 0 and <= 1 "),
        ("hurst=0.8, roll_off=8e-6, short_cutoff=80e-6", "short_cutoff = 8e-05: allowed: .* below roll_off "),
        ("hurst=0.8, short_cutoff=80e-6", "roll_off is missing; "),
    ],
)
def test_invalid_self_affine_spectrum_is_refused(keys, message):
    spec = f"surface.2.synthetic={{kind='self-affine', sq=2e-7, seed=3, {keys}}}"
    with pytest.raises(CaseError, match=message):
        rough("table1_smooth.toml", spec)


def test_fraction_of_short_waves_is_that_of_the_variance_and_noted():
    X = np.arange(8193) * 1e-6
    z = 3e-7 * np.cos(2 * np.pi * X / 128e-6) + 1e-7 * np.cos(2 * np.pi * X / 16e-6)
    p = profile(X, z).given
    assert p.unresolved_variance(5e-6) == pytest.approx(0.1, abs=1e-3)  # 4 nodes are 20 um: the 16 um wave
    assert p.unresolved_variance(3.9e-6) < 1e-3
    for points, share in ((200, None), (100, "7.3 %"), (50, "51.1 %")):
        c = case.load(CASES / "table1_rough.toml", [f"mesh.points_per_half_width={points}"])
        scales = Scales.of(c)
        notes = mesh_warnings(Roughness.of(c, scales), scales)
        assert [share in note for note in notes] == ([True, True] if share else [])
    assert "points_per_half_width = 162" in notes[0] or "points_per_half_width = 157" in notes[0]


def test_constant_offset_is_removed_with_a_note_and_levelling_removes_a_line(tmp_path):
    X, z, _ = read_profile(ALICONA)
    np.savetxt(tmp_path / "p.csv", np.transpose([X, z + 1e-6]), delimiter=",")
    spec = values_of(PROFILE, {"file": "p.csv", "scale": 0.5})
    given = samples(tmp_path, spec)
    assert len(given.notes) == 1 and "height of 1 um " in given.notes[0]
    np.testing.assert_allclose(given.z[0], 0.5 * z, atol=1e-14)
    assert samples(ALICONA.parent, values_of(PROFILE, {"file": ALICONA.name})).notes == ()
    X = np.linspace(0.0, 4e-3, 10_001)
    z = 1e-7 * np.cos(2 * np.pi * X / 1e-4)
    np.testing.assert_allclose(levelled(X, z + 3e-3 * X - 7e-6), levelled(X, z), atol=1e-18)
    np.testing.assert_allclose(levelled(X, z), z - np.polynomial.Polynomial.fit(X, z, 1)(X), atol=1e-20)
    np.testing.assert_allclose(without_form([X], z + 3e-3 * X, 1), levelled(X, z), atol=1e-18)


def test_travel_to_entry_and_filling_and_entry_of_a_surface_at_rest():
    r, s = rough("table1_rough.toml")  # inlet -2.5 a, slide/roll ratio 0.25: 5.625 and 4.375 m/s
    assert entry_times(r.surface_1, s) == pytest.approx((1.5, 3.5 + RAMP_LENGTH))
    assert entry_times(r.surface_2, s) == pytest.approx((1.5 * 9 / 7, (3.5 + RAMP_LENGTH) * 9 / 7))
    for profile in (r.surface_1, r.surface_2):
        reaches, fills = entry_times(profile, s)
        x = s.x * s.a
        inside = np.abs(s.x) <= 1.0
        before, then = (-phi(Roughness(profile, None), x, t * s.a / s.u_max) for t in (reaches, fills))
        assert (before[inside] == 0.0).all() and (before[s.x < -1.05] != 0.0).any()
        whole = profile._spline(x[0] - x[inside] + profile.speed * fills * s.a / s.u_max)
        np.testing.assert_allclose(then[inside], whole, rtol=1e-9)
    backwards, s = rough("table1_rough.toml", "motion.slide_roll_ratio=-4")  # u -1, 3: enters at the outlet
    reaches, fills = entry_times(backwards.surface_1, s)
    assert (reaches, fills) == pytest.approx((0.5 * 3, (2.5 + RAMP_LENGTH) * 3))
    ridge, s = rough("ridge.toml")
    assert entry_times(ridge.surface_2, s)[1] == pytest.approx((2.5 + 0.4) * s.u1 / s.u2)
    still, s = rough("dry_rough.toml")
    assert entry_times(still.surface_2, s) is None
    scales = SimpleNamespace(u1=0.02, u2=0.0, u_max=0.02)
    later = SimpleNamespace(conditions=SimpleNamespace(directions=lambda: (1.0, -1.0)))
    assert directed_speeds(later, scales) == pytest.approx((0.02, -2e-5))
