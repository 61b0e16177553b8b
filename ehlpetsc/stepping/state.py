"""One time level of a run."""

from dataclasses import dataclass, field

import numpy as np

from ehlpetsc.stepping.predictor import TimeLevel


@dataclass(frozen=True)
class State:
    """One time level with the history needed by the next step; arrays of shape (nx,), dimensionless.

    Attributes
    ----------
    q, w, h00
        Unknowns (see :mod:`ehlpetsc.discretisation.contact`).
    p, h
        Pressure and film.
    m, m_older
        Masses per area of the film at this level and the previous one (None: no such level).
    time, dt
        [s]; `dt` is the step to this level (None at the start).
    step
        Number of the time step.
    travelled
        Distances travelled by surfaces 1 and 2 since time 0 [m], signed.
    earlier
        Up to two previous levels, latest first.
    reynolds_residual
        F of the Reynolds equation at the solution.
    records
        Records of the effects by their names, see :mod:`ehlpetsc.effects`.
    """

    q: np.ndarray
    w: np.ndarray
    h00: float
    p: np.ndarray | None = None
    h: np.ndarray | None = None
    m: np.ndarray | None = None
    m_older: np.ndarray | None = None
    time: float = 0.0
    dt: float | None = None
    step: int = 0
    travelled: tuple = (0.0, 0.0)
    earlier: tuple = ()
    newton: int = 0
    retries: int = 0
    reynolds_residual: np.ndarray = field(default=None, repr=False)
    records: dict = field(default_factory=dict, repr=False)

    @property
    def level(self):
        """Time level for the predictor of later steps."""
        return TimeLevel(0.5 * sum(self.travelled), self.q, self.w)
