"""Gear pairs: geometry, path of contact, load sharing, losses, hunting teeth, standards.

Geometry alone: no solver, no PETSc. ``ehlpetsc gears CASE.toml`` prints the table of a ``[gears]``
case and draws it.
"""

from importlib import import_module

__all__ = ["GearPair", "Path", "path_of_contact"]


def __getattr__(name: str) -> object:
    """Public names; a case without gears loads none."""
    if name in __all__:
        module = "geometry" if name == "GearPair" else "path"
        return getattr(import_module(f"ehlpetsc.gears.{module}"), name)
    raise AttributeError(f"module 'ehlpetsc.gears' has no attribute {name!r}")
