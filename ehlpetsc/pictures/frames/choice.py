"""Which stored frames of results a picture or a movie shows, their view, and their title."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.figure import Figure

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.errors import OutputError
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames.data import Frame, common
from ehlpetsc.results.means import both_fill
from ehlpetsc.results.output_guard import replacing
from ehlpetsc.results.reader import Result

WINDOW = (-1.6, 1.4)  # limits of x/a by default
MIN_LOAD_ON_SOLIDS = 0.005  # of the load: with less the pressure determines the instant
MOVIE_FRAMES, RATE, MOVIE_DPI = 150, 15, 80  # of a movie: frames, frames per second, dots per inch


class Choice(NamedTuple):
    """A stored frame of each result, limits of x/a, and a field in the place of the film (None: the film)."""

    results: list[Result]
    indices: Sequence[int]
    window: Sequence[float]
    field: str | None = None

    @classmethod
    def of(cls, results: list[Result], options: argparse.Namespace) -> Choice:
        """Choice by the options of the command."""
        indices = choose_frames(results, options.step, options.time)
        return cls(results, indices, view(results, options.window), options.field)

    @property
    def frames(self) -> list[Frame]:
        """Fields of the frames."""
        pairs = zip(self.results, self.indices, strict=True)
        return [Frame.of(result, index, self.window, self.field) for result, index in pairs]

    @property
    def module(self) -> ModuleType:
        """Module that draws the frames: of lines and sections, or that of the kind of contact."""
        first = self.results[0]
        name = "line" if first.y is None else KINDS[first.case.kind].picture
        return import_module(f"ehlpetsc.pictures.frames.{name}")

    @property
    def title(self) -> list[str]:
        """Lines of a title: the common title of results with the instant, then the conditions there."""
        titles = {str(result.attrs["title"]) for result in self.results}
        texts = [titles.pop() if len(titles) == 1 else "", instant(self.results, self.indices)]
        return [": ".join(filter(None, texts)), style.conditions(self.results, self.indices)]

    @property
    def flow(self) -> str:
        """Direction of the entrainment as an arrow; "" without oil and where results have different ones."""
        pairs = zip(self.results, self.indices, strict=True)
        signs = {np.sign(sum(style.speeds_at(result, index))) for result, index in pairs}
        if len(signs) > 1 or not any(result.case.fluid for result in self.results):
            return ""
        return {1.0: "flow →", -1.0: "← flow"}.get(signs.pop(), "")

    @property
    def along(self) -> str:
        """Label of the abscissa of maps, with the direction of the flow."""
        return ", ".join(filter(None, (style.ACROSS, self.flow)))

    def draw(self, figure: Figure | None = None) -> Figure:
        """Draw pressure and film, or another field, into an empty figure or a new one."""
        figure = figure or Figure(layout="constrained")
        self.module.draw_frame(figure, self)
        style.set_title(figure, *self.title)
        return figure


def draw_instant(results: list[Result], options: argparse.Namespace) -> Figure:
    """Draw results at the instant of the options."""
    return Choice.of(results, options).draw()


def path_length(result: Result) -> np.ndarray:
    """Length of the path of the faster surface at the end of each step [m], shape (nsteps,).

    It increases where speeds reverse, unlike the displacement.
    """
    if "displacement_1" in result.scalars:
        moved = [np.diff(result.steps(f"displacement_{side}"), prepend=0.0) for side in "12"]
        return np.cumsum(np.abs(moved), axis=1).max(axis=0)
    return max(abs(result.attrs["u1"]), abs(result.attrs["u2"])) * result.steps("time")


def travel_of(result: Result) -> np.ndarray:
    """Path of the faster surface at the stored frames [half-widths], shape (nt,)."""
    return np.interp(result.time, result.steps("time"), path_length(result)) / result.attrs["a"]


def choose_frames(results: list[Result], step: int | None = None, time: float | None = None) -> list[int]:
    """Stored frame of every result nearest to a step or time [s] of the first; both None: `frame_to_show`.

    Results with different speeds are compared at equal travel of the faster surface, at which asperities are
    in the same position.
    """
    first = results[0]
    if step is None and time is None:
        frame = frame_to_show(first, min(travel_of(result)[-1] for result in results))
    else:
        wanted, stored = (step, first.step) if time is None else (time, first.time)
        if not stored[0] <= wanted <= stored[-1] * (1.0 + 1e-9):
            allowed = f"{stored[0]:g} to {stored[-1]:g}"
            raise OutputError(f"{first.path}: no frame at {wanted:g}; allowed: {allowed}")
        frame = first.nearest_frame(step=step, time=time)
    travel = travel_of(first)[frame]
    return [frame, *(_frame_at(result, travel, first.time[frame]) for result in results[1:])]


def _frame_at(result: Result, travel: float, time: float) -> int:
    """Frame at a travel [half-widths], of several that nearest to a time [s]."""
    last = path_length(result)[-1] / result.attrs["a"]
    if travel > last * (1.0 + 1e-9) + 1e-12:
        raise OutputError(f"{result.path}: ends at travel {last:.4g} a, before travel {travel:.4g} a")
    return int(np.argmin(np.abs(travel_of(result) - travel) + np.abs(result.time - time)))


def frame_to_show(result: Result, reached: float = np.inf) -> int:
    """Stored frame with the maximum load on the solids or, if they carry hardly any, the maximum pressure.

    Frames before both surfaces fill the contact are used only if there are no others, because the leading
    edge of a profile is not typical; frames beyond a travel of `reached` [half-widths] never.
    """
    allowed = travel_of(result) <= reached * (1.0 + 1e-9)
    if (filled := allowed & both_fill(result, result.time)).any():
        allowed = filled
    rows = np.searchsorted(result.steps("step"), result.step)
    values = result.steps("p_max")[rows]
    if "contact_share" in result.scalars:
        share = np.nan_to_num(result.steps("contact_share")[rows])
        if share[allowed].max() > MIN_LOAD_ON_SOLIDS:
            values = share * result.steps("load")[rows]
    return int(np.argmax(np.where(allowed, np.nan_to_num(values), -1.0)))


def view(results: list[Result], chosen: Sequence[float] | None = None) -> Sequence[float]:
    """Limits of x/a, by default around the contact, within the domains of all results."""
    low = max(result.x[0] / result.attrs["a"] for result in results)
    high = min(result.x[-1] / result.attrs["a"] for result in results)
    return chosen or (max(low, WINDOW[0]), min(high, WINDOW[1]))


def nodes_in_view(result: Result, window: Sequence[float]) -> int:
    """Nodes along x within limits of x/a, in a plane those across in its view if they are fewer."""
    x = result.x / result.attrs["a"]
    count = int(np.count_nonzero((x >= window[0]) & (x <= window[1])))
    if result.y is None:
        return count
    return min(count, int(np.count_nonzero(np.abs(result.y) <= style.reach_across(result, window))))


def instant(results: list[Result], indices: Sequence[int]) -> str:
    """Text with the travel of stored frames, and step and time if they are equal; "" if steady."""
    first, index = results[0], indices[0]
    if len(first.time) == 1:
        return ""
    travel = f"travel {travel_of(first)[index]:.2f} a"
    if len({float(result.time[k]) for result, k in zip(results, indices, strict=True)}) > 1:
        return travel
    return f"step {first.step[index]}, {1e6 * first.time[index]:.4g} µs, {travel}"


def save_movie(results: list[Result], options: argparse.Namespace, path: Path) -> None:
    """Write at most `MOVIE_FRAMES` frames of the first result, of others those at the same travel."""
    window, first = view(results, options.window), results[0]
    chosen = [
        Choice(results, choose_frames(results, time=first.time[k]), window, options.field)
        for k in style.spread(len(first.time), MOVIE_FRAMES)
    ]
    limits = common(frame.limits for choice in chosen for frame in choice.frames)
    figure, kind = Figure(layout="constrained"), chosen[0].module
    axes = kind.movie_panels(figure, chosen[0].frames[0], limits)
    writer = PillowWriter(fps=RATE)
    with replacing(path) as temporary, writer.saving(figure, temporary, MOVIE_DPI):
        for choice in chosen:
            for panel in axes:
                panel.clear()
            kind.fill(axes, choice, limits)
            style.set_title(figure, *choice.title)
            if choice is chosen[0]:  # one layout for all frames
                figure.draw_without_rendering()
                figure.set_layout_engine("none")
            writer.grab_frame()
