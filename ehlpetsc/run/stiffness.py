r"""Dynamic stiffness and damping of a smooth lubricated contact.

The load of a contact is modulated by a small share at one frequency while radius and speeds are constant,

.. math:: F=F_0\,(1+\varepsilon\sin\omega t),\qquad F-F_0=K(\delta-\delta_0)+C\dot\delta,

with the rigid-body approach :math:`\delta` of the bodies. Its response is fitted over the last period by a
sine and a cosine. With the complex amplitudes :math:`\hat F=\varepsilon F_0` and :math:`\hat\delta`,
:math:`K=\Re(\hat F/\hat\delta)` and :math:`C=\Im(\hat F/\hat\delta)/\omega`. The quasi-static stiffness is
the difference of two steady loads over that of their approaches.

Only whole contacts, points and rollers, have an approach: that of two half-planes grows without bound with
their depth.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.counts import whole_up
from ehlpetsc.base.errors import UsageError
from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation

STEPS_A_PERIOD = 32
LINES_A_PERIOD = 40  # of the table of loads, between which they are monotone cubics
MIN_PERIODS = 3  # with the one that is fitted
TRANSIT = 3.0  # half-widths that the film moves before it: across the contact
MAX_COURANT = 100.0


class Response(NamedTuple):
    """Response at one frequency.

    Attributes
    ----------
    frequency
        [Hz]; 0: quasi-static.
    stiffness, damping
        K [N/m], C [N s/m]; C is nan at rest.
    misfit
        Root mean square of what the fit leaves, over the amplitude of the approach.
    steps
        Time steps of the run.
    """

    frequency: float
    stiffness: float
    damping: float
    misfit: float
    steps: int


def responses(case: Case, frequencies: list[float], amplitude: float) -> Iterator[Response]:
    """Quasi-static response of a case, then that at each frequency [Hz], under a share of the load.

    Raises
    ------
    UsageError
        The contact is no whole one, is rough, has no oil, or has a given approach.
    """
    check(case)
    yield quasi_static(case, amplitude)
    for frequency in frequencies:
        yield response(case, frequency, amplitude)


def check(case: Case) -> None:
    """Refuse a case without an approach that follows from its load."""
    if not KINDS[case.kind].is_whole:
        raise UsageError(f"{case.path}: a {case.kind} contact has no approach; allowed: a point or a roller")
    if case.fluid is None or case.contact.approach is not None or case.conditions is not None:
        raise UsageError(f"{case.path}: allowed: oil, and a load and speeds that are constant")
    if case.surface.body_1 or case.surface.body_2:
        raise UsageError(f"{case.path}: allowed: smooth surfaces; roughness moves the bodies by itself")


def with_load(case: Case, changes: dict[str, Any]) -> Case:
    """Case with changed keys."""
    return load(case._tables, changes)


def quasi_static(case: Case, amplitude: float) -> Response:
    """Stiffness between two steady loads, on the nodes of the larger one."""
    loads, approaches = [case.contact.load * (1.0 + sign * amplitude) for sign in (-1.0, 1.0)], []
    for one in loads:
        operation = {"time": [0.0, 1.0], "load": [one, loads[1]]}  # the contact begins steady
        steady = Simulation(with_load(case, {"operation": operation, "time": {"travel": 1.0}}))
        approaches.append(steady.advance().scalars["approach"])
    return Response(0.0, (loads[1] - loads[0]) / (approaches[1] - approaches[0]), np.nan, 0.0, 0)


def response(case: Case, frequency: float, amplitude: float) -> Response:
    """Response at a frequency [Hz]."""
    scales, period = Scales.of(case), 1.0 / frequency
    transit = TRANSIT * scales.a / scales.u
    periods = MIN_PERIODS - 1 + whole_up(max(transit / period, 1.0))
    courant = min(period / STEPS_A_PERIOD * scales.u / scales.spacing, MAX_COURANT)
    time = np.linspace(0.0, periods * period, periods * LINES_A_PERIOD + 1)
    mean, omega = case.contact.load, 2.0 * np.pi * frequency
    operation = {
        "time": time.tolist(),
        "load": (mean * (1.0 + amplitude * np.sin(omega * time))).tolist(),
    }
    states = list(
        Simulation(with_load(case, {"operation": operation, "time": {"courant": courant, "travel": 1e5}}))
    )
    times, loads, approaches = (
        np.array([state.scalars[name] for state in states]) for name in ("time", "load_given", "approach")
    )
    late = times > (periods - 1.0) * period * (1.0 - 1e-9)
    (force, _), (approach, misfit) = (fitted(times[late], v[late], omega) for v in (loads, approaches))
    ratio = force / approach
    return Response(frequency, ratio.real, ratio.imag / omega, misfit, len(states) - 1)


def fitted(time: np.ndarray, values: np.ndarray, omega: float) -> tuple[complex, float]:
    r"""Complex amplitude of :math:`v_0+\Re(\hat ve^{i\omega t})` over time, and the misfit over it."""
    columns = np.stack((np.ones_like(time), np.cos(omega * time), np.sin(omega * time)), axis=1)
    (mean, cosine, sine), *_ = np.linalg.lstsq(columns, values, rcond=None)
    amplitude = complex(cosine, -sine)
    left = values - columns @ (mean, cosine, sine)
    return amplitude, float(np.sqrt(np.mean(left**2)) / abs(amplitude))
