"""What to know of a case before it runs, gathered: solids, motion, domain, profiles."""

from ehlpetsc.run.preview.domain import domain_warnings
from ehlpetsc.surfaces.arrival import arrival_warnings
from ehlpetsc.surfaces.mesh_fit import mesh_warnings
from ehlpetsc.surfaces.roughness import Roughness

SOFT = 0.25  # of p0: solids softer than that flow as a whole


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
