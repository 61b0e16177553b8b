"""What is told of an accepted state: fields in SI units and the figures of its step."""

import time as clock

import numpy as np

from ehlpetsc.physics.traction import shear_stresses


def observe(case, scales, rq, problem, state, started):
    """Per-step figures and fields in SI units.

    Parameters
    ----------
    case, scales, problem
        Of the run.
    rq : float
        Combined root mean square height of both surfaces [m]; 0: smooth.
    state : stepping.time_stepping.State
    started : float
        Monotonic clock at the begin of the step [s].

    Returns
    -------
    figures : dict of str to number
    fields : dict of str to ndarray, shape (nx,)
    in_contact : ndarray of bool, shape (nx,)
    """
    s, p, model = scales, problem, problem.model
    relations = model.relations(state.q, state.w)
    pressure, touching = relations.pressure * s.p0, relations.touching
    solids = model.contact_pressure(state.w) * s.p0
    # direct contact does not tell the solids' pressure from the oil's: there they carry what there is
    oil, carried = (pressure - solids, solids) if model.is_mixed else (pressure, pressure)
    void = np.zeros_like(pressure) if p.dry else np.maximum(-state.q, 0.0)
    fast, slow = shear_stresses(case, s, oil, carried, state.h * s.h, void, touching)
    load, friction = s.dx * pressure.sum(), s.dx * slow.sum()
    film = mean_film(s, state.h)
    figures = {
        "dt": state.dt or 0.0,
        "newton": state.newton,
        "retries": state.retries,
        "h_min": state.h.min() * s.h,
        "p_max": pressure.max(),
        "contacts": int(touching.sum()),
        "load": load,
        "load_error": abs(load / s.load - 1.0),
        "mass_error": mass_error(p, state, touching),
        "approach": state.h00 * s.h,
        "friction": friction,
        "friction_coefficient": friction / load,
        "film_central": film,
        "lambda_ratio": film / rq if rq else np.nan,
        "wall": clock.monotonic() - started,
    }
    fields = {
        "pressure": pressure,
        "contact_pressure": solids,
        "film_thickness": state.h * s.h,
        "void_fraction": void,
        "shear_stress_fast": fast,
        "shear_stress_slow": slow,
        "in_contact": touching,
    }
    if model.is_mixed:
        thin = state.h < case.output.thin_film * model.boundary_film
        figures |= {
            "contact_share": s.dx * solids.sum() / load,
            "contact_length": s.dx * touching.sum(),
            "thin_length": s.dx * thin.sum(),
            "thin_share": s.dx * pressure[thin].sum() / load,
        }
    return figures, fields, touching


def mean_film(scales, h):
    """Mean film [m] of the middle half of the Hertz contact; h in a^2/R."""
    middle = np.abs(scales.x) <= 0.5
    return float(h[middle].mean() * scales.h)


def mass_error(problem, state, touching):
    """Oil that the solution loses or makes in a step, over what is drawn in at the inlet.

    F sums to the mass imbalance. In direct contact it is not zero where solids touch: that is the flow that
    leaving out Reynolds' equation makes up. In mixed contact it is zero to Newton's tolerance everywhere.
    """
    if problem.dry:
        return 0.0
    counted = np.ones_like(touching) if problem.model.is_mixed else touching
    drawn_in = max(state.m[0], problem.film_scale)
    return float(np.abs(state.imbalance[counted]).sum() * problem.film_scale / drawn_in)
