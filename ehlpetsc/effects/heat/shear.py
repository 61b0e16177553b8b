"""Mean shear stress of the film at a node, with the derivatives that its temperature needs."""

import numpy as np

from ehlpetsc.compiled import inlined
from ehlpetsc.physics.rheology import limited_shear

MAX_LN_SINH = 20.0  # above it the stress is linear in ln(eta) to 1e-17

_limited = inlined(limited_shear)


@inlined
def shear_stress(ln_rate, ln_eta, p, eyring, limit):
    r"""Mean shear stress of the film :math:`\tau_m` [Pa].

    :math:`\tau_0\,\mathrm{asinh}(\eta|u_1-u_2|/(\tau_0h)\,e^{-s})`, :math:`s=\ln(\sinh\Sigma/\Sigma)` (Conry,
    Wang & Cusano 1987), limited by :func:`.rheology.limited_shear`.

    Parameters
    ----------
    ln_rate : float
        :math:`\ln(\eta_0|u_1-u_2|/(\tau_0h))-s`; Newtonian: :math:`\ln(\eta_0|u_1-u_2|/h)`.
    ln_eta, p : float
        ln(eta/eta0), pressure [Pa].
    eyring, limit : float
        Eyring stress [Pa], limiting shear stress over pressure; infinite: none.

    Returns
    -------
    tau, by_ln_eta, by_ln_eta_twice, by_p : float
        `by_p` at constant viscosity.
    """
    argument = ln_rate + ln_eta
    if eyring == np.inf:
        tau = by_ln_eta = twice = np.exp(min(argument, 600.0))
    elif argument > MAX_LN_SINH:
        tau, by_ln_eta, twice = eyring * (argument + 0.6931471805599453), eyring, 0.0
    else:
        x = np.exp(argument)
        root = np.sqrt(1.0 + x * x)
        over_root = 1.0 / root
        by_ln_eta = eyring * x * over_root
        tau = eyring * np.log(x + root) if x > 1e-4 else eyring * x
        twice = by_ln_eta * over_root * over_root
    if limit == np.inf:
        return tau, by_ln_eta, twice, 0.0
    value, by_tau, by_limit = _limited(tau, limit * p)
    if tau > 0.0:
        twice = by_tau * twice - 5.0 * by_tau * by_ln_eta * by_ln_eta / tau * (1.0 - (value / tau) ** 4)
    return value, by_ln_eta * by_tau, twice, by_limit * limit
