"""Positions of surface 2 relative to surface 1, and the columns of both bodies.

With `time.pass_shift` surface 2 begins each pass further on, as the teeth of a wheel follow each other: the
columns of body 2 cover all positions. Without it there is one position.

With gears a pass is one engagement of a pinion tooth, from the beginning of its contact to the end, and a
position is a tooth of the wheel. Columns then count along the flanks. In the time in which a pinion tooth
meets N wheel teeth, each wheel tooth meets N z1/z2 pinion teeth; they are taken to be alike.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.errors import PostError
from ehlpetsc.case.tables import Case
from ehlpetsc.effects.depths import PlasticRecord, WearRecord
from ehlpetsc.effects.effect import Scene
from ehlpetsc.life import laws
from ehlpetsc.life.body import NO_ROWS, LifeBody
from ehlpetsc.life.one_pass import OfBody
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.surfaces.motion.body_field import BodyFields
from ehlpetsc.surfaces.motion.roughness import directed_speeds

CELL_SIZE = 0.25  # of the combined Rq: thickness of the first cells
FLANK_END_LENGTH = 1.0  # half-widths at either end of a flank whose mean wear is that of the points beyond


def number_of_positions(case: Case) -> int:
    """Positions of surface 2 in the life of a case."""
    if not case.time.pass_shift:
        return 1
    return min(case.life.partners, case.gears.pair.partners) if case.gears else case.life.partners


class Positions:
    """Positions of surface 2.

    `scenes`: `effects.effect.Scene` of each position.

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
        self._columns_more = int(np.ceil(abs((self.count - 1) * shift) / scales.spacing))
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

    def new_body(self, of_pass: OfBody, k: int) -> LifeBody:
        """Columns of a body after a pass in position 0, of body 2 in all of its positions.

        Raises `PostError` if no stretch of it passed the contact at its full height.
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
        edges = laws.cell_edges(CELL_SIZE * self.rq, of_pass.depths[-1] + 1e-12)
        return LifeBody.new(s, height, edges, y)
