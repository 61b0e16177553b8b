"""Before a run: heading, both surfaces, forecast of work, memory and file size."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.counts import whole_up
from ehlpetsc.base.quantities import FIELDS, STEP_SCALARS, of_case
from ehlpetsc.base.version import __version__
from ehlpetsc.effects.scene import combined_rq
from ehlpetsc.physics import film_formulas, operation_of
from ehlpetsc.results.writer import CHUNK_STEPS, frames_of_chunk

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.motion.roughness import Roughness, RoughSurface

FULL_FILM = 3.0  # lambda ratio above which lubrication is full film


class Iterations(NamedTuple):
    """Expected iterations of Newton's method of a kind of contact.

    `smooth`, `film`, `mixed`: of a step before roughness enters, with roughness in full film, in mixed
        lubrication. `start`: of a steady solution.
    """

    smooth: float
    film: float
    mixed: float
    start: float


ITERATIONS = {"line": Iterations(1.6, 2.5, 4.5, 20.0), "plane": Iterations(2.5, 3.75, 10.0, 25.0)}
"""By the solver, :func:`solver_of`."""


class Overhead(NamedTuple):
    """Work of an iteration and of a step besides that of its nodes, in nodes."""

    iteration: float
    step: float


OVERHEADS = {"line": Overhead(1600.0, 2400.0), "plane": Overhead(0.0, 6250.0)}
START_MEMORY, NODE_MEMORY = 230e6, 2.0e3  # at the start and for each node [bytes]
HEAT_MEMORY = 6.0e3  # for each node with temperatures [bytes]
POINT_MEMORY = 70  # of a measured map, while it is read, for each point [bytes]
COMPRESSED = 0.6  # of the size of the fields


def lambda_ratio(case: Case, s: Scales, rough: Roughness | None) -> float:
    """Expected smooth minimum film over the combined root mean square height."""
    film, rq = film_formulas.smooth_films(s, case.fluid, s.conditions)[1], combined_rq(case, rough)
    return film / rq if rq > 0 else math.inf


def solver_of(kind: str) -> str:
    """Name of the solver of a kind of contact."""
    return "plane" if KINDS[kind].is_areal else "line"


def work(kind: str, nodes: int, count: float, steps: float) -> float:
    """Work of so many iterations and steps; a node in an iteration of Newton's method is the unit."""
    overhead = OVERHEADS[solver_of(kind)]
    return count * (overhead.iteration + nodes) + steps * overhead.step


def expected_work(case: Case, s: Scales, rough: Roughness | None) -> float:
    """Work of all passes."""
    count, passes = (steps(case, s), case.time.passes) if case.time else (0, 1)
    return passes * work(case.kind, s.grid.n, iterations(case, s, rough), count)


def memory(s: Scales, rough: Roughness | None, is_heated: bool = False) -> float:
    """Expected memory of a run on one rank [bytes], while it reads the largest measured map or profile."""
    given = [surface.given for surface in (rough.sides.values() if rough else ())]
    points = max((samples.z.size for samples in given if samples.measured), default=0)
    of_node = NODE_MEMORY + (HEAT_MEMORY if is_heated else 0.0)
    return START_MEMORY + of_node * s.grid.n + POINT_MEMORY * points


def iterations(case: Case, s: Scales, rough: Roughness | None) -> float:
    """Expected Newton iterations of a pass."""
    fraction, expected = _rough_fraction(case, s, rough), ITERATIONS[solver_of(case.kind)]
    is_mixed = bool(rough) and (case.fluid is None or lambda_ratio(case, s, rough) < FULL_FILM)
    each = (1.0 - fraction) * expected.smooth + fraction * (expected.mixed if is_mixed else expected.film)
    return expected.start + (steps(case, s) if case.time else 0) * each


def _rough_fraction(case: Case, s: Scales, rough: Roughness | None) -> float:
    """Fraction of the steps after the first profile has reached the contact."""
    if not rough or case.time is None:
        return 0.0
    from ehlpetsc.surfaces.motion.profile_checks import entry_times

    entries = [entry_times(profile, s) for profile in (rough.surface_1, rough.surface_2) if profile]
    first = min(times[0] if times else 0.0 for times in entries)
    return min(max(1.0 - first / case.time.travel, 0.0), 1.0)


def steps(case: Case, s: Scales) -> int:
    """Number of time steps of a transient case without halved steps."""
    return operation_of(case, s).step_count(s.dt)


def step_text(case: Case, s: Scales) -> str:
    """Text of the number of time steps: a bound where their length follows from an error."""
    return f"{'at most ' * bool(case.time.tolerance)}{steps(case, s)} steps"


def file_size(case: Case, s: Scales) -> float:
    """Expected size of the result file of a pass [bytes], in whole chunks; contact flags take nothing."""
    value = 8 if case.output.precision == "float64" else 4
    count = steps(case, s) if case.time else 0
    frames, rows = count // case.output.every + 1, frames_of_chunk(s.grid.shape, value)
    stored = set(case.output.fields) & set(of_case(FIELDS, case))
    fields = sum(FIELDS[name].dtype == "f8" for name in stored)
    scalars = len(of_case(STEP_SCALARS, case)) * 8 * CHUNK_STEPS * math.ceil((count + 1) / CHUNK_STEPS)
    return COMPRESSED * fields * value * s.grid.n * rows * math.ceil(frames / rows) + scalars


def surface_lines(case: Case, s: Scales, rough: Roughness | None) -> list[str]:
    """Both surfaces: size, roughness and travel, a line each."""
    profiles = {side: rough and rough.side(side) for side in ("1", "2")}
    lines = {side: _profile(case, s, one) if one else ["smooth"] for side, one in profiles.items()}
    return [f"Surface {side}: {line}" for side in lines for line in lines[side]]


def lambda_line(case: Case, s: Scales, rough: Roughness | None) -> list[str]:
    """Conventional lambda ratio: minimum smooth film by formula over the combined Rq; [] if smooth or dry."""
    rq = combined_rq(case, rough)
    if case.fluid is None or rq <= 0.0:
        return []
    ratio = lambda_ratio(case, s, rough)
    mixed = f"mixed lubrication, contact {'possible' if ratio > 1 else 'likely'}"
    regime = "full film" if ratio > FULL_FILM else mixed  # Johnson, Greenwood & Poon (1972)
    return [
        f"Lambda ratio {ratio:.2g}: minimum smooth film {1e6 * ratio * rq:.3g} um over the combined "
        f"Rq {1e6 * rq:.3g} um, {regime}"
    ]


def _profile(case: Case, s: Scales, profile: RoughSurface) -> list[str]:
    """Size, roughness and travel of one surface, a line each."""
    from ehlpetsc.surfaces.motion.profile_checks import entry_times

    samples, times = profile.given, entry_times(profile, s)
    (mean, ra), (rms, rq), (skewness, rsk) = profile.statistics.items()  # Ra, Rq, Rsk or Sa, Sq, Ssk
    heights = f"{mean.capitalize()} {ra * 1e6:.4f} um, {rms.capitalize()} {rq * 1e6:.4f} um"
    lines = [f"{heights}, {skewness.capitalize()} {rsk:.3f}"]
    extent = [samples.extent_text] * samples.measured
    if KINDS[case.kind].is_areal and samples.is_ridge:
        extent.append("a profile: a ridge across the width")
    lines += ["; ".join(extent)] * bool(extent) + list(samples.notes)
    if samples.measured:
        if profile.travelled > samples.length:
            lines.append(f"continued by reflection: {1e3 * profile.travelled:.4g} mm enter during the run")
        if case.time is not None and times:
            lines += _part_in_contact(case, s, profile, times[0])
    if times:
        end = "and fills it" if profile.repeats else "and has its middle at x = 0"
        lines.append(f"reaches the contact at travel {times[0]:.2f} a {end} at {times[1]:.2f} a")
    return lines


def _part_in_contact(case: Case, s: Scales, profile: RoughSurface, reaches: float) -> list[str]:
    """Part of a measured profile that passes the whole contact, and the travel at which all of it has."""
    length, slower = profile.given.length, s.u_max / abs(profile.speed)
    through = s.a * (case.time.travel - reaches - 2.0 * slower) / slower
    if through >= length:
        return []
    needed = reaches + (2.0 + length / s.a) * slower
    part = "no part passes through the contact"
    if through > 0.0:
        part = f"0 to {1e3 * through:.3g} mm of {1e3 * length:.4g} mm pass through the contact, x = 0 first"
    return [f"{part}; the whole profile needs time.travel = {whole_up(needed)}"]


def banner(case: Case, scales: Scales, rough: Roughness | None, ranks: int) -> list[str]:
    """Heading of a run in a few lines: title, size, surfaces."""
    length = step_text(case, scales) if case.time else "steady"
    length += f" of {1e9 * scales.dt:.2f} ns" if case.time and not case.conditions else ""
    nodes, size = " x ".join(map(str, scales.grid.shape[::-1])), f"a = {1e3 * scales.a:.4f} mm"
    size += f", b = {1e3 * scales.b:.4f} mm" * math.isfinite(scales.b)
    return [
        f"ehlpetsc {__version__}: {case.title}",
        f"{nodes} nodes, {2 * scales.grid.n + 1} unknowns, {length}; {ranks} rank{'s' * (ranks > 1)}; "
        f"{size}, p0 = {1e-9 * scales.p0:.4f} GPa",
        *(surface_lines(case, scales, rough) if rough else []),
        *lambda_line(case, scales, rough),
    ]
