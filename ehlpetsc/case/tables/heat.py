"""Keys of `[heat]`: temperatures, and thermal properties of both bodies and of the oil."""

from ehlpetsc.case.schema.table import Table
from ehlpetsc.case.schema.validation import Field, confloat, root_validator, validator

Temperature = confloat(ge=150.0, le=2000.0)
Conductivity = confloat(ge=1e-3, le=1e4)
Density = confloat(ge=10.0, le=1e5)
Capacity = confloat(ge=10.0, le=1e5)
PAIRS = ("bulk_temperature", "conductivity", "density", "heat_capacity")


class Heat(Table):
    """`[heat]`; without it the case is isothermal. Defaults: steel and mineral oil."""

    bulk_temperature: tuple[Temperature, Temperature] = Field(
        ..., unit="K", one_for_both=True, description="of both bodies far from the contact, or of each"
    )
    inlet_temperature: Temperature | None = Field(
        None, unit="K", description="of the oil that enters; left out: mean of both bodies"
    )
    conductivity: tuple[Conductivity, Conductivity] = Field(
        (46.0, 46.0), unit="W/(m K)", one_for_both=True, description="of both bodies, or of each"
    )
    density: tuple[Density, Density] = Field(
        (7850.0, 7850.0), unit="kg/m^3", one_for_both=True, description="of both bodies, or of each"
    )
    heat_capacity: tuple[Capacity, Capacity] = Field(
        (470.0, 470.0), unit="J/(kg K)", one_for_both=True, description="of both bodies, or of each"
    )
    oil_conductivity: float = Field(0.14, ge=1e-3, le=10, unit="W/(m K)", description="at ambient pressure")
    oil_conductivity_pressure: float = Field(
        0.0, ge=0, le=1e-7, unit="1/Pa", description="relative increase; mineral oils about 1e-9"
    )
    oil_density: float = Field(860.0, ge=100, le=5000, unit="kg/m^3", description="at ambient pressure")
    oil_heat_capacity: float = Field(2000.0, ge=100, le=1e5, unit="J/(kg K)", description="of the oil")
    reference_temperature: Temperature | None = Field(
        None, unit="K", description="where fluid.viscosity holds; left out: inlet_temperature"
    )
    viscosity_temperature: float | None = Field(
        None, ge=0, le=1, unit="1/K", description="beta of the exponential law [0.04]"
    )
    roelands_s0: float | None = Field(None, ge=0, le=10, description="S0 of Roelands' law, in place of beta")
    thermal_expansion: float = Field(
        0.0, ge=0, le=0.01, unit="1/K", description="beta_v of the oil: heat of compression"
    )

    @validator(*PAIRS, pre=True)
    def _of_both(cls, value):
        return value if isinstance(value, (list, tuple)) else [value, value]

    @root_validator(skip_on_failure=True)
    def _one_law(cls, values):
        beta, s0 = values["viscosity_temperature"], values["roelands_s0"]
        if beta is not None and s0 is not None:
            raise ValueError("roelands_s0: allowed: without viscosity_temperature")
        return values

    @property
    def oil_inlet_temperature(self):
        """Temperature of the oil that enters [K]."""
        return self.inlet_temperature or 0.5 * sum(self.bulk_temperature)
