r"""Wear of both surfaces by Archard's law.

.. math:: \frac{dz_i}{dt}=k_i\,p_c\,|u_1-u_2|

(Archard, J. Appl. Phys. 24 (1953) 981: worn volume per sliding distance in proportion to the load), p_c
the pressure of the solids in mixed contact and :math:`k_i` the specific wear rate of surface i, the wear
coefficient over the hardness. Implicit in time: a step wears with the pressure at its end.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ehlpetsc.base.declarations import Field, KeyTable, Required, StepScalar
from ehlpetsc.effects.body_depth import BodyDepth
from ehlpetsc.surfaces.body_field import BodyFields

if TYPE_CHECKING:
    from ehlpetsc.discretisation.ehl_problem import Solution
    from ehlpetsc.effects.effect import Step


COEFFICIENT = Required(
    "wear rate `k`, `dz/dt = k p_c |u1 - u2|`, `z` the depth worn off a surface",
    *("m^2/N", 0, 1e-10),
    many="both",
)
WEAR = KeyTable(
    "wear", "left out: no wear", {"coefficient": COEFFICIENT}, needs=('contact.model = "mixed"', "[time]")
)


def wear_depth(coefficient: float, contact_pressure: np.ndarray, sliding: float, dt: float) -> np.ndarray:
    """Depth worn off a surface in a step [m].

    `coefficient`: k [m^2/N].
    `contact_pressure`: p_c at the end of the step [Pa].
    `sliding`: u1 - u2 [m/s].
    `dt`: length of the step [s].
    """
    return coefficient * abs(sliding) * dt * contact_pressure


class WearRecord(NamedTuple):
    """Wear depth of both bodies, and its hidden part."""

    depth: BodyFields
    hidden: BodyFields


class Wear(BodyDepth[WearRecord]):
    """Wear depth, added to the gap and kept in the bodies."""

    name = "wear"
    table = WEAR
    record = WearRecord
    scalars = {
        "wear_volume": StepScalar(
            "m^3",
            "worn volume of both surfaces since the first pass",
            integrated=True,
            over_run="last",
            summary=".4g",
            compared=True,
            of=lambda o: o.scene.mesh_on_bodies.volume(o.state.records["wear"].depth),
        )
    }
    surface = {"wear": Field("m", "wear depth at the end", ("s",))}

    def accept(self, record: WearRecord, solution: Solution, step: Step) -> WearRecord:
        """Wear both surfaces where the solids carry."""
        if step.dt is None or self.scene.case.wear is None:
            return record
        pressure, sliding = self.scene.scales.p0 * solution.loads.contact_pressure, step.conditions.sliding
        depths = [wear_depth(k, pressure, sliding, step.dt) for k in self.scene.case.wear.coefficient]
        return record._replace(depth=self.scene.mesh_on_bodies.add(record.depth, step.travelled, depths))
