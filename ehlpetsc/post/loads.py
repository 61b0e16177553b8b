"""Loads of a result file, read in blocks of frames: pressure, wall shear, surface temperature; its case,
body points and their passages.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from ehlpetsc.base.errors import PostError
from ehlpetsc.base.materials import fatigue_constants, named_steels
from ehlpetsc.case.assumptions import COMMANDS, STRESSES, refusal
from ehlpetsc.case.loading import Case, stored_case
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.post.criteria.planes import Criteria
from ehlpetsc.post.fatigue.strain_life import Material
from ehlpetsc.post.level import scaled_to_test
from ehlpetsc.post.stresses.body_stress import limited_slopes
from ehlpetsc.post.stresses.half_plane import spacing
from ehlpetsc.results.post_result import UPPER_FIRST
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
        self.travelled = {surface: self._travelled(surface) for surface in UPPER_FIRST}
        self.profiles = {surface: self._sorted_profile(surface) for surface in UPPER_FIRST}

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
        """Pressure and traction in +x on the solid of `surface` in frames first .. last-1 [Pa].

        PostError if a value is not finite: cycles would be counted without it.
        """
        names = "pressure", f"shear_stress_{surface}"
        pressure, shear = (self.frames(name, first, last) for name in names)
        for name, values in zip(names, (pressure, shear), strict=True):
            if not np.isfinite(values).all():
                frame = first + np.flatnonzero(~np.isfinite(values.reshape(len(values), -1)).all(axis=1))[0]
                raise PostError(f"{self.path}: {name} is not finite in frame {frame}; run the case again")
        return pressure, shear

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


DEPTHS = (0.0, 0.01, 0.03, 0.05, 0.1, 0.2, 0.5, 0.7, 1.0)  # z/a: down to the stresses of the smooth contact
MIN_REPRESENTATIVE_POINTS = 30  # of a surface
LAST_FRAME_TOLERANCE = 0.01  # of the duration: a last frame nearer to the end counts as at the end


class Prepared(NamedTuple):
    """Data of a result file for all tasks.

    `s`: body points (ns,) [m]. `motions`: passages by surface. `materials`: by surface. `criteria`: their
    constants. `depths`: z/a.
    """

    loads: Loads
    s: np.ndarray
    motions: dict[str, PointPassage]
    materials: dict[str, Material]
    criteria: Criteria
    depths: np.ndarray


def materials_of(case: Case) -> dict[str, Material]:
    """Constants of the fatigue curves of each surface."""
    contact, given = case.contact, case.post.as_dict()
    bodies = zip(contact.youngs_modulus, contact.poisson_ratio, named_steels(contact.material), strict=True)
    one, two = (Material(*elastic, **fatigue_constants(steel, given)) for *elastic, steel in bodies)
    mean = {"tensile_strength": case.post.tensile_strength, "walker_exponent": case.post.walker_exponent}
    return {"1": replace(one, **mean), "2": replace(two, **mean)}


def prepare(loads: Loads, surfaces: Sequence[str], report: Callable[[str], None]) -> Prepared:
    """Find the body points whose damage can be computed, and report what limits it.

    PostError if there are none, or if the fatigue limits contradict each other.
    """
    post = loads.case.post
    constants = {name: getattr(post, name) for name in Criteria.__dataclass_fields__}
    criteria = Criteria(**{name: value for name, value in constants.items() if value is not None})
    if fault := refusal(loads.case, STRESSES, COMMANDS[STRESSES]):
        raise PostError(fault)
    loads.check(surfaces)
    depths = np.unique(post.depths or DEPTHS).astype(float)
    materials = {
        surface: scaled_to_test(loads.case, material, criteria)
        for surface, material in materials_of(loads.case).items()
    }
    prepared = Prepared(loads, *_motions(loads, surfaces), materials, criteria, depths)
    for warning in _warnings(prepared):
        report(f"warning: {warning}")
    return prepared


def _motions(loads: Loads, surfaces: Sequence[str]) -> tuple[np.ndarray, dict[str, PointPassage]]:
    distances = [loads.travelled[surface] for surface in surfaces]
    moved = max(abs(distance[-1] - distance[0]) for distance in distances)
    s = body_points(loads.x, loads.dx, distances)
    motions = {
        surface: passage(s, loads.x, loads.dx, distance, _flank(loads, surface))
        for surface, distance in zip(surfaces, distances, strict=True)
    }
    if not any(motion.complete.any() for motion in motions.values()):
        width = (loads.x[-1] - loads.x[0]) / loads.a
        raise PostError(
            f"no body point passed the whole contact: the surfaces moved {moved / loads.a:.3g} half-widths, "
            f"the domain is {width:.3g} wide; raise time.travel"
        )
    return s, motions


def _flank(loads: Loads, surface: str) -> tuple[float, float]:
    """Points of a flank between the ends of its path of contact, if the run has reached its end."""
    case, number = loads.case, int(surface) - 1
    if case.gears is None:
        return NO_FLANK
    pair, begin = case.gears.pair, case.conditions.profile_offsets[number]
    arc = pair.flank_arcs(pair.points["E"])[number]
    ended = loads.time[-1] > (1.0 - LAST_FRAME_TOLERANCE) * loads.operation.duration
    return begin - arc if ended else np.inf, begin


def _warnings(prepared: Prepared) -> Iterator[str]:
    if (status := prepared.loads.attrs["status"]) != "done":
        yield f'the run\'s status is "{status}": only its stored frames are used'
    if (every := prepared.loads.case.output.every) > 1:
        yield f"stored with output.every = {every}: peaks between frames are lost, too little damage"
    if of_ends := refusal(prepared.loads.case, "stresses near the ends", ("half-spaces",)):
        yield of_ends
    for surface, motion in prepared.motions.items():
        passed = np.count_nonzero(motion.complete)
        distance = prepared.loads.travelled[surface]
        if distance[0] == distance[-1]:
            yield f"surface {surface} is where it began: none of its points passed the whole contact"
        elif passed < MIN_REPRESENTATIVE_POINTS:
            yield f"points of surface {surface} that passed the whole contact: {passed}; raise time.travel"


NO_FLANK = np.inf, -np.inf
GRID_ROUNDING = 1e-9  # nodes: points nearer to a node are at it


class PointPassage(NamedTuple):
    """Passage of body points through the nodes.

    Body point j is at node j + shift[k] + offset[k] at frame k, 0 <= offset < 1. `enter` and `leave` are
    its first and last frames inside the nodes; `complete` is true if it entered and left the nodes, or if
    the contact began and ended on its flank.
    """

    shift: np.ndarray
    offset: np.ndarray
    enter: np.ndarray
    leave: np.ndarray
    complete: np.ndarray

    def positions(self, frame: int, x: np.ndarray, dx: float) -> np.ndarray:
        """Positions of all points in a frame [m]; nan beyond the nodes x."""
        node = np.arange(self.enter.size) + self.shift[frame]
        at = x[node.clip(0, x.size - 1)] + self.offset[frame] * dx
        return np.where((node >= 0) & (node < x.size), at, np.nan)


def body_points(x: np.ndarray, dx: float, travelled: Iterable[np.ndarray]) -> np.ndarray:
    """Body coordinates s, with the spacing dx, of all points that were ever among the nodes x [m].

    `travelled` are the distances of each body at each frame [m].
    """
    ends = np.array([[distance[0], distance[-1]] for distance in travelled])
    before = max(int(np.ceil(ends.max() / dx - GRID_ROUNDING)), 0)
    after = max(int(np.ceil(-ends.min() / dx - GRID_ROUNDING)), 0)
    return x[0] + dx * np.arange(-before, x.size + after)


def passage(
    s: np.ndarray, x: np.ndarray, dx: float, travelled: np.ndarray, flank: tuple[float, float] = NO_FLANK
) -> PointPassage:
    """Passage of the points s = s[0] + j dx of a body with x = s + travelled (nt,).

    `flank` are the points s at x = 0 at the end and at the beginning of the contact of two teeth; points
    between them need not enter or leave the nodes. PostError if the body turns back.
    """
    base = np.round((s[0] - x[0] + travelled) / dx, 9)
    shift = np.floor(base).astype(np.int64)
    j, last = np.arange(s.size), x.size - 1
    if (np.diff(base) >= 0).all():
        enter, leave = np.searchsorted(base, -j, "left"), np.searchsorted(base, last - j, "right") - 1
        complete = ((base[0] + j <= 0) | (s <= flank[1])) & ((base[-1] + j >= last) | (s >= flank[0]))
    elif (np.diff(base) <= 0).all():
        enter, leave = np.searchsorted(-base, j - last, "left"), np.searchsorted(-base, j, "right") - 1
        complete = (base[0] + j >= last) & (base[-1] + j <= 0)
    else:
        raise PostError("a surface turns back: its points would pass the contact several times")
    return PointPassage(shift, base - shift, enter, leave, complete)
