"""Tables of a case file that have no module of their own: motion, mesh, time, wear, output, series.

One model a table of the file; attribute names are the keys (`lambda` is `lambda_`). Bounds are wide enough
for any machine element in SI units and narrow enough that a value in GPa, mm or um is found out.
"""

import math
from typing import Any, Literal

from ehlpetsc.case.tables.table import Table
from ehlpetsc.case.tables.validation import Field, confloat, constr, root_validator, validator
from ehlpetsc.names import current_name
from ehlpetsc.quantities import FIELDS, STORED

DOTTED = r"^[A-Za-z_]+(\.[A-Za-z_0-9]+)+$"  # a key below a table
MAX_MEMBERS = 10_000  # of a series
MAX_NODES = 200_000  # beyond it the work of a step is hours: more likely a slip of the pen
WearRate = confloat(ge=0.0, le=1e-10)


class Motion(Table):
    """`[motion]`: speeds of the surfaces."""

    entrainment_speed: float = Field(..., ge=1e-9, le=1e3, unit="m/s", description="mean of both, not zero")
    slide_roll_ratio: float = Field(0.0, ge=-100, le=100, description="(u1 - u2)/u")


class Mesh(Table):
    """`[mesh]`: nodes in x."""

    inlet: float = Field(..., ge=-100, lt=-1, unit="half widths", description="first node")
    outlet: float = Field(..., gt=1, le=100, unit="half widths", description="last node")
    points_per_half_width: int = Field(..., ge=4, le=100_000, description="at most 200000 nodes in all")
    near_field: int = Field(3, ge=2, le=1000, description="nodes of deflection in the matrix, each side")

    @validator("points_per_half_width")
    def _affordable(cls, value, values):
        if value * (values.get("outlet", 0.0) - values.get("inlet", 0.0)) > MAX_NODES:
            raise ValueError("too many nodes")
        return value

    @property
    def nodes(self):
        """Number of nodes; the last one lies at the outlet to the nearest whole spacing."""
        return round((self.outlet - self.inlet) * self.points_per_half_width) + 1


class Time(Table):
    """`[time]`: left out, the case is steady."""

    travel: float = Field(
        ...,
        ge=1e-6,
        le=1e5,
        unit="half widths",
        description="of the faster surface, from the smooth start; all of [gears] or [operation] if left out",
    )
    courant: float = Field(0.5, ge=1e-3, le=100, description="u_max dt/dx")
    passes: int = Field(1, ge=1, le=10_000, description="times that the same stretch of both surfaces meets")
    pass_shift: float = Field(
        0.0,
        ge=-1,
        le=1,
        unit="m",
        description="by which surface 2's profile enters further on, from pass to pass",
    )


class Wear(Table):
    """`[wear]`: left out, surfaces do not wear."""

    coefficient: tuple[WearRate, WearRate] = Field(
        ..., unit="m^2/N", one_for_both=True, description="specific wear rate k, of both or of each surface"
    )

    @validator("coefficient", pre=True)
    def _of_both(cls, value):
        return value if isinstance(value, (list, tuple)) else [value, value]


class Output(Table):
    """`[output]`: what the result file holds."""

    every: int = Field(1, ge=1, le=10**9, description="steps between stored fields")
    fields: list[Literal[tuple(FIELDS)]] = Field(STORED, min_items=1, description="stored fields")
    precision: Literal["float64", "float32"] = Field("float64", description="of the stored fields")
    thin_film: float = Field(
        2.0, ge=1, le=1000, unit="boundary films", description="mixed contact: films below it count as thin"
    )
    checkpoint: float = Field(10.0, gt=0, le=1e5, unit="minutes", description="between restart files")

    @validator("fields", pre=True)
    def _former_names(cls, names):
        if not isinstance(names, list):
            return names
        return [current_name(name) if isinstance(name, str) else name for name in names]


class Series(Table):
    """`[series]`: a key swept over values, or several, one member a value or a combination of values."""

    key: str | None = Field(None, regex=DOTTED, description='as in "fluid.viscosity"; or keys')
    keys: list[constr(regex=DOTTED)] | None = Field(None, min_items=2, description="several keys at once")
    values: list[Any] = Field(
        ..., min_items=1, description="a list of values of the key; of keys, such a list for each"
    )
    combine: Literal["grid", "step"] | None = Field(
        None,
        description="of keys: every value with every other [grid], or the first ones, the second ones ...",
    )

    @root_validator(skip_on_failure=True)
    def _one_or_several(cls, values):
        keys, lists = values["keys"], values["values"]
        if (values["key"] is None) == (keys is None):
            raise ValueError("needs either key or keys: one of them")
        if keys is None:
            if values["combine"]:
                raise ValueError("combine is for several keys")
            if len(lists) > MAX_MEMBERS:
                raise ValueError(f"{len(lists)} members; allowed: at most {MAX_MEMBERS}")
            return values
        if len(set(keys)) < len(keys):
            raise ValueError("keys: the same one twice")
        if len(lists) != len(keys) or not all(isinstance(one, list) and one for one in lists):
            raise ValueError(f"values: allowed: {len(keys)} lists of values, one for each of the keys")
        if values["combine"] == "step" and len({len(one) for one in lists}) > 1:
            counts = ", ".join(str(len(one)) for one in lists)
            raise ValueError(
                f'values: lists of {counts}; allowed with combine = "step": as long as each other'
            )
        members = math.prod(map(len, lists)) if values["combine"] != "step" else len(lists[0])
        if members > MAX_MEMBERS:
            raise ValueError(f"{members} members; allowed: at most {MAX_MEMBERS}")
        return values
