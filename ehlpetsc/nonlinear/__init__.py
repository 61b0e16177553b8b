"""Newton's method for one scene of any kind of contact."""

from __future__ import annotations

import mpi4py.MPI  # noqa: F401  # loads the library that PETSc's wheel needs
import numpy as np
from petsc4py import PETSc

from ehlpetsc.base.case import KINDS, Case
from ehlpetsc.base.errors import UsageError
from ehlpetsc.nonlinear.newton import NewtonSolver
from ehlpetsc.nonlinear.options import RunOptions
from ehlpetsc.nonlinear.two_fields import ZERO_TOLERANCE
from ehlpetsc.physics.scales import Scales


def solver_of(
    case: Case, scales: Scales, film_scale: float, comm: PETSc.Comm, options: RunOptions
) -> NewtonSolver:
    """Solver of one scene on one communicator.

    `film_scale`: expected film in a^2/R.
    """
    if PETSc.ScalarType is not np.float64:
        real = "needed: real numbers of double precision, as of python3-petsc4py-real or dolfinx-solver-real"
        raise UsageError(f"PETSc in {PETSc.__file__} computes with {PETSc.ScalarType.__name__}; {real}")
    bounded = options.value("snes_type", "vinewtonrsls") == "vinewtonrsls"
    tolerance = options.real("snes_vi_zero_tolerance", ZERO_TOLERANCE) if bounded else 0.0
    system = KINDS[case.kind].part("system")
    return NewtonSolver(system(case, scales, film_scale, comm, tolerance), options)
