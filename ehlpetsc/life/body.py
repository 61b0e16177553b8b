"""A body over its life: wear, pits and damage in columns of cells below its surface."""

from __future__ import annotations

from bisect import bisect_left
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ehlpetsc.life import laws
from ehlpetsc.results.post_result import is_damaged
from ehlpetsc.surfaces.filters import MIN_SPACINGS, mean_line, periodic_mean
from ehlpetsc.surfaces.motion.body_field import BodyField

if TYPE_CHECKING:
    from ehlpetsc.life.one_pass import OfBody


NO_ROWS = np.zeros(0)
MAX_EXTRAPOLATION = 2.0  # length of a jump over the previous one, up to which rates are extrapolated
MAX_FALL, MAX_RISE = 0.5, 1.0  # of a rate in such a jump, over the rate


class Rates(NamedTuple):
    """Wear, damage and worn volume of a pass at the start of a jump, and their changes per pass.

    `wear`: in m, shape (n,). `damage`: shape (cells, n). `volume`: worn off [m^2]. `slopes`: changes of the
    three per pass; by default none.
    """

    wear: np.ndarray
    damage: np.ndarray
    volume: float
    slopes: tuple = (0.0, 0.0, 0.0)

    def continued(
        self, before: tuple[np.ndarray, np.ndarray, float], passes: int, column_area: float
    ) -> Rates:
        """Rates with the slopes since a previous round.

        No rate halves or doubles within `MAX_EXTRAPOLATION` times as many passes: two rounds say too little
        of a rate that vanishes. The worn volume of the columns changes as their wear does, also where this
        limits it.

        `before`: rates of that round. `passes`: since it. `column_area`: of a column, over the width of the
        body across [m].
        """
        slopes = []
        new: Any
        beyond, beyond_before = (volume - column_area * wear.sum() for wear, _, volume in (self[:3], before))
        for new, old in zip((self.wear, self.damage, beyond), (*before[:2], beyond_before), strict=True):
            bound = np.abs(new) / (MAX_EXTRAPOLATION * passes)
            slopes.append(np.clip((new - old) / passes, -MAX_FALL * bound, MAX_RISE * bound))
        slopes[2] += column_area * slopes[0].sum()
        return self._replace(slopes=tuple(slopes))

    def after(self, passes: float) -> tuple:
        """Wear [m], damage and worn volume [m^2] of a number of passes."""
        rates: Any = zip((self.wear, self.damage, self.volume), self.slopes, strict=True)
        return tuple(laws.sum_over(passes, rate, slope) for rate, slope in rates)

    def passes_to_wear(self, depth: float | np.ndarray) -> np.ndarray:
        """Passes after which a depth of wear is reached [m], shape (n,)."""
        return laws.passes_to(depth, self.wear, self.slopes[0])

    def passes_to_damage(self, damage: float | np.ndarray) -> np.ndarray:
        """Passes after which an amount of damage is added, shape (cells, n)."""
        return laws.passes_to(damage, self.damage, self.slopes[1])


class LifeBody(NamedTuple):
    """Columns of a body and their cells.

    A line contact has one row of columns, shape (n,); a strip has rows across, (ny, n), which repeat.

    Attributes
    ----------
    s : shape (n,)
        Middles of the columns over the body's abscissa, equally spaced [m].
    y : shape (ny,)
        Middles of the rows across, equally spaced [m]; none of a line.
    edges : shape (cells + 1,)
        Depths of the edges of the cells below the surface as made [m].
    height : shape (*ny, n)
        Of the surface as made [m].
    smooth_rate : shape (cells,)
        Damage that a pass of the smooth contact adds to the cells below the surface as made.
    wear, pit : shape (*ny, n)
        Depths worn off and broken out [m].
    damage : shape (cells, *ny, n)
        Miner's sum; of cells that are gone that at their end.
    failed : shape (cells, *ny, n)
        Passes after which D reached 1; inf: it did not.
    is_pitted : shape (*ny, n)
        Columns in which failed cells have reached the surface.
    volume
        Worn off since the first pass, beyond the columns too [m^2], of a strip per metre of width.
    wear_rate, damage_rate, volume_rate
        Of a pass at the begin of the last jump: [m] and 1, shapes of wear and damage, and [m^2].
    """

    s: np.ndarray
    y: np.ndarray
    edges: np.ndarray
    height: np.ndarray
    smooth_rate: np.ndarray
    wear: np.ndarray
    pit: np.ndarray
    damage: np.ndarray
    failed: np.ndarray
    is_pitted: np.ndarray
    volume: float
    wear_rate: np.ndarray
    damage_rate: np.ndarray
    volume_rate: float

    @classmethod
    def new(
        cls,
        s: np.ndarray,
        height: np.ndarray,
        edges: np.ndarray,
        y: np.ndarray = NO_ROWS,
        smooth_rate: np.ndarray | None = None,
    ) -> LifeBody:
        """Without wear and damage; by default the smooth contact adds no damage."""
        zero, cells = np.zeros(height.shape), np.zeros((len(edges) - 1, *height.shape))
        smooth = cells.reshape(len(cells), -1)[:, 0] if smooth_rate is None else smooth_rate
        never = np.full_like(cells, np.inf)
        return cls(s, y, edges, height, smooth, zero, zero, cells, never, zero > 0.0, 0.0, zero, cells, 0.0)

    @property
    def recession(self) -> np.ndarray:
        """Depth of the present surface below that as made [m], shape of the height."""
        return self.wear + self.pit

    @property
    def profile(self) -> np.ndarray:
        """Present heights [m]."""
        return self.height - self.recession

    @property
    def ra(self) -> float:
        """Mean deviation of the present heights [m]."""
        return float(np.abs(self.profile - self.profile.mean()).mean())

    @property
    def pitted_share(self) -> float:
        """Share of the columns that are pitted."""
        return float(self.is_pitted.mean())

    def damaged_share(self, passes: float) -> float:
        """Share of the columns with a cell, gone or not, that asperities have damaged after so many passes.

        See :func:`.post_result.is_damaged`.
        """
        smooth = passes * laws.below(self.smooth_rate, self.height)
        return float(is_damaged(self.damage, smooth).any(axis=0).mean())

    @property
    def pits(self) -> int:
        """Number of pits, regions of neighbouring pitted columns."""
        return laws.regions(self.is_pitted, self.y.size > 0)[1]

    @property
    def is_there(self) -> np.ndarray:
        """Cells that are not gone, shape of the damage."""
        return laws.below(self.edges[1:], self.height) > self.recession

    @property
    def widths(self) -> tuple[float, ...]:
        """Widths of the columns across, if there are rows, and along [m]."""
        across = float(self.y[1] - self.y[0]) if self.y.size > 1 else np.inf
        return *(across,) * bool(self.y.size), float(self.s[1] - self.s[0])

    @property
    def column_area(self) -> float:
        """Area of a column, of a strip over its width [m]."""
        return self.widths[-1] / max(self.y.size, 1)

    @property
    def largest_damage(self) -> float:
        """Largest damage of the cells that have not broken out."""
        return float(np.max(self.damage, initial=0.0, where=self.is_there))

    def columns_within(self, stretch: tuple[float, float]) -> np.ndarray:
        """Columns within a stretch of the abscissa [m], with a quarter of a column either side."""
        slack = 0.25 * (self.s[1] - self.s[0])
        return (self.s >= stretch[0] - slack) & (self.s <= stretch[1] + slack)

    def gap_field(
        self,
        stretch: tuple[float, float],
        reach: tuple[float, float],
        averaged: float = np.inf,
        short_cutoff: float | None = None,
    ) -> BodyField:
        """Depth of the present surface for the solver; beyond the stretch its mean.

        The contact begins and ends on parts of the bodies that are not followed: they wear as the mean of
        the stretch, or of the part of it that is next to them, with its median depth of pits. Edges of pits
        are rounded as the profile is: sharp ones would be as sharp as the mesh.

        `stretch`: abscissas that pass the whole contact [m]. `reach`: abscissas that the mesh meets [m].
        `averaged`: length at either end of the stretch of which the mean is taken [m]; by default all of it.
        `short_cutoff`: of the filter of the profile [m].
        """
        width, met = self.s[1] - self.s[0], self.columns_within(stretch)
        pit = self.pit
        if short_cutoff and pit.any() and short_cutoff > MIN_SPACINGS * width:
            pit = np.maximum(mean_line(self.s, pit, short_cutoff, "short_cutoff"), 0.0)
            pit = np.maximum(periodic_mean(pit, short_cutoff / self.widths[0]), 0.0) if self.y.size else pit
        wear, pit = self.wear[..., met], pit[..., met]
        first, last = self.s[met][[0, -1]]
        before = max(int(np.ceil((first - reach[0]) / width)) + 1, 0)
        after = max(int(np.ceil((reach[1] - last) / width)) + 1, 0)
        count = int(min(max(averaged / width, 1.0), wear.shape[-1]))
        # a mean of pits would be a step at the ends, which no surface has
        ends = slice(count), slice(-count, None)
        beyond = [wear[..., part].mean() + np.median(pit[..., part]) for part in ends]
        rows = np.atleast_2d(wear + pit)
        padded = np.array([np.pad(row, (before, after), constant_values=beyond) for row in rows])
        depth = padded.reshape(*self.height.shape[:-1], -1)
        faces = first + width * (np.arange(depth.shape[-1] + 1) - before - 0.5)
        return BodyField.zero(width, depth.shape[:-1]).add(faces, depth)

    def faces(self) -> np.ndarray:
        """Faces of the columns [m], shape (n + 1,)."""
        width = self.s[1] - self.s[0]
        return np.append(self.s - 0.5 * width, self.s[-1] + 0.5 * width)

    def rates(self, of_pass: OfBody) -> tuple[np.ndarray, np.ndarray]:
        """Wear [m] and damage, of their shapes, that a pass adds to every column."""
        met = self.columns_within((of_pass.s[0], of_pass.s[-1]))
        before, after = (field.means(self.faces()) for field in of_pass.depth)
        wear = np.where(met, np.maximum(after - before, 0.0), 0.0) + np.zeros(self.height.shape)
        at = np.where(met, self.s, np.nan)
        rows = of_pass.damage.reshape(-1, of_pass.damage.shape[-1])
        columns = np.array([np.interp(at, of_pass.s, row) for row in rows])
        columns = np.where(met, columns, 0.0).reshape(*of_pass.damage.shape[:-1], -1)
        # the surface recedes within the jump: by less than the wear allowed, and cells are at its begin
        depths = laws.cell_depths(self.edges, self.recession)
        return wear, laws.damage_at(of_pass.depths, columns, depths)

    def passes_to(self, rates: Rates, wear: float, damage: float) -> float:
        """Passes after which a column has worn by a depth [m], or an intact cell has got so much damage."""
        intact = self.is_there & (self.damage < 1.0)
        reached = rates.passes_to_damage(damage)
        return min(rates.passes_to_wear(wear).min(), np.min(reached, initial=np.inf, where=intact))

    def passes_to_break_out(self, rates: Rates, max_passes: int, rule: str) -> int:
        """Passes after which the first cells break out, `max_passes` where none do before.

        `rule`: as of :func:`.laws.broken_out`.
        """

        def breaks(passes: float) -> bool:
            wear, added, _ = rates.after(passes)
            recession, damage = self.recession + wear, self.damage + added
            return bool((laws.broken_out(damage, self.edges, recession, rule) > recession).any())

        if not breaks(max_passes):
            return max_passes
        levels = laws.below(np.array([1.0, laws.WEAKENED_DAMAGE]), self.damage) - self.damage
        reached = rates.passes_to_damage(np.maximum(levels, 0.0))
        uncovered = rates.passes_to_wear(
            np.maximum(laws.below(self.edges[1:], self.height) - self.recession, 0.0)
        )
        times = np.floor(np.append(reached, uncovered)) + 1.0
        times = np.unique(np.append(times[times < max_passes], max_passes))
        return int(times[bisect_left(times, True, hi=len(times) - 1, key=breaks)])

    def after(self, rates: Rates, passes: int, done: int, rule: str) -> LifeBody:
        """The body after a jump.

        `passes`, `done`: passes of the jump, and before it. `rule`: as of :func:`.laws.broken_out`; "none":
        columns with failed cells are counted, and remain.
        """
        wear, added, volume = rates.after(passes)
        fails = (self.damage < 1.0) & (self.damage + added >= 1.0)
        failed = np.where(fails, done + rates.passes_to_damage(1.0 - self.damage), np.inf)
        body = self._replace(
            wear=self.wear + wear,
            damage=self.damage + added,
            failed=np.minimum(self.failed, failed),
            volume=self.volume + volume,
            wear_rate=rates.wear,
            damage_rate=rates.damage,
            volume_rate=rates.volume,
        )
        recession, breaks = body.recession, rule != "none"
        bottom = laws.broken_out(body.damage, body.edges, recession, rule if breaks else "above")
        if breaks:
            bottom = laws.with_walls(bottom, recession, self.widths)
        is_new = bottom > recession
        pit = bottom - body.wear if breaks else body.pit
        return body._replace(is_pitted=body.is_pitted | is_new, pit=np.where(is_new, pit, body.pit))
