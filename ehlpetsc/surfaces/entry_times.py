"""Times at which roughness reaches the contact and fills it."""


def entry_times(profile, scales):
    """Travel of the faster surface [half widths] when a profile reaches and fills the contact.

    Parameters
    ----------
    profile : ehlpetsc.surfaces.profile.Profile
    scales : scales.Scales

    Returns
    -------
    reaches, fills : float
        Its first point at the near edge of the Hertz contact; its full heights, ramp included, at the far
        one. Of a lone ridge or dent `fills` is for its middle at x = 0. None where the profile lies
        under the domain from the start.
    """
    if not profile.enters:
        return None
    edge = -1.0 - scales.x[0] if profile.speed > 0 else scales.x[-1] - 1.0
    first, last = profile.X[0] / scales.a, profile.X[-1] / scales.a
    slower = scales.u_max / abs(profile.speed)
    if not profile.repeats:
        return (edge + first) * slower, (edge + 1.0 + 0.5 * (first + last)) * slower
    return edge * slower, (edge + 2.0 + profile.ramp / scales.a) * slower


def entry_warnings(case, scales, rough):
    """Warnings of profiles that do not fill the contact before the end of the run, one line each.

    Parameters
    ----------
    case : case.loading.Case
    scales : scales.Scales
    rough : ehlpetsc.surfaces.roughness.Roughness or None
    """
    notes = []
    for side in ("1", "2"):
        profile = rough and rough.side(side)
        arrives = profile and entry_times(profile, scales)
        if not arrives or case.time.travel >= arrives[1]:
            continue
        reaches, fills = arrives
        ends = f"surface.{side}: the run ends at time.travel = {case.time.travel:g}, before"
        if case.time.travel < reaches:
            notes.append(f"{ends} the profile reaches the contact ({reaches:.2f}): it stays smooth there")
        elif profile.repeats:
            notes.append(f"{ends} the profile fills the contact ({fills:.2f})")
        else:
            notes.append(f"{ends} the middle of the profile is at x = 0 ({fills:.2f})")
    return notes
