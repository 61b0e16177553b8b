"""Pressure and wall shear of a result file, read in blocks of frames, with the case."""

from pathlib import Path

import numpy as np

from ehlpetsc.case.loading import stored_case
from ehlpetsc.errors import PostError
from ehlpetsc.physics.scales import Scales
from ehlpetsc.physics.variable_operation import operation_of
from ehlpetsc.post.stresses.half_plane import spacing
from ehlpetsc.results.post_result import SURFACES
from ehlpetsc.results.reader import read_result

CACHE_BYTES = 32 << 20  # of chunks of each dataset
VARIABLE = ("displacement_1", "displacement_2", "load_given")  # of changing operating conditions
MIN_NODES = 8  # slopes between nodes use seven nodes
UNITS = {"x": "m", "time": "s", "pressure": "Pa"}
UNITS |= {f"shear_stress_{surface}": "Pa" for surface in SURFACES}
UNITS |= {f"temperature_{surface}": "K" for surface in SURFACES}


class Loads:
    """Pressure and wall shear over stored frames.

    Parameters
    ----------
    path : path-like
    overrides : dict, optional
        Overrides of its case, see `ehlpetsc.load`.

    Attributes
    ----------
    case : Case
    scales : Scales
        Scales of the case: a, p0, dx, dt ...
    x : ndarray (nx,), m
    time : ndarray (nt,), s
    step : ndarray (nt,)
        Numbers of the stored steps.
    dx, a, p0 : float
        As stored.
    speeds : dict
        Speeds of the reference state, m/s, by surface.
    operation : ehlpetsc.physics.operation.ConstantOperation or VariableOperation
    dt : float or None
        Longest time step of the case, s; None with variable operating conditions.
    load : ndarray (nt,)
        Load of the operating conditions at each frame, N/m.
    has_conditions : bool
        Whether the case has its operating conditions; they may be in a separate file.
    travelled : dict
        Distance covered since time 0 at each frame, m, (nt,), by surface.
    profiles : dict
        (s, z) sorted by s; None for a smooth surface.
    profile_speeds : dict
        Speeds of the profiles, m/s, by surface.
    title, status : str

    Raises
    ------
    OutputError
        Not a result file, or a damaged one.
    CaseError
        The case text in the file is faulty.
    PostError
        Nodes not uniform, times that do not increase, a faulty profile.
    """

    def __init__(self, path, overrides=None):
        self.path = Path(path)
        self._result = read_result(path, rdcc_nbytes=CACHE_BYTES)
        self._stored = {}
        try:
            attrs = self._result.attrs
            self.case = stored_case(attrs["case"], overrides)
            self.title, self.status = attrs.get("title", ""), attrs.get("status", "unknown")
            self.a, self.p0 = float(attrs["a"]), float(attrs["p0"])
            self.speeds = {"1": float(attrs["u1"]), "2": float(attrs["u2"])}
            self._read_mesh()
            profiles = {surface: self._profile(surface) for surface in SURFACES}
            self.profiles = {surface: profile and profile[:2] for surface, profile in profiles.items()}
            self.profile_speeds = {surface: profile[2] for surface, profile in profiles.items() if profile}
        except BaseException:
            self._result.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self._result.close()

    def _read_mesh(self):
        result = self._result
        self.x, self.time, self.step = result.x, result.time, result.step.astype(np.int64)
        if self.x.size < MIN_NODES:
            raise PostError(f"dataset x: {self.x.size} nodes, at least {MIN_NODES} are needed")
        try:
            self.dx = spacing(self.x)
        except ValueError as fault:
            raise PostError(f"dataset x: {fault}") from None
        if (np.diff(self.time) <= 0).any():
            raise PostError("dataset time: does not increase from frame to frame")
        self.scales, self.has_conditions = Scales.of(self.case), True
        self.operation = operation_of(self.case, self.scales)
        stored = [self.step_scalar(name) for name in VARIABLE]
        if all(values is not None for values in stored):
            travelled_1, travelled_2, self.load = stored
            self.dt, self.has_conditions = None, self.case.conditions is not None
        else:
            travelled_1, travelled_2 = (
                np.array([self.operation.travelled(t) for t in self.time]).reshape(-1, 2).T
            )
            self.load = np.array([self.operation.at(t).load for t in self.time])
            self.dt = self.scales.dt
        self.travelled = {"1": travelled_1, "2": travelled_2}

    def _profile(self, surface):
        """(s, z, speed) sorted by s; None for a smooth surface."""
        profile = self._result.profile(surface)
        if profile is None:
            return None
        s, z, speed = profile
        if s.shape != z.shape or s.ndim != 1 or s.size < 2:
            raise PostError(f"datasets surface/{surface}/s and z: not one height a place")
        for name, values in (("s", s), ("z", z)):
            if not np.isfinite(values).all():
                row = np.flatnonzero(~np.isfinite(values))[0]
                raise PostError(f"dataset surface/{surface}/{name} is {values[row]} at point {row}")
        order = np.argsort(s)
        return s[order], z[order], speed

    @property
    def case_text(self):
        """Case text as stored."""
        return self._result.attrs["case"]

    def heated(self, surfaces):
        """Surfaces among `surfaces` whose temperature is stored; empty without [heat]."""
        stored = () if self.case.heat is None else self._result.fields
        return tuple(surface for surface in surfaces if f"temperature_{surface}" in stored)

    def bulk_temperature(self, surface):
        """Temperature of the body of `surface` far from the contact [K]."""
        return self.case.heat.bulk_temperature[int(surface) - 1]

    def needed(self, surfaces):
        """Names of the fields required for `surfaces`."""
        shear = (f"shear_stress_{surface}" for surface in surfaces)
        heat = (f"temperature_{surface}" for surface in self.heated(surfaces))
        return ("pressure", *shear, *heat)

    def check(self, surfaces):
        """Raise PostError if a field required for `surfaces` is missing or in another unit."""
        for name in ("x", "time", *self.needed(surfaces)):
            if name not in ("x", "time", *self._result.fields):
                raise PostError(
                    f'no dataset {name} of frames: list "{name}" in output.fields of the case and run it '
                    "again"
                )
            unit = self._result[name].attrs.get("units", UNITS[name])
            if unit != UNITS[name]:
                raise PostError(f'dataset {name}: its unit is "{unit}", it must be "{UNITS[name]}"')

    def read(self, surface, first, last):
        """Pressure and traction in +x on the solid of `surface` in frames first .. last-1, float64, Pa."""
        return self.rows("pressure", first, last), self.rows(f"shear_stress_{surface}", first, last)

    def rows(self, name, first, last):
        """Frames first .. last-1 of one dataset, float64."""
        if name not in self._stored:  # remains open with HDF5's cache of chunks
            self._stored[name] = self._result[name]
        return self._stored[name][first:last].astype(float, copy=False)

    def step_scalar(self, name):
        """Scalar ``steps/name`` at each stored frame; None if it is not in the file."""
        if name not in self._result.scalars or "step" not in self._result.scalars:
            return None
        rows = np.searchsorted(self._result.steps("step"), self.step)
        return self._result.steps(name)[rows].astype(float)
