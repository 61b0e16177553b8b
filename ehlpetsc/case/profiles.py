"""Faults of the profile files of a case: unreadable, or implausible for its contact."""

from ehlpetsc.case.faults import show
from ehlpetsc.case.schema.validation import ValidationError
from ehlpetsc.case.tables.surface import SurfaceProfile
from ehlpetsc.errors import ProfileError
from ehlpetsc.names import FORMER, SIDES
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales
from ehlpetsc.surfaces.measured.plausibility import absurd, likely_unit
from ehlpetsc.surfaces.samples import layout_of, samples


def profile_faults(folder, surface, case):
    """Faults of both surfaces' files.

    Parameters
    ----------
    folder : pathlib.Path
        Folder of the case file.
    surface : object
        Table `surface` of the case file.
    case : Case or None
        None if other tables have faults; the profiles are then not compared with the contact.

    Returns
    -------
    list of str
        ``key = value: what is wrong; allowed: ...``
    """
    faults = []
    for side in (*SIDES, *FORMER):
        table = surface.get(side) if isinstance(surface, dict) else None
        if not isinstance(table, dict):
            continue
        key, kind = ("z", list) if "z" in table else ("file", str)
        if isinstance(table.get(key), kind) and table[key]:
            try:
                _check_profile(folder, table, case)
            except ProfileError as error:
                faults.append(f"surface.{side}.{key} = {show(table[key])}: {error}")
    return faults


def _check_profile(folder, table, case):
    try:
        spec = SurfaceProfile(**table)
    except ValidationError:  # reported with its keys; only the existence of the file can be checked
        spec = None
    if spec is None:
        if "file" not in table:
            return None
        return _check_file(folder / table["file"])
    scales = case and Scales.of(case)
    profile_samples = samples(folder, spec, scales and scales.dx)
    if case is None:
        return None
    film = scales.h * expected_film(case, scales) if case.fluid else 0.0
    fault = absurd(profile_samples, scales.a, scales.dx, scales.h, film)
    if fault:
        likely = likely_unit(profile_samples.source or profile_samples, layout_of(spec), spec.scale)
        raise ProfileError(f"{fault}" + (f"; is it in another unit? write {likely}" if likely else ""))
    return None


def _check_file(path):
    try:
        if path.is_file():
            return
    except (OSError, ValueError):  # an impossible file name
        pass
    raise ProfileError(f"no such file: {path}")
