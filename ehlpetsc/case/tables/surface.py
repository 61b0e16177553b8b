"""`[surface]` of a case file: measured and synthetic profiles."""

from typing import Literal

from ehlpetsc.case.schema.table import Table
from ehlpetsc.case.schema.validation import Field, confloat, conint, root_validator, validator
from ehlpetsc.names import FORMER

Height = confloat(ge=1e-12, le=1e-2)
Length = confloat(ge=1e-9, le=1.0)
Column = conint(ge=1, le=1000)
UNITS = ("m", "mm", "um", "nm")  # of profile files


class Ground(Table):
    """Random profile with prescribed Ra, correlation length and skewness."""

    kind: Literal["ground"]
    ra: float = Field(..., ge=1e-12, le=1e-3, unit="m", description="mean height deviation")
    correlation: Length = Field(..., unit="m", description="lag at which the autocorrelation is 1/e")
    skewness: float = Field(0.0, ge=-3, le=3, description="negative: plateaus with valleys")
    seed: int = Field(..., ge=0, le=2**32 - 1, description="of the random numbers")


class Wave(Table):
    """Cosine or square wave with a crest at profile abscissa 0."""

    kind: Literal["sine", "square"]
    amplitude: Height = Field(..., unit="m", description="half of the peak to valley height")
    wavelength: Length = Field(..., unit="m", description="crest to crest")


class Bump(Table):
    """Single ridge or dent of Gaussian shape."""

    kind: Literal["ridge", "dent"]
    amplitude: Height = Field(..., unit="m", description="height of the ridge, depth of the dent")
    wavelength: Length = Field(..., unit="m", description="full width at 1/e")
    position: float | None = Field(
        None, ge=0, le=10, unit="m", description="abscissa of the centre; left out: 2 wavelengths"
    )


SYNTHETIC = {"ground": Ground, "sine": Wave, "square": Wave, "ridge": Bump, "dent": Bump}


class SurfaceProfile(Table):
    """`[surface.1]`, `[surface.2]`: measured or synthetic profile."""

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
        """Check the keys of a synthetic profile with the table of its kind."""
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


def with_current_sides(surface):
    """Table `[surface]` with the names 1 and 2 in place of fast and slow.

    Raises
    ------
    ValueError
        A surface has both names.
    """
    for former, side in FORMER.items():
        if former in surface and side in surface:
            raise ValueError(f"{former} and {side} are the same surface; allowed: one of them")
    return {FORMER.get(name, name): spec for name, spec in surface.items()}


class Surface(Table):
    """`[surface]`: a missing surface is smooth."""

    body_1: SurfaceProfile | None = Field(
        None, alias="1", description="profile of the surface moving at u (1 + xi/2)"
    )
    body_2: SurfaceProfile | None = Field(
        None, alias="2", description="profile of the surface moving at u (1 - xi/2)"
    )

    @root_validator(pre=True)
    def _former_names(cls, values):
        return with_current_sides(values)

    def side(self, name):
        """Profile of surface "1" or "2"; None: smooth."""
        return {"1": self.body_1, "2": self.body_2}[name]
