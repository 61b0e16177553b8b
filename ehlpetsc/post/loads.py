"""Pressure, wall shear and surface temperature of a result file, read in blocks of frames, with its case."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ehlpetsc.base.errors import PostError
from ehlpetsc.case.loading import stored_case
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.post.stresses.half_plane import spacing
from ehlpetsc.results.post_result import SURFACES
from ehlpetsc.results.reader import read_result

CACHE_BYTES = 32 << 20  # of chunks of each dataset


class Loads:
    """Loads of both surfaces over the stored frames, a context manager.

    `case`, `case_text`: with the overrides, and as stored.
    `x`, `dx`, `a`, `p0`: nodes [m], their spacing [m], Hertz half-width [m], Hertz pressure [Pa].
    `time`, `step`: times [s] and step numbers of the frames, shape (nt,).
    `speeds`: speed of each surface in the reference state [m/s].
    `travelled`: distance covered by each surface since time 0 at each frame [m].
    `profiles`: (s, z) of each surface, sorted by s; None for a smooth one.
    """

    def __init__(self, path: str | Path, overrides: Iterable = ()) -> None:
        self.path = Path(path)
        self._result = read_result(self.path, rdcc_nbytes=CACHE_BYTES)
        self._stored: dict[str, Any] = {}
        attrs = self._result.attrs
        self.case_text = attrs["case"]
        self.case = stored_case(self.case_text, overrides)
        self.title, self.status = attrs["title"], attrs["status"]
        self.a, self.p0 = float(attrs["a"]), float(attrs["p0"])
        self.speeds = {"1": float(attrs["u1"]), "2": float(attrs["u2"])}
        self.x, self.time, self.step = self._result.x, self._result.time, self._result.step
        self.dx = spacing(self.x)
        self.operation = operation_of(self.case, Scales.of(self.case))
        self.travelled = self._travelled()
        self.profiles = {surface: self._profile(surface) for surface in SURFACES}

    def __enter__(self) -> Loads:
        return self

    def __exit__(self, *exception: object) -> None:
        self._result.close()

    def _travelled(self) -> dict[str, np.ndarray]:
        names = {surface: f"displacement_{surface}" for surface in SURFACES}
        if set(names.values()) <= set(self._result.scalars):  # of operating conditions that change
            rows = np.searchsorted(self._result.steps("step"), self.step)
            return {surface: self._result.steps(name)[rows].astype(float) for surface, name in names.items()}
        distances = np.array([self.operation.travelled(t) for t in self.time]).reshape(-1, 2).T
        return dict(zip(("1", "2"), distances, strict=True))

    def _profile(self, surface: str) -> tuple[np.ndarray, np.ndarray] | None:
        profile = self._result.profile(surface)
        if profile is None:
            return None
        order = np.argsort(profile[0])
        return profile[0][order].astype(float), profile[1][order].astype(float)

    def is_heated(self, surface: str) -> bool:
        """Whether the temperature of a surface is stored; False without [heat]."""
        return self.case.heat is not None and f"temperature_{surface}" in self._result.fields

    def bulk_temperature(self, surface: str) -> float:
        """Temperature of the body of `surface` far from the contact [K]."""
        return self.case.heat.bulk_temperature[int(surface) - 1]

    def check(self, surfaces: Sequence[str]) -> None:
        """Raise PostError if a field required for `surfaces`, or the history, is not stored."""
        for name in ("pressure", *(f"shear_stress_{surface}" for surface in surfaces)):
            if name not in self._result.fields:
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
        return self.rows("pressure", first, last), self.rows(f"shear_stress_{surface}", first, last)

    def rows(self, name: str, first: int, last: int) -> np.ndarray:
        """Frames first .. last-1 of one dataset, float64."""
        if name not in self._stored:  # remains open with HDF5's cache of chunks
            self._stored[name] = self._result[name]
        return self._stored[name][first:last].astype(float, copy=False)
