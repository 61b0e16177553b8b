"""Consistency of a result file with its case: wrong units and numbers of another case are refused."""

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.post.inputs.loads import UNITS

SCALE_TOLERANCE = 1e-4  # relative: attributes and case differ by rounding
LOAD_TOLERANCE = 0.01  # the solver balances the load to rounding; other programs' quadrature may differ
FRAME_TOLERANCE = 1e-4  # of a stored frame, also in single precision, and the scalars of its step
MIN_STEP = 2.0**-13  # of the nominal time step: half the smallest time step of the solver
MAX_STEP = 1.5  # of the nominal time step, the largest time step of the solver
MAX_NEGATIVE_PRESSURE = 1e-3  # of p0: rounding of a pressure at 0
MIN_TEMPERATURE = 100.0  # K: smaller values are in degrees Celsius, or temperature rises


def check_scales(loads):
    """Check half width, Hertz pressure, speeds and nodes against the case; PostError with all faults."""
    if not loads.has_conditions:
        return
    scales, faults = loads.scales, []
    stored = {"a": loads.a, "p0": loads.p0, "u1": loads.speeds["1"], "u2": loads.speeds["2"]}
    for name, unit, size in (
        ("a", "m", scales.a),
        ("p0", "Pa", scales.p0),
        ("u1", "m/s", scales.u_max),
        ("u2", "m/s", scales.u_max),
    ):
        expected = getattr(scales, name)
        if not abs(stored[name] - expected) <= SCALE_TOLERANCE * size:
            faults.append(f"attribute {name} = {stored[name]:.6g}: its case gives {expected:.6g} {unit}")
    for surface, speed in loads.profile_speeds.items():
        if not abs(speed - loads.speeds[surface]) <= SCALE_TOLERANCE * scales.u_max:
            faults.append(
                f"attribute speed of surface/{surface} = {speed:g} m/s: the surface has "
                f"{loads.speeds[surface]:g} m/s"
            )
    inlet = scales.x[0] * scales.a
    if abs(loads.dx - scales.dx) > SCALE_TOLERANCE * scales.dx or abs(loads.x[0] - inlet) > 0.01 * scales.a:
        faults.append(
            f"dataset x: begins at {loads.x[0]:.6g} with a spacing of {loads.dx:.6g}, its case's mesh at "
            f"{inlet:.6g} m with {scales.dx:.6g} m"
        )
    if faults:
        raise PostError("\n".join(faults))


def check_time_step(loads):
    """Check the times of the frames against the time step of the case; PostError if in another unit."""
    step = np.median(np.diff(loads.time) / np.diff(loads.step))
    if loads.dt and not MIN_STEP < step / loads.dt < MAX_STEP:
        raise PostError(
            f"dataset time: a step takes {step:.3g}, by the case {loads.dt:.3g} s: times must be in s"
        )


class Balance:
    """Checks of pressure and shear of each frame against the load of the case and the scalars of its step."""

    def __init__(self, loads):
        self.loads = loads
        self.load = loads.load
        names = "load", "p_max", "friction", "temperature_1_max", "temperature_2_max"
        self.of_step = {name: loads.step_scalar(name) for name in names}

    def check_pressure(self, first, total, low, high):
        """Check sums, minima and maxima of the pressures of frames from `first` on."""
        p0, force = self.loads.p0, total * self.loads.dx
        load = self.load[first : first + len(force)]
        wrong = ~(np.abs(force - load) <= LOAD_TOLERANCE * load)
        self._refuse(wrong, first, force, "pressure", "its integral over x", load, "N/m, the case's load")
        negative = low < -MAX_NEGATIVE_PRESSURE * p0
        self._refuse(negative, first, low, "pressure", "its least value", 0.0, "or more")
        self._of_step(first, force, "load", "pressure", "its integral over x", self.load[0])
        self._of_step(first, high, "p_max", "pressure", "its greatest value", p0)

    def check_shear_2(self, first, total):
        """Check sums of the shear stresses on surface 2 of frames from `first` on."""
        force, small = total * self.loads.dx, 1e-3 * self.load[0]
        self._of_step(first, force, "friction", "shear_stress_2", "its integral over x", small)

    def check_shear_size(self, name, first, size):
        """Check the largest magnitudes of a shear stress against the Hertz pressure."""
        limit = 10 * self.loads.p0
        self._refuse(size > limit, first, size, name, "its greatest value", limit, "or less")

    def check_temperature(self, name, first, low, high):
        """Check the extreme temperatures of frames from `first` on."""
        self._refuse(low < MIN_TEMPERATURE, first, low, name, "its least value", MIN_TEMPERATURE, "K or more")
        self._of_step(first, high, f"{name}_max", name, "its greatest value", MIN_TEMPERATURE)

    def _of_step(self, first, values, name, dataset, quantity, size):
        expected = self.of_step[name]
        if expected is not None:
            expected = expected[first : first + len(values)]
            wrong = ~(np.abs(values - expected) <= FRAME_TOLERANCE * np.maximum(np.abs(expected), size))
            self._refuse(wrong, first, values, dataset, quantity, expected, f"as steps/{name} has it")

    def _refuse(self, wrong, first, values, dataset, quantity, expected, why):
        if not wrong.any():
            return
        row = int(np.flatnonzero(wrong)[0])
        should = np.broadcast_to(expected, wrong.shape)[row]
        raise PostError(
            f"dataset {dataset}: {quantity} at frame {first + row} "
            f"(t = {self.loads.time[first + row]:.6g} s) is {values[row]:.6g}, "
            f"it must be {should:.6g} {why}: is it in {UNITS[dataset]}, and of this case?"
        )
