"""Selection of the nonlinear iteration, ``-ehl_scheme``."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from petsc4py import PETSc

from ehlpetsc.base.errors import UsageError
from ehlpetsc.nonlinear.newton import NewtonSolver
from ehlpetsc.nonlinear.options import RunOptions
from ehlpetsc.nonlinear.two_fields import ZERO_TOLERANCE, TwoFields
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.nonlinear.line.gauss_seidel import GaussSeidelSolver


def _line() -> Callable[..., TwoFields]:
    from ehlpetsc.nonlinear.line.system import line_system

    return line_system


def _plane() -> Callable[..., TwoFields]:
    from ehlpetsc.nonlinear.plane.system import plane_system

    return plane_system


def _line_sweeps() -> type[GaussSeidelSolver]:
    from ehlpetsc.nonlinear.line.gauss_seidel import GaussSeidelSolver

    return GaussSeidelSolver


SYSTEMS = {"line": _line, "strip": _plane, "point": _plane}  # a kind loads no module of another one
SWEEPS = {"line": _line_sweeps}
ALLOWED = ("newton", "sweep")


def check_scheme(name: str | None) -> None:
    """Raise a `UsageError` for an unknown scheme."""
    if name and name not in ALLOWED:
        raise UsageError(f"-ehl_scheme {name}: allowed: {', '.join(ALLOWED)}")


def solver_of(
    case: Case, scales: Scales, film_scale: float, comm: PETSc.Comm, options: RunOptions
) -> NewtonSolver | GaussSeidelSolver:
    """Solver of one scene on one communicator.

    `film_scale`: expected film in a^2/R.
    """
    name = options.value("ehl_scheme")
    check_scheme(name)
    if name != "sweep":
        bounded = options.value("snes_type", "vinewtonrsls") == "vinewtonrsls"
        tolerance = options.real("snes_vi_zero_tolerance", ZERO_TOLERANCE) if bounded else 0.0
        return NewtonSolver(SYSTEMS[case.kind]()(case, scales, film_scale, comm, tolerance), options)
    if case.kind not in SWEEPS:
        raise UsageError(
            f"-ehl_scheme sweep: the paper's sweeps solve line contacts, not a {case.kind}; leave it out"
        )
    if case.fluid is None:
        raise UsageError("-ehl_scheme sweep: a dry contact has no Reynolds equation to pair; leave it out")
    if case.contact.has_contact_pressure:
        raise UsageError("-ehl_scheme sweep: the paper's sweeps solve direct contact only; leave it out")
    return SWEEPS[case.kind]()(case, scales, film_scale, options.real("snes_atol"))
