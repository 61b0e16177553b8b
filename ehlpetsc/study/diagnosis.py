"""Diagnosis of a run that did not converge, in terms of the contact."""

import math

import numpy as np

from ehlpetsc.case.loading import load
from ehlpetsc.errors import ExitStatus
from ehlpetsc.physics.film_formulas import (
    expected_film,
    inlet_opening,
    moes_central_film,
    points_for_opening,
)
from ehlpetsc.physics.rheology import viscosity
from ehlpetsc.physics.scales import Scales
from ehlpetsc.study.runs import TIMED_OUT

SOLID_OIL = 50.0  # ln(eta/eta0) above which oil does not flow during any contact
ASPERITY_YIELD = 6.0  # GPa: pressure at which asperities of hardened steel yield
MAX_FILM_SLOPE = 1.0  # films by which the gap may open within one node


def diagnosis(outcome, path, overrides):
    """Line with properties of the contact that explain the failure, then the message of the solver.

    Parameters
    ----------
    outcome : runs.Outcome
    path : path-like
    overrides : sequence of str
    """
    if outcome.status == TIMED_OUT:
        return f"stopped by the time limit after {outcome.steps} steps and {outcome.retries} halved ones"
    if outcome.status in (ExitStatus.BAD_INPUT, ExitStatus.BUG):
        return outcome.message
    case = load(path, overrides)
    scales = Scales.of(case)
    findings = _findings(outcome, case, scales)
    return "; ".join([*findings, f"solver: {outcome.message}"])


def _findings(outcome, case, scales):
    findings = []
    hertz = float(viscosity(np.array([scales.p0]), case.fluid)[0][0]) if case.fluid else 0.0
    if case.fluid:
        findings += _too_coarse(case, scales)
        film = scales.h * expected_film(case, scales)
        if film > scales.a:
            findings.append(
                f"the expected film, {1e6 * film:.2g} um, is thicker than Hertz' half width, "
                f"{1e6 * scales.a:.2g} um: the solids hardly deform, the domain is too small"
            )
    if hertz > SOLID_OIL:
        decades = hertz / math.log(10)
        findings.append(f"the oil is solid at Hertz pressure (10^{decades:.0f} times its ambient viscosity)")
    if outcome.p_max > ASPERITY_YIELD * 1e9:
        findings.append(
            f"asperity pressures reached {1e-9 * outcome.p_max:.1f} GPa, beyond what steel carries"
        )
    if outcome.h_min < 1e-9 and outcome.steps:
        findings.append(f"the film fell to {1e9 * outcome.h_min:.2g} nm before solids touched")
    return findings


def _too_coarse(case, scales):
    """Finding of a mesh that is too coarse for the inlet."""
    film = moes_central_film(scales.moes_m, scales.moes_l) * math.pi / (8.0 * scales.moes_m)
    opening = inlet_opening(film, case.mesh.points_per_half_width)
    if opening < MAX_FILM_SLOPE:
        return []
    return [
        f"the mesh is too coarse for so thin a film: beside the contact the gap opens by {opening:.1f} "
        f"films from one node to the next; try mesh.points_per_half_width="
        f"{math.ceil(points_for_opening(film, MAX_FILM_SLOPE))}"
    ]
