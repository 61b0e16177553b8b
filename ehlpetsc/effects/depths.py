"""Plastic deformation and wear: effects whose record is a depth of both bodies, which is added to the gap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, Self, TypeVar

import numpy as np

from ehlpetsc.base.declarations import Field, Key, KeyTable, Refused, StepScalar, Values
from ehlpetsc.base.quantities import AtEnd, Count
from ehlpetsc.effects.effect import Effect, Step
from ehlpetsc.effects.scene import Scene
from ehlpetsc.surfaces.motion.body_field import BodyField, BodyFields

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.discretisation.ehl_problem import Solution, StepInputs
    from ehlpetsc.surfaces.motion.roughness import RoughSurface


class DepthRecord(Protocol):
    """Record with a depth, and the part of it that is not in the gap."""

    @property
    def depth(self) -> BodyFields:
        """Depth of both bodies."""

    @property
    def hidden(self) -> BodyFields:
        """Its hidden part."""

    def _replace(self, *, depth: BodyFields = ..., hidden: BodyFields = ...) -> Self: ...


D = TypeVar("D", bound=DepthRecord)


class BodyDepth(Effect[D]):
    """Effect whose record has `depth` and `hidden`, the part of the depth that is not in the gap.

    With a profile that is shifted in each pass (``time.pass_shift``), the depths of earlier passes enter the
    contact with the heights of the profile. Ahead of the profile the body is smooth: pits without the
    asperities in which they formed would disturb the steady start. Depths ahead of the profile are hidden
    from the gap, but kept in the record; depths added during the pass are not hidden.

    While roughness is ramped up before time 0, nothing is added: solids that yield there do so in each step
    anew, and with lasting effect in the first step of the pass.
    """

    frozen_before_start = True

    def start(self, before: D | None = None, **entries: np.ndarray) -> D:
        """Depth zero with further entries of the record, or the record of the previous pass."""
        if before is None:
            zero = self.scene.mesh_on_bodies.zero
            return self.record(depth=zero, hidden=zero, **entries)
        roughness, faces = self.scene.roughness, self.scene.mesh_on_bodies.faces((0.0, 0.0))
        profiles = (roughness.surface_1, roughness.surface_2) if roughness else (None, None)
        return before._replace(hidden=type(before.depth)(*map(_ahead, before.depth, profiles, faces)))

    def inputs(self, record: D, inputs: StepInputs, step: Step) -> StepInputs:
        """Add both depths to the gap."""
        return replace(inputs, phi=inputs.phi + sum(self.in_gap(record, step)) / self.scene.scales.h)

    def in_gap(self, record: D, step: Step) -> list[np.ndarray]:
        """Depths of both bodies in the gap at the nodes [m]."""
        depths = self.scene.mesh_on_bodies.means(record.depth, step.travelled)
        hidden = self.scene.mesh_on_bodies.means(record.hidden, step.travelled)
        return [depth - hidden_depth for depth, hidden_depth in zip(depths, hidden, strict=True)]

    def on_surfaces(
        self, record: D, points: Sequence[np.ndarray | None]
    ) -> dict[str, Sequence[np.ndarray | None]]:
        """Depth along both surfaces."""
        return dict.fromkeys(self.surface, self.scene.mesh_on_bodies.at_points(record.depth, points))


def _ahead(field: BodyField, profile: RoughSurface | None, faces: np.ndarray) -> BodyField:
    """Depth ahead of a profile, in excess of that of its row, the minimum in the mesh at the start."""
    if profile is None or not profile.is_moving or not profile.body_offset or not field.cells:
        return field._replace(first=0, depth=field.depth[..., :0])
    centres = 0.5 * (field.edges[1:] + field.edges[:-1]) - profile.body_offset
    excess = np.maximum(field.depth - field.means(faces).min(axis=-1, keepdims=True), 0.0)
    return field._replace(depth=(1.0 - profile.entered(centres)) * excess)


def _volume(name: str, text: str) -> StepScalar:
    """Volume of both depths in the record of an effect."""
    return AtEnd(
        "m^3",
        f"{text} since the first pass",
        integrated=True,
        compared=True,
        of=lambda o: o.scene.mesh_on_bodies.volume(o.state.records[name].depth),
    )


class PlasticRecord(NamedTuple):
    """Plastic deformation of both bodies, its hidden part; increment of the last step at the nodes [m]."""

    depth: BodyFields
    added: np.ndarray
    hidden: BodyFields


class PlasticDeformation(BodyDepth[PlasticRecord]):
    r"""Plastic deformation of both surfaces, left where the solids have yielded.

    A step adds the depth :math:`\delta` of :mod:`ehlpetsc.discretisation.contact.yielding` at opposite points
    of the surfaces: to the softer surface, or half to each if both have the same yield pressure.
    """

    name = "plastic_deformation"
    record = PlasticRecord
    scalars = {
        "yielding": Count(
            "nodes that yield",
            summary="d",
            compared=True,
            of=lambda o: np.count_nonzero(o.state.records["plastic_deformation"].added),
        ),
        "set_volume": _volume("plastic_deformation", "plastic deformation of both solids"),
    }
    surface = {"set": Field("m", "depth of the plastic deformation at the end", ("s",))}

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        yield_1, yield_2 = scene.case.contact.yield_pressure or (0.0, 0.0)
        is_equal = yield_1 == yield_2
        self._fractions = (0.5, 0.5) if is_equal else (float(yield_1 < yield_2), float(yield_2 < yield_1))

    @classmethod
    def is_in(cls, case: Case) -> bool:
        """Whether the solids yield."""
        return case.contact.yield_pressure is not None

    def start(self, before: PlasticRecord | None = None, **entries: np.ndarray) -> PlasticRecord:
        """No deformation, or the deformation of the previous pass."""
        none = np.zeros(self.scene.scales.grid.n)
        return super().start(before, added=none, **entries)._replace(added=none)

    def accept(self, record: PlasticRecord, solution: Solution, step: Step) -> PlasticRecord:
        """Add the depth of the step to both bodies."""
        plastic = solution.nodes.plastic
        if plastic is None:
            return record
        total = self.scene.scales.h * plastic.depth
        depths = [fraction * total for fraction in self._fractions]
        depth = self.scene.mesh_on_bodies.add(record.depth, step.travelled, depths)
        return PlasticRecord(depth, total, record.hidden)


WEAR_KEYS = {
    "coefficient": Key(
        "wear rate `k` of the load of the solids, `dz/dt = k p_c |u1 - u2|`, `z` the depth worn off",
        *("m^2/N", 0, 1e-10),
        many="both",
    ),
    "load_coefficient": Key(
        "instead of it: wear rate of the whole load, `k` times the share of the solids",
        *("m^2/N", 0, 1e-10),
        many="both",
    ),
}


def _one_of_both(wear: Values) -> dict[str, Any]:
    """No further values; Refused unless one of both rates is given."""
    if (wear.coefficient is None) == (wear.load_coefficient is None):
        raise Refused("needs either coefficient or load_coefficient: one of them")
    return {}


WEAR = KeyTable(
    "wear",
    "left out: no wear",
    WEAR_KEYS,
    needs=('contact.model = "mixed"', "[time]"),
    complete=_one_of_both,
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
    r"""Wear of both surfaces by Archard's law.

    .. math:: \frac{dz_i}{dt}=k_i\,p_c\,|u_1-u_2|

    (Archard, J. Appl. Phys. 24 (1953) 981: worn volume per sliding distance in proportion to the load), p_c
    the pressure of the solids in mixed contact and :math:`k_i` the specific wear rate of surface i, the wear
    coefficient over the hardness. Implicit in time: a step wears with the pressure at its end.

    A rate of the whole load, `load_coefficient`, is divided by the share of the solids in it at the end of
    each step: the worn volume is then that of the whole load, its place where the solids carry.
    """

    name = "wear"
    table = WEAR
    record = WearRecord
    scalars = {"wear_volume": _volume("wear", "worn volume of both surfaces")}
    surface = {"wear": Field("m", "wear depth at the end", ("s",))}

    def accept(self, record: WearRecord, solution: Solution, step: Step) -> WearRecord:
        """Wear both surfaces where the solids carry."""
        wear, solids = self.scene.case.wear, solution.loads.contact_pressure
        if step.dt is None or wear is None or not solids.any():
            return record
        share = solids.sum() / solution.loads.pressure.sum()
        coefficients = wear.coefficient or [k / share for k in wear.load_coefficient]
        pressure, sliding = self.scene.scales.p0 * solids, step.conditions.sliding
        depths = [wear_depth(k, pressure, sliding, step.dt) for k in coefficients]
        return record._replace(depth=self.scene.mesh_on_bodies.add(record.depth, step.travelled, depths))
