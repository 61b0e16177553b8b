"""Check of a case with the files or heights of its surfaces."""

from __future__ import annotations

import math
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

from ehlpetsc.base.case import KINDS, Case
from ehlpetsc.base.declarations import Values
from ehlpetsc.base.errors import ProfileError
from ehlpetsc.base.toml_file import Tables
from ehlpetsc.case.checking import Fault, check
from ehlpetsc.case.stages import Checked, checked
from ehlpetsc.case.tables.surface import PROFILE, SIDES
from ehlpetsc.case.values import show
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.surfaces.topography import Topography


def checked_with_surfaces(folder: Path, data: Tables, kind: str, known: Collection[str] = ()) -> Checked:
    """Case checked as by :func:`.stages.checked`, with the faults of files or heights of both surfaces.

    Without a case, as other tables have faults, they are read alone, as profiles or maps.
    """
    stored, case, faults = checked(folder, data, kind, known)
    is_whole = case and case.contact and case.mesh and not known  # its kind and its values are known
    whole = case if is_whole else None
    surface = data.get("surface")
    tables = {side: surface.get(side) if isinstance(surface, dict) else None for side in SIDES}
    specs = {side: check(PROFILE, t)[0] if isinstance(t, dict) else None for side, t in tables.items()}
    for side, spec in specs.items():
        if spec is None:  # smooth, or its faults are reported with its keys
            continue
        try:
            _check_surface(folder, spec, whole)
        except ProfileError as error:
            key = "z" if "z" in tables[side] else "file"
            of_map = whole and KINDS[whole.kind].is_areal  # of several keys
            is_named = key in tables[side] and not (of_map and key == "z")
            given = f".{key} = {show(tables[side][key])}" if is_named else ""
            faults = [*faults, Fault("", f"surface.{side}{given}: {error}")]
    return Checked(stored, case, faults)


def _check_surface(folder: Path, spec: Values, case: Case | None) -> None:
    """Raise `ProfileError` for a surface that cannot be used in a case; None: in any kind of contact."""
    from ehlpetsc.surfaces.samples import areal_samples, measured_samples, samples

    if case is not None and KINDS[case.kind].is_areal:
        grid = Scales.of(case).grid
        width = grid.spacings[0] * grid.shape[0]
        if spec.synthetic:
            areal_samples(folder, spec, width, grid.periodic)
        else:
            _check_plausible(areal_samples(folder, spec, width, False), case)  # with its own spacings
    elif not spec.synthetic:
        if case is None:
            measured_samples(folder, spec)
        else:
            _check_plausible(samples(folder, spec), case)


def _check_plausible(given: Topography, case: Case) -> None:
    from ehlpetsc.surfaces.motion.profile_checks import absurd

    scales = Scales.of(case)
    across = scales.b if math.isfinite(scales.b) else scales.grid.spacings[0] * scales.grid.shape[0]
    film = scales.h * expected_film(case, scales) if case.fluid else 0.0
    if fault := absurd(given, scales.a, across, scales.h, film):
        raise ProfileError(fault)
