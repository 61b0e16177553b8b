"""The scene of a case in words, and what to know before it runs."""

import math
import tomllib

from ehlpetsc import __version__
from ehlpetsc.case.loading import members
from ehlpetsc.case.sweep import combinations, keys_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.domain import domain_faults, domain_warnings
from ehlpetsc.run.forecast import FULL_FILM, dowson_higginson, file_size, lambda_ratio, run_time, steps
from ehlpetsc.surfaces.arrival import arrival, arrival_warnings
from ehlpetsc.surfaces.mesh_fit import mesh_warnings
from ehlpetsc.surfaces.roughness import Roughness

SOFT = 0.25  # of p0: solids softer than that flow as a whole
WORTH_TWO_RANKS = 2000  # nodes: 801 took two ranks as long as one, 3,201 0.8 to 0.9 of it


def explain(case):
    """The scene in words: figures, size, what is switched off.

    Parameters
    ----------
    case : case.loading.Case

    Returns
    -------
    str
        Several lines.

    Raises
    ------
    profiles.ProfileError
    """
    scales = Scales.of(case)
    rough = Roughness.of(case, scales)
    sections = [
        [case.title],
        _contact(scales),
        _film(case, scales, rough),
        _motion(case, scales),
        _surfaces(case, scales, rough),
        _heights(rough, scales),
        _size(case, scales, rough),
        _switched_off(case, rough),
        [f"Warning: {line}" for line in warnings(case, scales)],
        [f"Refused: {line}" for line in domain_faults(case, scales)],
    ]
    if case.series:
        sections.insert(1, _series(case))
    return "\n".join(line for section in sections for line in section)


def banner(case, scales, rough, ranks):
    """What is about to run, in a few lines: title, size, surfaces.

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
        *(_surfaces(case, scales, rough) if rough else []),
        *_ranks_for_nothing(scales, ranks),
    ]


def worthwhile_ranks(case):
    """Ranks that a case is worth where nobody says how many: two for a series or a large mesh, else one."""
    return 2 if case.series or case.mesh.nodes >= WORTH_TWO_RANKS else 1


def _ranks_for_nothing(scales, ranks):
    if ranks == 1 or scales.nx >= WORTH_TWO_RANKS:
        return []
    return [
        f"note: one rank would be about as quick: at {scales.nx} nodes exchanging vectors costs what more "
        "cores save; the members of a series gain from ranks at any size"
    ]


def warnings(case, scales):
    """What a user should know before the run, one line each.

    Parameters
    ----------
    case : case.loading.Case
    scales : scales.Scales
    """
    rough = [f"surface.{name}" for name in ("fast", "slow") if getattr(case.surface, name)]
    notes = []
    if case.contact.yield_pressure and min(case.contact.yield_pressure) < SOFT * scales.p0:
        notes.append(
            f"contact.yield_pressure = {1e-9 * min(case.contact.yield_pressure):g} GPa is below a quarter of "
            f"Hertz' {1e-9 * scales.p0:.3g} GPa: the solids yield as a whole, which no half space tells"
        )
    if rough and case.time is None and case.motion is not None:
        notes.append(
            f"{' and '.join(rough)} with [motion] but without [time]: "
            "the roughness is held still under the film; add [time] to let it move"
        )
    profiles = Roughness.of(case, scales)
    notes += domain_warnings(case, scales)
    return notes + arrival_warnings(case, scales, profiles) + mesh_warnings(profiles, scales)


def _contact(s):
    return [
        f"Contact: radius {s.R:g} m, load {s.load:g} N/m, reduced modulus {s.E / 1e9:.4f} GPa",
        f"Hertz: half width a = {s.a * 1e3:.6f} mm, maximum pressure p0 = {s.p0 / 1e9:.6f} GPa",
    ]


def _film(case, s, rough):
    if case.fluid is None:
        return ["Film: none, dry contact"]
    h_min = dowson_higginson(s, case.fluid.pressure_viscosity)
    lines = [
        f"Film: {case.fluid.law} viscosity, {s.eta0:g} Pa s at ambient pressure; Moes M = {s.moes_m:.2f}, "
        f"L = {s.moes_l:.2f}",
        f"Expected smooth minimum film (Dowson & Higginson): {h_min * 1e6:.3g} um",
    ]
    if rough and rough.rq > 0:
        ratio = lambda_ratio(case, s, rough)
        lines.append(
            f"Lambda ratio: {ratio:.2g} "
            f"(that film over the combined Rq, {rough.rq * 1e6:.3f} um): {_regime(ratio)}"
        )
    return lines


def _regime(ratio):
    """Usual reading of the lambda ratio, e.g. Johnson, Greenwood & Poon (1972)."""
    if ratio > FULL_FILM:
        return "full film"
    return "mixed lubrication, contact possible" if ratio > 1 else "mixed lubrication, contact likely"


def _motion(case, s):
    if case.motion is None:
        return ["Motion: none"]
    line = f"Motion: mean {s.u:g} m/s, slide/roll ratio {s.xi:g}; fast {s.u1:g} m/s, slow {s.u2:g} m/s"
    if case.time is None:
        return [line, "Time: steady"]
    return [
        line,
        f"Time: the faster surface moves {case.time.travel:g} a = {s.u_max * s.duration * 1e3:.3f} mm in "
        f"{s.duration * 1e3:.4f} ms, {steps(s)} steps of {s.dt * 1e9:.2f} ns",
    ]


def _surfaces(case, s, rough):
    lines = []
    for side in ("fast", "slow"):
        profile = rough and getattr(rough, side)
        told = _profile(case, s, profile) if profile else ["smooth"]
        lines += [f"Surface {side}: {line}" for line in told]
    return lines


def _profile(case, s, profile):
    """Size, roughness and travel of one profile, a line each."""
    given = profile.given
    film = dowson_higginson(s, case.fluid.pressure_viscosity) if case.fluid else None
    ratio = f", lambda ratio {film / profile.rq:.2g}" if film and profile.rq > 0.0 else ""
    lines = [
        f"Ra {profile.ra * 1e6:.4f} um, Rq {profile.rq * 1e6:.4f} um, Rsk {profile.rsk:.3f}{ratio}",
        *given.notes,
    ]
    if given.measured:
        size = f"{1e3 * given.length:.4g} mm long, {given.X.size} points {1e6 * given.spacing:.4g} um apart"
        lines.insert(1, size)
        if profile.travelled > given.length:
            lines.append(f"continues mirrored: {1e3 * profile.travelled:.4g} mm of it are drawn in")
    arrives = arrival(profile, s)
    if arrives:
        reaches, fills = arrives
        then = "and fills it" if profile.repeats else "and stands with its middle at x = 0"
        lines.append(f"reaches the contact at travel {reaches:.2f} a {then} at {fills:.2f} a")
    return lines


def _heights(rough, s):
    """Valleys and peaks of the profiles beside those that the mesh is given."""
    for side in ("fast", "slow"):
        profile = rough and getattr(rough, side)
        if profile:
            given = profile.heights.min(), profile.heights.max()
            given, seen = (
                " to ".join(f"{1e6 * round(z, 12):.3g}" for z in pair)
                for pair in (given, profile.extremes_of_cells(s.dx))
            )
            about = "means over cells, as the mesh has them"
            yield f"Surface {side}: heights from {given} um; {about}, {seen} um"


def _size(case, s, rough):
    seconds = run_time(case, s, rough)
    return [
        f"Mesh: {s.nx} nodes from {s.x[0]:g} to {s.x[-1]:g} a, spacing {s.dx * 1e6:.3f} um; "
        f"{2 * s.nx + 1} unknowns",
        f"Expected run time on one rank: {_duration(seconds)}; result file: {_bytes(file_size(case, s))}",
    ]


def _series(case):
    """The members of a series and what they take together."""
    series = tomllib.loads(case.text)["series"]
    shown = "; ".join(
        f"{key} = {', '.join(map(str, values))}"
        for key, values in zip(keys_of(series), zip(*combinations(series), strict=True), strict=True)
    )
    seconds = size = 0.0
    for _, member in members(case):
        scales = Scales.of(member)
        seconds += run_time(member, scales, Roughness.of(member, scales))
        size += file_size(member, scales)
    return [
        f"A series: {shown}; below, the base case.",
        f"All members on one rank: {_duration(seconds)}, result files: {_bytes(size)}",
    ]


def _switched_off(case, rough):
    fluid = case.fluid
    off = {
        "Reynolds equation (no [fluid])": fluid is None,
        "time (no [time])": case.time is None,
        "roughness (no [surface])": not rough,
        "Eyring stress (Newtonian)": fluid and fluid.eyring_stress is None,
        "compressibility": fluid and fluid.density == "incompressible",
        "starvation (fully flooded inlet)": fluid and fluid.inlet_film is None,
        "boundary friction at dry nodes": case.contact.boundary_friction == 0.0,
    }
    return ["Switched off: " + (", ".join(name for name, is_off in off.items() if is_off) or "nothing")]


def _duration(seconds):
    for limit, unit, size in ((90, "s", 1), (5400, "min", 60)):
        if seconds < limit:
            return f"about {max(seconds / size, 1):.0f} {unit}"
    return f"about {seconds / 3600:.1f} h"


def _bytes(count):
    for unit, size in (("GB", 1e9), ("MB", 1e6)):
        if count >= size:
            return f"about {count / size:.1f} {unit}"
    return f"about {math.ceil(count / 1e3)} kB"
