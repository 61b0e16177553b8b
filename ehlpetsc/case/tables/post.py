"""Tables `[post]` and `[life]`: fatigue of both surfaces, and their life over many passes."""

from typing import Literal

from ehlpetsc.case.schema.table import Table, is_of
from ehlpetsc.case.schema.validation import Field, confloat, validator

Depth = confloat(ge=0, le=100)
Residual = confloat(ge=-1e10, le=1e10)


class Post(Table):
    """`[post]`: used only by `ehlpetsc.post`, but checked before the run."""

    depths: list[Depth] | None = Field(None, min_items=1, unit="half widths", description="z/a")
    b: float | None = Field(None, gt=-2, lt=0, description="fatigue strength exponent")
    c: float | None = Field(None, gt=-5, lt=0, description="fatigue ductility exponent")
    cyclic_hardening: float | None = Field(None, gt=0, lt=1, description="n'")
    fatigue_strength: float | None = Field(None, ge=1e6, le=1e12, unit="Pa", description="sigma_f'")
    fatigue_ductility: float | None = Field(None, ge=1e-6, le=100, description="eps_f'")
    cyclic_strength: float | None = Field(
        None, ge=1e6, le=1e12, unit="Pa", description="K'; left out: sigma_f'/eps_f'^n'"
    )
    strain: Literal["neuber", "glinka", "direct"] = Field(
        "neuber",
        description="rule from elastic stress ranges to strains; direct: none, as in the paper",
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
        if not all(is_of(float, item) for row in rows for item in row):
            raise TypeError("numbers expected")
        depths = [row[0] for row in rows if row]
        if sorted(set(depths)) != depths:
            raise ValueError("depths must rise")
        return value


class Life(Table):
    """`[life]`: number of passes, and how many of them a solved one may stand for."""

    passes: float = Field(1e6, ge=1, le=1e12, description="passes of both surfaces over each other")
    wear_jump: float = Field(
        0.05, gt=0, le=1, description="wear depth between two solved passes over the combined Rq"
    )
    damage_jump: float = Field(0.1, gt=0, le=1, description="damage of any point between two solved passes")
    break_out: Literal["above", "connected", "none"] = Field(
        "above",
        description="a failed cell breaks out with all cells above it; only where failed cells reach the "
        "surface; or not at all: counted",
    )
    partners: int = Field(
        4,
        ge=1,
        le=1000,
        description="positions of surface 2, time.pass_shift apart, that a round solves; "
        "of gears, teeth of the wheel: as many as a pinion tooth meets at most",
    )
    max_solved: int = Field(500, ge=1, le=100_000, description="solved passes after which a life ends early")
