"""Fields in SI units and scalars of an accepted time level."""

import time as clock

import numpy as np

from ehlpetsc.discretisation.contact.node_state import SurfaceLoads
from ehlpetsc.discretisation.ehl_problem import EHLProblem, Solution
from ehlpetsc.effects.effect import Effect, Scene, Step
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.physics.scales import Scales
from ehlpetsc.physics.traction import shear_stresses
from ehlpetsc.stepping.state import State

MIN_CONTINUUM_FILM = 1e-9  # m: thinner films are one or two molecules of oil
MIN_BALANCE_FILM = 1e-10  # m, size of an atom: smallest reference film of the mass error


def diagnostics(
    scene: Scene, problem: EHLProblem, effects: list[Effect], state: State, started: float
) -> tuple[dict, dict, np.ndarray]:
    """Scalars of the step, fields and mask of the nodes in contact, in SI units.

    `started` is the monotonic clock at the beginning of the step [s].
    """
    case, s, rq, conditions = scene.case, scene.scales, scene.rq, scene.operation.at(state.time)
    solution, loads = state.solution, state.solution.loads
    shear = None
    for effect in effects:
        if effect.is_in(case):
            shear = effect.film_shear(state.records[effect.name], solution, shear)
    fields, contact_mask = _fields(scene, conditions, solution, shear), loads.contact_mask
    pressure, thickness = fields["pressure"], fields["film_thickness"]
    size = s.size(conditions)
    load, film = s.grid.cell_size * pressure.sum(), mean_film(s, solution.nodes.film, size)
    friction_1, friction_2 = (s.grid.cell_size * fields[f"shear_stress_{side}"].sum() for side in ("1", "2"))
    smooth_film = smooth_films(s, case.fluid, conditions)[1] if case.fluid else np.nan
    scalars = {
        "dt": state.dt or 0.0,
        "newton": state.newton,
        "retries": state.retries,
        "h_min": thickness.min(),
        "p_max": pressure.max(),
        "contacts": int(contact_mask.sum()),
        "load": load,
        "load_error": abs(load / conditions.load - 1.0),
        "mass_error": mass_error(problem, solution, size),
        "approach": solution.unknowns.h00 * s.h,
        "friction": friction_2,
        "friction_1": friction_1,
        "friction_coefficient": 0.5 * abs(friction_2 - friction_1) / load,
        "film_central": film,
        "lambda_ratio": smooth_film / rq if rq else np.nan,
        "mean_gap_ratio": film / rq if rq else np.nan,
        "wall": clock.monotonic() - started,
    }
    if case.conditions is not None:
        scalars |= {"load_given": conditions.load, "radius": conditions.radius}
        scalars |= {"speed_1": conditions.u1, "speed_2": conditions.u2}
        scalars |= dict(zip(("displacement_1", "displacement_2"), state.travelled, strict=True))
    if problem.fluid is not None:
        scalars |= _of_oil(loads, s)
    scalars |= problem.model.diagnostics(loads, s, case.output.thin_film)
    step = Step(state.time, state.dt, state.travelled, conditions)
    for effect in effects:
        if effect.is_in(case):
            effect_fields, effect_scalars = effect.observe(state.records[effect.name], solution, step)
            fields, scalars = fields | effect_fields, scalars | effect_scalars
    return scalars, fields, contact_mask


def _fields(scene: Scene, conditions: Conditions, solution: Solution, shear: np.ndarray | None) -> dict:
    """Fields in SI units that every case has."""
    s, loads, fluid = scene.scales, solution.loads, solution.inputs.fluid
    void = np.zeros(s.grid.n) if fluid is None else np.maximum(-solution.nodes.reynolds_unknown, 0.0)
    sheared = np.where(loads.sheared_oil, 1.0 - void, 0.0)
    oil, solids, film = loads.oil_pressure * s.p0, loads.friction_pressure * s.p0, loads.film * s.h
    rubbing, rows = solution.inputs.boundary_friction * solids, s.grid.rows
    gradient = np.gradient(rows(oil), s.dx, axis=-1).ravel()
    shear_1, shear_2 = shear_stresses(fluid, rubbing, gradient, conditions.sliding, oil, film, sheared, shear)
    return {
        "pressure": loads.pressure * s.p0,
        "contact_pressure": loads.contact_pressure * s.p0,
        "film_thickness": film,
        "void_fraction": void,
        "shear_stress_1": shear_1,
        "shear_stress_2": shear_2,
        "in_contact": loads.contact_mask,
    }


def _of_oil(loads: SurfaceLoads, s: Scales) -> dict:
    """Maximum pressure of the oil, and number of nodes with less than 1 nm of oil."""
    oil = np.where(loads.oil_mask, loads.oil_pressure, 0.0) * s.p0
    thin = ~loads.contact_mask & (loads.film * s.h < MIN_CONTINUUM_FILM)
    return {"oil_pressure": oil.max(), "nodes_below_1nm": int(thin.sum())}


def mean_film(scales: Scales, h: np.ndarray, size: float) -> float:
    """Mean film [m] of the middle half of the Hertz contact of the instant.

    `h`: film in a^2/R. `size`: of the contact of the instant over that of the widest contact of the run.
    """
    middle = scales.grid.inside(0.5 * size)
    return float(h[middle].mean() * scales.h)


def mass_error(problem: EHLProblem, solution: Solution, size: float) -> float:
    r"""Mass defect of a step over the mass that the contact carries.

    :math:`\sum_{i\ge1}|F_i|` over the mean of :math:`\rho h(1-\theta)` in the Hertz contact, `size` its
    size at the instant over that of the scales, both times u: 0 where mass is conserved at every node. At
    contact nodes of direct contact, F is the mass that is not conserved; at other nodes, and at all nodes in
    mixed contact, it is the residual of Newton's method. (The mass flow at the inlet is no reference: nearly
    all of the thick film there flows back.) The inlet node has no balance: its pressure or its oil film is
    prescribed.
    """
    if problem.fluid is None:
        return 0.0
    grid = problem.grid
    defect = problem.film_scale * np.abs(grid.rows(solution.residual)[:, 1:]).sum()
    carried = solution.mass[grid.inside(size)].mean()
    return float(defect / (max(carried, MIN_BALANCE_FILM / problem.scales.h) * grid.breadth))
