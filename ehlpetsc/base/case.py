"""Checked values of a case file, as all parts of the program read them; the keys are in `case.tables`."""

from __future__ import annotations

from array import array
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from ehlpetsc.base.declarations import Values
from ehlpetsc.base.toml_file import toml_text

DIGEST_LENGTH = 16  # characters


class Kind(NamedTuple):
    """Quantities and parts in which the kinds of contact differ.

    `is_whole`: whether integrals are of the whole contact; of lines and strips they are per metre of width.
    `radii`: after a unit that another kind does not have.
    `is_areal`: whether surfaces are maps; of a line they are profiles.

    Parts, ``module:name``, each loaded where it is used, so that a kind loads no module of another one:
    `geometry`: a :class:`ehlpetsc.physics.contact.geometry.Geometry`.
    `forecast`: a :class:`ehlpetsc.run.forecast.kinds.Forecast`.
    `system`: system of equations, see :func:`ehlpetsc.nonlinear.solver_of`.
    `linear_solver`: options of PETSc's linear solver, from those of the user.

    `has_ends`: whether the contact ends along its length, as of a roller.
    `picture`: module of `ehlpetsc.pictures.frames` that draws its fields.
    `surroundings`: of a part of a contact, a function that solves what is beyond its mesh; "": nothing is.
    """

    is_whole: bool
    radii: str
    is_areal: bool
    geometry: str
    forecast: str
    system: str
    linear_solver: str
    has_ends: bool = False
    picture: str = "line"
    surroundings: str = ""

    @property
    def mean_height(self) -> str:
        """Name of the mean deviation of the heights of a surface."""
        return "Sa" if self.is_areal else "Ra"

    def part(self, name: str) -> Any:
        """Load a part."""
        module, _, attribute = getattr(self, name).partition(":")
        return getattr(import_module(f"ehlpetsc.{module}"), attribute)


KINDS = {
    "line": Kind(
        is_whole=False,
        radii=" in a line contact or a strip, of one radius",
        is_areal=False,
        geometry="physics.contact.geometry:LINE",
        forecast="run.forecast.kinds:LINE",
        system="nonlinear.line.system:line_system",
        linear_solver="nonlinear.options:line_solver",
    )
}
KINDS["strip"] = KINDS["line"]._replace(
    is_areal=True,
    geometry="physics.contact.geometry:STRIP",
    forecast="run.forecast.kinds:STRIP",
    system="nonlinear.plane.system:plane_system",
    linear_solver="nonlinear.options:plane_solver",
    picture="plane",
)
KINDS["point"] = KINDS["strip"]._replace(
    is_whole=True,
    radii=" in a point contact, of two radii",
    geometry="physics.contact.geometry:POINT",
    forecast="run.forecast.kinds:POINT",
)
KINDS["roller"] = KINDS["point"]._replace(
    radii=" in a roller, of one radius and a length",
    geometry="physics.contact.roller:ROLLER",
    forecast="run.forecast.kinds:ROLLER",
    linear_solver="nonlinear.options:roller_solver",
    has_ends=True,
    picture="roller",
)
KINDS["window"] = KINDS["roller"]._replace(
    radii=" in a window of a roller, of one radius and a length",
    geometry="physics.contact.window:WINDOW",
    forecast="run.forecast.kinds:WINDOW",
    linear_solver=KINDS["point"].linear_solver,
    picture="window",
    surroundings="run.surroundings:of_roller",
)
"""Kinds of contact by name, :attr:`Case.kind`."""


def kind_of(tables: dict[str, Any]) -> str:
    """Kind of contact, a key of `KINDS`, of tables of a case, which may have faults."""
    contact, mesh = (
        table if isinstance(table, dict) else {} for table in map(tables.get, ("contact", "mesh"))
    )
    if isinstance(contact.get("radius"), list | tuple):
        return "point"
    if contact.get("length") is not None:
        return "roller" if mesh.get("window") is None else "window"
    return "line" if mesh.get("width") is None else "strip"


class Contact(Values):
    """`[contact]`: solids and load."""

    @property
    def has_contact_pressure(self) -> bool:
        """Whether the pressure of the solids is separate from that of the oil."""
        return self.model == "mixed"

    @property
    def law(self) -> str:
        """Contact law: "direct", "mixed" (rigid below the boundary film) or "compliant"."""
        return self.model if self.asperity_height is None else "compliant"


class Fluid(Values):
    """`[fluid]`: the oil."""


class Case(Values):
    """Case by tables, `case.fluid.viscosity`; a missing table is None.

    `contact` and `motion` of variable conditions contain the reference state of the scales.
    """

    @property
    def text(self) -> str:
        """TOML text with the overrides, which in the same folder defines the same case.

        Maps given as heights are named by a digest.
        """
        if self._text is None:  # generated when it is needed: members of a long series
            self.__dict__["_text"] = toml_text(with_digests(self._tables))
        return self._text

    @property
    def default_friction(self) -> float | None:
        """Coefficient of friction of sliding solids by default; None: given, or nothing slides."""
        given = "boundary_friction" in self._tables["contact"]
        slides = self.motion is not None and (
            self.conditions is not None
            or self.motion.slide_roll_ratio
            or self.motion.spin
            or self.contact.groove_radius
        )
        return self.contact.boundary_friction if slides and not given else None

    @property
    def path(self) -> Path:
        """Path of the case file, in whose folder profile files are."""
        return self._path

    @property
    def digests(self) -> dict[str, str]:
        """Digests of the surface files as read, see `ehlpetsc.case.tables.surface`; {} of a stored case."""
        return vars(self).get("_digests", {})

    @property
    def kind(self) -> str:
        """Kind of contact, a key of `KINDS`."""
        return self._kind

    @property
    def conditions(self) -> Any:
        """Load, radius and speeds over time (`physics.variable_operation`); None: constant."""
        return self._conditions


def with_digests(tables: dict[str, Any]) -> dict[str, Any]:
    """Tables of a case with heights of maps, which may be long, replaced by a file named by their digest."""
    surfaces = dict(tables.get("surface", {}))
    for side, table in surfaces.items():
        if isinstance(table, dict) and isinstance(table.get("z"), list) and isinstance(table["z"][0], list):
            numbers = [array("d", row) for row in (*table["z"], table.get("x", []), table.get("y", []))]
            digest = sha256(b"".join(row.tobytes() for row in numbers)).hexdigest()[:DIGEST_LENGTH]
            kept = {key: value for key, value in table.items() if key not in ("x", "y", "z")}
            surfaces[side] = {"file": f"heights_{digest}.npy"} | kept
    return tables | {"surface": surfaces} if surfaces else tables


def changed_files(before: dict[str, str], now: dict[str, str]) -> str:
    """Keys of the files whose digests differ, joined by "and"; "": none. Files in one alone do not count."""
    return " and ".join(key for key in now if before.get(key, now[key]) != now[key])
