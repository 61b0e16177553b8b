"""Traction on both surfaces: shear of the film and friction of the solids."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.physics.laws import viscosity
from ehlpetsc.physics.rheology import NEWTON, FlowLaw, flow_law, flow_stress, stress_pressure
from ehlpetsc.physics.tabulated_flow import flow_table, stress_spread

if TYPE_CHECKING:
    from ehlpetsc.case.tables.contact import Fluid


def shear_stresses(
    fluid: Fluid,
    solids: np.ndarray,
    gradient: np.ndarray,
    sliding: float,
    oil: np.ndarray,
    h: np.ndarray,
    sheared: np.ndarray,
    mean: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Shear stress [Pa] in +x on surfaces 1 (upper) and 2 (lower).

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
        u1 - u2 [m/s].
    oil
        Pressure of the oil [Pa].
    h
        Film [m].
    sheared
        Fraction of the gap in which oil is sheared: 1 less the void fraction, 0 without a film.
    mean
        Mean shear stress of the film [Pa], not negative; None: isothermal.
    """
    shear_2 = np.sign(sliding) * solids
    shear_1 = -shear_2
    if fluid is None:
        return shear_1, shear_2
    film = np.where(sheared > 0.0, h, 1.0)
    if mean is None:
        lower, upper = wall_shear(film, gradient, viscosity(oil, fluid)[0], fluid, sliding, oil)
    else:
        lower, upper = (np.sign(sliding) * mean + sign * 0.5 * film * gradient for sign in (-1.0, 1.0))
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
    flow, limit = flow_law(fluid), getattr(fluid, "limiting_shear", None)
    half, mean = 0.5 * h * gradient, np.zeros_like(h)
    if sliding:
        table, viscous = flow_table(flow.kind, flow.n, flow.a), fluid.viscosity * abs(sliding)
        constants = stress_pressure(fluid), viscous, flow, np.inf if limit is None else float(limit), table
        _mean_stress(h, half, ln_eta, p, *constants, mean)
    mean *= np.sign(sliding)
    return mean - half, mean + half


@compiled
def _mean_stress(
    h: np.ndarray,
    half: np.ndarray,
    ln_eta: np.ndarray,
    p: np.ndarray,
    rise: float,
    viscous: float,
    law: FlowLaw,
    limit: float,
    table: np.ndarray,
    out: np.ndarray,
) -> None:
    for i in range(len(h)):
        flow = FlowLaw(law.kind, law.stress * (1.0 + rise * p[i]), law.n, law.a)
        x = np.log(viscous / (h[i] * flow.stress)) + ln_eta[i]
        if flow.kind != NEWTON:
            x -= stress_spread(abs(half[i]) / flow.stress, x, table)
        out[i] = flow_stress(x, flow, limit * p[i] if limit < np.inf else limit)[0]
