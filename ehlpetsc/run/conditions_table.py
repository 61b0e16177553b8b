"""Friction, film and heat of a smooth contact over pressure, speed, slide/roll ratio and temperature."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpi4py import MPI

from ehlpetsc.base.errors import CaseError, NotConverged
from ehlpetsc.base.quantities import STEP_SCALARS, of_case, unit_in
from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.recorder import Recorder
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.run.solve import solve

# conditions by name: unit; bounds of a table
CONDITIONS = {
    "pressure": ("Pa", 1e7, 1e10),
    "speed": ("m/s", 1e-6, 1e3),
    "slide_roll": ("1", -100.0, 100.0),
    "temperature": ("K", 200.0, 700.0),
}
QUANTITIES = "friction_coefficient", "film_central", "h_min", "contact_share", "heat", "film_temperature_mean"


class ConditionsTable:
    """Quantities of steady contacts at conditions.

    `case`: smooth, with oil; its own conditions hold where a table does not vary them.
    `names`: conditions that the table varies.

    `quantities`, `units`: names and units of what is computed. `limits`: messages on validity by point.

    Raises
    ------
    CaseError
        The case is rough, dry, a series, or its conditions vary.
    """

    def __init__(self, case: Case, names: list[str], comm: MPI.Comm) -> None:
        self.case, self.names, self.comm = case, names, comm
        rough = case.surface.body_1 or case.surface.body_2
        if case.fluid is None or rough or case.series or case.conditions is not None:
            needless = {"surface": rough, "series": case.series}
            cures = [f"--set {name}=" for name, given in needless.items() if given]
            allowed = "smooth surfaces with oil under constant conditions, also with contact.asperity_height"
            cure = f"; to leave out the rest, add {' '.join(cures)}" if cures else ""
            raise CaseError([f"{case.path}: a table: allowed: {allowed}{cure}"])
        self.scales = Scales.of(case)
        present = of_case(STEP_SCALARS, case)
        self.quantities = [name for name in QUANTITIES if name in present]
        self.units = [unit_in(STEP_SCALARS[name], case.kind) for name in self.quantities]
        self.limits: dict[tuple[float, ...], list[str]] = {}

    def changes(self, point: tuple[float, ...]) -> dict[str, Any]:
        """Keys of the case at a point."""
        keys = {
            "pressure": "contact.load",
            "speed": "motion.entrainment_speed",
            "slide_roll": "motion.slide_roll_ratio",
            "temperature": "heat.bulk_temperature" if self.case.heat else "fluid.temperature",
        }
        changes: dict[str, Any] = {"time": None}
        for name, value in zip(self.names, point, strict=True):
            if name == "pressure":  # which grows with the load to the power of half the growth of its area
                power = 2.0 / self.scales.grid.growth
                value = self.scales.load * (value / self.scales.p0) ** power
            changes[keys[name]] = value
        return changes

    def compute(self, points: list[tuple[float, ...]]) -> np.ndarray:
        """Quantities at points, shape (points, quantities), each rank a part of them.

        Raises `NotConverged` that names the conditions.
        """
        mine = points[self.comm.rank :: self.comm.size]
        parts = self.comm.allgather([self._solved(point) for point in mine])
        values = np.empty((len(points), len(self.quantities)))
        for rank, part in enumerate(parts):
            for number, (found, limits, fault) in enumerate(part):
                point = points[rank + number * self.comm.size]
                if fault:
                    raise NotConverged(f"{self.words(point)}: {fault}")
                values[rank + number * self.comm.size], self.limits[point] = found, limits
        return values

    def words(self, point: tuple[float, ...]) -> str:
        """Conditions of a point for messages."""
        return ", ".join(f"{name} = {value:g}" for name, value in zip(self.names, point, strict=True))

    def _solved(self, point: tuple[float, ...]) -> tuple[list[float], list[str], str]:
        """Quantities, limits and fault of a point."""
        try:
            simulation = Simulation(load(self.case._tables, self.changes(point)))
            recorder = Recorder(simulation, None)
            with recorder:
                recorder.lock_output(None, False)
                _, failure = solve(simulation, [recorder])
        except CaseError as error:
            return [], [], "; ".join(error.faults)
        if failure:
            return [], [], str(failure)
        return [simulation.state.scalars[name] for name in self.quantities], recorder.limits, ""
