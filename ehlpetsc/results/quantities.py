"""Every dataset of a result file in one table: unit, long name, dimensions, type.

The writer, the reader, `ehlpetsc.analysis.compare` and `ehlpetsc.plot` know the quantities from here alone.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Field:
    """What is stored about a dataset beside its values.

    Attributes
    ----------
    units : str
        SI unit, "1" for a number.
    long_name : str
        Name for axes and headings.
    dims : tuple of str
        Names of the dimension scales, each beside the dataset or in a group above it.
    dtype : str
        Type on disk; the stored fields may be narrowed to float32 on request.
    """

    units: str
    long_name: str
    dims: tuple
    dtype: str = "f8"


_FRAME = ("time", "x")
_STEP = ("time",)

FIELDS = {
    "pressure": Field("Pa", "pressure", _FRAME),
    "film_thickness": Field("m", "film thickness", _FRAME),
    "void_fraction": Field("1", "void fraction of the film", _FRAME),
    "shear_stress_fast": Field("Pa", "shear stress on the fast solid", _FRAME),
    "shear_stress_slow": Field("Pa", "shear stress on the slow solid", _FRAME),
    "in_contact": Field("1", "surfaces in contact (film thickness at its bound)", _FRAME, "u1"),
}
"""Fields over (stored frame, node), in the order in which files list them."""

STEP_SCALARS = {
    "step": Field("1", "number of the time step", _STEP, "i8"),
    "dt": Field("s", "time step", _STEP),
    "newton": Field("1", "Newton iterations of the step, retries included", _STEP, "i4"),
    "retries": Field("1", "attempts that did not converge", _STEP, "i4"),
    "h_min": Field("m", "least film thickness", _STEP),
    "p_max": Field("Pa", "greatest pressure", _STEP),
    "contacts": Field("1", "nodes in contact", _STEP, "i4"),
    "load": Field("N/m", "integral of the pressure", _STEP),
    "load_error": Field("1", "relative error of the load", _STEP),
    "mass_error": Field("1", "relative defect of the mass balance", _STEP),
    "approach": Field("m", "undeformed separation h00", _STEP),
    "friction": Field("N/m", "friction force on the slow solid", _STEP),
    "wall": Field("s", "wall clock time of the step", _STEP),
}
"""Scalars of every time step, below ``steps/``."""

OTHERS = {
    "x": Field("m", "distance along the entrainment direction", ("x",)),
    "time": Field("s", "time of the stored frame", ("time",)),
    "step": Field("1", "number of the time step stored in the frame", ("time",), "i8"),
    "contact_count": Field("1", "time steps in contact over the whole run", ("x",), "i8"),
    "steps/time": Field("s", "time at the end of the step", _STEP),
    "surface/s": Field("m", "coordinate fixed to the surface, s = x - speed time", ("s",)),
    "surface/z": Field("m", "height, positive out of the metal", ("s",)),
}
"""Coordinates and what else is neither a field nor a scalar of the step."""

GROUPS = {
    "/": "Result of ehlpetsc, in SI units. Attributes: the case as run, Hertz half width a [m] and pressure "
    "p0 [Pa], h_scale = a^2/R [m], speeds u1 (fast), u2 (slow) [m/s], provenance, how the run ended (status)",
    "steps": "a row for every accepted time step, also where no frame is stored",
    "surface": "profiles as used, fixed in the bodies",
    "surface/fast": "attributes: speed [m/s], ra, rq [m], rsk [1] of the whole profile",
    "surface/slow": "attributes: speed [m/s], ra, rq [m], rsk [1] of the whole profile",
}
"""What the groups hold."""
