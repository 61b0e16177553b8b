"""Every key of a case file: type, unit, bounds, default and meaning; here all but surfaces and `[post]`.

One model a table of the file; attribute names are the keys (`lambda` is `lambda_`). Bounds are wide enough
for any machine element in SI units and narrow enough that a value in GPa, mm or um is found out.
"""

import math
from typing import Any, Literal

from ehlpetsc.case.tables.table import Needs, Table
from ehlpetsc.case.tables.validation import Field, confloat, constr, root_validator, validator
from ehlpetsc.materials import STEELS
from ehlpetsc.quantities import FIELDS, STORED
from ehlpetsc.sides import current_name

BOUNDARY_FILM = 10e-9  # m: an adsorbed or reacted layer has 2 to 50 nm
ASPERITIES = {"asperity_stiffness": 1.0, "asperity_slope": 0.1}  # of ground and superfinished steel
DOTTED = r"^[A-Za-z_]+(\.[A-Za-z_0-9]+)+$"  # a key below a table
MAX_MEMBERS = 10_000  # of a series
MAX_NODES = 200_000  # beyond it the work of a step is hours: more likely a slip of the pen

# the density law is (1 + gamma p)/(1 + lambda p): gamma is the sum of both constants as textbooks print them
TEXTBOOKS = "the density 1 + 0.6e-9 p/(1 + 1.7e-9 p) of textbooks is"

DENSITY = {"gamma": 2.3e-9, "lambda_": 1.7e-9}  # 1/Pa
ROELANDS_PRESSURE = 1.96e8  # Pa
ROELANDS_VISCOSITY = 6.315e-5  # Pa s: ln eta0 + 9.67 = ln(eta0/6.315e-5)

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
        """Whether the solids have a pressure of their own beside that of the oil."""
        return self.model == "mixed"

    @property
    def law(self):
        """Name of the law of contact: "direct", "mixed" (rigid from the boundary film on) or "compliant"."""
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
        return ASPERITIES[field.name] if value is None else value

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


class Grade(Table):
    """`fluid.grade`: an oil as data sheets give it."""

    v40: float = Field(..., gt=2e-6, le=0.1, unit="m^2/s", description="kinematic viscosity at 40 C")
    v100: float = Field(..., gt=2e-6, le=0.1, unit="m^2/s", description="at 100 C, below v40")
    density: float = Field(..., ge=500, le=3000, unit="kg/m^3", description="at ambient pressure")

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
    def _below(cls, value, values, field):
        # kappa >= eta0 turns the seed law's exponent round; lambda > gamma thins the oil under pressure
        limit = values.get("viscosity" if field.name == "kappa" else "gamma")
        equal_too = field.name == "kappa"
        if value is not None and limit is not None and (value > limit or equal_too and value == limit):
            raise ValueError("too large")
        return value

    @root_validator(skip_on_failure=True)
    def _roelands(cls, values):
        """Constants left out: from kappa and chi, which write the same law, or from eta0 and alpha."""
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
