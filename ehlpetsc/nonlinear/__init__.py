"""Selection of the nonlinear iteration, ``-ehl_scheme``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mpi4py.MPI  # noqa: F401  # loads the library that PETSc's wheel needs
import numpy as np
from petsc4py import PETSc

from ehlpetsc.base.case import KINDS, Case
from ehlpetsc.base.errors import UsageError
from ehlpetsc.nonlinear.newton import NewtonSolver
from ehlpetsc.nonlinear.options import RunOptions
from ehlpetsc.nonlinear.two_fields import ZERO_TOLERANCE
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.nonlinear.line.gauss_seidel import GaussSeidelSolver

ALLOWED = ("newton", "sweep")


def solver_of(
    case: Case, scales: Scales, film_scale: float, comm: PETSc.Comm, options: RunOptions
) -> NewtonSolver | GaussSeidelSolver:
    """Solver of one scene on one communicator.

    `film_scale`: expected film in a^2/R.
    """
    if PETSc.ScalarType is not np.float64:
        real = "needed: real numbers of double precision, as of python3-petsc4py-real or dolfinx-solver-real"
        raise UsageError(f"PETSc in {PETSc.__file__} computes with {PETSc.ScalarType.__name__}; {real}")
    name, kind = options.value("ehl_scheme"), KINDS[case.kind]
    if name and name not in ALLOWED:
        raise UsageError(f"-ehl_scheme {name}: allowed: {', '.join(ALLOWED)}")
    if name != "sweep":
        bounded = options.value("snes_type", "vinewtonrsls") == "vinewtonrsls"
        tolerance = options.real("snes_vi_zero_tolerance", ZERO_TOLERANCE) if bounded else 0.0
        return NewtonSolver(kind.part("system")(case, scales, film_scale, comm, tolerance), options)
    if not kind.sweeps:
        raise UsageError(
            f"-ehl_scheme sweep: the paper's sweeps solve line contacts, not a {case.kind}; leave it out"
        )
    if case.fluid is None:
        raise UsageError("-ehl_scheme sweep: a dry contact has no Reynolds equation to pair; leave it out")
    if case.contact.has_contact_pressure:
        raise UsageError("-ehl_scheme sweep: the paper's sweeps solve direct contact only; leave it out")
    return kind.part("sweeps")(case, scales, film_scale, options.real("snes_atol"))
