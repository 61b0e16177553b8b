"""Traction on both surfaces: shear of the film, friction of the solids; published correlations of friction.

Each correlation is a fit to one series of measurements or computations of discs or gears, over the oils and
speeds of that series; they differ by a factor of two to three. Arguments are in SI units, those of the
equations are given beside them.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.case import Fluid
from ehlpetsc.base.compiled import compiled
from ehlpetsc.physics.oil.laws import viscosity
from ehlpetsc.physics.oil.rheology import NEWTON, FlowLaw, flow_law, flow_stress, stress_pressure
from ehlpetsc.physics.oil.tabulated_flow import flow_table, stress_spread


def shear_stresses(
    fluid: Fluid,
    solids: np.ndarray,
    gradient: np.ndarray,
    sliding: float | np.ndarray,
    oil: np.ndarray,
    h: np.ndarray,
    sheared: np.ndarray,
    mean: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Shear stress [Pa] in +x on surfaces 1 (upper) and 2 (lower); or in the direction across.

    In the film :func:`wall_shear` under the oil's pressure, times the fraction of
    the gap in which oil is sheared; between the solids their friction, + on surface 2 and - on surface 1
    where u1 > u2, none in pure rolling. Where both act, they are added: a boundary film of some nanometres is
    then sheared with the bulk viscosity, which overestimates its shear stress.

    Parameters
    ----------
    fluid
        None: dry.
    solids
        Friction between the solids [Pa], 0 out of contact.
    gradient
        Of the oil's pressure along x [Pa/m].
    sliding
        u1 - u2 [m/s]; where `mean` is given, its sign or a component of its direction.
    oil
        Pressure of the oil [Pa].
    h
        Film [m].
    sheared
        Fraction of the gap in which oil is sheared: 1 less the void fraction, 0 without a film.
    mean
        Mean shear stress of the film [Pa], not negative; None: isothermal.
    """
    direction = np.sign(sliding) if mean is None else sliding
    shear_2 = direction * solids
    shear_1 = -shear_2
    if fluid is None:
        return shear_1, shear_2
    film = np.where(sheared > 0.0, h, 1.0)
    if mean is None:
        lower, upper = wall_shear(film, gradient, viscosity(oil, fluid)[0], fluid, sliding, oil)
    else:
        lower, upper = (direction * mean + sign * 0.5 * film * gradient for sign in (-1.0, 1.0))
    return shear_1 - upper * sheared, shear_2 + lower * sheared


def wall_shear(
    h: np.ndarray,
    gradient: np.ndarray | float,
    ln_eta: np.ndarray,
    fluid: Fluid,
    sliding: float,
    p: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    r"""Shear stress at the lower and the upper wall, :math:`\tau(\mp h/2)=\tau_m\mp hp_x/2`, isothermal.

    Eyring: :math:`\tau_m=\tau_0\,\mathrm{asinh}(\zeta\Sigma/\sinh\Sigma)`,
    :math:`\zeta=\eta(u_1-u_2)/(\tau_0h)` (Conry, Wang & Cusano 1987); Newtonian:
    :math:`\tau_m=\eta(u_1-u_2)/h`. With a limiting shear stress :math:`\tau_m` is limited to
    :math:`\Lambda p`, see :func:`.rheology.flow_stress`.

    Returns
    -------
    lower, upper : ndarray
        Shear stress [Pa] in the film at the walls of surface 2 (lower) and 1 (upper), at h > 0.
    """
    half, mean = 0.5 * h * gradient, mean_shear(h, gradient, ln_eta, fluid, abs(sliding), p)
    mean *= np.sign(sliding)
    return mean - half, mean + half


def mean_shear(
    h: np.ndarray,
    gradient: np.ndarray | float,
    ln_eta: np.ndarray,
    fluid: Fluid,
    speed: float | np.ndarray,
    p: np.ndarray,
) -> np.ndarray:
    """Mean shear stress of an isothermal film [Pa], not negative, see :func:`wall_shear`.

    `speed`: magnitude of the sliding velocity [m/s].
    """
    flow, limit = flow_law(fluid), getattr(fluid, "limiting_shear", None)
    half, mean = 0.5 * h * gradient, np.zeros_like(h)
    table, viscous = flow_table(flow.kind, flow.n, flow.a), np.full(len(h), fluid.viscosity * speed)
    constants = stress_pressure(fluid), viscous, flow, np.inf if limit is None else float(limit), table
    _mean_stress(h, half, ln_eta, p, *constants, mean)
    return mean


@compiled
def _mean_stress(
    h: np.ndarray,
    half: np.ndarray,
    ln_eta: np.ndarray,
    p: np.ndarray,
    rise: float,
    viscous: np.ndarray,
    law: FlowLaw,
    limit: float,
    table: np.ndarray,
    out: np.ndarray,
) -> None:
    for i in range(len(h)):
        if viscous[i] == 0.0:
            continue
        flow = FlowLaw(law.kind, law.stress * (1.0 + rise * p[i]), law.n, law.a)
        x = np.log(viscous[i] / (h[i] * flow.stress)) + ln_eta[i]
        if flow.kind != NEWTON:
            x -= stress_spread(abs(half[i]) / flow.stress, x, table)
        out[i] = flow_stress(x, flow, limit * p[i] if limit < np.inf else limit)[0]


MIN_LINE_LOAD = 150e3  # N/m: below it ISO/TR 14179-2 takes this load
MAX_SUM_SPEED = 50.0  # m/s: above it ISO/TR 14179-2 takes this speed


def hoehn_michaelis(
    load: np.ndarray,
    sum_speed: np.ndarray,
    radius: np.ndarray,
    viscosity: np.ndarray,
    ra: np.ndarray,
    oil_factor: float = 1.0,
) -> np.ndarray:
    r"""Mean coefficient of friction along the path of contact of gears, by values at the pitch point.

    .. math:: \mu=0.048\left(\frac{F_{bt}/b}{v_\Sigma\rho}\right)^{0.2}\eta^{-0.05}R_a^{0.25}X_L,

    the load in N/mm, :math:`v_\Sigma` in m/s, :math:`\rho` in mm, :math:`\eta` in mPa s, :math:`R_a` in um:
    Schlenk 1994, as in ISO/TR 14179-2 (with its limits of load and speed) and in Hoehn, Michaelis &
    Hinterstoisser, Goriva i maziva 48 (2009) 441. Fitted to FZG tests of mineral oils, :math:`X_L=1`; the
    other :math:`X_L` and both limits are from memory, not checked against the report. Fernandes and Seabra
    fit lower ones to their FZG tests: 0.846 for mineral oil, 0.65 for PAO and ester, 0.585 for polyglycol.

    Parameters
    ----------
    load
        Normal load per face width, :math:`F_{bt}/b` [N/m].
    sum_speed
        Sum of both surface speeds [m/s].
    radius, viscosity
        Reduced radius [m]; of the oil at its temperature of supply [Pa s].
    ra
        Arithmetic mean roughness, the average of both flanks [m].
    oil_factor
        :math:`X_L`: 1 for mineral oils, 0.8 for PAO and esters, 0.75 for water-free polyglycols.
    """
    line_load = np.maximum(load, MIN_LINE_LOAD) * 1e-3
    ratio = line_load / (np.minimum(sum_speed, MAX_SUM_SPEED) * radius * 1e3)
    return 0.048 * ratio**0.2 * (viscosity * 1e3) ** -0.05 * (ra * 1e6) ** 0.25 * oil_factor


def xu_kahraman(
    pressure: np.ndarray,
    slide_roll: np.ndarray,
    speed: np.ndarray,
    viscosity: np.ndarray,
    radius: np.ndarray,
    rms: np.ndarray,
) -> np.ndarray:
    r"""Local coefficient of friction of a line contact.

    .. math::
       \mu=e^fP^{b_2}|S_R|^{b_3}V^{b_6}\nu^{b_7}R^{b_8},\qquad
       f=b_1+b_4|S_R|P\lg\nu+b_5e^{-|S_R|P\lg\nu}+b_9e^S:

    Xu, Kahraman, Anderson & Maddock, J. Mech. Des. 129 (2007) 58, doi:10.1115/1.2359478. A fit to thermal,
    non-Newtonian computations for one 75W90 gear oil.

    Parameters
    ----------
    pressure
        Maximum Hertz pressure P [Pa], in the fit GPa.
    slide_roll, speed
        Sliding over mean speed :math:`S_R`; mean surface speed V [m/s].
    viscosity
        Of the oil that enters, at ambient pressure [Pa s], in the fit mPa s.
    radius, rms
        Reduced radius R [m]; rms roughness of both surfaces together, S [m], in the fit um.
    """
    p, nu, sr = pressure * 1e-9, viscosity * 1e3, np.abs(slide_roll)
    heating = sr * p * np.log10(nu)
    f = -8.916465 - 0.354068 * heating + 2.812084 * np.exp(-heating) + 0.620305 * np.exp(rms * 1e6)
    powers = p**1.03303 * sr**1.036077 * speed**-0.100601 * nu**0.752755 * radius**-0.390958
    return np.exp(f) * powers


def benedict_kelley(
    load: np.ndarray, sliding: np.ndarray, sum_speed: np.ndarray, viscosity: np.ndarray, ra: np.ndarray
) -> np.ndarray:
    r"""Local coefficient of friction of a gear contact.

    .. math:: \mu=0.0127\,\frac{1.13}{1.13-R_a}\lg\frac{29660\,w'}{\eta|u_1-u_2|v_\Sigma^2},

    w' in N/mm, :math:`\eta` in mPa s, :math:`R_a` in um: Benedict & Kelley, ASLE Trans. 4 (1961) 59,
    doi:10.1080/05698196108972420, with their imperial constants :math:`3.17\cdot10^8` and 50 microinches.
    Disc tests of ground steel with mineral oils; without bound towards no sliding. 0.0127 and 29660 are as in
    the public program github.com/PedroTayer/contact_mechanics, the factor of the roughness is from memory.

    Parameters
    ----------
    load
        Normal load per face width w' [N/m].
    sliding, sum_speed
        :math:`|u_1-u_2|` and :math:`v_\Sigma=u_1+u_2` [m/s].
    viscosity, ra
        Of the oil that enters [Pa s]; arithmetic mean roughness, mean of both surfaces [m], below 1.13 um.
    """
    argument = 29660.0 * load * 1e-3 / (viscosity * 1e3 * np.abs(sliding) * sum_speed**2)
    return 0.0127 * 1.13 / (1.13 - ra * 1e6) * np.log10(argument)
