"""Case: all tables of a case file, checked, with the text."""

from functools import partial
from pathlib import Path

from ehlpetsc.case.faults import show
from ehlpetsc.case.schema.table import Needs, Table, is_plain
from ehlpetsc.case.schema.validation import Field, PrivateAttr, validator
from ehlpetsc.case.tables.contact import Contact, Wear
from ehlpetsc.case.tables.discretisation import Mesh, Time
from ehlpetsc.case.tables.fluid import Fluid
from ehlpetsc.case.tables.gears import Gears
from ehlpetsc.case.tables.heat import Heat
from ehlpetsc.case.tables.operation import Motion, Operation
from ehlpetsc.case.tables.output import Output, Series
from ehlpetsc.case.tables.post import Life, Post
from ehlpetsc.case.tables.surface import Surface


class Case(Table):
    """Case; a missing table is None.

    Attributes
    ----------
    text : str
        TOML text including the overrides, which in the same folder defines the same case.
    path : pathlib.Path
        Path of the case file, in whose folder profile files are.
    """

    title: str = Field(
        ..., min_length=1, max_length=1000, description="one line for the result file and its pictures"
    )
    contact: Contact = Field(..., description="solids and load")
    fluid: Fluid | None = Field(None, description="left out: dry contact")
    motion: Motion | None = Field(None, description="speeds; needed with [fluid] and with [time]")
    mesh: Mesh = Field(..., description="nodes")
    surface: Surface = Field(Surface(), description="left out: smooth")
    time: Time | None = Field(None, description="left out: steady")
    operation: Operation | None = Field(None, description="left out: constant conditions")
    gears: Gears | None = Field(None, description="left out: constant conditions")
    wear: Wear | None = Field(None, description="left out: no wear")
    heat: Heat | None = Field(None, description="left out: isothermal; needs [motion]")
    output: Output = Field(Output(), description="what the result file holds")
    post: Post = Field(Post(), description="read by ehlpetsc.post alone")
    life: Life | None = Field(None, description="read by ehlpetsc.life alone")
    petsc: dict = Field(
        {},
        description="PETSc options without the dash, each text, a number, true (no value) or false (not set)",
    )
    series: Series | None = Field(None, description="one key swept over values")
    _text: str | partial = PrivateAttr("")
    _path: Path = PrivateAttr(Path())
    _conditions: tuple | None = PrivateAttr(None)

    @classmethod
    def of(cls, tables, text, path, conditions):
        """The case of checked tables.

        Parameters
        ----------
        tables : dict
        text : str or functools.partial
            Text, or a function that returns it.
        path : pathlib.Path
        conditions : physics.conditions_table.ConditionsTable or None
        """
        case = cls(**tables)
        case._text, case._path, case._conditions = text, path, conditions
        return case

    @validator("wear")
    def _of_mixed_contact_in_time(cls, value, values):
        contact, time = values.get("contact"), values.get("time")
        if value is not None and contact is not None and (contact.model != "mixed" or time is None):
            raise ValueError('needs contact.model = "mixed" and [time]')
        return value

    @validator("heat")
    def _of_surfaces_in_motion(cls, value, values):
        if value is not None and values.get("motion") is None:
            raise Needs("[motion]")
        return value

    @validator("petsc")
    def _options(cls, options):
        """Options as strings, as PETSc requires."""
        for name, value in options.items():
            number = isinstance(value, int | float) and abs(value) < 1e300
            text = isinstance(value, str) and is_plain(value)
            if not name or name.startswith("-") or not is_plain(name) or not (number or text):
                raise ValueError(name)
        given = {name: value for name, value in options.items() if value is not False}
        bare = {name: "" if value is True else value for name, value in given.items()}
        return {name: value if isinstance(value, str) else show(value) for name, value in bare.items()}

    @property
    def text(self):
        if isinstance(self._text, partial):  # member of a series: generated at first use
            self._text = self._text()
        return self._text

    @property
    def path(self):
        return self._path

    @property
    def conditions(self):
        """Load, radius and speeds over time: a `physics.conditions_table.ConditionsTable`; None: constant.

        `contact` and `motion` then contain the reference state of the scales.
        """
        return self._conditions
