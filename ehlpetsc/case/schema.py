"""Every key of a case file: type, unit, bounds, default and meaning.

One model a table of the file; attribute names are the keys (`lambda` is `lambda_`). Bounds are wide enough
for any machine element in SI units and narrow enough that a value in GPa, mm or um is found out.
"""

from typing import Any, Literal

from ehlpetsc.case.validation import BaseModel, Extra, Field, confloat, conint, root_validator, validator
from ehlpetsc.quantities import FIELDS

BOUNDARY_FILM = 10e-9  # m: an adsorbed or reacted layer has 2 to 50 nm
MAX_NODES = 200_000  # beyond it the work of a step is hours: more likely a slip of the pen

Modulus = confloat(ge=1e6, le=1e18)
Ratio = confloat(ge=0.0, le=0.5)
Height = confloat(ge=1e-12, le=1e-2)
Length = confloat(ge=1e-9, le=1.0)
Depth = confloat(ge=0, le=100)
Residual = confloat(ge=-1e10, le=1e10)
Column = conint(ge=1, le=1000)
UNITS = ("m", "mm", "um", "nm")  # of profile files


def _is(kind, value):
    """TOML's own types: an integer is a number, true and false are not."""
    if isinstance(value, bool):
        return kind is bool
    return isinstance(value, (int, float) if kind is float else kind)


class Table(BaseModel):
    """A table of the case file: frozen, no unknown keys, no silent conversions."""

    class Config:
        extra = Extra.forbid
        allow_mutation = False
        allow_population_by_field_name = False

    @validator("*", pre=True)
    def _no_conversion(cls, value, field):
        kind = next((k for k in (bool, int, float, str, dict) if _subclass(item_type(field), k)), None)
        if value is None or kind is None:  # None: left out
            return value
        for item in value if isinstance(value, list) and kind is not dict else [value]:
            if not _is(kind, item):
                raise TypeError(f"{kind.__name__} expected")
            if kind is float and not -1e308 < item < 1e308:  # nan compares false
                raise ValueError("not finite")
        return value


def _subclass(type_, kind):
    return isinstance(type_, type) and issubclass(type_, (BaseModel, dict) if kind is dict else kind)


def item_type(field):
    """Type of a key, of its items where it takes several."""
    return field.sub_fields[0].type_ if field.sub_fields and field.shape != 1 else field.type_


class Contact(Table):
    """`[contact]`: solids and load."""

    radius: float = Field(..., ge=1e-9, le=100, unit="m", description="radius of relative curvature")
    load: float = Field(..., ge=1e-3, le=1e10, unit="N/m", description="load per length of contact")
    youngs_modulus: tuple[Modulus, Modulus] = Field(..., unit="Pa", description="of surface fast and slow")
    poisson_ratio: tuple[Ratio, Ratio] = Field(..., description="of surface fast and slow")
    boundary_friction: float = Field(0.0, ge=0, le=2, description="|q|/p at dry nodes")
    model: Literal["direct", "mixed"] = Field(
        "direct", description="the film's bound replaces Reynolds; or oil and solids carry side by side"
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

    @validator("boundary_film", always=True)
    def _of_mixed_contact(cls, value, values):
        if values.get("model") != "mixed":
            if value is not None:
                raise ValueError("for mixed contact")
            return None
        return BOUNDARY_FILM if value is None else value


class Fluid(Table):
    """`[fluid]`: viscosity, density and Eyring stress."""

    viscosity: float = Field(..., ge=1e-6, le=1e4, unit="Pa s", description="at ambient pressure")
    law: Literal["seed", "barus", "roelands"] = Field(..., description="viscosity law")
    pressure_viscosity: float = Field(..., ge=1e-12, le=1e-6, unit="1/Pa", description="alpha")
    kappa: float | None = Field(None, ge=1e-9, le=1, unit="Pa s", description="seed law, below viscosity")
    chi: float | None = Field(None, ge=1e-12, le=1e-6, unit="1/Pa", description="seed law")
    roelands_z: float | None = Field(None, ge=1e-3, le=2, description="Roelands law, exponent z")
    roelands_pressure: float | None = Field(None, ge=1e6, le=1e10, unit="Pa", description="Roelands law, pr")
    density: Literal["dowson-higginson", "incompressible"] = Field(..., description="density law")
    gamma: float | None = Field(None, ge=0, le=1e-6, unit="1/Pa", description="Dowson-Higginson density")
    lambda_: float | None = Field(
        None, alias="lambda", ge=0, le=1e-6, unit="1/Pa", description="Dowson-Higginson density, below gamma"
    )
    eyring_stress: float | None = Field(None, ge=1e3, le=1e12, unit="Pa", description="left out: Newtonian")
    inlet_film: float | None = Field(
        None, ge=1e-10, le=1e-2, unit="m", description="oil film at the inlet; left out: fully flooded"
    )

    @validator("kappa", "chi", "roelands_z", "roelands_pressure", "gamma", "lambda_", always=True)
    def _law_is_complete(cls, value, values, field):
        law, density = values.get("law"), values.get("density")
        needed = {
            "kappa": law == "seed",
            "chi": law == "seed",
            "roelands_z": law == "roelands",
            "roelands_pressure": law == "roelands",
            "gamma": density == "dowson-higginson",
            "lambda_": density == "dowson-higginson",
        }
        if value is None and needed[field.name]:
            raise ValueError("missing for this law")
        return value

    @validator("kappa", "lambda_")
    def _below(cls, value, values, field):
        # kappa >= eta0 turns the seed law's exponent round; lambda > gamma thins the oil under pressure
        limit = values.get("viscosity" if field.name == "kappa" else "gamma")
        equal_too = field.name == "kappa"
        if value is not None and limit is not None and (value > limit or equal_too and value == limit):
            raise ValueError("too large")
        return value


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


class Ground(Table):
    """A random profile of given Ra, correlation length and skewness."""

    kind: Literal["ground"]
    ra: float = Field(..., ge=1e-12, le=1e-3, unit="m", description="mean height deviation")
    correlation: Length = Field(..., unit="m", description="lag at which the autocorrelation is 1/e")
    skewness: float = Field(0.0, ge=-3, le=3, description="negative: plateaus with valleys")
    seed: int = Field(..., ge=0, le=2**32 - 1, description="of the random numbers")


class Wave(Table):
    """A cosine or square wave with a crest at profile abscissa 0."""

    kind: Literal["sine", "square"]
    amplitude: Height = Field(..., unit="m", description="half of the peak to valley height")
    wavelength: Length = Field(..., unit="m", description="crest to crest")


class Bump(Table):
    """One ridge or dent of Gaussian section."""

    kind: Literal["ridge", "dent"]
    amplitude: Height = Field(..., unit="m", description="height of the ridge, depth of the dent")
    wavelength: Length = Field(..., unit="m", description="full width at 1/e")
    position: float | None = Field(
        None, ge=0, le=10, unit="m", description="abscissa of the centre; left out: 2 wavelengths"
    )


SYNTHETIC = {"ground": Ground, "sine": Wave, "square": Wave, "ridge": Bump, "dent": Bump}


class SurfaceProfile(Table):
    """`[surface.fast]`, `[surface.slow]`: a measured or a synthetic profile."""

    file: str | None = Field(None, min_length=1, description="profile file, beside the case file")
    unit: Literal[UNITS] | None = Field(None, description="of the heights in the file; left out: m")
    x_unit: Literal[UNITS] | None = Field(None, description="of x in the file; left out: as unit")
    spacing: Length | None = Field(None, unit="m", description="of points without x in the file")
    columns: list[Column] | None = Field(
        None, min_items=1, max_items=2, description="of x and z in the file, or of z alone, counted from 1"
    )
    decimal: Literal[".", ","] | None = Field(None, description="decimal sign; left out: found from the file")
    header_lines: int | None = Field(
        None, ge=0, le=100_000, description="lines before the numbers; left out: found from the file"
    )
    fill_gaps: float | None = Field(
        None, ge=0, le=1, unit="m", description="longest gap of missing heights that the spline bridges"
    )
    z: list[confloat(ge=-1e9, le=1e9)] | None = Field(
        None, min_items=4, description="heights in unit, here instead of in a file"
    )
    x: list[confloat(ge=-1e9, le=1e9)] | None = Field(
        None, min_items=4, description="of the heights z, in x_unit; with spacing left out"
    )
    level: bool = Field(False, description="subtract the least-squares line")
    cutoff: Length | None = Field(None, unit="m", description="Gaussian high-pass, ISO 16610-21")
    short_cutoff: Length | None = Field(
        None, unit="m", description="Gaussian low-pass, S-filter of ISO 3274, below cutoff"
    )
    flip: bool = Field(False, description="run the profile from its other end")
    synthetic: dict | None = Field(None, description='{ kind = "' + '" | "'.join(SYNTHETIC) + '", ... }')
    scale: float = Field(1.0, ge=-1e4, le=1e4, description="factor on the heights; negative: turned over")

    @validator("short_cutoff")
    def _below_the_cutoff(cls, value, values):
        if value is not None and values.get("cutoff") is not None and value >= values["cutoff"]:
            raise ValueError("not below cutoff")
        return value

    @validator("synthetic")
    def _kind(cls, value):
        """The keys of a synthetic profile are those of its kind."""
        if value is None:
            return None
        model = SYNTHETIC.get(value.get("kind")) if isinstance(value.get("kind"), str) else None
        if model is None:
            raise ValueError("unknown kind")
        return model(**value)

    @root_validator(skip_on_failure=True)
    def _one_source(cls, values):
        sources = ("file", "synthetic", "z")
        if sum(values[key] is not None for key in sources) != 1:
            raise ValueError("needs either file or synthetic, or the heights z: one of them")
        if values["z"] is None and values["x"] is not None:
            raise ValueError("x is for heights z")
        if values["z"] is not None and (values["x"] is None) == (values["spacing"] is None):
            raise ValueError("heights z need either x or spacing")
        if values["x"] is not None and len(values["x"]) != len(values["z"]):
            raise ValueError(f"x has {len(values['x'])} values, z {len(values['z'])}; allowed: as many")
        of_text = [key for key in ("columns", "decimal", "header_lines") if values[key] is not None]
        if values["z"] is not None and of_text:
            raise ValueError(f"{', '.join(of_text)}: for a file, not for heights z")
        for_a_file = [key for key in values if key not in (*sources, "scale")]
        if values["synthetic"] and any(values[key] not in (None, False) for key in for_a_file):
            raise ValueError(f"{', '.join(for_a_file)} are for a file, not for a synthetic profile")
        return values


class Surface(Table):
    """`[surface]`: a side left out is smooth."""

    fast: SurfaceProfile | None = Field(None, description="profile of the surface moving at u (1 + xi/2)")
    slow: SurfaceProfile | None = Field(None, description="profile of the surface moving at u (1 - xi/2)")


class Time(Table):
    """`[time]`: left out, the case is steady."""

    travel: float = Field(
        ..., ge=1e-6, le=1e5, unit="half widths", description="of the faster surface, from the smooth start"
    )
    courant: float = Field(0.5, ge=1e-3, le=100, description="u_max dt/dx")


class Output(Table):
    """`[output]`: what the result file holds."""

    every: int = Field(1, ge=1, le=10**9, description="steps between stored fields")
    fields: list[Literal[tuple(FIELDS)]] = Field(list(FIELDS), min_items=1, description="stored fields")
    precision: Literal["float64", "float32"] = Field("float64", description="of the stored fields")
    thin_film: float = Field(
        2.0, ge=1, le=1000, unit="boundary films", description="mixed contact: films below it count as thin"
    )
    checkpoint: float = Field(10.0, gt=0, le=1e5, unit="minutes", description="between restart files")


class Post(Table):
    """`[post]`: read by `ehlpetsc.post` alone; checked here so that a slip shows before the run."""

    depths: list[Depth] | None = Field(None, min_items=1, unit="half widths", description="z/a")
    b: float | None = Field(None, gt=-2, lt=0, description="fatigue strength exponent")
    c: float | None = Field(None, gt=-5, lt=0, description="fatigue ductility exponent")
    cyclic_hardening: float | None = Field(None, gt=0, lt=1, description="n'")
    fatigue_strength: float | None = Field(None, ge=1e6, le=1e12, unit="Pa", description="sigma_f'")
    fatigue_ductility: float | None = Field(None, ge=1e-6, le=100, description="eps_f'")
    cyclic_strength: float | None = Field(
        None, ge=1e6, le=1e12, unit="Pa", description="K'; left out: sigma_f'/eps_f'^n'"
    )
    residual_stress: list[tuple[Depth, Residual]] | None = Field(
        None, min_items=1, description="[[z/a, Pa], ...] along the surface, depths rising"
    )
    normal_sensitivity: float | None = Field(None, ge=0, le=10, description="k of Fatemi and Socie")
    yield_strength: float | None = Field(
        None, ge=1e6, le=1e12, unit="Pa", description="of Fatemi and Socie; left out: cyclic, 0.2 %"
    )
    torsion_limit: float | None = Field(None, ge=1e6, le=1e12, unit="Pa", description="of Dang Van")
    bending_limit: float | None = Field(None, ge=1e6, le=1e12, unit="Pa", description="of Dang Van")

    @validator("residual_stress", pre=True)
    def _rows_of_numbers(cls, value):
        rows = [row for row in value if isinstance(row, list)] if isinstance(value, list) else []
        if not all(_is(float, item) for row in rows for item in row):
            raise TypeError("numbers expected")
        depths = [row[0] for row in rows if row]
        if sorted(set(depths)) != depths:
            raise ValueError("depths must rise")
        return value


class Series(Table):
    """`[series]`: one key swept over values, one member a value."""

    key: str = Field(..., regex=r"^[A-Za-z_]+(\.[A-Za-z_]+)+$", description='as in "fluid.viscosity"')
    values: list[Any] = Field(..., min_items=1, description="a list of values of that key")
