"""`[life]`: surfaces over many passes, solved now and then; read by `ehlpetsc.life` alone."""

from ehlpetsc.case.tables.table import Table
from ehlpetsc.case.tables.validation import Field


class Life(Table):
    """`[life]`: number of passes, and how many of them a solved one may stand for."""

    passes: float = Field(1e6, ge=1, le=1e12, description="passes of both surfaces over each other")
    wear_jump: float = Field(
        0.05, gt=0, le=1, description="wear depth between two solved passes over the combined Rq"
    )
    damage_jump: float = Field(0.1, gt=0, le=1, description="damage of any point between two solved passes")
    pits: bool = Field(True, description="failed cells at the surface break out; false: they are counted")
    partners: int = Field(
        4,
        ge=1,
        le=1000,
        description="positions of surface 2, time.pass_shift apart, that a round solves; "
        "of gears, teeth of the wheel: as many as a pinion tooth meets at most",
    )
    max_solved: int = Field(500, ge=1, le=100_000, description="solved passes after which a life ends early")
