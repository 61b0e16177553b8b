"""Tables `[mesh]` and `[time]`: nodes and time steps."""

from ehlpetsc.case.schema.table import Table
from ehlpetsc.case.schema.validation import Field, validator

MAX_NODES = 200_000  # with more a time step would take hours; more likely a typing error


class Mesh(Table):
    """`[mesh]`: nodes in x."""

    inlet: float = Field(..., ge=-100, lt=-1, unit="half widths", description="first node")
    outlet: float = Field(..., gt=1, le=100, unit="half widths", description="last node")
    points_per_half_width: int = Field(..., ge=4, le=100_000, description="at most 200000 nodes in all")
    near_field: int = Field(3, ge=2, le=1000, description="nodes of deflection in the matrix, each side")

    @validator("points_per_half_width")
    def _check_node_count(cls, value, values):
        if value * (values.get("outlet", 0.0) - values.get("inlet", 0.0)) > MAX_NODES:
            raise ValueError("too many nodes")
        return value

    @property
    def nodes(self):
        """Number of nodes; the outlet is rounded to a whole number of spacings."""
        return round((self.outlet - self.inlet) * self.points_per_half_width) + 1


class Time(Table):
    """`[time]`; without it the case is steady."""

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
