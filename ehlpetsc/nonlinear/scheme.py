"""Which iteration solves the equations of a time step: ``-ehl_scheme``."""

from ehlpetsc.errors import UsageError
from ehlpetsc.nonlinear.gauss_seidel import Sweeper
from ehlpetsc.nonlinear.newton import Solver
from ehlpetsc.nonlinear.options import text_of

ALLOWED = ("newton", "sweep")


def scheme(options):
    """Name of the iteration asked for.

    Raises
    ------
    options.UsageError
        There is none of that name.
    """
    name = text_of(options, "ehl_scheme") or ALLOWED[0]
    if name not in ALLOWED:
        raise UsageError(f"-ehl_scheme {name}: allowed: {', '.join(ALLOWED)}")
    return name


def solver_of(case, scales, film_scale, comm, options):
    """The solver asked for, of one scene on one communicator.

    Raises
    ------
    options.UsageError
        Sweeps are asked for, but the contact is dry.
    """
    if scheme(options) == "newton":
        return Solver(case, scales, film_scale, comm)
    if case.fluid is None:
        raise UsageError("-ehl_scheme sweep: a dry contact has no Reynolds equation to pair; leave it out")
    return Sweeper(case, scales, film_scale)
