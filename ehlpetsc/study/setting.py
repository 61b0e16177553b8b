"""Setting of a run in a study: values that differ from those of the case."""

import json
from dataclasses import dataclass

MESH, STEP, NEAR = "mesh.points_per_half_width", "time.courant", "mesh.near_field"
MODEL, FILM = "contact.model", "contact.boundary_film"
ATOL, RTOL, RANKS = "-snes_atol", "-ksp_rtol", "ranks"


@dataclass(frozen=True)
class Setting:
    """Setting of one run.

    Attributes
    ----------
    values : dict
        By key of the case file (``table.key``), by PETSc option (``-name``), and `RANKS`.
    varied : str
        Name of the varied value; "" for several.
    label : object
        Varied value, as printed in the table.
    """

    values: dict
    varied: str = ""
    label: object = ""

    @property
    def ranks(self):
        """Number of ranks."""
        return self.values.get(RANKS, 1)

    def overrides(self):
        """``table.key=value`` of the case."""
        return [f"{key}={value}" for key, value in self.values.items() if "." in key]

    def options(self):
        """Arguments for PETSc options."""
        pairs = [(key, f"{value:g}") for key, value in self.values.items() if key.startswith("-")]
        return [word for pair in pairs for word in pair]


def stored(fields, every):
    """Overrides for fields stored at intervals of `every` time steps."""
    return [f"output.every={every}", f"output.fields={json.dumps(fields)}"]
