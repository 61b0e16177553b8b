"""Fields in SI units and scalars of an accepted time level."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.discretisation.contact.node_state import SurfaceLoads
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.effects.effect import Effect, Step
from ehlpetsc.effects.scene import Scene
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.oil.laws import viscosity
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.physics.scales import Scales
from ehlpetsc.physics.speeds_across import Slip
from ehlpetsc.physics.traction import mean_shear, shear_stresses
from ehlpetsc.stepping.state import State

if TYPE_CHECKING:
    from ehlpetsc.physics.contact.roller_loads import RollerLoads

VACUUM_PERMITTIVITY = 8.8541878188e-12  # F/m
MIN_BALANCE_FILM = 1e-10  # m, size of an atom: smallest reference film of the mass error


@dataclass(frozen=True)
class Observation:
    """An accepted time level, of which :mod:`ehlpetsc.base.quantities` states fields and scalars.

    `film_shear`: mean shear stress of the film by the effects [Pa]; None: isothermal.
    `started`: monotonic clock at the beginning of the step [s].
    `smooth`: minimum film of the smooth contact over that of the formulas, at time 0.
    """

    scene: Scene
    problem: EHLProblem
    state: State
    conditions: Conditions
    film_shear: np.ndarray | None
    started: float
    smooth: float = 1.0

    @property
    def loads(self) -> SurfaceLoads:
        """Loads on the surfaces, dimensionless."""
        return self.state.solution.loads

    @cached_property
    def pressure(self) -> np.ndarray:
        """Pressure of oil and solids at the nodes [Pa]."""
        return self.loads.pressure * self.scene.scales.p0

    @cached_property
    def film(self) -> np.ndarray:
        """Film at the nodes [m]."""
        return self.loads.film * self.scene.scales.h

    @cached_property
    def void_fraction(self) -> np.ndarray:
        """Void fraction of the film at the nodes; 0 without oil."""
        q = self.state.solution.nodes.reynolds_unknown
        return np.zeros(len(q)) if self.scene.case.fluid is None else np.maximum(-q, 0.0)

    @cached_property
    def slip(self) -> Slip:
        """Sliding velocity at the nodes."""
        return self.scene.scales.across.slip(self.conditions)

    @cached_property
    def sheared(self) -> np.ndarray:
        """Fraction of the gap in which oil is sheared, at the nodes."""
        return np.where(self.loads.sheared_oil, 1.0 - self.void_fraction, 0.0)

    @property
    def solid_friction(self) -> np.ndarray:
        """Friction between the solids at the nodes where they slide [Pa]."""
        s, inputs = self.scene.scales, self.state.solution.inputs
        return inputs.boundary_friction * (self.loads.friction_pressure * s.p0)

    @cached_property
    def gradient(self) -> np.ndarray:
        """Gradient of the oil's pressure along x at the nodes [Pa/m]."""
        return self._gradient(-1)

    def _gradient(self, axis: int) -> np.ndarray:
        s = self.scene.scales
        oil = s.grid.rows(self.loads.oil_pressure * s.p0)
        return np.gradient(oil, s.grid.spacings[axis], axis=axis).ravel()

    @cached_property
    def mean_shear(self) -> np.ndarray:
        """Mean shear stress of the film across its thickness at the nodes [Pa], along the sliding."""
        fluid, s = self.state.solution.inputs.fluid, self.scene.scales
        if fluid is None or self.film_shear is not None:
            return np.zeros(s.grid.n) if fluid is None else self.film_shear
        film = np.where(self.sheared > 0.0, self.film, 1.0)
        nodes = self.loads.oil_pressure * s.p0, film, self.gradient, self.slip.speed

        def at(columns: slice) -> np.ndarray:
            oil, film, slope, speed = (s.grid.at_columns(values, columns) for values in nodes)
            return s.grid.as_rows(mean_shear(film, slope, viscosity(oil, fluid)[0], fluid, speed, oil))

        return self.scene.over_columns(at).ravel()

    def _shear_stresses(self, gradient: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Shear stress on both surfaces in a direction: by the oil's gradient, the sliding's part in it."""
        fluid, oil = self.state.solution.inputs.fluid, self.loads.oil_pressure * self.scene.scales.p0
        walls = self.solid_friction, gradient, direction
        return shear_stresses(fluid, *walls, oil, self.film, self.sheared, self.mean_shear)

    @cached_property
    def shear_stresses(self) -> tuple[np.ndarray, np.ndarray]:
        """Shear stress on surfaces 1 and 2 at the nodes [Pa]."""
        return self._shear_stresses(self.gradient, self.slip.along)

    @cached_property
    def shear_stresses_across(self) -> tuple[np.ndarray, np.ndarray]:
        """Shear stress across, in +y, on surfaces 1 and 2 at the nodes [Pa]."""
        return self._shear_stresses(self._gradient(0), self.slip.across)

    @property
    def spin_moment(self) -> float:
        """Moment of the shear stresses on surface 2 about the normal, in the direction of the spin [N m]."""
        across, x = self.scene.scales.across, self.scene.scales.across.x
        rows = self.scene.scales.grid.rows
        moments = across.y[:, None] * rows(self.shear_stresses[1]) - x * rows(self.shear_stresses_across[1])
        return float(self.node_size * moments.sum())

    @property
    def friction_power(self) -> float:
        """Power of the shear stresses on both moving surfaces [W]: of sliding, spin and rolling."""
        s, total = self.scene.scales, 0.0
        both = zip(s.across.surfaces(self.conditions), s.across.spins, *self._tractions, strict=True)
        for speeds, spin, along, across in both:
            total -= (speeds[:, None] * along - spin * s.across.x * across).sum()
        return float(self.node_size * total)

    @property
    def _tractions(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Shear stresses of both surfaces along x, and across, in rows [Pa]."""
        rows = self.scene.scales.grid.rows
        return [*map(rows, self.shear_stresses)], [*map(rows, self.shear_stresses_across)]

    @property
    def sliding_power(self) -> float:
        """Power of sliding and spin alone [W]."""
        stress = self.mean_shear * self.sheared + self.solid_friction
        return float(self.node_size * (stress * self.slip.speed).sum())

    @property
    def node_size(self) -> float:
        """Size of a cell [m], of a point contact [m^2]."""
        return self.scene.scales.grid.node_size

    @cached_property
    def size(self) -> float:
        """Size of the Hertz contact of the instant over that of the scales."""
        return self.scene.scales.size(self.conditions)

    @cached_property
    def load(self) -> float:
        """Integral of the pressure [N/m]."""
        return self.node_size * self.pressure.sum()

    @property
    def load_error(self) -> float:
        """Relative error of the border's equation."""
        return self.problem.balance.error(self.state.solution.unknowns.border, self.load, self.conditions)

    @cached_property
    def friction_1(self) -> float:
        """Friction force on surface 1 [N/m]."""
        return self.node_size * self.shear_stresses[0].sum()

    @cached_property
    def friction_2(self) -> float:
        """Friction force on surface 2 [N/m]."""
        return self.node_size * self.shear_stresses[1].sum()

    @property
    def approach(self) -> float:
        """Rigid-body approach from the first touch of the undeformed smooth bodies, -h00 [m]."""
        return -self.problem.balance.separation(self.state.solution.unknowns.border)

    @cached_property
    def roller(self) -> RollerLoads:
        """Loads along a roller."""
        from ehlpetsc.physics.contact.roller_loads import RollerLoads

        tilt = self.problem.balance.tilt(self.state.solution.unknowns.border)
        return RollerLoads.of(self.scene.scales, self.conditions.radius, tilt, self.pressure, self.film)

    @cached_property
    def mean_film(self) -> float:
        """See :func:`mean_film`."""
        nodes = self.state.solution.nodes
        return mean_film(self.scene.scales, nodes.film, self.size, self.loads.pressure)

    @property
    def smooth_film(self) -> float:
        """Minimum film of smooth surfaces [m]: that of the start, then as by formulas; nan without oil."""
        fluid = self.scene.case.fluid
        return self.smooth * smooth_films(self.scene.scales, fluid, self.conditions)[1] if fluid else np.nan

    @property
    def mass_error(self) -> float:
        r"""Mass defect of a step over the mass that the contact carries.

        :math:`\sum_{i\ge1}|F_i|` over the mean of :math:`\rho h(1-\theta)` in the Hertz contact, of the
        instant, both times u: 0 where mass is conserved at every node. At contact nodes of direct contact, F
        is the mass that is not conserved; at other nodes, and at all nodes in mixed contact, it is the
        residual of Newton's method. (The mass flow at the inlet is no reference: nearly all of the thick film
        there flows back.) The inlet node has no balance: its pressure or its oil film is prescribed.
        """
        problem, solution, grid = self.problem, self.state.solution, self.problem.grid
        if problem.fluid is None:
            return 0.0
        defect = problem.film_scale * np.abs(grid.rows(solution.residual)[:, 1:]).sum()
        carried = solution.mass[grid.inside(self.size)].mean()
        return float(defect / (max(carried, MIN_BALANCE_FILM / problem.scales.h) * grid.breadth))

    @cached_property
    def capacitance(self) -> float:
        r"""Electrical capacitance of the gap [F/m].

        :math:`\varepsilon_0\int[1+(\varepsilon-1)(1-\theta)]dA/h` of the oil and the void in it side by
        side. Nodes in contact conduct and are left out.
        """
        permittivity = self.scene.case.fluid.permittivity
        relative = 1.0 + (permittivity - 1.0) * (1.0 - self.void_fraction)
        apart = ~self.loads.contact_mask
        integral = (relative[apart] / self.film[apart]).sum()
        return VACUUM_PERMITTIVITY * self.node_size * float(integral)

    @property
    def plate_capacitance(self) -> float:
        """Capacitance of oil between plates of the size of the Hertz contact at its mean film [F/m]."""
        area = self.node_size * self.scene.scales.grid.inside(self.size).sum()
        return VACUUM_PERMITTIVITY * self.scene.case.fluid.permittivity * float(area) / self.mean_film

    @property
    def oil_pressure(self) -> np.ndarray:
        """Pressure of the oil where it is known [Pa], else 0."""
        return np.where(self.loads.oil_mask, self.loads.oil_pressure, 0.0) * self.scene.scales.p0

    @cached_property
    def thin(self) -> np.ndarray:
        """Nodes whose film is thin, ``output.thin_film``."""
        return self.loads.film < self.scene.case.output.thin_film * self.problem.model.minimum_film

    @property
    def wall(self) -> float:
        """Wall clock time of the step until now [s]."""
        return clock.monotonic() - self.started


def diagnostics(
    scene: Scene,
    problem: EHLProblem,
    effects: list[Effect],
    state: State,
    started: float,
    smooth: float = 1.0,
) -> tuple[dict, dict, np.ndarray]:
    """Scalars of the step, fields and mask of the nodes in contact, in SI units.

    `started`: monotonic clock at the beginning of the step [s]. `smooth`: see :class:`Observation`.
    """
    case, conditions, solution = scene.case, scene.operation.at(state.time), state.solution
    present = [effect for effect in effects if effect.is_in(case)]
    shear = None
    for effect in present:
        shear = effect.film_shear(state.records[effect.name], solution, shear)
    observation = Observation(scene, problem, state, conditions, shear, started, smooth)
    fields, scalars = ({name: of(observation) for name, of in table.items()} for table in scene.quantities)
    step = Step(state.time, state.dt, state.travelled, conditions)
    for effect in present:
        effect_fields, effect_scalars = effect.observe(state.records[effect.name], solution, step)
        fields, scalars = fields | effect_fields, scalars | effect_scalars
    return scalars, fields, solution.loads.contact_mask


def mean_film(scales: Scales, h: np.ndarray, size: float, pressure: np.ndarray) -> float:
    """Mean film [m] of the middle half of the Hertz contact of the instant.

    `h`: film in a^2/R. `size`: of the contact of the instant over that of the widest contact of the run.
    `pressure`: in p0, whose load on each row is its weight along a roller.
    """
    return scales.grid.mean_inside(h, 0.5 * size, pressure) * scales.h
