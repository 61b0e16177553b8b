"""Tables `[motion]` and `[operation]`: constant speeds; load, radius and speeds as functions of time."""

from ehlpetsc.case.schema.table import Table
from ehlpetsc.case.schema.validation import Field, confloat, root_validator

COLUMNS = {  # allowed names of the columns of a file, by key
    "time": ("time", "t"),
    "load": ("load", "w"),
    "radius": ("radius", "r"),
    "speed_1": ("speed 1", "u1"),
    "speed_2": ("speed 2", "u2"),
}
Number = confloat(ge=-1e15, le=1e15)


def _column(unit, description):
    text = f"{description}, here instead of in a file"
    return Field(None, min_items=2, unit=unit, description=text)


class Motion(Table):
    """`[motion]`: speeds of the surfaces."""

    entrainment_speed: float = Field(..., ge=1e-9, le=1e3, unit="m/s", description="mean of both, not zero")
    slide_roll_ratio: float = Field(0.0, ge=-100, le=100, description="(u1 - u2)/u")


class Operation(Table):
    """`[operation]`: conditions over time; others are constant, from `[contact]` and `[motion]`."""

    file: str | None = Field(
        None,
        min_length=1,
        description="CSV table beside the case file; its first line names the columns: time, load, radius, "
        "speed 1, speed 2",
    )
    repeat: int = Field(1, ge=1, le=100_000, description="times that the table is run through")
    time: list[Number] | None = _column("s", "increasing")
    load: list[Number] | None = _column("N/m", "above 0")
    radius: list[Number] | None = _column("m", "above 0")
    speed_1: list[Number] | None = _column("m/s", "of surface 1, signed")
    speed_2: list[Number] | None = _column("m/s", "of surface 2, signed")

    @root_validator(skip_on_failure=True)
    def _file_or_columns(cls, values):
        columns = [key for key in COLUMNS if values[key] is not None]
        if (values["file"] is None) == (not columns):
            raise ValueError("needs either file or time with load, radius, speed_1 or speed_2")
        return values
