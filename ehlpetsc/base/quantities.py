"""Table of all datasets of a result file: unit, long name, type, cases that have it, function, reduction.

A new scalar of the steps is a line here. Effects add their quantities (`register`). The case file's list of
fields, writer and reader, progress, the summary line, totals of runs and series, the forecast of file sizes
and `ehlpetsc.analysis.compare` use this table.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Protocol

import numpy as np

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.declarations import Column, Field, StepScalar, Values

MIN_CONTINUUM_FILM = 1e-9  # m: thinner films are one or two molecules of oil
HIGH_PRESSURE = 100e6  # Pa: of the second length in contact
PER_METRE = {"N": "N/m", "W": "W/m", "F": "F/m", "m^2": "m", "m^3": "m^2"}
"""Units of integrals over a contact, per metre of its width."""

REDUCTIONS: dict[str, Callable] = {"sum": sum, "min": min, "max": max, "last": lambda values: values[-1]}
"""From the values of the steps, in their order, to the one of a run."""

MEANS = ("friction_coefficient", "film_central", "lambda_ratio", "mean_gap_ratio", "contact_share")
"""Scalars whose means over the time in which both surfaces fill the contact are in the summary of a run."""

SCENES: dict[str, Callable[[Any], bool]] = {
    "": lambda case: True,
    "fluid": lambda case: case.fluid is not None,
    "permittivity": lambda case: case.fluid is not None and case.fluid.permittivity is not None,
    "mixed": lambda case: case.contact.has_contact_pressure,
    "compliant": lambda case: case.contact.asperity_height is not None,
    "tilted": lambda case: case.contact.tilt is not None or case.contact.self_aligning,
    "roller": lambda case: KINDS[case.kind].has_ends and not KINDS[case.kind].surroundings,
    "roller in oil": lambda case: SCENES["roller"](case) and case.fluid is not None,
    "variable": lambda case: case.conditions is not None,
    "rows apart": lambda case: (
        case.contact.groove_radius is not None or bool(case.motion and case.motion.spin)
    ),
    "mixed row": lambda case: SCENES["mixed"](case) and not KINDS[case.kind].is_whole,
    "mixed point": lambda case: SCENES["mixed"](case) and KINDS[case.kind].is_whole,
    "compliant row": lambda case: SCENES["compliant"](case) and not KINDS[case.kind].is_whole,
    "compliant point": lambda case: SCENES["compliant"](case) and KINDS[case.kind].is_whole,
}
"""Whether a case has what a quantity needs; rows: lines and strips, of which integrals are per width."""

FIELDS = {
    "pressure": Field("Pa", "pressure", of=lambda o: o.pressure),
    "contact_pressure": Field(
        "Pa",
        "pressure of the solids, part of the pressure",
        only="mixed",
        of=lambda o: o.loads.contact_pressure * o.scene.scales.p0,
    ),
    "film_thickness": Field("m", "film thickness", of=lambda o: o.film),
    "void_fraction": Field("1", "void fraction of the film", only="fluid", of=lambda o: o.void_fraction),
    "shear_stress_1": Field("Pa", "shear stress on surface 1", of=lambda o: o.shear_stresses[0]),
    "shear_stress_2": Field("Pa", "shear stress on surface 2", of=lambda o: o.shear_stresses[1]),
    "shear_stress_across_1": Field(
        "Pa",
        "shear stress on surface 1 in +y",
        only="rows apart",
        of=lambda o: o.shear_stresses_across[0],
    ),
    "shear_stress_across_2": Field(
        "Pa",
        "shear stress on surface 2 in +y",
        only="rows apart",
        of=lambda o: o.shear_stresses_across[1],
    ),
    "sliding_speed": Field(
        "m/s",
        "magnitude of the sliding velocity",
        only="rows apart",
        of=lambda o: o.slip.speed,
    ),
    "in_contact": Field(
        "1",
        "surfaces in contact (film at its bound, or solids carry)",
        dtype="u1",
        of=lambda o: o.loads.contact_mask,
    ),
}
"""Fields over (stored frame, node), in the order in which files list them."""

DEFAULT_FIELDS = list(FIELDS)
"""Fields that a case stores unless it names its own."""

Count = partial(StepScalar, "1", dtype="i4", over_run="sum")
Error = partial(StepScalar, "1", over_run="max", summary=".2e")
AtEnd = partial(StepScalar, over_run="last", summary=".4g")
Compared = partial(StepScalar, compared=True)
Integral = partial(StepScalar, integrated=True, compared=True)
Condition = partial(StepScalar, only="variable")
OfRows = partial(StepScalar, only="rows apart", over_run="last", compared=True, summary=".4g")
OfRoller = partial(StepScalar, only="roller", over_run="last", compared=True)


def _extents(noun: str, contact: str) -> dict[str, StepScalar]:
    """Length, or area of a point contact, where solids carry and where the film is thin, by name."""
    extent = partial(Integral, "m^2")
    mixed, compliant = f"mixed {contact}", f"compliant {contact}"
    return {
        f"contact_{noun}": extent(
            f"{noun} where solids carry; of a compliant layer, integral of the real area fraction",
            only=mixed,
            of=lambda o: o.node_size * o.problem.model.real_area_fraction(o.loads).sum(),
        ),
        f"contact_{noun}_10mpa": extent(
            f"{noun} where asperities carry more than 10 MPa",
            only=compliant,
            of=lambda o: o.node_size * o.loads.contact_mask.sum(),
        ),
        f"contact_{noun}_100mpa": extent(
            f"{noun} where asperities carry more than 100 MPa",
            only=compliant,
            of=lambda o: o.node_size * (o.loads.contact_pressure > HIGH_PRESSURE / o.scene.scales.p0).sum(),
        ),
        f"thin_{noun}": extent(
            f"{noun} where the film is thin", only=mixed, of=lambda o: o.node_size * o.thin.sum()
        ),
    }


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
    "dt": StepScalar(
        "s", "time step", progress=Column("dt/us", 1e6, "{:>9.5f}"), of=lambda o: o.state.dt or 0.0
    ),
    "newton": Count(
        "Newton iterations of the step, retries included",
        summary="d",
        progress=Column("newton", 1, "{:>6d}"),
        of=lambda o: o.state.newton,
    ),
    "gmres": Count("GMRES iterations of the step, retries included"),
    "retries": Count("attempts that did not converge", of=lambda o: o.state.retries),
    "h_min": Compared(
        "m",
        "minimum film thickness",
        over_run="min",
        summary=".9g",
        progress=Column("h_min/um", 1e6, "{:>9.5f}"),
        of=lambda o: o.film.min(),
    ),
    "p_max": Compared(
        "Pa",
        "maximum pressure",
        over_run="max",
        summary=".9g",
        progress=Column("p_max/GPa", 1e-9, "{:>9.4f}"),
        of=lambda o: o.pressure.max(),
    ),
    "contacts": Count(
        "nodes in contact",
        summary="d",
        progress=Column("contacts", 1, "{:>8d}"),
        compared=True,
        of=lambda o: int(o.loads.contact_mask.sum()),
    ),
    "load": Integral("N", "integral of the pressure", of=lambda o: o.load),
    "load_error": Error("relative error of the load, or of the given approach", of=lambda o: o.load_error),
    "mass_error": Error(
        "mass defect summed over all nodes, relative to the mass that the contact carries",
        of=lambda o: o.mass_error,
    ),
    "approach": Compared("m", "rigid-body approach of the bodies, -h00", of=lambda o: o.approach),
    "tilt": StepScalar(
        "1",
        "slope of the gap across",
        only="tilted",
        of=lambda o: o.problem.balance.tilt(o.state.solution.unknowns.border),
    ),
    "edge_factor": OfRoller(
        "1", "maximum pressure over p0 of the mean load", summary=".4g", of=lambda o: o.roller.edge_factor
    ),
    "edge_factor_local": OfRoller(
        "1",
        "maximum pressure over Hertz' of the load per length of its row",
        of=lambda o: o.roller.local_edge_factor,
    ),
    "edge_factor_inside": OfRoller(
        "1",
        "maximum pressure over p0 at least a half-width a inside the ends",
        of=lambda o: o.roller.edge_factor_inside,
    ),
    "load_per_length_middle": OfRoller("N/m", "load per length in the middle", of=lambda o: o.roller.middle),
    "load_per_length_end_1": OfRoller(
        "N/m", "load per length of the first row, at the lower end", of=lambda o: o.roller.ends[0]
    ),
    "load_per_length_end_2": OfRoller(
        "N/m", "load per length of the last row, at the upper end", of=lambda o: o.roller.ends[1]
    ),
    "load_per_length_max": OfRoller("N/m", "largest load per length", of=lambda o: o.roller.w.max()),
    "load_per_length_max_at": OfRoller(
        "m", "y of the largest load per length", of=lambda o: o.roller.highest_at
    ),
    "moment": OfRoller("N m", "moment of the pressure about y = 0", of=lambda o: o.roller.moment),
    "moment_lamina": OfRoller(
        "N m", "the same by the lamina model of ISO/TS 16281", of=lambda o: o.roller.lamina_moment
    ),
    "film_of_ends": OfRoller(
        "1",
        "minimum film of the outer halves of the roller over that in its middle",
        only="roller in oil",
        of=lambda o: o.roller.film_of_ends,
    ),
    "life_factor": OfRoller(
        "1",
        "life of the line over that with the load even, (mean w^4.5)^(-8/9)",
        summary=".4g",
        of=lambda o: o.roller.life_factor,
    ),
    "life_factor_lamina": OfRoller(
        "1", "the same by the lamina model of ISO/TS 16281", of=lambda o: o.roller.lamina_life_factor
    ),
    "friction": Integral("N", "friction force on surface 2", of=lambda o: o.friction_2),
    "friction_1": Integral("N", "friction force on surface 1, in +x", of=lambda o: o.friction_1),
    "friction_coefficient": AtEnd(
        "1",
        "magnitude of the mean friction force of both walls over load",
        of=lambda o: 0.5 * abs(o.friction_2 - o.friction_1) / o.load,
    ),
    "spin_moment": OfRows(
        "N m",
        "moment of the shear stresses on surface 2 about the normal, in the direction of the spin",
        of=lambda o: o.spin_moment,
    ),
    "sliding_power": OfRows("W", "power of sliding and spin in the contact", of=lambda o: o.sliding_power),
    "friction_power": OfRows(
        "W", "power of the shear stresses on both surfaces, also of rolling", of=lambda o: o.friction_power
    ),
    "film_central": AtEnd(
        "m", "mean film of the middle half of the Hertz contact of the instant", of=lambda o: o.mean_film
    ),
    "lambda_ratio": AtEnd(
        "1",
        "minimum film of the smooth contact, of the start where computed, over the combined Rq",
        of=lambda o: o.smooth_film / o.scene.rq if o.scene.rq else np.nan,
    ),
    "mean_gap_ratio": AtEnd(
        "1", "mean film over the combined Rq", of=lambda o: o.mean_film / o.scene.rq if o.scene.rq else np.nan
    ),
    "capacitance": AtEnd(
        "F",
        "electrical capacitance between the surfaces over the mesh, without nodes in contact",
        integrated=True,
        only="permittivity",
        of=lambda o: o.capacitance,
    ),
    "capacitance_ratio": AtEnd(
        "1",
        "capacitance over that of oil between plates of the Hertz contact at the central film",
        only="permittivity",
        of=lambda o: o.capacitance / o.plate_capacitance,
    ),
    "oil_pressure": StepScalar(
        "Pa",
        "maximum pressure of the oil, nodes in direct contact left out",
        over_run="max",
        only="fluid",
        of=lambda o: o.oil_pressure.max(),
    ),
    "nodes_below_1nm": Count(
        "nodes out of contact under less than 1 nm of oil",
        only="fluid",
        of=lambda o: int((~o.loads.contact_mask & (o.film < MIN_CONTINUUM_FILM)).sum()),
    ),
    "contact_share": Compared(
        "1",
        "share of the load on the solids",
        over_run="max",
        summary=".4g",
        label="contact_share_max",
        only="mixed",
        of=lambda o: o.loads.contact_pressure.sum() / o.loads.pressure.sum(),
    ),
    **_extents("length", "row"),
    **_extents("area", "point"),
    "thin_share": Compared(
        "1",
        "share of the load where the film is thin",
        only="mixed",
        of=lambda o: o.loads.pressure[o.thin].sum() / o.loads.pressure.sum(),
    ),
    "radius": Condition("m", "radius of relative curvature", of=lambda o: o.conditions.radius),
    "load_given": Condition(
        "N", "load of the operating conditions", integrated=True, of=lambda o: o.conditions.load
    ),
    "speed_1": Condition("m/s", "speed of surface 1", of=lambda o: o.conditions.u1),
    "speed_2": Condition("m/s", "speed of surface 2", of=lambda o: o.conditions.u2),
    "displacement_1": Condition(
        "m", "distance travelled by surface 1 since time 0, signed", of=lambda o: o.state.travelled[0]
    ),
    "displacement_2": Condition(
        "m", "distance travelled by surface 2 since time 0, signed", of=lambda o: o.state.travelled[1]
    ),
    "wall": StepScalar("s", "wall clock time of the step", over_run="sum", of=lambda o: o.wall),
}
"""Scalars of every time step, below ``steps/``, in the order of progress and summary."""

OTHERS = {
    "x": Field("m", "distance along the entrainment direction", ("x",)),
    "y": Field("m", "distance across the entrainment direction", ("y",)),
    "time": Field("s", "time of the stored frame", ("time",)),
    "step": Field("1", "number of the time step stored in the frame", ("time",), "i8"),
    "contact_count": Field("1", "time steps in contact over the whole run", ("nodes",), "i8"),
    "surface/s": Field("m", "coordinate fixed to the surface, s = x - speed time", ("s",)),
    "surface/z": Field("m", "height, positive out of the metal", ("s",)),
}
"""Coordinates and what else is neither a field nor a scalar of the step."""


class HasQuantities(Protocol):
    """Quantities of an effect by name: of time levels, of steps, on both surfaces; cases that have it."""

    name: str
    fields: dict[str, Field]
    scalars: dict[str, StepScalar]
    surface: dict[str, Field]

    @classmethod
    def is_in(cls, case: Any) -> bool:
        """Whether a case has this effect."""
        ...


def register(kind: type[HasQuantities]) -> None:
    """Add the quantities of an effect to the tables."""
    SCENES[kind.name] = kind.is_in
    FIELDS.update({name: replace(field, only=kind.name) for name, field in kind.fields.items()})
    DEFAULT_FIELDS.extend(name for name in kind.fields if name not in DEFAULT_FIELDS)
    STEP_SCALARS.update({name: replace(scalar, only=kind.name) for name, scalar in kind.scalars.items()})
    OTHERS.update(_on_surfaces(kind))


def of_effect(kind: type[HasQuantities]) -> dict[str, Field]:
    """Quantities of an effect by their names in the tables."""
    return {**kind.fields, **kind.scalars, **_on_surfaces(kind)}


def _on_surfaces(kind: type[HasQuantities]) -> dict[str, Field]:
    return {f"surface/{name}": field for name, field in kind.surface.items()}


def of_case(table: Mapping[str, Field], case: Values) -> list[str]:
    """Names of the quantities of a table in a case."""
    return [name for name, field in table.items() if SCENES[field.only](case)]


def of_every_case(table: Mapping[str, Field]) -> list[str]:
    """Names of the quantities of a table in all cases."""
    return [name for name, field in table.items() if not field.only]


def unit_in(quantity: Field, contact: str = "line") -> str:
    """Unit of a quantity of a kind of contact: of the whole one or per metre of its width."""
    return (
        PER_METRE[quantity.units] if quantity.integrated and not KINDS[contact].is_whole else quantity.units
    )


def dims_in(quantity: Field, axes: Sequence[str] = ("x",)) -> tuple[str, ...]:
    """Names of the dimension scales of a quantity on a grid with these axes."""
    return tuple(dim for name in quantity.dims for dim in (axes if name == "nodes" else [name]))
