r"""The bound without a film: exact solutions of dry contact, with the observed orders of convergence.

Westergaard's wavy surface is periodic, a cylinder is not: ten waves to the half-width of a smooth cylinder.
Within the central wave the mean pressure of a cylinder falls by :math:`(l/2a)^2/2`, a part of 0.0013, towards
its ends, by 0.0004 in the mean. The pressure that counts is the one found, averaged over that wave, because
waves carry some load further out than Hertz has it, 1 to 2 % here; their amplitude is corrected for
that, such that the ratio wanted comes out. What is left of the cylinder is thus of the order of 0.1 %.
"""

import numpy as np
import pytest
from support import exact_solutions
from support.convergence import observed_order
from support.driving import Scene
from support.exact_solutions import hertz_gap

from ehlpetsc.physics.contact.hertz import hertz_pressure
from ehlpetsc.physics.scales import Scales

WAVES = 10  # to a half-width
DOMAIN = ("mesh.inlet=-1.3", "mesh.outlet=1.3")  # 13 waves either side: a crest at x = 0
MAX_IT = 300  # edges of contacts move by a few nodes an iteration


def mesh(points):
    return f"mesh.points_per_half_width={points}"


def hertz(points):
    """Errors of pressure over p0, mean and within 0.9 a, and of the gap beyond 1.1 a over a^2/R."""
    scene = Scene("dry_hertz.toml", mesh(points), "mesh.inlet=-2.52", "mesh.outlet=2.52").start()
    s = scene.scales
    wrong = np.abs(scene.pressure / s.p0 - hertz_pressure(s.x, 1.0, 1.0))
    gap = np.abs(scene.film - hertz_gap(s.x * s.a, s.a, s.R)) / s.h
    assert (scene.state.h >= 0.0).all() and (scene.pressure >= -1e-12 * s.p0).all()
    return wrong.sum() / points, wrong[np.abs(s.x) <= 0.9].max(), gap[np.abs(s.x) >= 1.1].max(), scene


def test_hertz_with_its_order():
    """Second order away from the edge, where the pressure's slope is infinite; 1.5 in the mean over all."""
    found = [hertz(points) for points in (25, 50, 100, 200, 400)]
    mean, inside, gap = np.array([errors[:3] for errors in found]).T
    assert mean[-1] < 1e-4 and inside[-1] < 1e-5 and gap[-1] < 2e-7
    assert observed_order(mean) > 1.45
    assert observed_order(inside) > 1.9
    assert observed_order(gap) > 1.9
    scene = found[-1][3]
    assert np.interp(2.5, scene.x, scene.film) == pytest.approx(12.27534e-6, rel=1e-6)


def parabola_and_quartic(points, width, folder):
    """Errors of pressure over its maximum, mean and within 0.9 of the contact, and the contact's half-width.

    The load is Table 1's, of Hertz half-width a; the quartic makes the contact's half-width `width` a.
    """
    s = Scene("dry_hertz.toml", mesh(points)).scales
    contact = width * s.a
    quartic = (1.0 / width**2 - 1.0) / (3.0 * s.R * contact**2)
    assert exact_solutions.quartic_load(contact, s.R, s.E, quartic) == pytest.approx(s.load, rel=1e-12)
    x = np.linspace(-1.52, 1.52, 3041) * s.a
    np.savetxt(folder / "quartic.csv", np.column_stack([x, -quartic * x**4]), delimiter=",")
    scene = Scene(
        "dry_hertz.toml",
        mesh(points),
        "mesh.inlet=-1.52",
        "mesh.outlet=1.52",
        f"surface.2.file='{folder}/quartic.csv'",
    ).start(MAX_IT)
    x = scene.x * s.a
    exact = exact_solutions.quartic_pressure(x, contact, s.R, s.E, quartic)
    wrong = np.abs(scene.pressure - exact) / exact.max()
    touching = np.abs(scene.x[scene.pressure > 1e-6 * s.p0]).max() / width
    return wrong.sum() / points, wrong[np.abs(x) <= 0.9 * contact].max(), touching, scene


def test_parabola_and_quartic_with_its_order(tmp_path):
    """Pressure at a given load, edge at a node of every mesh: the same orders as Hertz."""
    found = [parabola_and_quartic(points, 0.8, tmp_path) for points in (25, 50, 100, 200, 400)]
    mean, inside, touching = np.array([errors[:3] for errors in found]).T
    assert mean[-1] < 2e-4 and inside[-1] < 2e-5
    assert observed_order(mean) > 1.45
    assert observed_order(inside) > 1.9
    assert touching[-1] == pytest.approx(1.0, abs=0.005)
    s = found[-1][3].scales
    assert s.spacing * found[-1][3].pressure.sum() == pytest.approx(s.load, rel=1e-10)


class Wave:
    """The central wave of a wavy cylinder.

    Attributes
    ----------
    ratio : float
        Mean pressure over the pressure of full contact.
    fraction : float
        Contact width over wavelength: from a straight line through (p/cos psi)^2 over sin^2 psi, see
        :func:`westergaard_pressure`, which vanishes at the edge; finer than the nodes.
    exact : float
        Westergaard's fraction at `ratio`.
    error : float
        Mean error of the pressure over its maximum.
    """

    def __init__(self, nodes, amplitude):
        s = Scene("dry_hertz.toml").scales
        length = s.a / WAVES
        wave = f"surface.2.synthetic={{kind='sine', amplitude={amplitude}, wavelength={length}}}"
        scene = Scene("dry_hertz.toml", mesh(nodes * WAVES), *DOMAIN, wave).start(MAX_IT)
        assert (scene.state.h >= 0.0).all()
        central = slice(scene.centre - nodes // 2, scene.centre + nodes // 2)
        x, p = scene.x[central] * s.a, scene.pressure[central]
        mean = p.mean()
        self.ratio = mean / exact_solutions.westergaard_full_pressure(amplitude, length, s.E)
        self.exact = 2.0 * exact_solutions.westergaard_half_width(mean, amplitude, length, s.E) / length
        psi, high = np.pi * x / length, p > 0.5 * p.max()
        slope, level = np.polyfit(np.sin(psi[high]) ** 2, (p[high] / np.cos(psi[high])) ** 2, 1)
        self.fraction = 2.0 / np.pi * np.arcsin(np.sqrt(-level / slope))
        exact = exact_solutions.westergaard_pressure(x, mean, amplitude, length, s.E)
        self.error = np.abs(p - exact).mean() / exact.max()


@pytest.mark.parametrize("ratio", [0.25, 0.5])
def test_wavy_surface_with_its_order(ratio):
    s: Scales = Scene("dry_hertz.toml").scales
    amplitude = 2.0 * s.a / WAVES * s.p0 / (np.pi * s.E * ratio)
    amplitude *= Wave(24, amplitude).ratio / ratio
    waves = [Wave(nodes, amplitude) for nodes in (12, 24, 48, 96, 192)]
    finest = waves[-1]
    assert finest.ratio == pytest.approx(ratio, rel=2e-3)
    assert finest.fraction == pytest.approx(finest.exact, rel=1e-3)
    assert finest.fraction == pytest.approx({0.25: 1.0 / 3.0, 0.5: 0.5}[ratio], rel=2e-3)
    assert finest.error < 5e-4
    assert observed_order([wave.error for wave in waves]) > 1.3
