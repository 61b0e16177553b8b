"""Heading of a run, and its default number of ranks."""

import os

from ehlpetsc import __version__
from ehlpetsc.run.preview.forecast import steps
from ehlpetsc.run.preview.surfaces import lambda_line, surface_lines

MIN_NODES_OF_TWO_RANKS = 8000  # with fewer, two ranks gain little on a quiet machine and lose on a busy one


def banner(case, scales, rough, ranks):
    """Heading of a run in a few lines: title, size, surfaces.

    Parameters
    ----------
    case : case.loading.Case
    scales : scales.Scales
    rough : roughness.Roughness or None
    ranks : int

    Returns
    -------
    list of str
    """
    length = f"{steps(scales)} steps of {1e9 * scales.dt:.2f} ns" if case.time else "steady"
    return [
        f"ehlpetsc {__version__}: {case.title}",
        f"{scales.nx} nodes, {2 * scales.nx + 1} unknowns, {length}; {ranks} rank{'s' * (ranks > 1)}; "
        f"a = {1e3 * scales.a:.4f} mm, p0 = {1e-9 * scales.p0:.4f} GPa",
        *(surface_lines(case, scales, rough) if rough else []),
        *lambda_line(case, scales, rough),
        *_note_on_ranks(scales, ranks),
    ]


def worthwhile_ranks(case):
    """Default number of ranks: two for a series, and for a large mesh if two cores are idle; else one."""
    is_large = case.mesh.nodes >= MIN_NODES_OF_TWO_RANKS
    return 2 if case.series or (is_large and idle_cores() >= 2) else 1


def idle_cores():
    """Idle cores of this process, mean over the last minute."""
    return round(len(os.sched_getaffinity(0)) - os.getloadavg()[0])


def _note_on_ranks(scales, ranks):
    if ranks == 1 or scales.nx >= MIN_NODES_OF_TWO_RANKS:
        return []
    return [
        f"note: at {scales.nx} nodes a second rank saves two fifths of the time at most, on idle cores; "
        "the members of a series gain from ranks at any size"
    ]
