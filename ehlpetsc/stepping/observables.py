"""What is told of an accepted state: fields in SI units and the figures of its step."""

import time as clock

import numpy as np

from ehlpetsc.physics.traction import shear_stresses

MOLECULES = 1e-9  # m: films below it are of one or two molecules of oil
ATOM = 1e-10  # m: least film that oil balances are held against


def observe(case, scales, conditions, rq, problem, state, depths, started):
    """Per-step figures and fields in SI units.

    Parameters
    ----------
    case, scales, problem
        Of the run.
    conditions : physics.operation.Conditions
        Of the instant.
    rq : float
        Combined root mean square height of both surfaces [m]; 0: smooth.
    state : stepping.time_stepping.State
    depths : pair of ndarray, or empty
        Permanent sets at the nodes [m].
    started : float
        Monotonic clock at the begin of the step [s].

    Returns
    -------
    figures : dict of str to number
    fields : dict of str to ndarray, shape (nx,)
    in_contact : ndarray of bool, shape (nx,)
    """
    s, model = scales, problem.model
    touching = model.in_contact(state.w, state.imbalance)
    fields = _fields(case, s, conditions, problem, state, touching)
    pressure, thickness = fields["pressure"], fields["film_thickness"]
    load, friction, film = (
        s.dx * pressure.sum(),
        s.dx * fields["shear_stress_slow"].sum(),
        mean_film(s, state.h),
    )
    figures = {
        "dt": state.dt or 0.0,
        "newton": state.newton,
        "retries": state.retries,
        "h_min": thickness.min(),
        "p_max": pressure.max(),
        "contacts": int(touching.sum()),
        "load": load,
        "load_error": abs(load / conditions.load - 1.0),
        "mass_error": mass_error(problem, state),
        "approach": state.h00 * s.h,
        "friction": friction,
        "friction_coefficient": friction / load,
        "film_central": film,
        "lambda_ratio": film / rq if rq else np.nan,
        "wall": clock.monotonic() - started,
    }
    if not problem.dry:
        figures |= _of_oil(fields, touching, model)
    if model.is_mixed:
        figures |= _of_solids(fields, touching, s, state.h < case.output.thin_film * model.boundary_film)
    if model.yields:
        volumes = [one.volume for one in state.sets]
        figures |= {"yielding": int(np.count_nonzero(state.depth)), "set_volume": sum(volumes)}
        fields |= dict(zip(("set_fast", "set_slow"), depths, strict=True))
    return figures, fields, touching


def _fields(case, s, conditions, problem, state, touching):
    """Fields in SI units, but for the permanent sets."""
    model = problem.model
    pressure = model.relations(state.q, state.w).pressure * s.p0
    thickness = s.h * (state.h if model.is_mixed else np.where(touching, model.bound, state.h))
    solids = model.contact_pressure(state.w) * s.p0
    # direct contact does not tell the solids' pressure from the oil's: there they carry what there is
    oil, carried = (pressure - solids, solids) if model.is_mixed else (pressure, pressure)
    void = np.zeros_like(pressure) if problem.dry else np.maximum(-state.q, 0.0)
    # the shear of a film that rounding left would be anything: there the solids rub
    rubbing = touching if model.is_mixed else state.h <= model.bound + model.near
    fast, slow = shear_stresses(case, s.dx, conditions.sliding, oil, carried, thickness, void, rubbing)
    return {
        "pressure": pressure,
        "contact_pressure": solids,
        "film_thickness": thickness,
        "void_fraction": void,
        "shear_stress_fast": fast,
        "shear_stress_slow": slow,
        "in_contact": touching,
    }


def _of_oil(fields, touching, model):
    """Its largest pressure, and films of molecules."""
    pressure = fields["pressure"]
    oil = pressure - fields["contact_pressure"] if model.is_mixed else np.where(touching, 0.0, pressure)
    molecular = ~touching & (fields["film_thickness"] < MOLECULES)
    return {"oil_pressure": oil.max(), "molecular_films": int(molecular.sum())}


def _of_solids(fields, touching, s, thin):
    """What the solids of mixed contact carry, and where films are thin."""
    load = s.dx * fields["pressure"].sum()
    return {
        "contact_share": s.dx * fields["contact_pressure"].sum() / load,
        "contact_length": s.dx * touching.sum(),
        "thin_length": s.dx * thin.sum(),
        "thin_share": s.dx * fields["pressure"][thin].sum() / load,
    }


def mean_film(scales, h):
    """Mean film [m] of the middle half of the Hertz contact; h in a^2/R."""
    middle = np.abs(scales.x) <= 0.5
    return float(h[middle].mean() * scales.h)


def mass_error(problem, state):
    r"""Oil that the solution loses or makes in a step, over what the contact carries through.

    :math:`\sum_{i\ge1}|F_i|` over the mean of :math:`\rho h(1-\theta)` on :math:`|x|\le a`, both times u: 0
    is a balance that holds at every node. Where direct contact leaves the Reynolds equation out, F is the oil
    that this makes; elsewhere, and everywhere in mixed contact, it is what Newton's tolerance leaves. (What
    is drawn in at the inlet is no measure: nearly all of the thick film there flows back.) The inlet node has
    no balance, its pressure or its oil is given.
    """
    if problem.dry:
        return 0.0
    made = problem.film_scale * np.abs(state.imbalance[1:]).sum()
    carried = state.m[np.abs(problem.x) <= 1.0].mean()
    return float(made / max(carried, ATOM / problem.scales.h))
