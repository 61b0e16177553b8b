"""Positions of surface 2 relative to surface 1, in which the passes of a round are solved.

With `time.pass_shift` surface 2 begins each pass further on, and its columns cover all positions. Partners
drift: positions of a round are a shift apart, and from round to round they move by the golden section of a
shift, so that no pass meets a former position and all are met equally often. Without a shift there is one
position in which the same points meet for ever.

With gears a pass is one engagement of a pinion tooth, from the beginning of its contact to the end, and a
position is a tooth of the wheel, which does not drift. Columns then count along the flanks. In the time in
which a pinion tooth meets N wheel teeth, each wheel tooth meets N z1/z2 pinion teeth; they are taken to be
alike.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.counts import whole_down, whole_up
from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.tables import Case
from ehlpetsc.effects.depths import PlasticRecord, WearRecord
from ehlpetsc.effects.scene import Scene
from ehlpetsc.life import laws
from ehlpetsc.life.body import NO_ROWS, LifeBody
from ehlpetsc.life.one_pass import OfBody, Pass
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.post.loads import body_points, passage
from ehlpetsc.surfaces.motion.body_field import BodyFields
from ehlpetsc.surfaces.motion.roughness import directed_speeds

if TYPE_CHECKING:
    from ehlpetsc.results.post_result import SmoothContact

CELL_SIZE = 0.25  # of the combined Rq: thickness of the first cells
FLANK_END_LENGTH = 1.0  # half-widths at either end of a flank whose mean wear is that of the points beyond
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)  # the fraction whose multiples are most evenly spread
DEFAULT_SHIFT = 1.0 - GOLDEN  # half-widths: no divisor of the period of a profile


def with_shift(case: Case) -> Case:
    """Case with the shift of surface 2 between passes that a life has by default."""
    if case.time.pass_shift is not None:
        return case
    shift = DEFAULT_SHIFT * Scales.of(case).a
    return case.copy({"time": case.time.copy({"pass_shift": shift})})


def number_of_positions(case: Case) -> int:
    """Positions of surface 2 in a round of a case."""
    if not case.time.pass_shift:
        return 1
    return min(case.life.partners, case.gears.pair.partners) if case.gears else case.life.partners


class Positions:
    """Positions of surface 2, given by their distance from the first one in shifts, their place.

    `count`: positions of a round. `drifts`: whether they differ from round to round. `rq`: combined root mean
    square roughness [m]. `passes_2`: passes of body 2 for each one of body 1, over the positions together.
    """

    def __init__(self, case: Case, scales: Scales) -> None:
        self.case, self.scales, self.count = case, scales, number_of_positions(case)
        self.drifts = bool(case.time.pass_shift) and not case.gears
        self._operation = operation_of(case, scales)
        self.scene = lru_cache(maxsize=self.count + 1)(self._scene)
        self.rq = self.scene(0.0).rq
        self._margins = self._columns_beyond()
        self.passes_2 = 1.0
        if case.gears:
            pinion, wheel = map(abs, case.gears.pair.teeth)
            self.passes_2 = self.count * pinion / wheel

    def _scene(self, place: float) -> Scene:
        return Scene.of_pass(self.case, self.scales, self._operation, place + 1.0)

    def places(self, number: int) -> list[float]:
        """Places of the positions of a round, by the number of rounds before it."""
        drift = number * GOLDEN % 1.0 if self.drifts else 0.0
        return [k + drift for k in range(self.count)]

    def _columns_beyond(self) -> tuple[int, int]:
        """Columns of body 2 before and after those that pass the contact in the first position.

        Those that are met in any position, but if positions drift, that are met in every round.
        """
        shift = abs(self.case.time.pass_shift) if self.count > 1 or self.drifts else 0.0
        ahead, behind = (self.count - 1) * shift / self.scales.spacing, 0
        if self.drifts:
            ahead, behind = whole_down(ahead), -whole_up(shift / self.scales.spacing)
        ahead = whole_up(ahead)
        is_turned = (directed_speeds(self.case, self.scales)[1] > 0.0) == (self.case.time.pass_shift > 0.0)
        return (ahead, behind) if is_turned else (behind, ahead)

    def records(
        self, bodies: tuple[LifeBody, ...], place: float, plastic: PlasticRecord | None
    ) -> dict[str, tuple]:
        """Records of the effects with which a pass begins."""
        scene = self.scene(place)
        ends = scene.operation.travelled(0.0), scene.operation.travelled(scene.operation.duration)
        are_flanks = self.case.conditions and self.case.conditions.profile_offsets
        averaged = FLANK_END_LENGTH * self.scales.a if are_flanks else np.inf
        fields = []
        for k, body in enumerate(bodies):
            faces = np.concatenate([scene.mesh_on_bodies.faces(travelled)[k][[0, -1]] for travelled in ends])
            stretch = self._stretch(body, k, place)
            spec = self.case.surface.side("12"[k])
            cutoff = spec.short_cutoff if spec else None
            fields.append(body.gap_field(stretch, (faces.min(), faces.max()), averaged, cutoff))
        records = {"wear": WearRecord(BodyFields(*fields), scene.mesh_on_bodies.zero)}
        return records | ({"plastic_deformation": plastic} if plastic else {})

    def _offset(self, place: float, k: int) -> float:
        return self.scene(place).mesh_on_bodies.offsets[k]

    def _stretch(self, body: LifeBody, k: int, place: float) -> tuple[float, float]:
        """Abscissas between which points of body k pass the whole contact in a position."""
        before, after = self._margins if k else (0, 0)
        moved = self._offset(place, k) - self._offset(0.0, k)
        first, last = body.s[0] + before * self.scales.spacing, body.s[-1] - after * self.scales.spacing
        return first + moved, last + moved

    def followed(self, solved: Pass, place: float) -> Pass:
        """Pass of the points alone that passed the contact with all of their height."""
        bodies = []
        for k, body in enumerate(solved.bodies):
            kept = self._at_full_height(body.s - self._offset(place, k), k)
            bodies.append(
                body._replace(
                    s=body.s[kept], damage=body.damage[..., kept], pressure=body.pressure[..., kept]
                )
            )
        return solved._replace(bodies=tuple(bodies))

    def _at_full_height(self, s: np.ndarray, k: int) -> np.ndarray:
        """Whether points s of body k [m] are not where the heights of a profile come in over its ramp."""
        roughness = self.scene(0.0).roughness
        profile = roughness and roughness.side("12"[k])
        if not profile or not profile.is_moving:
            return np.ones(s.shape, bool)
        inlet, outlet = self.scales.x[0] * self.scales.a, self.scales.x[-1] * self.scales.a
        X = inlet - s if profile.speed > 0 else s - outlet
        return X >= profile.ramp * (1.0 - 1e-9)

    def check_travel(self) -> None:
        """Check that points of both bodies pass the whole contact; `CaseError` with the travel that does.

        Conditions over time of gears end with the path of contact instead.
        """
        if self.case.gears:
            return
        x, faults = self.scales.x * self.scales.a, []
        ends = zip(*map(self._operation.travelled, (0.0, self._operation.duration)), strict=True)
        for k, travelled in enumerate(map(np.array, ends)):
            if travelled[0] == travelled[-1]:
                reason = "is where it began at the end of a pass; a life needs points that pass the contact"
                faults.append(f"{self.case.path}: surface {k + 1} {reason}")
                continue
            s = body_points(x, self.scales.spacing, [travelled])
            s = s[passage(s, x, self.scales.spacing, travelled).complete]
            if np.count_nonzero(self._at_full_height(s, k)) - self._columns_left_out(k) < 2:
                faults.append(f"{self.case.path}: {self._too_short(k)}")
        if faults:
            raise CaseError(faults)

    def _columns_left_out(self, k: int) -> int:
        """Columns at either end of a stretch of body k that are not met in every round."""
        return max(0, *(-margin for margin in self._margins)) if k else 0

    def _too_short(self, k: int) -> str:
        """Fault of a pass in which body k gets no column."""
        reason = f"surface {k + 1}: no stretch of it would pass the whole contact at its full height"
        if self.case.conditions is not None:
            return f"{reason}; the conditions must last longer"
        scales, profile = self.scales, self.scene(0.0).roughness.side("12"[k])
        ramp = profile.ramp if profile else 0.0
        length = np.ptp(scales.x) + (self._columns_left_out(k) * scales.spacing + ramp) / scales.a
        ratio = scales.u_max / abs((scales.u1, scales.u2)[k])
        travel = ratio * (length + 1.0)  # a stretch of one half-width
        return f"{reason}; time.travel = {self.case.time.travel:g}, allowed: {travel:.2g} or more"

    def new_body(self, of_pass: OfBody, smooth: SmoothContact, k: int) -> LifeBody:
        """Columns of a body after a pass in the first position, of body 2 in all of its positions.

        `of_pass`: of :meth:`followed`. `smooth`: smooth contact of the body.
        """
        dx, (before, after) = self.scales.spacing, self._margins if k else (0, 0)
        s = of_pass.s[0] + dx * np.arange(-before, len(of_pass.s) + after)
        roughness = self.scene(0.0).roughness
        profile = roughness and roughness.side("12"[k])
        grid = self.scales.grid
        height = profile.height(s - self._offset(0.0, k)) if profile else np.zeros((*grid.shape[:-1], len(s)))
        y = self.scales.a * grid.axes[0] if len(grid.axes) > 1 else NO_ROWS
        edges = laws.cell_edges(CELL_SIZE * self.rq, of_pass.depths[-1])
        smooth_rate = (1.0, self.passes_2)[k] * smooth.damage_at(0.5 * (edges[1:] + edges[:-1]))
        return LifeBody.new(s, height, edges, y, smooth_rate)
