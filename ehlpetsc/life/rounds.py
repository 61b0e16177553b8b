"""Rounds of passes from the same surfaces, one for each position of surface 2, and jumps between them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from mpi4py import MPI

from ehlpetsc.base.errors import CaseError, NotConverged, OutputError, PostError, Stopped, UsageError
from ehlpetsc.effects.depths import PlasticRecord
from ehlpetsc.life.body import MAX_EXTRAPOLATION, LifeBody, Rates
from ehlpetsc.life.one_pass import Pass
from ehlpetsc.run.ranks import WorkQueue
from ehlpetsc.surfaces.motion.body_field import BodyField, BodyFields

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values
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

    def solve(self, positions: list[int], solve: Callable, stop: StopRequest | None = None) -> list[Pass]:
        """Passes of a round in the order of `positions`, on every rank.

        `solve` solves the pass of a position on a group of ranks. Raises one of `FAULTS`.
        """
        if len(positions) == 1 or self._group is self.comm:
            return [solve(position, self.comm, stop) for position in positions]
        outcomes: dict = {}

        def outcome(position: int, group: MPI.Comm, stop: StopRequest | None) -> Any:
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

    `passes_2`: as of `positions.Positions`.
    """

    passes: list
    passes_2: float

    def rates(self, bodies: tuple[LifeBody, ...]) -> tuple[Rates, ...]:
        """Wear, damage and worn volume that a pass adds to each body: means over the round."""
        rates = []
        for k, (body, factor) in enumerate(zip(bodies, (1.0, self.passes_2), strict=True)):
            pass_rates = [(*body.rates(pass_.bodies[k]), pass_.bodies[k].volume) for pass_ in self.passes]
            means = [sum(values) / len(pass_rates) for values in zip(*pass_rates, strict=True)]
            rates.append(Rates(*(factor * mean for mean in means)))
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

    def figures(self) -> dict[str, float]:
        """Friction and share of the solids, means over the round; largest pressure [Pa]."""
        figures = {"p_max": max(pass_.figures["p_max"] for pass_ in self.passes)}
        for name, source in (("friction", "friction_coefficient"), ("contact_share", "contact_share")):
            figures[name] = float(np.mean([pass_.figures.get(source, np.nan) for pass_ in self.passes]))
        return figures


def _deepest(fields: list[BodyField]) -> BodyField:
    """Largest depth of several fields of a body at each point."""
    first = min(field.first for field in fields)
    last = max(field.first + field.cells for field in fields)
    depths = np.zeros((len(fields), *fields[0].depth.shape[:-1], last - first))
    for depth, field in zip(depths, fields, strict=True):
        begin = field.first - first
        depth[..., begin : begin + field.cells] = field.depth
    return BodyField(fields[0].spacing, first, depths.max(axis=0))


BREAK_OUT_DELAY = 1.1  # longest jump over the allowed one, where it then ends with a break-out


class Jumps:
    r"""Size of the jumps of a life, and bodies after them.

    Rates change smoothly as wear changes the surface, and at once where cells break out. Between two
    break-outs they are extrapolated linearly from the last two rounds,

    .. math:: f(t) = f_n + t\,\frac{f_n-f_{n-1}}{h_{n-1}},\qquad y_{n+1} = y_n + \int_0^{h_n} f\,dt

    (Adams-Bashforth of two steps): the error of wear and damage falls with the square of the jumps. After a
    break-out, and in the first jump of all, rates are constant.

    `rq`: combined root mean square roughness [m].
    """

    def __init__(self, life: Values, rq: float) -> None:
        self.life, self.passes = life, int(life.passes)
        self.wear_allowed = life.wear_jump * rq

    def is_yielding(self, yielded: float) -> bool:
        """Whether a pass yields more [m] than a jump may wear: plastic deformation is not multiplied."""
        return yielded > self.wear_allowed

    def jump(
        self, bodies: tuple[LifeBody, ...], solved_round: Round, done: int, before: int = 0
    ) -> tuple[tuple[LifeBody, ...], int, tuple[Rates, ...]]:
        """Jump with the rates of a solved round, up to the allowed wear or damage or the next break-out.

        `done`: passes before it. `before`: passes of the previous jump if the rates are continuous since;
        else 0.

        Returns
        -------
        jump
            Passes of the jump, including the solved ones.
        """
        rates, max_passes = solved_round.rates(bodies), self.passes - done
        if before:
            rates = tuple(
                rate.continued((body.wear_rate, body.damage_rate, body.volume_rate), before, body.column_area)
                for rate, body in zip(rates, bodies, strict=True)
            )
            max_passes = min(max_passes, int(MAX_EXTRAPOLATION * before))
        pairs = list(zip(bodies, rates, strict=True))
        jump = self._allowed(pairs, solved_round, max_passes)
        return tuple(body.after(rate, jump, done, self.life.break_out) for body, rate in pairs), jump, rates

    def _allowed(self, pairs: list[tuple[LifeBody, Rates]], solved_round: Round, left: int) -> int:
        """Passes until the allowed wear or damage is reached or a cell breaks out, `left` at most."""
        passes: float = 1 if self.is_yielding(solved_round.yielded) else left
        for body, rate in pairs:
            passes = min(passes, body.passes_to(rate, self.wear_allowed, self.life.damage_jump))
        passes = max(int(passes), 1)
        if (rule := self.life.break_out) != "none":
            late = min(left, int(BREAK_OUT_DELAY * passes))
            ends = min(body.passes_to_break_out(rate, late, rule) for body, rate in pairs)
            passes = ends if ends < late else passes
        return min(left, max(int(passes), len(solved_round.passes)))
