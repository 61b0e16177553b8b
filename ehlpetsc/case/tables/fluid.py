"""Table `[fluid]` of a case file: the oil."""

from typing import Any, Literal

from ehlpetsc.case.schema.table import Table
from ehlpetsc.case.schema.validation import Field, pydantic, root_validator, validator
from ehlpetsc.keys import Key
from ehlpetsc.physics.laws import DENSITY_LAWS, LAWS, completed


class Grade(Table):
    """`fluid.grade`: oil grade of data sheets."""

    v40: float = Field(..., gt=2e-6, le=0.1, unit="m^2/s", description="kinematic viscosity at 40 C")
    v100: float = Field(..., gt=2e-6, le=0.1, unit="m^2/s", description="at 100 C, below v40")
    density: float = Field(
        ...,
        ge=500,
        le=3000,
        unit="kg/m^3",
        description="at ambient pressure, at the temperature of the contact",
    )

    @validator("v100")
    def _thinner_when_hot(cls, value, values):
        if values.get("v40") is not None and value >= values["v40"]:
            raise ValueError("too large")
        return value


class _Fluid(Table):
    """`[fluid]`: viscosity, density and Eyring stress."""

    viscosity: float = Field(
        ..., ge=1e-6, le=1e4, unit="Pa s", description="at ambient pressure; left out: of grade"
    )
    grade: Grade | None = Field(None, description="oil as data sheets give it, with a temperature")
    temperature: float | None = Field(
        None, ge=200, le=700, unit="K", description="at which grade gives viscosity; left out: that of [heat]"
    )
    law: Literal[tuple(LAWS)] = Field(..., description="viscosity law")
    pressure_viscosity: float | None = Field(
        None, ge=1e-12, le=1e-6, unit="1/Pa", description="alpha; left out: of grade, or of a law that has it"
    )
    density: Literal[tuple(DENSITY_LAWS)] = Field(..., description="density law")
    eyring_stress: float | None = Field(None, ge=1e3, le=1e12, unit="Pa", description="left out: Newtonian")
    limiting_shear: float | None = Field(
        None, ge=1e-4, le=1, description="limiting shear stress over pressure; left out: none"
    )
    inlet_film: float | None = Field(
        None, ge=1e-10, le=1e-2, unit="m", description="oil film at the inlet; left out: fully flooded"
    )

    @root_validator(skip_on_failure=True)
    def _of_laws(cls, values):
        return completed(values)


def _field(key: Key) -> tuple[type, Any]:
    bounds = {name: getattr(key, name) for name in ("ge", "gt", "le", "lt") if getattr(key, name) is not None}
    unit = {"unit": key.unit} if key.unit else {}
    return float | None, Field(None, description=key.text, **unit, **bounds)


Fluid = pydantic.create_model(
    "Fluid",
    __base__=_Fluid,
    __module__=__name__,
    **{
        name.replace("lambda", "lambda_"): _field(key)
        for laws in (LAWS, DENSITY_LAWS)
        for law in laws.values()
        for name, key in law.keys.items()
    },
)
Fluid.__fields__["lambda_"].alias = "lambda"
