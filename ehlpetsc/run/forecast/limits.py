"""Limits of a result: messages where it is outside the validity of the model.

They follow from the totals over all steps, are printed at the end of a run and stored in its file.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.quantities import MIN_CONTINUUM_FILM
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.oil.laws import viscosity
from ehlpetsc.run.forecast.validity import isothermal

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.case.tables.contact import Contact
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.motion.roughness import Roughness

ASPERITY_YIELD_PRESSURE = 5e9  # Pa: asperities of hardened steel flow at 5 to 8 GPa
MAX_MEASURED_VISCOSITY = 1e7  # Pa s: about the highest measured viscosity of oils
MAX_MASS_ERROR = 0.05  # of the oil in the contact
MAX_OIL_FRICTION = 0.15  # shear stress of oils over their pressure: up to about 0.1
# temperatures [K] above which: round numbers without a source; a flash does less than a furnace
MAX_STEEL = 800.0, "hardened steel softens"
MAX_OIL = 700.0, "oils crack"
MIN_SHARE_OF_SOLIDS = 0.01  # of the load: with more their coefficient of friction matters
FLATTENED = 0.01  # film over the rms height of the layer: below it the mesh does not resolve the film
MAX_DECADES = 300  # log10 of the maximum viscosity that is printed with digits
MAX_FILM_OF_INLET = 4.0  # mean film over the smooth one: up to 2.3 where the layer lets the oil escape
MIN_SHARE_OF_ENCLOSED_OIL = 0.5  # of the load


def limits(
    case: Case,
    scales: Scales,
    rough: Roughness | None,
    totals: dict[str, float],
    boundary_friction: float | None = None,
) -> list[str]:
    """Messages on results outside the validity of the model.

    `totals`: scalars over the run, see `ehlpetsc.results.means.Totals`.
    `boundary_friction`: maximum over the run, of effects too; None: that of the case.
    """
    if "p_max" not in totals:  # no step was taken
        return []
    friction = case.contact.boundary_friction if boundary_friction is None else boundary_friction
    of_oil = _of_oil(case, totals, friction) if case.fluid else []
    heat = (f"heat: {note}" for note in isothermal(case, scales, totals.get("friction_coefficient")))
    mesh = []
    if rough:
        from ehlpetsc.surfaces.motion.profile_checks import mesh_warnings

        mesh = [f"mesh: {note}" for note in mesh_warnings(rough, scales)]
    return [
        *_of_solids(case.contact, totals),
        *_of_enclosed_oil(case, scales, totals),
        *_of_default_friction(case, scales, totals),
        *mesh,
        *heat,
        *_of_temperatures(totals),
        *of_oil,
    ]


def _of_solids(contact: Contact, totals: dict[str, float]) -> Iterator[str]:
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


def _of_enclosed_oil(case: Case, scales: Scales, totals: dict[str, float]) -> Iterator[str]:
    """Note on oil that carries most of the load in a film which the inlet does not supply."""
    oil = 1.0 - totals.get("contact_share", 1.0)
    if case.fluid is None or not totals.get("lambda_ratio") or oil < MIN_SHARE_OF_ENCLOSED_OIL:
        return
    central, minimum = smooth_films(scales, case.fluid, scales.conditions)
    films = totals["mean_gap_ratio"] / totals["lambda_ratio"] * minimum / central
    if films > MAX_FILM_OF_INLET:
        yield (
            f"enclosed oil: the oil carries {100 * oil:.2g} % of the load in a mean film {films:.3g} times "
            "the smooth one: solids that touch around a valley lock it in, and at low speed friction does "
            "not rise to that of the solids; a longer short_cutoff "
            'with asperity_height = "measured" gives a layer through which it escapes'
        )


def _of_default_friction(case: Case, scales: Scales, totals: dict[str, float]) -> Iterator[str]:
    """Note on solids that carry load with a coefficient of friction that the case does not give."""
    share, of = totals.get("contact_share", 1.0), "load"
    if case.fluid and not case.contact.has_contact_pressure:
        nodes = scales.grid.inside(1.0).sum() * (totals.get("step", 0) + 1)
        share, of = totals.get("contacts", 0) / nodes, "Hertz contact, in the mean"
    if case.default_friction is not None and share >= MIN_SHARE_OF_SOLIDS:
        yield (
            f"friction: the solids carry up to {100 * share:.3g} % of the {of}, with a coefficient of "
            f"friction of {case.default_friction:g}, the default; contact.boundary_friction sets theirs"
        )


def _of_temperatures(totals: dict[str, float]) -> Iterator[str]:
    """Temperatures at which neither the oil nor hard steel exists any longer."""
    walls = max(totals.get(f"temperature_{side}_max", 0.0) for side in ("1", "2"))
    for name, found, (limit, words) in (
        ("surfaces", walls, MAX_STEEL),
        ("film", totals.get("film_temperature_max", 0.0), MAX_OIL),
    ):
        if found > limit:
            yield f"temperature: up to {found:.4g} K in the {name}, but {words} above about {limit:g} K"


def _of_oil(case: Case, totals: dict[str, float], boundary_friction: float) -> Iterator[str]:
    coefficient = abs(totals.get("friction_coefficient", 0.0))
    if coefficient > max(MAX_OIL_FRICTION, boundary_friction):
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
