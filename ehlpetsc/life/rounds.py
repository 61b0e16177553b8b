"""Positions of surface 2 relative to surface 1, rounds of passes in all of them, and jumps between rounds.

With `time.pass_shift` surface 2 begins each pass further on, as the teeth of a wheel follow each other: the
columns of body 2 cover all positions. Without it there is one position.

With gears a pass is one engagement of a pinion tooth, from the beginning of its contact to the end, and a
position is a tooth of the wheel. Columns then count along the flanks. In the time in which a pinion tooth
meets N wheel teeth, each wheel tooth meets N z1/z2 pinion teeth; they are taken to be alike.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from mpi4py import MPI

from ehlpetsc.base.counts import whole_up
from ehlpetsc.base.errors import CaseError, NotConverged, OutputError, PostError, Stopped, UsageError
from ehlpetsc.case.tables import Case
from ehlpetsc.effects.depths import PlasticRecord, WearRecord
from ehlpetsc.effects.scene import Scene
from ehlpetsc.life import laws
from ehlpetsc.life.body import MAX_EXTRAPOLATION, NO_ROWS, LifeBody, Rates
from ehlpetsc.life.one_pass import OfBody, Pass
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.ranks import WorkQueue
from ehlpetsc.surfaces.motion.body_field import BodyField, BodyFields
from ehlpetsc.surfaces.motion.roughness import directed_speeds

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values
    from ehlpetsc.results.post_result import SmoothContact
    from ehlpetsc.run.ranks import StopRequest

CELL_SIZE = 0.25  # of the combined Rq: thickness of the first cells
FLANK_END_LENGTH = 1.0  # half-widths at either end of a flank whose mean wear is that of the points beyond
FAULTS = (CaseError, NotConverged, OutputError, PostError, Stopped, UsageError)


def number_of_positions(case: Case) -> int:
    """Positions of surface 2 in the life of a case."""
    if not case.time.pass_shift:
        return 1
    return min(case.life.partners, case.gears.pair.partners) if case.gears else case.life.partners


class Positions:
    """Positions of surface 2.

    `scenes`: `effects.scene.Scene` of each position.

    `rq`: combined root mean square roughness [m]. `passes_2`: passes of body 2 for each one of body 1, over
    the positions together.
    """

    def __init__(self, case: Case, scales: Scales) -> None:
        self.case, self.scales, self.count = case, scales, number_of_positions(case)
        operation = operation_of(case, scales)
        self.scenes = [Scene.of_pass(case, scales, operation, k + 1) for k in range(self.count)]
        self.rq = self.scenes[0].rq
        shift = case.time.pass_shift if self.count > 1 else 0.0
        # columns of body 2 in excess of position 0, and the direction in which positions follow each other
        self._columns_more = whole_up(abs((self.count - 1) * shift) / scales.spacing)
        self._sign = -1.0 if (directed_speeds(case, scales)[1] > 0.0) == (shift > 0.0) else 1.0
        self.passes_2 = 1.0
        if case.gears:
            pinion, wheel = map(abs, case.gears.pair.teeth)
            self.passes_2 = self.count * pinion / wheel

    def records(
        self, bodies: tuple[LifeBody, ...], position: int, plastic: PlasticRecord | None
    ) -> dict[str, tuple]:
        """Records of the effects with which a pass begins."""
        scene = self.scenes[position]
        ends = scene.operation.travelled(0.0), scene.operation.travelled(scene.operation.duration)
        are_flanks = self.case.conditions and self.case.conditions.profile_offsets
        averaged = FLANK_END_LENGTH * self.scales.a if are_flanks else np.inf
        fields = []
        for k, body in enumerate(bodies):
            faces = np.concatenate([scene.mesh_on_bodies.faces(travelled)[k][[0, -1]] for travelled in ends])
            stretch = self._stretch(body, k, position)
            spec = self.case.surface.side("12"[k])
            cutoff = spec.short_cutoff if spec else None
            fields.append(body.gap_field(stretch, (faces.min(), faces.max()), averaged, cutoff))
        records = {"wear": WearRecord(BodyFields(*fields), scene.mesh_on_bodies.zero)}
        return records | ({"plastic_deformation": plastic} if plastic else {})

    def _offset(self, position: int, k: int) -> float:
        return self.scenes[position].mesh_on_bodies.offsets[k]

    def _stretch(self, body: LifeBody, k: int, position: int) -> tuple[float, float]:
        """Abscissas of the first and last column of body k in a position."""
        if self.count == 1 or k == 0:
            return body.s[0], body.s[-1]
        length = body.s[-1] - body.s[0] - self._columns_more * self.scales.spacing
        first = body.s[0] if self._sign > 0 else body.s[-1] - length
        first += self._offset(position, k) - self._offset(0, k)
        return first, first + length

    def _too_short(self, ramp: float, k: int) -> str:
        """Fault of a pass in which body k gets no column behind the ramp of its profile [m]."""
        reason = f"surface {k + 1}: no stretch of it passed the whole contact behind the ramp of its profile"
        if self.case.conditions is not None:
            return f"{reason}; the conditions must last longer"
        scales = self.scales
        ratio = scales.u_max / abs((scales.u1, scales.u2)[k])
        travel = self.case.time.travel + ratio * (ramp / scales.a + 1.0)  # a stretch of one half-width
        return f"{reason}; time.travel = {self.case.time.travel:g}, allowed: {travel:.2g} or more"

    def new_body(self, of_pass: OfBody, smooth: SmoothContact, k: int) -> LifeBody:
        """Columns of a body after a pass in position 0, of body 2 in all of its positions.

        `smooth`: smooth contact of the body. Raises `PostError` if no stretch of it passed the contact at its
        full height.
        """
        s, dx, offset = of_pass.s, self.scales.spacing, self._offset(0, k)
        roughness = self.scenes[0].roughness
        profile = roughness and roughness.side("12"[k])
        if profile and profile.is_moving:  # not where its heights come in over the ramp
            inlet, outlet = self.scales.x[0] * self.scales.a, self.scales.x[-1] * self.scales.a
            X = inlet - s if profile.speed > 0 else s - outlet
            s = s[X >= profile.ramp * (1.0 - 1e-9)]
            if len(s) < 2:
                raise PostError(self._too_short(profile.ramp, k))
        if k == 1 and self.count > 1:
            extra = dx * np.arange(1, self._columns_more + 1)
            s = np.append(s, s[-1] + extra) if self._sign > 0 else np.append(s[0] - extra[::-1], s)
        grid = self.scales.grid
        height = profile.height(s - offset) if profile else np.zeros((*grid.shape[:-1], len(s)))
        y = self.scales.a * grid.axes[0] if len(grid.axes) > 1 else NO_ROWS
        edges = laws.cell_edges(CELL_SIZE * self.rq, of_pass.depths[-1])
        smooth_rate = (1.0, self.passes_2)[k] * smooth.damage_at(0.5 * (edges[1:] + edges[:-1]))
        return LifeBody.new(s, height, edges, y, smooth_rate)


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

    `passes_2`: as of `Positions`.
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
