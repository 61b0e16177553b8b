"""What is to be expected of a case before it runs: film, run time, file size."""

import math

from ehlpetsc.physics import film_formulas
from ehlpetsc.quantities import FIELDS, STEP_SCALARS, of_case
from ehlpetsc.results.hdf5.datasets import CHUNK_BYTES, CHUNK_STEPS

# measured on one rank: seconds a time step takes in full film, as such and for each node
STEP_TIME, NODE_TIME = 2.0e-3, 2.0e-6
MIXED_FACTOR = 2.0  # times that where asperities squeeze the film to nothing
FULL_FILM = 3.0  # lambda ratio from which on they do not
STEADY_STEPS = 20  # what a steady solution takes, in time steps


def dowson_higginson(scales, alpha):
    """Minimum film of the smooth line contact [m], after `ehlpetsc.physics.film_formulas.dowson_higginson`.

    Parameters
    ----------
    scales : scales.Scales
    alpha : float
        Pressure-viscosity coefficient [1/Pa].
    """
    speed = scales.eta0 * scales.u / (scales.E * scales.R)
    load = scales.load / (scales.E * scales.R)
    return scales.R * film_formulas.dowson_higginson(speed, alpha * scales.E, load)


def lambda_ratio(case, s, rough):
    """Expected smooth film over the combined root mean square height."""
    film = dowson_higginson(s, case.fluid.pressure_viscosity)
    return film / rough.rq if rough.rq > 0 else math.inf


def run_time(case, s, rough):
    """Expected wall clock time on one rank [s], an order of magnitude."""
    seconds = (steps(s) if case.time else STEADY_STEPS) * (STEP_TIME + NODE_TIME * s.nx)
    mixed = rough and (case.fluid is None or lambda_ratio(case, s, rough) < FULL_FILM)
    return MIXED_FACTOR * seconds if mixed else seconds


def steps(s):
    """Time steps of a transient case, none of them halved."""
    return math.ceil(s.duration / s.dt - 1e-9)


def file_size(case, s):
    """Expected size of the result file [bytes]: whole chunks; flags of contact pack to nothing."""
    value = 8 if case.output.precision == "float64" else 4
    count = steps(s) if case.time else 0
    frames, rows = count // case.output.every + 1, max(1, CHUNK_BYTES // (s.nx * value))
    stored = set(case.output.fields) & set(of_case(FIELDS, case))
    fields = sum(FIELDS[name].dtype == "f8" for name in stored)
    scalars = len(of_case(STEP_SCALARS, case)) * 8 * CHUNK_STEPS * math.ceil((count + 1) / CHUNK_STEPS)
    return fields * value * s.nx * rows * math.ceil(frames / rows) + scalars
