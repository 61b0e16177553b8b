"""Tables `[output]` and `[series]`: stored quantities, and keys varied over values."""

import math
from typing import Any, Literal

from ehlpetsc.case.schema.table import Table
from ehlpetsc.case.schema.validation import Field, constr, root_validator, validator
from ehlpetsc.names import current_name
from ehlpetsc.quantities import FIELDS, STORED

DOTTED_KEY = r"^[A-Za-z_]+(\.[A-Za-z_0-9]+)+$"
MAX_MEMBERS = 10_000  # of a series


class Output(Table):
    """`[output]`: content of the result file."""

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
    """`[series]`: one or several varied keys; one member for each value or combination of values."""

    key: str | None = Field(None, regex=DOTTED_KEY, description='as in "fluid.viscosity"; or keys')
    keys: list[constr(regex=DOTTED_KEY)] | None = Field(None, min_items=2, description="several keys at once")
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
        if len(lists) != len(keys) or not all(isinstance(entries, list) and entries for entries in lists):
            raise ValueError(f"values: allowed: {len(keys)} lists of values, one for each of the keys")
        if values["combine"] == "step" and len({len(entries) for entries in lists}) > 1:
            counts = ", ".join(str(len(entries)) for entries in lists)
            raise ValueError(
                f'values: lists of {counts}; allowed with combine = "step": as long as each other'
            )
        members = math.prod(map(len, lists)) if values["combine"] != "step" else len(lists[0])
        if members > MAX_MEMBERS:
            raise ValueError(f"{members} members; allowed: at most {MAX_MEMBERS}")
        return values
