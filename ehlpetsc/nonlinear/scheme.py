"""Which iteration solves the equations of a time step: ``-ehl_scheme``."""

from ehlpetsc.errors import UsageError
from ehlpetsc.nonlinear.gauss_seidel import GaussSeidelSolver
from ehlpetsc.nonlinear.newton import NewtonSolver
from ehlpetsc.nonlinear.options import text_of
from ehlpetsc.nonlinear.systems.two_fields import TwoFields

ALLOWED = ("newton", "sweep")


def scheme(options):
    """Name of the iteration asked for.

    Raises
    ------
    UsageError
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
    UsageError
        Sweeps are asked for, but the contact is dry or mixed.
    """
    if scheme(options) == "newton":
        return NewtonSolver(TwoFields(case, scales, film_scale, comm))
    if case.fluid is None:
        raise UsageError("-ehl_scheme sweep: a dry contact has no Reynolds equation to pair; leave it out")
    if case.contact.has_contact_pressure:
        raise UsageError("-ehl_scheme sweep: the paper's sweeps know direct contact alone; leave it out")
    return GaussSeidelSolver(case, scales, film_scale)
