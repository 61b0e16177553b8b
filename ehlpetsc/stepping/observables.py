"""What is told of an accepted state: fields in SI units and the figures of its step."""

import time as clock

import numpy as np

from ehlpetsc.physics.traction import shear_stresses


def observe(case, scales, problem, state, started):
    """Per-step figures and fields in SI units.

    Parameters
    ----------
    case, scales, problem
        Of the run.
    state : stepping.time_stepping.State
    started : float
        Monotonic clock at the begin of the step [s].

    Returns
    -------
    scalars : dict of str to number
    fields : dict of str to ndarray, shape (nx,)
    in_contact : ndarray of bool, shape (nx,)
    """
    s, p = scales, problem
    relations = p.model.relations(state.q, state.w)
    pressure, in_contact = relations.pressure, relations.touching
    void = np.zeros_like(pressure) if p.dry else np.maximum(-state.q, 0.0)
    fast, slow = shear_stresses(case, s, pressure * s.p0, state.h * s.h, void, in_contact)
    load = s.dx * s.p0 * pressure.sum()
    # F sums to the mass imbalance; at contact nodes it is the flow that leaving out Reynolds makes up,
    # here over the flow drawn in at the inlet
    drawn_in = 1.0 if p.dry else max(state.m[0], p.film_scale)
    defect = 0.0 if p.dry else float(np.abs(state.imbalance[in_contact]).sum() * p.film_scale / drawn_in)
    scalars = {
        "dt": state.dt or 0.0,
        "newton": state.newton,
        "retries": state.retries,
        "h_min": state.h.min() * s.h,
        "p_max": pressure.max() * s.p0,
        "contacts": int(in_contact.sum()),
        "load": load,
        "load_error": abs(load / s.load - 1.0),
        "mass_error": defect,
        "approach": state.h00 * s.h,
        "friction": s.dx * slow.sum(),
        "wall": clock.monotonic() - started,
    }
    fields = {
        "pressure": pressure * s.p0,
        "film_thickness": state.h * s.h,
        "void_fraction": void,
        "shear_stress_fast": fast,
        "shear_stress_slow": slow,
        "in_contact": in_contact,
    }
    return scalars, fields, in_contact
