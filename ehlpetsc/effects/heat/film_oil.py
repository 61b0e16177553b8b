"""Oil of a heated film: its constants in a step, and its laws at the pressure and film of a node."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.case import Fluid
from ehlpetsc.base.compiled import inlined
from ehlpetsc.base.declarations import Values
from ehlpetsc.physics.oil.law import SLOTS
from ehlpetsc.physics.oil.laws import (
    conductivity,
    is_linear_in_temperature,
    ln_viscosities,
    ln_viscosity,
    viscosity_law,
)
from ehlpetsc.physics.oil.rheology import NEWTON, FlowLaw, flow_law, stress_pressure

MIN_CONDUCTING_FRACTION = 1e-6  # fraction of the gap: less conducts as this
MIN_VISCOSITY_SLOPE = 1e-12  # 1/K
MIN_RISE = 0.1  # K of the secant
MIN_STRESS = 0.1  # of the shear law's and the limiting stress, over those at the reference temperature


class FilmLaw(NamedTuple):
    """Constants of the oil in a step.

    Attributes
    ----------
    viscosity
        :class:`ehlpetsc.physics.oil.laws.OilLaw` as a tuple.
    is_linear
        Whether the logarithm of the viscosity is linear in temperature.
    eta0
        Viscosity at ambient pressure and reference temperature [Pa s].
    flow
        :class:`ehlpetsc.physics.oil.rheology.FlowLaw` as a tuple.
    limit
        Limiting shear stress over pressure; infinite: none.
    conductivity, conductivity_pressure, conductivity_saturation
        k_f at ambient pressure [W/(m K)], its relative increase with pressure, and the
        decrease of that [1/Pa].
    thinnest
        Film [m] below which the shear stress is that of this film; 0: films of no thickness are not sheared.
    stress_pressure, stress_temperature
        Relative rise of the stress of the shear law with pressure [1/Pa] and, from the temperature at which
        the viscosity is eta0, with temperature [1/K].
    limit_temperature
        Relative rise of the limiting shear stress with temperature [1/K], likewise.
    """

    viscosity: tuple
    is_linear: bool
    eta0: float
    flow: tuple
    limit: float
    conductivity: float
    conductivity_pressure: float
    conductivity_saturation: float
    thinnest: float = 0.0
    stress_pressure: float = 0.0
    stress_temperature: float = 0.0
    limit_temperature: float = 0.0


def film_law(fluid: Fluid | None, heat: Values, thinnest: float = 0.0) -> FilmLaw:
    """Constants of the oil in a step; `fluid` None: dry."""
    conduction = (
        float(heat.oil_conductivity),
        float(heat.oil_conductivity_pressure),
        float(heat.oil_conductivity_saturation),
    )
    if fluid is None:
        return FilmLaw((0, (0.0,) * SLOTS, 300.0), True, 1.0, tuple(FlowLaw(NEWTON)), np.inf, *conduction)
    law = viscosity_law(fluid, heat)
    return FilmLaw(
        tuple(law),
        is_linear_in_temperature(law, fluid.law),
        float(fluid.viscosity),
        tuple(flow_law(fluid)),
        np.inf if fluid.limiting_shear is None else float(fluid.limiting_shear),
        *conduction,
        thinnest,
        stress_pressure(fluid),
        getattr(fluid, "eyring_stress_temperature", None) or 0.0,
        getattr(fluid, "limiting_shear_temperature", None) or 0.0,
    )


class NodeOil(NamedTuple):
    r"""Oil at a node.

    `h`, `sheared`: film [m], and that of the shear stress, which is not below the thinnest one.
    `r`, `r_h`, `k_p`: :math:`h/k_f` [m^2 K/W], its derivative by h, and :math:`d\ln k_f/dp`.
    `flow`, `stress_p`: shear law, and the derivative of the logarithm of its stress by p.
    `limit`, `limit_p`: limiting shear stress [Pa], infinite: none; over p.
    `reference`, `ln_eta`, `beta`: :math:`\ln(\eta/\eta_0)` at the temperature `reference`, its secant
        :math:`\beta`; `eta_p`, `beta_p`: their derivatives by p.
    `speed`: |u1 - u2| times the fraction of the gap full of oil [m/s]; 0: not sheared.
    `ln_rate`: logarithm of the viscous stress at eta0 over that of the shear law.
    `heating`, `heating_h`: B of :mod:`.film_shear` [1/Pa], and its derivative by h.
    """

    h: float
    sheared: float
    r: float
    r_h: float
    k_p: float
    flow: FlowLaw
    stress_p: float
    limit: float
    limit_p: float
    reference: float
    ln_eta: float
    beta: float
    eta_p: float
    beta_p: float
    speed: float
    ln_rate: float
    heating: float
    heating_h: float


@inlined
def oil_at(
    p: float, h: float, left: float, sliding: float, last: tuple[float, float, float], law: FilmLaw
) -> NodeOil:
    r"""Oil of a film.

    `p`, `h`, `left`: pressure [Pa], film [m], fraction of the gap full of oil.
    `sliding`: |u1 - u2| [m/s].
    `last`: :math:`\ln(\sinh\Sigma/\Sigma)` of the Eyring stress, temperatures of the last level [K], in the
        middle of the film and :math:`T_s`: :math:`\beta` is the secant of ln(eta) between them. Around the
        second the law is exponential, which leaves one solution.
    """
    spread, middle, reference = last
    over_k, k_p = _resistivity(p, left, law)
    r, conducting = h * over_k, max(left, MIN_CONDUCTING_FRACTION)
    flow, stress_p, limit_p = _stresses(p, reference, law)
    ln_eta, beta, eta_p, beta_p = _line(p, middle, reference, law)
    sheared = max(h, law.thinnest)
    speed = left * sliding if sheared > 0.0 else 0.0
    ln_rate, limit = 0.0, np.inf
    if speed > 0.0:
        ln_rate = np.log(sliding * law.eta0 / (flow.stress * sheared)) - spread
        limit = np.inf if law.limit == np.inf else limit_p * p
    heating = 0.125 * beta * sliding * r * conducting
    heating_h = 0.125 * beta * sliding * over_k * conducting
    oil = h, sheared, r, over_k, k_p, flow, stress_p, limit, limit_p, reference, ln_eta, beta, eta_p, beta_p
    return NodeOil(*oil, speed, ln_rate, heating, heating_h)


@inlined
def _resistivity(p: float, left: float, law: FilmLaw) -> tuple[float, float]:
    """1/k_f [m K/W] of a film with a fraction of oil, and d ln(k_f)/dp [1/Pa]."""
    k, by_p = conductivity(p, law.conductivity, law.conductivity_pressure, law.conductivity_saturation)
    return 1.0 / (k * max(left, MIN_CONDUCTING_FRACTION)), by_p / k


@inlined
def _stresses(p: float, reference: float, law: FilmLaw) -> tuple[FlowLaw, float, float]:
    """Shear law, derivative of the logarithm of its stress by p [1/Pa], limiting stress over p."""
    kind, stress, n, width = law.flow
    stress_p, warmer = 0.0, reference - law.viscosity[2]
    if law.stress_pressure != 0.0 or law.stress_temperature != 0.0:
        grown = 1.0 + law.stress_pressure * p
        stress *= grown * max(1.0 + law.stress_temperature * warmer, MIN_STRESS)
        stress_p = law.stress_pressure / grown
    limit_p = law.limit
    if law.limit_temperature != 0.0:
        limit_p *= max(1.0 + law.limit_temperature * warmer, MIN_STRESS)
    return FlowLaw(kind, stress, n, width), stress_p, limit_p


@inlined
def _line(p: float, middle: float, reference: float, law: FilmLaw) -> tuple[float, float, float, float]:
    """ln(eta/eta0) at `reference`, its secant to the temperature `middle`, -d/dT [1/K]; both by p."""
    if law.is_linear:
        value, by_p, slope = ln_viscosity(law.viscosity, p, reference)
        return value, max(-slope, MIN_VISCOSITY_SLOPE), by_p, 0.0
    rise = max(middle - reference, MIN_RISE)
    (value, by_p, _), (further, further_by_p, _) = ln_viscosities(
        law.viscosity, p, reference, reference + rise
    )
    return value, max((value - further) / rise, MIN_VISCOSITY_SLOPE), by_p, (by_p - further_by_p) / rise
