"""One time level of a run."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.ehl_problem import Solution
from ehlpetsc.discretisation.unknowns import Unknowns


class TimeLevel(NamedTuple):
    """Unknowns of an earlier time level, and the distance travelled by the film [m]."""

    travelled: float
    q: np.ndarray
    w: np.ndarray


@dataclass(frozen=True)
class State:
    """One time level with the history needed by the next step; arrays of shape (nx,), dimensionless.

    Attributes
    ----------
    unknowns
        Without the plastic deformation of the last step, which is in the record of the effect.
    solution
        Solution of the step; None after a restart.
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
    newton, retries
        Iterations of the step, failed attempts included; number of times that it was halved.
    records
        Records of the effects by their names, see :mod:`ehlpetsc.effects`.
    """

    unknowns: Unknowns
    solution: Solution | None = field(default=None, repr=False)
    m: np.ndarray | None = None
    m_older: np.ndarray | None = None
    time: float = 0.0
    dt: float | None = None
    step: int = 0
    travelled: tuple[float, float] = (0.0, 0.0)
    earlier: tuple[TimeLevel, ...] = ()
    newton: int = 0
    retries: int = 0
    records: dict = field(default_factory=dict, repr=False)

    @property
    def q(self) -> np.ndarray:
        """First unknown of each node."""
        return self.unknowns.q

    @property
    def w(self) -> np.ndarray:
        """Second unknown of each node."""
        return self.unknowns.w

    @property
    def h00(self) -> float:
        """Approach in a^2/R."""
        return self.unknowns.h00

    @property
    def p(self) -> np.ndarray:
        """Pressure in p0."""
        return self.solution.nodes.pressure

    @property
    def h(self) -> np.ndarray:
        """Film in a^2/R."""
        return self.solution.nodes.film

    @property
    def reynolds_residual(self) -> np.ndarray:
        """F of the Reynolds equation at the solution."""
        return self.solution.residual

    @property
    def level(self) -> TimeLevel:
        """Time level for the predictor of later steps."""
        return TimeLevel(0.5 * sum(self.travelled), self.q, self.w)
