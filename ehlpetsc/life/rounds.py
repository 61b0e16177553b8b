"""Rounds of passes: ranks that solve them, and what a round adds to both bodies."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from mpi4py import MPI

from ehlpetsc.base.errors import CaseError, NotConverged, OutputError, PostError, Stopped, UsageError
from ehlpetsc.effects.depths import PlasticRecord
from ehlpetsc.life.body import LifeBody, Rates
from ehlpetsc.life.one_pass import Pass
from ehlpetsc.run.ranks import WorkQueue
from ehlpetsc.surfaces.motion.body_field import BodyField, BodyFields

if TYPE_CHECKING:
    from ehlpetsc.run.ranks import StopRequest

FAULTS = (CaseError, NotConverged, OutputError, PostError, Stopped, UsageError)


class Ranks:
    """Ranks of a life, in groups: of one rank each if there are at least as many positions as ranks.

    `groups`: number of passes that are solved at the same time.
    """

    def __init__(self, comm: MPI.Comm, positions: int) -> None:
        self.comm, self.each = comm, max(1, comm.size // positions)
        is_shared = positions > 1 and comm.size > 1
        self.groups = min(positions, comm.size)
        self._group = comm.Split(comm.rank // self.each, comm.rank) if is_shared else comm

    def solve(self, positions: list[float], solve: Callable, stop: StopRequest | None = None) -> list[Pass]:
        """Passes of a round in the order of `positions`, on every rank.

        `solve` solves the pass of a position on a group of ranks. Raises one of `FAULTS`.
        """
        if len(positions) == 1 or self._group is self.comm:
            return [solve(position, self.comm, stop) for position in positions]
        outcomes: dict = {}

        def outcome(position: float, group: MPI.Comm, stop: StopRequest | None) -> Any:
            try:
                return solve(position, group, stop)
            except FAULTS as fault:
                return type(fault)(fault.args[0])

        queue = WorkQueue(
            self.comm, self.each, positions, lambda report: outcomes.update([report]), self._group
        )
        outcomes = queue.compute(outcome, stop, lambda: outcomes)
        for found in outcomes.values():
            if not isinstance(found, Pass):
                raise found
        if len(outcomes) < len(positions):
            raise Stopped
        return [outcomes[position] for position in positions]


class Round(NamedTuple):
    """Passes on the same surfaces.

    `passes_2`: as of `Positions`. `drifts`: whether partners drift, see :meth:`rates`.
    """

    passes: list
    passes_2: float
    drifts: bool = False

    def rates(self, bodies: tuple[LifeBody, ...]) -> tuple[Rates, ...]:
        """Wear, damage and worn volume that a pass adds to each body: means over the round.

        With gears a column of body 2 is on one tooth of those that the round meets. If partners drift, a pass
        that does not reach a column would have met it with a part of body 1 that is not followed: the mean
        is then that of the passes that do.
        """
        rates = []
        for k, (body, factor) in enumerate(zip(bodies, (1.0, self.passes_2), strict=True)):
            of_body = [pass_.bodies[k] for pass_ in self.passes]
            wear, damage = (sum(parts) for parts in zip(*map(body.rates, of_body), strict=True))
            met = sum(body.columns_within((one.s[0], one.s[-1])).astype(int) for one in of_body)
            count = np.maximum(met, 1) if self.drifts else len(of_body)
            volume = sum(one.volume for one in of_body) / len(of_body)
            rates.append(Rates(factor * (wear / count), factor * (damage / count), factor * volume))
        return tuple(rates)

    @property
    def yielded(self) -> float:
        """Largest depth by which a point yielded [m]."""
        return max(pass_.yielded for pass_ in self.passes)

    @property
    def plastic(self) -> PlasticRecord | None:
        """Record of the plastic deformation after the round; None without.

        A point that yielded in several passes of the round has the largest of their depths: once yielded
        under an asperity, it carries less under the next.
        """
        records = [pass_.plastic for pass_ in self.passes]
        if records[0] is None:
            return None
        depth = BodyFields(*(_deepest([record.depth[k] for record in records]) for k in range(2)))
        return records[-1]._replace(depth=depth)

    def figures(self, bodies: tuple[LifeBody, ...]) -> dict[str, float]:
        """Friction and share of the solids, means over the round; largest pressure on the columns [Pa]."""
        figures = {"p_max": max(self._largest_pressure(body, k) for k, body in enumerate(bodies))}
        for name, source in (("friction", "friction_coefficient"), ("contact_share", "contact_share")):
            figures[name] = float(np.mean([pass_.figures.get(source, np.nan) for pass_ in self.passes]))
        return figures

    def _largest_pressure(self, body: LifeBody, k: int) -> float:
        of_body = [pass_.bodies[k] for pass_ in self.passes]
        inside = [(one.s >= body.s[0]) & (one.s <= body.s[-1]) for one in of_body]
        pressures = [one.pressure[within] for one, within in zip(of_body, inside, strict=True)]
        return float(np.max(np.concatenate(pressures), initial=0.0))


def _deepest(fields: list[BodyField]) -> BodyField:
    """Largest depth of several fields of a body at each point."""
    first = min(field.first for field in fields)
    last = max(field.first + field.cells for field in fields)
    depths = np.zeros((len(fields), *fields[0].depth.shape[:-1], last - first))
    for depth, field in zip(depths, fields, strict=True):
        begin = field.first - first
        depth[..., begin : begin + field.cells] = field.depth
    return BodyField(fields[0].spacing, first, depths.max(axis=0))
