"""Table of all datasets of a result file: unit, long name, type, cases that have it, reduction over a run.

A new quantity is a line here and a value in `ehlpetsc.stepping.observables`, or belongs to an effect
(`ehlpetsc.effects`), which has both; the case file's list of fields,
writer and reader, progress, the summary line, totals of runs and series, the forecast of file sizes and
`ehlpetsc.analysis.compare` use this table.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from ehlpetsc.base.declarations import Column, Field, StepScalar
from ehlpetsc.effects import EFFECTS

if TYPE_CHECKING:
    from ehlpetsc.case.loading import Case
    from ehlpetsc.effects.effect import Effect

REDUCTIONS: dict[str, Callable] = {"sum": sum, "min": min, "max": max, "last": lambda values: values[-1]}
"""From the values of the steps, in their order, to the one of a run."""

MEANS = ("friction_coefficient", "film_central", "lambda_ratio", "mean_gap_ratio", "contact_share")
"""Scalars whose means over the time in which both surfaces fill the contact are in the summary of a run."""

SCENES = {
    "": lambda case: True,
    "fluid": lambda case: case.fluid is not None,
    "mixed": lambda case: case.contact.has_contact_pressure,
    "compliant": lambda case: case.contact.asperity_height is not None,
    "variable": lambda case: case.conditions is not None,
    **{kind.name: kind.is_in for kind in EFFECTS},
}
"""Whether a case has what a quantity needs."""

FIELDS = {
    "pressure": Field("Pa", "pressure"),
    "contact_pressure": Field("Pa", "pressure of the solids, part of the pressure", only="mixed"),
    "film_thickness": Field("m", "film thickness"),
    "void_fraction": Field("1", "void fraction of the film", only="fluid"),
    "shear_stress_1": Field("Pa", "shear stress on surface 1"),
    "shear_stress_2": Field("Pa", "shear stress on surface 2"),
    "in_contact": Field("1", "surfaces in contact (film at its bound, or solids carry)", dtype="u1"),
    **{name: replace(field, only=kind.name) for kind in EFFECTS for name, field in kind.fields.items()},
}
"""Fields over (stored frame, node), in the order in which files list them."""

STORED = list(FIELDS)
"""Fields that a case stores unless it names its own."""

STEP_SCALARS = {
    "step": StepScalar(
        "1",
        "number of the time step",
        dtype="i8",
        over_run="last",
        over_series="sum",
        summary="d",
        label="steps",
        progress=Column("step", 1, "{:>8d}"),
    ),
    "time": StepScalar("s", "time at the end of the step", progress=Column("time/us", 1e6, "{:>11.4f}")),
    "dt": StepScalar("s", "time step", progress=Column("dt/us", 1e6, "{:>9.5f}")),
    "newton": StepScalar(
        "1",
        "Newton iterations of the step, retries included",
        dtype="i4",
        over_run="sum",
        summary="d",
        progress=Column("newton", 1, "{:>6d}"),
    ),
    "retries": StepScalar("1", "attempts that did not converge", dtype="i4", over_run="sum"),
    "h_min": StepScalar(
        "m",
        "minimum film thickness",
        over_run="min",
        summary=".9g",
        progress=Column("h_min/um", 1e6, "{:>9.5f}"),
        compared=True,
    ),
    "p_max": StepScalar(
        "Pa",
        "maximum pressure",
        over_run="max",
        summary=".9g",
        progress=Column("p_max/GPa", 1e-9, "{:>9.4f}"),
        compared=True,
    ),
    "contacts": StepScalar(
        "1",
        "nodes in contact",
        dtype="i4",
        over_run="sum",
        summary="d",
        progress=Column("contacts", 1, "{:>8d}"),
        compared=True,
    ),
    "load": StepScalar("N/m", "integral of the pressure", compared=True),
    "load_error": StepScalar("1", "relative error of the load", over_run="max", summary=".2e"),
    "mass_error": StepScalar(
        "1",
        "mass defect summed over all nodes, relative to the mass that the contact carries",
        over_run="max",
        summary=".2e",
    ),
    "approach": StepScalar("m", "undeformed separation h00", compared=True),
    "friction": StepScalar("N/m", "friction force on surface 2", compared=True),
    "friction_1": StepScalar("N/m", "friction force on surface 1, in +x", compared=True),
    "friction_coefficient": StepScalar(
        "1", "magnitude of the mean friction force of both walls over load", over_run="last", summary=".4g"
    ),
    "film_central": StepScalar(
        "m",
        "mean film of the middle half of the Hertz contact of the instant",
        over_run="last",
        summary=".4g",
    ),
    "lambda_ratio": StepScalar(
        "1", "expected smooth minimum film over the combined Rq", over_run="last", summary=".4g"
    ),
    "mean_gap_ratio": StepScalar("1", "mean film over the combined Rq", over_run="last", summary=".4g"),
    "oil_pressure": StepScalar(
        "Pa", "maximum pressure of the oil, nodes in direct contact left out", over_run="max", only="fluid"
    ),
    "nodes_below_1nm": StepScalar(
        "1", "nodes out of contact under less than 1 nm of oil", dtype="i4", over_run="sum", only="fluid"
    ),
    "contact_share": StepScalar(
        "1",
        "share of the load on the solids",
        over_run="max",
        summary=".4g",
        label="contact_share_max",
        compared=True,
        only="mixed",
    ),
    "contact_length": StepScalar(
        "m",
        "length where solids carry; of a compliant layer, integral of the real area fraction",
        compared=True,
        only="mixed",
    ),
    "contact_length_10mpa": StepScalar(
        "m", "length where asperities carry more than 10 MPa", compared=True, only="compliant"
    ),
    "contact_length_100mpa": StepScalar(
        "m", "length where asperities carry more than 100 MPa", compared=True, only="compliant"
    ),
    "thin_length": StepScalar("m", "length where the film is thin", compared=True, only="mixed"),
    "thin_share": StepScalar("1", "share of the load where the film is thin", compared=True, only="mixed"),
    **{name: replace(scalar, only=kind.name) for kind in EFFECTS for name, scalar in kind.scalars.items()},
    "radius": StepScalar("m", "radius of relative curvature", only="variable"),
    "load_given": StepScalar("N/m", "load of the operating conditions", only="variable"),
    "speed_1": StepScalar("m/s", "speed of surface 1", only="variable"),
    "speed_2": StepScalar("m/s", "speed of surface 2", only="variable"),
    "displacement_1": StepScalar(
        "m", "distance travelled by surface 1 since time 0, signed", only="variable"
    ),
    "displacement_2": StepScalar(
        "m", "distance travelled by surface 2 since time 0, signed", only="variable"
    ),
    "wall": StepScalar("s", "wall clock time of the step", over_run="sum"),
}
"""Scalars of every time step, below ``steps/``, in the order of progress and summary."""

OTHERS = {
    "x": Field("m", "distance along the entrainment direction", ("x",)),
    "time": Field("s", "time of the stored frame", ("time",)),
    "step": Field("1", "number of the time step stored in the frame", ("time",), "i8"),
    "contact_count": Field("1", "time steps in contact over the whole run", ("x",), "i8"),
    "surface/s": Field("m", "coordinate fixed to the surface, s = x - speed time", ("s",)),
    "surface/z": Field("m", "height, positive out of the metal", ("s",)),
    **{f"surface/{name}": field for kind in EFFECTS for name, field in kind.surface.items()},
}
"""Coordinates and what else is neither a field nor a scalar of the step."""


def add_quantities(kind: type[Effect]) -> None:
    """Add the quantities of an effect of the user to the tables."""
    SCENES[kind.name] = kind.is_in
    FIELDS.update({name: replace(field, only=kind.name) for name, field in kind.fields.items()})
    STORED.extend(name for name in kind.fields if name not in STORED)
    STEP_SCALARS.update({name: replace(scalar, only=kind.name) for name, scalar in kind.scalars.items()})
    OTHERS.update(_on_surfaces(kind))


def quantities_of(kind: type[Effect]) -> dict[str, Field]:
    """Quantities of an effect by their names in the tables."""
    return {**kind.fields, **kind.scalars, **_on_surfaces(kind)}


def _on_surfaces(kind: type[Effect]) -> dict[str, Field]:
    return {f"surface/{name}": field for name, field in kind.surface.items()}


def of_case(table: dict[str, Field], case: Case) -> list[str]:
    """Names of the quantities of a table in a case."""
    return [name for name, field in table.items() if SCENES[field.only](case)]


def of_every_case(table: dict[str, Field]) -> list[str]:
    """Names of the quantities of a table in all cases."""
    return [name for name, field in table.items() if not field.only]
