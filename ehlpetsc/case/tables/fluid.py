"""Table `[fluid]` of a case file: the oil."""

import math
from typing import Literal

from ehlpetsc.case.schema.table import Needs, Table
from ehlpetsc.case.schema.validation import Field, root_validator, validator

# the density law is (1 + gamma p)/(1 + lambda p): gamma is the sum of both constants as textbooks print them
TEXTBOOKS = "the density 1 + 0.6e-9 p/(1 + 1.7e-9 p) of textbooks is"

DENSITY = {"gamma": 2.3e-9, "lambda_": 1.7e-9}  # 1/Pa
ROELANDS_PRESSURE = 1.96e8  # Pa
ROELANDS_VISCOSITY = 6.315e-5  # Pa s: ln eta0 + 9.67 = ln(eta0/6.315e-5)


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


class Fluid(Table):
    """`[fluid]`: viscosity, density and Eyring stress."""

    viscosity: float = Field(
        ..., ge=1e-6, le=1e4, unit="Pa s", description="at ambient pressure; left out: of grade"
    )
    grade: Grade | None = Field(None, description="oil as data sheets give it, with a temperature")
    temperature: float | None = Field(
        None, ge=200, le=700, unit="K", description="at which grade gives viscosity; left out: that of [heat]"
    )
    law: Literal["seed", "barus", "roelands"] = Field(..., description="viscosity law")
    pressure_viscosity: float = Field(
        ..., ge=1e-12, le=1e-6, unit="1/Pa", description="alpha; left out: of grade"
    )
    kappa: float | None = Field(None, ge=1e-9, le=1, unit="Pa s", description="seed law, below viscosity")
    chi: float | None = Field(None, ge=1e-12, le=1e-6, unit="1/Pa", description="seed law")
    roelands_z: float | None = Field(
        None, ge=1e-3, le=2, description="Roelands law, exponent z; left out: alpha pr/(ln eta0 + 9.67)"
    )
    roelands_pressure: float | None = Field(
        None,
        ge=1e6,
        le=1e10,
        unit="Pa",
        description="Roelands law, pr; left out: 1.96e8, or 1/chi where given",
    )
    density: Literal["dowson-higginson", "incompressible"] = Field(..., description="density law")
    gamma: float | None = Field(
        None, ge=0, le=1e-6, unit="1/Pa", description=f"{TEXTBOOKS} gamma = 2.3e-9, the default"
    )
    lambda_: float | None = Field(
        None,
        alias="lambda",
        ge=0,
        le=1e-6,
        unit="1/Pa",
        description=f"below gamma; {TEXTBOOKS} gamma = 2.3e-9 and lambda = 1.7e-9, the defaults",
    )
    eyring_stress: float | None = Field(None, ge=1e3, le=1e12, unit="Pa", description="left out: Newtonian")
    limiting_shear: float | None = Field(
        None, ge=1e-4, le=1, description="limiting shear stress over pressure; left out: none"
    )
    inlet_film: float | None = Field(
        None, ge=1e-10, le=1e-2, unit="m", description="oil film at the inlet; left out: fully flooded"
    )

    @validator("temperature")
    def _of_a_grade(cls, value, values):
        if value is not None and values.get("grade") is None:
            raise Needs("fluid.grade; the temperature at which viscosity holds is heat.reference_temperature")
        return value

    @validator("kappa", "chi", always=True)
    def _law_is_complete(cls, value, values):
        if value is None and values.get("law") == "seed":
            raise ValueError("missing for this law")
        return value

    @validator("gamma", "lambda_", always=True)
    def _density_of_textbooks(cls, value, values, field):
        if value is None and values.get("density") == "dowson-higginson":
            return DENSITY[field.name]
        return value

    @validator("kappa", "lambda_")
    def _check_upper_bound(cls, value, values, field):
        # kappa >= eta0 reverses the sign of the exponent; lambda > gamma makes the density fall with pressure
        limit = values.get("viscosity" if field.name == "kappa" else "gamma")
        equal_too = field.name == "kappa"
        if value is not None and limit is not None and (value > limit or equal_too and value == limit):
            raise ValueError("too large")
        return value

    @root_validator(skip_on_failure=True)
    def _roelands(cls, values):
        """Missing constants from kappa and chi of the equivalent law, or from eta0 and alpha."""
        if values["law"] != "roelands":
            return values
        eta0, alpha, kappa, chi = (values[k] for k in ("viscosity", "pressure_viscosity", "kappa", "chi"))
        other = kappa is not None and chi is not None
        pressure = values["roelands_pressure"] or (1.0 / chi if other else ROELANDS_PRESSURE)
        decades = math.log(eta0 / kappa) if other else math.log(eta0 / ROELANDS_VISCOSITY)
        z = values["roelands_z"]
        if z is None:
            z = alpha * pressure / decades if decades > 0.0 else math.inf
            if not 1e-3 <= z <= 2.0:
                raise ValueError(
                    f"roelands_z is missing, and by viscosity and pressure_viscosity it is {z:.3g}; allowed: "
                    "0.001 to 2 (viscosity in Pa s, pressure_viscosity in 1/Pa?)"
                )
        return values | {"roelands_z": z, "roelands_pressure": pressure}
