"""Interface of an effect: physics, other than the film, whose state changes from time level to time level.

The state of a run contains one record of each effect, a NamedTuple of arrays, numbers and other NamedTuples.
The record is saved in restart files by its field names; only the effect reads it.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, get_type_hints

from ehlpetsc.keys import KeyTable


@dataclass(frozen=True)
class Scene:
    """Quantities that are fixed over a run, for effects.

    Attributes
    ----------
    case : case.loading.Case
    scales : physics.scales.Scales
    operation : physics.operation.ConstantOperation
    positions : surfaces.roughness.SurfacePositions
        Positions of both surfaces at the beginning of the run.
    """

    case: object
    scales: object
    operation: object
    positions: object

    @classmethod
    def of_pass(cls, case: Any, scales: Any, operation: Any, number: int) -> "Scene":
        """Scene at the beginning of a pass, from 1: `time.pass_shift` shifts surface 2 from pass to pass."""
        from ehlpetsc.surfaces.roughness import SurfacePositions

        offset_1, offset_2 = (case.conditions and case.conditions.profile_offsets) or (0.0, 0.0)
        shift = (number - 1) * case.time.pass_shift if case.time else 0.0
        positions = replace(SurfacePositions.at_rest(scales), profile_offsets=(offset_1, offset_2 + shift))
        return cls(case, scales, operation, positions)

    @cached_property
    def roughness(self):
        """Profiles of both surfaces, `surfaces.roughness.Roughness`; None where both are smooth."""
        from ehlpetsc.surfaces.roughness import Roughness

        return Roughness.of(self.case, self.scales, self.positions)

    @property
    def rq(self):
        """Combined root mean square roughness [m]; 0: smooth."""
        return self.roughness.rq if self.roughness else 0.0

    @cached_property
    def mesh_on_bodies(self):
        """Cells of the mesh in both bodies, `surfaces.body_field.MeshOnBodies`."""
        from ehlpetsc.surfaces.body_field import MeshOnBodies
        from ehlpetsc.surfaces.roughness import directed_speeds

        speeds = directed_speeds(self.case, self.scales)
        return MeshOnBodies(self.scales, self.positions.offsets(speeds))


class Step(NamedTuple):
    """End of a time step.

    Attributes
    ----------
    time : float
        [s]
    dt : float or None
        Length of the step [s]; None: the steady start.
    travelled : (float, float)
        Distances travelled by surfaces 1 and 2 since time 0 [m].
    conditions : physics.operation.Conditions
    """

    time: float
    dt: float | None
    travelled: tuple
    conditions: object


class NoRecord(NamedTuple):
    """Empty record of an effect without a state."""


class Effect:
    """Base class of effects: no influence, no quantities.

    Parameters
    ----------
    scene : Scene

    Attributes
    ----------
    name : str
        Name of the record in the state and in restart files.
    record : type
        Type of the record, a NamedTuple.
    table : KeyTable or None
        Table of the case file, :class:`ehlpetsc.keys.KeyTable`.
    moves_with_surfaces : bool
        Whether its contribution to the gap moves with the surfaces from the first step on.
    fields, scalars, surface : dict
        Quantities of the effect, see :mod:`ehlpetsc.quantities`: fields over the nodes, scalars of every time
        step, depths along each surface at the end of the run.
    """

    name = ""
    record = NoRecord
    table: KeyTable | None = None
    moves_with_surfaces = False
    fields: dict = {}
    scalars: dict = {}
    surface: dict = {}

    def __init__(self, scene):
        self.scene = scene

    @classmethod
    def is_in(cls, case):
        """Whether a case has this effect: by default its table of keys."""
        return cls.table is not None and getattr(case, cls.table.name) is not None

    def start(self, before=None):
        """Record at time 0.

        Parameters
        ----------
        before : NamedTuple, optional
            Record at the end of the previous pass.
        """
        return self.record()

    def inputs(self, record, inputs, step):
        """Inputs of the solve with the contribution of the effect.

        Parameters
        ----------
        record : NamedTuple
            Record at the beginning of the step.
        inputs : discretisation.step_inputs.StepInputs
        step : Step

        Returns
        -------
        StepInputs
        """
        return inputs

    def accept(self, record, solution, step):
        """Record at the end of an accepted step.

        Parameters
        ----------
        record : NamedTuple
            Record at the beginning of the step.
        solution : discretisation.ehl_problem.Solution
        step : Step
        """
        return record

    def is_settled(self, before, after):
        """Whether a steady solution is consistent with the record after it; otherwise it is solved again."""
        return True

    def film_shear(self, record, solution, shear):
        """Mean shear stress of the film [Pa] by `shear`, that without this effect; None: isothermal."""
        return shear

    def observe(self, record, solution, step):
        """Values of `fields` and `scalars` by name, in SI units."""
        return {}, {}

    def on_surfaces(self, record, points):
        """Values of the quantities `surface` at points of surfaces 1 and 2.

        Parameters
        ----------
        record : NamedTuple
        points : pair of ndarray or None
            Body points s [m]; None: not stored.

        Returns
        -------
        dict of str to pair of ndarray or None
        """
        return {}


def flat(record, name):
    """Fields of a record, and of records in it, by dotted names."""
    values = {}
    for key, value in record._asdict().items():
        inner = f"{name}.{key}"
        values |= flat(value, inner) if hasattr(value, "_asdict") else {inner: value}
    return values


def unflat(kind: type, values: dict[str, Any], name: str) -> Any:
    """Record of type `kind` from the values of :func:`flat`."""
    fields = {}
    for key, inner in get_type_hints(kind).items():
        path = f"{name}.{key}"
        fields[key] = unflat(inner, values, path) if hasattr(inner, "_fields") else values[path]
    return kind(**fields)
