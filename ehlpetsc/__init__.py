"""Transient mixed lubrication and contact of rough line contacts on PETSc."""

__version__ = "0.1.0"
