"""The near-exact inverse of a contact's matrix: an LU of a band that knows the far deflection."""

from ehlpetsc.nonlinear.preconditioner.far_field_band import FarFieldBand

__all__ = ["FarFieldBand"]
