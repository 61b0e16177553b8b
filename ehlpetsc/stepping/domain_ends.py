"""Check that pressure and contact vanish at the ends of the domain; otherwise a solution is meaningless."""

from ehlpetsc.errors import NotConverged

MAX_END_PRESSURE = 0.01  # p0


def check_ends(x, pressure, touching):
    """Refuse a solution whose pressure or contact is cut off by an end of the domain.

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
        Pressure or contact at an end; the message names the end and the cure.
    """
    for end, key in ((0, "inlet"), (-1, "outlet")):
        at = f"at the {key}, x = {x[end]:g} a"
        cure = f"put mesh.{key} further out"
        if touching[end]:
            raise NotConverged(f"solids touch {at}: the contact is wider than the domain; {cure}")
        if pressure[end] > MAX_END_PRESSURE:
            raise NotConverged(f"{pressure[end]:.2g} p0 {at}: the domain cuts the pressure off; {cure}")
