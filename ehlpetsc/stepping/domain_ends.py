"""Check that the domain does not cut off pressure or contact: such a solution is meaningless."""

from ehlpetsc.errors import NotConverged

CUT_OFF = 0.01  # of p0, at an end of the domain


def check_ends(x, pressure, touching):
    """Whether pressure and contact end within the domain.

    Parameters
    ----------
    x : ndarray, shape (nx,)
        Nodes in half widths.
    pressure : ndarray, shape (nx,)
        In p0.
    touching : ndarray of bool, shape (nx,)

    Raises
    ------
    NotConverged
        They do not; the text names the end and the cure.
    """
    for end, key in ((0, "inlet"), (-1, "outlet")):
        at = f"at the {key}, x = {x[end]:g} a"
        cure = f"put mesh.{key} further out"
        if touching[end]:
            raise NotConverged(f"solids touch {at}: the contact is wider than the domain; {cure}")
        if pressure[end] > CUT_OFF:
            raise NotConverged(f"{pressure[end]:.2g} p0 {at}: the domain cuts the pressure off; {cure}")
