"""Results outside the validity of the model: one message each with the value, printed at the end of a run.

The messages follow from the totals over all steps and are also stored in the result file.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.physics.laws import viscosity
from ehlpetsc.stepping.observables import MIN_CONTINUUM_FILM

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.roughness import Roughness

ASPERITY_YIELD_PRESSURE = 5e9  # Pa: asperities of hardened steel flow at 5 to 8 GPa
MAX_MEASURED_VISCOSITY = 1e7  # Pa s: about the highest measured viscosity of oils
MAX_MASS_ERROR = 0.05  # of the oil in the contact
MAX_OIL_FRICTION = 0.15  # shear stress of oils over their pressure: up to about 0.1
FLATTENED = 0.01  # film over the rms height of the layer: below it the mesh does not resolve the film
MAX_DECADES = 300  # log10 of the maximum viscosity that is printed with digits


def limits(case: Case, scales: Scales, rough: Roughness | None, totals: dict[str, float]) -> list[str]:
    """Messages on results outside the validity of the model.

    `totals`: scalars over the run, see `ehlpetsc.results.means.Totals`.
    """
    if "p_max" not in totals:  # no step was taken
        return []
    of_oil = _of_oil(case, totals) if case.fluid else []
    heat = (f"heat: {note}" for note in isothermal(case, scales, totals.get("friction_coefficient")))
    mesh = []
    if rough:
        from ehlpetsc.surfaces.profile_checks import mesh_warnings

        mesh = [f"mesh: {note}" for note in mesh_warnings(rough, scales)]
    return [*_of_solids(case.contact, totals), *mesh, *heat, *of_oil]


def _of_solids(contact: Any, totals: dict[str, float]) -> Iterator[str]:
    if contact.yield_pressure is None and totals["p_max"] > ASPERITY_YIELD_PRESSURE:
        yield (
            f"pressure: up to {1e-9 * totals['p_max']:.2f} GPa, but asperities of hardened steel flow at "
            f"{1e-9 * ASPERITY_YIELD_PRESSURE:g} to 8 GPa, and these solids are elastic; "
            "in mixed contact yield_pressure lets them flow"
        )
    height = contact.asperity_height
    if height is not None and totals["h_min"] - contact.adsorbed_film < FLATTENED * height:
        yield (
            f"layer: flattened from {1e9 * height:.3g} nm to a film of {1e9 * totals['h_min']:.2g} nm: "
            "friction and load on the solids depend on the mesh there; a longer short_cutoff with "
            'asperity_height = "measured" gives a thicker layer'
        )


def isothermal(case: Case, scales: Scales, friction: float | None) -> Iterator[str]:
    """Note on an isothermal case with a high flash temperature by its coefficient of friction, if known."""
    if friction is None or case.heat is not None or case.motion is None:
        return
    from ehlpetsc.physics.flash_temperature import MAX_ISOTHERMAL_FLASH, flash_temperature

    flash = flash_temperature(abs(friction), scales)
    if flash > MAX_ISOTHERMAL_FLASH:
        yield (
            f"the case is isothermal, but its flash temperature by Blok's formula is about {flash:.0f} K "
            f"(steel, coefficient of friction {friction:.3f}); [heat] computes with temperatures"
        )


def _of_oil(case: Case, totals: dict[str, float]) -> Iterator[str]:
    coefficient = abs(totals.get("friction_coefficient", 0.0))
    if coefficient > max(MAX_OIL_FRICTION, case.contact.boundary_friction):
        yield (
            f"friction: a coefficient of {coefficient:.3g}, but oils bear a shear stress of about 0.1 of "
            "their pressure; eyring_stress, carreau_stress or limiting_shear in [fluid] bounds it"
        )
    pressure, fluid = totals["oil_pressure"], case.fluid
    decades = (float(viscosity(np.array([pressure]), fluid)[0][0]) + np.log(fluid.viscosity)) / np.log(10.0)
    if decades > np.log10(MAX_MEASURED_VISCOSITY):
        value = f"{10.0**decades:.1e}" if decades < MAX_DECADES else f"1e{decades:.0f}"
        yield (
            f"viscosity: {value} Pa s by the law at the oil's maximum pressure, {1e-9 * pressure:.2f} GPa; "
            "oils are measured up to about 1e7 Pa s"
        )
    if totals["mass_error"] > MAX_MASS_ERROR:
        cure = "a finer mesh or smaller snes_atol reduces it"
        if not case.contact.has_contact_pressure:
            cure = 'nodes in direct contact do not conserve mass, contact.model = "mixed" does'
        yield (
            f"oil balance: the mass defect of one step is {100 * totals['mass_error']:.3g} % of the oil that "
            f"the contact carries; {cure}"
        )
    if totals["nodes_below_1nm"]:
        yield (
            f"film: {totals['nodes_below_1nm']} times a node out of contact had less than "
            f"{1e9 * MIN_CONTINUUM_FILM:g} nm of oil, a molecule or two, where oil is no continuum"
        )
