"""Forecast of film, run time and file size of a case."""

import math
import time as clock
from functools import cache

import numpy as np

from ehlpetsc.physics import film_formulas
from ehlpetsc.quantities import FIELDS, STEP_SCALARS, of_case
from ehlpetsc.results.hdf5.datasets import CHUNK_BYTES, CHUNK_STEPS
from ehlpetsc.surfaces.entry_times import entry_times

# time of a Newton iteration on one rank over that of `probe`: constant part and part for each node, measured
# side by side on 141 to 2661 nodes; a step takes the time of its iterations and of one more
ITERATION_PROBES, NODE_PROBES = 0.105, 6.7e-5
# Newton iterations a step: before roughness enters, with roughness in full film, in mixed lubrication
SMOOTH_ITERATIONS, FILM_ITERATIONS, MIXED_ITERATIONS = 1.6, 2.5, 4.5
PROBE_OPERATIONS = 3000
START_PROBES = 70.0  # time of imports and of loading compiled loops, over that of `probe`
FULL_FILM = 3.0  # lambda ratio above which lubrication is full film
STEADY_ITERATIONS = 20  # Newton iterations of a steady solution


def lambda_ratio(case, s, rough):
    """Expected smooth minimum film over the combined root mean square height."""
    film = film_formulas.smooth_films(case.fluid, s.E, s.conditions)[1]
    return film / rough.rq if rough.rq > 0 else math.inf


def run_time(case, s, rough):
    """Expected wall clock time of all passes on one rank of this machine at its current load [s]."""
    return begin_time() + work_time(case, s, rough)


def begin_time():
    """Wall clock time before the first iteration, once for a series [s]."""
    return START_PROBES * probe()


def work_time(case, s, rough):
    """Wall clock time of the iterations [s]."""
    solves, passes = (steps(s), case.time.passes) if case.time else (1, 1)
    each = (ITERATION_PROBES + NODE_PROBES * s.nx) * probe()
    return passes * (iterations(case, s, rough) + solves) * each


def iterations(case, s, rough):
    """Expected Newton iterations of a run."""
    fraction = _rough_fraction(case, s, rough)
    mixed = rough and (case.fluid is None or lambda_ratio(case, s, rough) < FULL_FILM)
    each = (1.0 - fraction) * SMOOTH_ITERATIONS + fraction * (MIXED_ITERATIONS if mixed else FILM_ITERATIONS)
    return STEADY_ITERATIONS + (steps(s) if case.time else 0) * each


def _rough_fraction(case, s, rough):
    """Fraction of the steps after the first profile has reached the contact."""
    if not rough or case.time is None:
        return 0.0
    entries = [entry_times(profile, s) for profile in (rough.surface_1, rough.surface_2) if profile]
    first = min(times[0] if times else 0.0 for times in entries)
    return min(max(1.0 - first / case.time.travel, 0.0), 1.0)


@cache
def probe():
    """Time of `PROBE_OPERATIONS` small array operations, as in a time step, on this machine [s]."""
    return sorted(_timed_operations() for _ in range(3))[1]


def _timed_operations():
    small = np.linspace(0.0, 1.0, 400)
    begun = clock.perf_counter()
    for k in range(PROBE_OPERATIONS):
        other = small * 0.5 + small
        other[3:30] = other[2:29]
        float(np.fft.rfft(other)[k % 200].real if k % 4 == 0 else other.max())
    return clock.perf_counter() - begun


def steps(s):
    """Number of time steps of a transient case without halved steps."""
    return math.ceil(s.duration / s.dt - 1e-9)


def file_size(case, s):
    """Expected size of the result file of a pass [bytes], in whole chunks; contact flags are compressed."""
    value = 8 if case.output.precision == "float64" else 4
    count = steps(s) if case.time else 0
    frames, rows = count // case.output.every + 1, max(1, CHUNK_BYTES // (s.nx * value))
    stored = set(case.output.fields) & set(of_case(FIELDS, case))
    fields = sum(FIELDS[name].dtype == "f8" for name in stored)
    scalars = len(of_case(STEP_SCALARS, case)) * 8 * CHUNK_STEPS * math.ceil((count + 1) / CHUNK_STEPS)
    return fields * value * s.nx * rows * math.ceil(frames / rows) + scalars
