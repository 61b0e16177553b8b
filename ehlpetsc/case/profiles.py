"""Faults of the profile files of a case: unreadable, or implausible for its contact."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ehlpetsc.case.checking import check
from ehlpetsc.case.messages import show
from ehlpetsc.case.tables import Case
from ehlpetsc.case.tables.surface import PROFILE, SIDES
from ehlpetsc.errors import ProfileError
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales


def profile_faults(folder: Path, surface: Any, case: Case | None) -> list[str]:
    """Faults of the files or heights of both surfaces.

    Without a case, as other tables have faults, the profiles are not compared with the contact.
    """
    faults = []
    for side in SIDES:
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


def _check_profile(folder: Path, table: dict[str, Any], case: Case | None) -> None:
    from ehlpetsc.surfaces.plausibility import absurd, likely_unit  # smooth surfaces need none
    from ehlpetsc.surfaces.samples import layout_of, samples

    spec, faults = check(PROFILE, table)
    if faults:  # reported with its keys
        return
    if case is None or case.contact is None:
        samples(folder, spec)
        return
    scales = Scales.of(case)
    profile_samples = samples(folder, spec, scales.dx)
    film = scales.h * expected_film(case, scales) if case.fluid else 0.0
    fault = absurd(profile_samples, scales.a, scales.dx, scales.h, film)
    if fault:
        likely = likely_unit(profile_samples.source or profile_samples, layout_of(spec), spec.scale)
        raise ProfileError(f"{fault}" + (f"; is it in another unit? write {likely}" if likely else ""))
