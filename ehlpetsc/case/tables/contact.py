"""Tables `[contact]` and `[wear]` of a case file: solids, load, contact model, wear rate."""

from typing import Literal

from ehlpetsc.case.schema.table import Needs, Table
from ehlpetsc.case.schema.validation import Field, confloat, validator
from ehlpetsc.materials import STEELS

BOUNDARY_FILM = 10e-9  # m: an adsorbed or reacted layer has 2 to 50 nm
ASPERITY_DEFAULTS = {"asperity_stiffness": 1.0, "asperity_slope": 0.1}  # ground and superfinished steel
SteelName = Literal[tuple(STEELS)]
Modulus = confloat(ge=1e6, le=1e18)
Ratio = confloat(ge=0.0, le=0.5)
Pressure = confloat(ge=1e6, le=1e18)
WearRate = confloat(ge=0.0, le=1e-10)


class Contact(Table):
    """`[contact]`: solids and load."""

    radius: float = Field(..., ge=1e-9, le=100, unit="m", description="radius of relative curvature")
    load: float = Field(..., ge=1e-3, le=1e10, unit="N/m", description="load per length of contact")
    material: tuple[SteelName, SteelName] | None = Field(
        None,
        one_for_both=True,
        description="steel of both solids, or of each: elastic and fatigue constants, and the pressure at "
        "which it yields",
    )
    youngs_modulus: tuple[Modulus, Modulus] = Field(
        ...,
        unit="Pa",
        one_for_both=True,
        description="of both solids, or of surfaces 1 and 2; with material left out",
    )
    poisson_ratio: tuple[Ratio, Ratio] = Field(
        ...,
        one_for_both=True,
        description="of both solids, or of surfaces 1 and 2; with material left out",
    )
    boundary_friction: float = Field(
        0.0, ge=0, le=2, description="boundary friction coefficient: shear stress over pressure of the solids"
    )
    model: Literal["direct", "mixed"] = Field(
        "direct", description="the film's bound replaces Reynolds; or oil and solids carry side by side"
    )
    asperity_height: float | None = Field(
        None,
        ge=1e-11,
        le=1e-6,
        unit="m",
        description="mixed contact: rms height of the roughness finer than the mesh, whose asperities carry "
        'beta E* exp(-2 h/asperity_height), instead of boundary_film; "measured": of what short_cutoff '
        "removes, both surfaces together",
    )
    asperity_stiffness: float | None = Field(
        None,
        ge=1e-4,
        le=1e4,
        description="beta of that law [1]; theory: 6 to 11 times asperity_height over the longest wave",
    )
    asperity_slope: float | None = Field(
        None, ge=1e-4, le=10, description="rms slope of that roughness, for the real area of contact [0.1]"
    )
    boundary_film: float | None = Field(
        None,
        ge=1e-11,
        le=1e-6,
        unit="m",
        description="mixed contact: film below which the solids carry [10 nm]",
    )
    minimum_film: float = Field(
        0.0, ge=0, le=1e-6, unit="m", description="direct contact: the bound of the film thickness"
    )
    yield_pressure: tuple[Pressure, Pressure] | None = Field(
        None,
        unit="Pa",
        one_for_both=True,
        description="mixed contact: pressure at which solids yield, of both or of surfaces 1 and 2, or "
        '"material": that of contact.material; left out: elastic',
    )

    @property
    def has_contact_pressure(self):
        """Whether the pressure of the solids is separate from that of the oil."""
        return self.model == "mixed"

    @property
    def law(self):
        """Contact law: "direct", "mixed" (rigid below the boundary film) or "compliant"."""
        return self.model if self.asperity_height is None else "compliant"

    @validator("boundary_film", always=True)
    def _of_mixed_contact(cls, value, values):
        if values.get("model") != "mixed":
            if value is not None:
                raise Needs('contact.model = "mixed"')
            return None
        if values.get("asperity_height") is not None:
            if value is not None:
                raise Needs("asperity_height left out")
            return None
        return BOUNDARY_FILM if value is None else value

    @validator("asperity_height")
    def _of_mixed_contact_as_well(cls, value, values):
        if value is not None and values.get("model") != "mixed":
            raise Needs('contact.model = "mixed"')
        return value

    @validator("asperity_stiffness", "asperity_slope", always=True)
    def _of_asperities(cls, value, values, field):
        if values.get("asperity_height") is None:
            if value is not None:
                raise Needs("asperity_height")
            return None
        return ASPERITY_DEFAULTS[field.name] if value is None else value

    @validator("minimum_film")
    def _of_direct_contact(cls, value, values):
        if value and values.get("model") == "mixed":
            raise Needs('contact.model = "direct"')
        return value

    @validator("material", "youngs_modulus", "poisson_ratio", "yield_pressure", pre=True)
    def _of_both(cls, value):
        return value if value is None or isinstance(value, (list, tuple)) else [value, value]

    @validator("yield_pressure")
    def _of_mixed_contact_too(cls, value, values):
        if value is not None and values.get("model") != "mixed":
            raise Needs('contact.model = "mixed"')
        return value


class Wear(Table):
    """`[wear]`; without it surfaces do not wear."""

    coefficient: tuple[WearRate, WearRate] = Field(
        ..., unit="m^2/N", one_for_both=True, description="specific wear rate k, of both or of each surface"
    )

    @validator("coefficient", pre=True)
    def _of_both(cls, value):
        return value if isinstance(value, (list, tuple)) else [value, value]
