"""What a result file says twice must agree: numbers in wrong units, or of another case, do not."""

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.physics.scales import hertz_line, reduced_modulus
from ehlpetsc.post.inputs.settings import is_number

AGREE = 1e-4  # relative: attributes and case are the same numbers but for rounding
LOAD_AGREES = 0.01  # the solver balances the load to rounding; other programs' quadrature may differ
FRAME_AGREES = 1e-4  # a stored frame, in single precision too, and the figures of its step
COURANT = 0.5  # where the case leaves it out
SHORTEST_STEP = 2.0**-13  # of the nominal one: the solver gives up at twice that
LONGEST_STEP = 1.5  # the solver's steps are at most the nominal one
MOST_STEPS = 100  # from frame to frame where their numbers are not stored
LEAST, WIDEST = 0.99, 101.0  # half widths from the middle to the ends of the mesh
NEGATIVE = 1e-3  # of p0: rounding of a pressure at 0


def expected(case):
    """Scales that follow from a parsed case, by attribute: a, p0, u1, u2, load.

    Raises
    ------
    PostError
        A key is missing or no number.
    """
    contact, motion = case["contact"], case["motion"]
    moduli, ratios = contact.get("youngs_modulus"), contact.get("poisson_ratio")
    load, radius = contact.get("load"), contact.get("radius")
    for key, value in (("load", load), ("radius", radius)):
        if not is_number(value) or value <= 0:
            raise PostError(f"contact.{key} = {value!r} in its case: must be a number above 0")
    half_width, pressure = hertz_line(load, radius, reduced_modulus(moduli, ratios))
    mean, ratio = motion.get("entrainment_speed", 0.0), motion.get("slide_roll_ratio", 0.0)
    if not (is_number(mean) and is_number(ratio)):
        raise PostError(f"motion = {motion!r} in its case: must be two numbers")
    return {
        "a": half_width,
        "p0": pressure,
        "u1": mean * (1 + ratio / 2),
        "u2": mean * (1 - ratio / 2),
        "load": load,
    }


def check_scales(loads, case):
    """Half width, Hertz pressure, speeds and nodes against the case; PostError with a line a fault."""
    wanted, faults = expected(case), []
    found = {"a": loads.a, "p0": loads.p0, "u1": loads.speeds["fast"], "u2": loads.speeds["slow"]}
    fastest = max(abs(wanted["u1"]), abs(wanted["u2"]))
    for name, unit, size in (("a", "m", wanted["a"]), ("p0", "Pa", wanted["p0"])) + tuple(
        (name, "m/s", fastest) for name in ("u1", "u2")
    ):
        if not abs(found[name] - wanted[name]) <= AGREE * size:
            faults.append(f"attribute {name} = {found[name]:.6g}: its case gives {wanted[name]:.6g} {unit}")
    for surface, speed in loads.profile_speeds.items():
        if not abs(speed - loads.speeds[surface]) <= AGREE * fastest:
            faults.append(
                f"attribute speed of surface/{surface} = {speed:g} m/s: the surface has "
                f"{loads.speeds[surface]:g} m/s"
            )
    first, last = loads.x[[0, -1]] / wanted["a"]
    if not -WIDEST < first < -LEAST < LEAST < last < WIDEST:
        faults.append(f"dataset x: from {first:.3g} to {last:.3g} half widths: it must be in m")
    mesh = case["mesh"]
    if not faults and is_number(mesh.get("points_per_half_width")) and is_number(mesh.get("inlet")):
        spacing, inlet = wanted["a"] / max(mesh["points_per_half_width"], 1), mesh["inlet"] * wanted["a"]
        if abs(loads.dx - spacing) > AGREE * spacing or abs(loads.x[0] - inlet) > 0.01 * wanted["a"]:
            faults.append(
                f"dataset x: begins at {loads.x[0]:.6g} with a spacing of {loads.dx:.6g}, its case's mesh at "
                f"{inlet:.6g} m with {spacing:.6g} m"
            )
    if faults:
        raise PostError("\n".join(faults))


def nominal_movement(case):
    """Nodes that the faster surface moves in a time step of the case."""
    courant = case["time"].get("courant", COURANT)
    if not is_number(courant) or courant <= 0:
        raise PostError(f"time.courant = {courant!r} in its case: must be a number above 0")
    return courant


def check_movement(loads, case, steps):
    """Movement a frame against the case's time step: times or speeds in other units; `steps` lie between.

    Parameters
    ----------
    loads : ehlpetsc.post.inputs.loads.Loads
    case : dict
    steps : ndarray (nt - 1,)
        Time steps from each frame to the next, 1 where that is not known.
    """
    fastest = max(map(abs, loads.speeds.values()))
    moved = np.median(np.diff(loads.time) / steps) * fastest / loads.dx
    nominal = nominal_movement(case)
    most = LONGEST_STEP if loads.step is not None else MOST_STEPS
    if fastest and not SHORTEST_STEP * nominal < moved < most * nominal:
        raise PostError(
            f"dataset time: the faster surface moves {moved:.3g} nodes a step, by the case {nominal:g}: "
            "times must be in s, speeds in m/s"
        )


class Balance:
    """Each frame's pressure and shear against the load of the case and the figures of its time step."""

    def __init__(self, loads, case):
        self.loads, self.load = loads, expected(case)["load"]
        self.of_step = {name: loads.of_steps(name) for name in ("load", "p_max", "friction")}

    def check_pressure(self, first, total, low, high):
        """Sums, least and greatest of the pressures of frames from `first` on."""
        loads = self.loads
        force = total * loads.dx
        wrong = ~(np.abs(force - self.load) <= LOAD_AGREES * self.load)
        self._refuse(
            wrong, first, force, "pressure", "its integral over x", self.load, "N/m, the case's load", "Pa"
        )
        self._refuse(
            low < -NEGATIVE * loads.p0, first, low, "pressure", "its least value", 0.0, "or more", "Pa"
        )
        self._of_step(first, force, "load", "pressure", "its integral over x", self.load)
        self._of_step(first, high, "p_max", "pressure", "its greatest value", loads.p0)

    def check_slow_shear(self, first, total):
        """Sums of the shear stresses on the slow solid of frames from `first` on."""
        self._of_step(
            first,
            total * self.loads.dx,
            "friction",
            "shear_stress_slow",
            "its integral over x",
            1e-3 * self.load,
        )

    def _of_step(self, first, found, name, dataset, what, size):
        known = self.of_step[name]
        if known is not None:
            known = known[first : first + len(found)]
            wrong = ~(np.abs(found - known) <= FRAME_AGREES * np.maximum(np.abs(known), size))
            self._refuse(wrong, first, found, dataset, what, known, f"as steps/{name} has it", "Pa")

    def _refuse(self, wrong, first, found, dataset, what, wanted, why, unit):
        if not wrong.any():
            return
        row = int(np.flatnonzero(wrong)[0])
        should = np.broadcast_to(wanted, wrong.shape)[row]
        raise PostError(
            f"dataset {dataset}: {what} at frame {first + row} (t = {self.loads.time[first + row]:.6g} s) is "
            f"{found[row]:.6g}, it must be {should:.6g} {why}: is it in {unit}, and of this case?"
        )


def check_shear_size(loads, name, first, size):
    """Greatest magnitudes of a shear stress against the Hertz pressure."""
    limit = 10 * loads.p0
    if (size > limit).any():
        row = int(np.argmax(size > limit))
        raise PostError(
            f"dataset {name}: {size[row]:.6g} at frame {first + row}, more than ten times the Hertz "
            "pressure: is it in Pa?"
        )
