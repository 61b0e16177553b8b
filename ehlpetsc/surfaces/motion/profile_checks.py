"""Checks of profiles: units, resolution by the mesh, times at which they reach and fill the contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.counts import whole_up
from ehlpetsc.surfaces.topography import WAVE_NODES

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.motion.roughness import Roughness, RoughSurface
    from ehlpetsc.surfaces.topography import Topography

MAX_SPACING = 0.25  # half-widths between two points: wider than asperities
MAX_RQ = 0.1  # half-widths
MAX_RQ_RATIO = 30.0  # Rq over the elastic approach a^2/R, or over the film
MAX_SLOPE = 1.0  # root mean square
SMALLEST_RQ = 1e-9  # m, of measured roughness: that of finest polish, and of ground steel in nm for um
USUAL_SPACING, USUAL_RQ = 100e-6, 100e-6  # m, at most
OTHER_SPACING = "is x in another unit, x_unit or unit, or spacing not in m?"
OTHER_HEIGHTS = 'are the heights in another unit, unit = "mm", "um" or "nm", or is level or form needed?'


def absurd(surface: Topography, a: float, across: float, approach: float, film: float) -> str | None:
    """Message on a profile or map that is implausible for a contact, mostly by a wrong unit; None: plausible.

    `a`, `across`: half-width along x, and across, of a strip its width [m].
    `approach`, `film`: a^2/R and expected film [m].
    """
    beside = f" beside a half-width of {_um(a)}"
    fault = _implausible(
        surface,
        (MAX_SPACING * a, MAX_SPACING * across),
        min(MAX_RQ * a, MAX_RQ_RATIO * max(approach, film)),
        (beside, f"{beside}, a^2/R of {_um(approach)}, a film of {_um(film)}"),
    )
    return fault and "{}: not a surface of this contact; {}".format(*fault)


def doubts(surface: Topography) -> list[str]:
    """Warning of a profile or map whose spacings or heights are hardly those of roughness, a line or none."""
    fault = _implausible(surface, (USUAL_SPACING, USUAL_SPACING), USUAL_RQ) or _too_smooth(surface)
    return ["warning: {}, hardly roughness: {}".format(*fault)] if fault else []


def smooth_warnings(rough: Roughness) -> list[str]:
    """Warnings of measured surfaces whose heights are too low, mostly by a wrong unit."""
    faults = {
        side: _too_smooth(profile.given) for side, profile in rough.sides.items() if profile.given.measured
    }
    return [
        "surface.{}: {}, hardly roughness: {}".format(side, *fault) for side, fault in faults.items() if fault
    ]


def _too_smooth(surface: Topography) -> tuple[str, str] | None:
    """Words on an Rq of other than equal heights that is below that of roughness, as :func:`_implausible`."""
    rq = float(surface.z.std())
    return (f"Rq {_um(rq)}", OTHER_HEIGHTS) if 0.0 < rq < SMALLEST_RQ else None


def _implausible(
    surface: Topography, spacings: tuple[float, float], rq: float, beside: tuple[str, str] = ("", "")
) -> tuple[str, str] | None:
    """Words on a spacing along or across, an Rq or a slope above its limit, and a question on its cause.

    `spacings`, `rq`: limits [m].
    `beside`: words on the scales of the contact, behind a spacing and behind an Rq.
    """
    for spacing, limit in zip(surface.spacings, spacings, strict=False):
        if spacing > limit:
            return f"points {_um(spacing)} apart{beside[0]}", OTHER_SPACING
    if (found := float(surface.z.std())) > rq:
        return f"Rq {_um(found)}{beside[1]}", OTHER_HEIGHTS
    slope = surface.rms_slope
    return (f"slopes of {slope:.3g} in the root mean square", OTHER_HEIGHTS) if slope > MAX_SLOPE else None


def _um(length: float) -> str:
    return f"{1e6 * length:.3g} um"


MAX_UNRESOLVED = 0.01  # of the height variance: more in unresolved wavelengths causes a warning


def mesh_warnings(rough: Roughness | None, scales: Scales, limit: float = MAX_UNRESOLVED) -> list[str]:
    """Messages on surfaces of which the mesh does not resolve more than a share of the height variance."""
    notes, spacings = [], scales.grid.spacings[::-1]
    shortest = " x ".join(f"{1e6 * WAVE_NODES * spacing:.2f}" for spacing in dict.fromkeys(spacings))
    for side, profile in (rough.sides if rough else {}).items():
        fraction = profile.given.unresolved_variance(*spacings)
        if fraction > limit:
            kind = "map" if len(spacings) > 1 else "profile"
            notes.append(
                f"surface.{side}: the mesh is too coarse for the {kind}: {100 * fraction:.1f} % of its "
                f"height variance lies in wavelengths under {WAVE_NODES} nodes ({shortest} um); "
                f"points_per_half_width = {_needed_points(profile, scales, limit)} brings that under "
                f"{100 * limit:.0f} %"
            )
    return notes


def step_warnings(
    case: Case, rough: Roughness, scales: Scales, varies: bool, limit: float = MAX_UNRESOLVED
) -> list[str]:
    """Warnings of time steps of more than a node in which roughness passes, or conditions vary, too fast.

    `varies`: whether the conditions do.
    """
    courant = case.time.courant if case.time and case.fluid else 0.0
    if courant <= 1.0:
        return []
    notes = []
    for side, profile in rough.sides.items():
        in_step = abs(profile.speed) * scales.dt
        fraction, shorter = profile.given.unresolved_variance(in_step), courant
        while shorter > 1.0 and profile.given.unresolved_variance(in_step * shorter / courant) > limit:
            shorter = max(0.8 * shorter, 1.0)
        if fraction > limit:
            notes.append(
                f"surface.{side}: {100 * fraction:.0f} % of its height variance lies in waves that pass in "
                f"fewer than {WAVE_NODES} time steps, in which the film follows them too little; "
                f"time.courant = {shorter:.2g}"
            )
    if varies:
        notes.append(
            f"time.courant = {courant:g}: with moving roughness under conditions that vary, the film comes "
            f"out as on a mesh {courant:.3g} times coarser; time.courant = 1"
        )
    return notes


def _needed_points(profile: RoughSurface, scales: Scales, limit: float) -> int | list[int]:
    """Nodes per half-width that leave at most a share `limit` of the height variance unresolved.

    Two, along and across, where the spacings of a plane differ; both are then reduced by one factor.
    """
    spacings, half_widths = scales.grid.spacings[::-1], (scales.a, scales.b)
    factor = 1.0
    while profile.given.unresolved_variance(*(spacing / factor for spacing in spacings)) > limit:
        factor *= 1.1
    needed = [
        whole_up(factor * (size if np.isfinite(size) else scales.a) / spacing)
        for size, spacing in zip(half_widths, spacings, strict=False)
    ]
    return needed[0] if np.ptp(spacings) < 1e-9 * spacings[0] else needed


def entry_times(profile: RoughSurface, scales: Scales) -> tuple[float, float] | None:
    """Travel of the faster surface [half-widths] when a profile reaches and fills the contact.

    Its first point is then at the near edge of the Hertz contact; its full heights, ramp included, at the far
    one or, of a lone ridge or dent, its middle at x = 0. None where the profile lies under the domain from
    the start.
    """
    if not profile.enters:
        return None
    edge = -1.0 - scales.x[0] if profile.speed > 0 else scales.x[-1] - 1.0
    first, last = profile.X[0] / scales.a, profile.X[-1] / scales.a
    slower = scales.u_max / abs(profile.speed)
    if not profile.repeats:
        return (edge + first) * slower, (edge + 1.0 + 0.5 * (first + last)) * slower
    return edge * slower, (edge + 2.0 + profile.ramp / scales.a) * slower


def entry_warnings(case: Case, scales: Scales, rough: Roughness | None) -> list[str]:
    """Warnings of profiles that do not fill the contact before the end of the run, one line each."""
    notes = []
    for side, profile in (rough.sides if rough else {}).items():
        arrives = entry_times(profile, scales)
        if not arrives or case.time.travel >= arrives[1]:
            continue
        event, time = "fills" if profile.repeats else "is with its middle in the centre of", arrives[1]
        if case.time.travel < arrives[0]:
            event, time = "reaches", arrives[0]
        notes.append(
            f"surface.{side}: the run ends at time.travel = {case.time.travel:g}, before the profile {event} "
            f"the contact ({time:.2f})"
        )
    return notes
