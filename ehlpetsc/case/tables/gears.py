"""`[gears]`: a pair of spur gear teeth through the mesh."""

from typing import Literal

from ehlpetsc.case.schema.table import Table
from ehlpetsc.case.schema.validation import Field, confloat, conint, root_validator
from ehlpetsc.gears.geometry import MESH_STIFFNESS, GearPair
from ehlpetsc.gears.load_sharing import RULES

Teeth = conint(ge=5, le=10_000)
Diameter = confloat(ge=1e-4, le=100)


class Gears(Table):
    """`[gears]`: geometry and running conditions of a spur gear pair; surface 1 is the pinion's flank."""

    module: float = Field(..., ge=1e-5, le=1, unit="m", description="normal module")
    teeth: tuple[Teeth, Teeth] = Field(..., description="of pinion and wheel")
    pressure_angle: float = Field(20.0, ge=5, le=40, unit="degrees", description="of the basic rack")
    centre_distance: float = Field(..., ge=1e-4, le=100, unit="m", description="above the sum of base radii")
    tip_diameter: tuple[Diameter, Diameter] = Field(..., unit="m", description="of pinion and wheel")
    face_width: float = Field(..., ge=1e-5, le=10, unit="m", description="common to both")
    torque: float = Field(..., ge=1e-6, le=1e9, unit="N m", description="on the pinion")
    speed: float = Field(..., ge=1e-3, le=1e6, unit="1/min", description="of the pinion")
    tip_relief: float = Field(
        0.0, ge=0, le=1e-3, unit="m", description="depth at both tips, linear from B and D on"
    )
    load_sharing: Literal[RULES] | None = Field(
        None, description="rule; left out: tip-relief where there is one, else thirds"
    )
    mesh_stiffness: float = Field(
        MESH_STIFFNESS,
        ge=1e6,
        le=1e12,
        unit="Pa",
        description="of one tooth pair per face width, c' of ISO 6336",
    )

    @root_validator(skip_on_failure=True)
    def _check_geometry(cls, values):
        faults = GearPair(**values).faults()
        if faults:
            raise ValueError("; ".join(fault.removeprefix("gears.") for fault in faults))
        return values

    @property
    def pair(self):
        """The gear pair, :class:`ehlpetsc.gears.GearPair`."""
        return GearPair(**self.dict())
