"""Pressure, wall shear and surface temperature of a result file, read in blocks of frames, with its case."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from ehlpetsc.base.errors import PostError
from ehlpetsc.case.loading import stored_case
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.post.stresses.body_stress import limited_slopes
from ehlpetsc.post.stresses.half_plane import spacing
from ehlpetsc.results.post_result import SURFACES
from ehlpetsc.results.reader import Result, open_result

CACHE_BYTES = 32 << 20  # of chunks of each dataset


class Loads(Result):
    """Loads of both surfaces over the stored frames, a context manager.

    `case`: with the overrides. `dx`, `a`, `p0`: spacing of the nodes [m], Hertz half-width [m], Hertz
        pressure [Pa].
    `rows`: (ny,) of a plane, () of a line contact. `dy`: spacing across [m]. `is_periodic`: of a strip.
    `rows_in_contact`: True for those (ny,) within the half-width b of a point contact; None for a line.
    `speeds`: speed of each surface in the reference state [m/s].
    `travelled`: distance covered by each surface since time 0 at each frame [m].
    `profiles`: (s, z) of each surface, sorted by s, z of shape (*rows, ns); None for a smooth one.
    """

    def __init__(self, path: str | Path, overrides: Iterable = ()) -> None:
        super().__init__(open_result(Path(path), rdcc_nbytes=CACHE_BYTES), Path(path))
        self._stored: dict[str, Any] = {}
        self.case = stored_case(self.attrs["case"], overrides)
        self.a, self.p0, u1, u2 = (float(self.attrs[name]) for name in ("a", "p0", "u1", "u2"))
        self.speeds, self.dx = {"1": u1, "2": u2}, spacing(self.x)
        self.scales = Scales.of(self.case)
        self.operation = operation_of(self.case, self.scales)
        self.rows: tuple[int, ...] = () if self.y is None else self.y.shape
        self.dy = 0.0 if self.y is None else spacing(self.y)
        self.is_periodic = self.attrs.get("kind") == "strip"
        b = np.inf if self.is_periodic else float(self.attrs.get("b", np.inf))
        self.rows_in_contact = None if self.y is None else np.abs(self.y) < b
        self.travelled = {surface: self._travelled(surface) for surface in SURFACES}
        self.profiles = {surface: self._sorted_profile(surface) for surface in SURFACES}

    def __enter__(self) -> Loads:
        return self

    def _travelled(self, surface: str) -> np.ndarray:
        if (name := f"displacement_{surface}") in self.scalars:  # of operating conditions that change
            return self.steps(name)[np.searchsorted(self.steps("step"), self.step)].astype(float)
        return np.array([self.operation.travelled(t)[int(surface) - 1] for t in self.time], float)

    def _sorted_profile(self, surface: str) -> tuple[np.ndarray, np.ndarray] | None:
        if (profile := self.profile(surface)) is None:
            return None
        order = np.argsort(profile[0])
        return profile[0][order].astype(float), profile[1][..., order].astype(float)

    def half_width(self, frame: int) -> float:
        """Hertz half-width of the conditions at a frame [m]."""
        return self.scales.a * self.scales.size(self.operation.at(self.time[frame]))

    def is_heated(self, surface: str) -> bool:
        """Whether the temperature of a surface is stored; False without [heat]."""
        return self.case.heat is not None and f"temperature_{surface}" in self.fields

    def check(self, surfaces: Sequence[str]) -> None:
        """Raise PostError if a field required for `surfaces`, or the history, is not stored."""
        for name in ("pressure", *(f"shear_stress_{surface}" for surface in surfaces)):
            if name not in self.fields:
                raise PostError(
                    f'no dataset {name} of frames: list "{name}" in output.fields of the case, run it again'
                )
        if self.time.size < 2 or self.case.time is None:
            raise PostError(
                f"stored frames: {self.time.size}; damage needs the stress history of a run over time, "
                "a [time] section and output.every = 1"
            )

    def read(self, surface: str, first: int, last: int) -> tuple[np.ndarray, np.ndarray]:
        """Pressure and traction in +x on the solid of `surface` in frames first .. last-1 [Pa]."""
        return self.frames("pressure", first, last), self.frames(f"shear_stress_{surface}", first, last)

    def frames(self, name: str, first: int, last: int) -> np.ndarray:
        """Frames first .. last-1 of one dataset, float64."""
        if name not in self._stored:  # remains open with HDF5's cache of chunks
            self._stored[name] = self[name]
        return self._stored[name][first:last].astype(float, copy=False)

    def temperatures(self, surface: str, frame: int, x: np.ndarray) -> np.ndarray:
        """Surface temperatures (*rows, points) at positions x [m] in a frame by limited cubics.

        nan beyond the nodes.
        """
        values = self.frames(f"temperature_{surface}", frame, frame + 1)[0]
        slopes = np.empty_like(values)
        limited_slopes(np.atleast_2d(values), np.atleast_2d(slopes))
        return CubicHermiteSpline(self.x, values, slopes / self.dx, axis=-1, extrapolate=False)(x)
