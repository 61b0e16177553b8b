r"""Limit of a quantity on infinitely fine meshes, from its values on three, with the order and an error bar.

An error :math:`C n^{-p}` of n nodes leaves three values the limit, C and p:

.. math:: \frac{f_1-f_2}{f_2-f_3}=\frac{n_1^{-p}-n_2^{-p}}{n_2^{-p}-n_3^{-p}},\qquad
   f=f_3+\frac{f_3-f_1}{(n_3/n_1)^p-1}.

The limit is that of the observed order, between `LEAST_ORDER` and `HIGHEST_ORDER`, that of the scheme.
Where solids touch in spots of one or two nodes, friction, the load on the solids and damage show orders
of 0.8 to 1 on coarse meshes and 1.5 to 2 on fine ones: their limit is that of at least `SPOT_ORDER`.
The bar reaches to the limits of orders `SPREAD` lower and higher, or to that of a higher observed one; that
of damage, which follows few large cycles, also to the value on the finest mesh.
On three meshes and factors of safety: Roache, J. Fluids Eng. 116 (1994) 405.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ehlpetsc.analysis.summary import EXTREMES, run_scalars
from ehlpetsc.base.quantities import MEANS
from ehlpetsc.results.index import groups
from ehlpetsc.results.post_result import PostResult, damage_beside
from ehlpetsc.results.reader import Result

MESH_KEY = "points_per_half_width"
MESHES = 3
LEAST_ORDER, HIGHEST_ORDER = 1.0, 2.0  # of the extrapolation
SPOT_ORDER = 1.5  # at least, of `OF_SPOTS` where the solids carry more than `MIN_SHARE` of the load
DAMAGE = "damage"  # first word of its names
OF_SPOTS = "friction_coefficient", "contact_share", DAMAGE
MIN_SHARE = 1e-4
SPREAD = 0.4  # of the order, for the bar
OBSERVED = 0.5, 4.0  # orders beyond are none
NOT_MONOTONE, NO_ORDER = "not monotone: no order", "order below 0.5 or above 4: none"
SINGLE_NODE = "of single nodes: no order"
EQUAL = "equal"
RELATIVE_ROUNDING = 1e-6  # of values that are equal


class Limit(NamedTuple):
    """Limit of a quantity.

    `order`: observed one; nan: none. `value`: extrapolated, without an order that on the finest mesh.
    `bar`: of its error; without an order the range of the values. `remark`: why there is no order.
    """

    order: float
    value: float
    bar: float
    remark: str = ""

    @property
    def is_extrapolated(self) -> bool:
        """Whether the value is an extrapolated one."""
        return not self.remark


def observed_order(nodes: Sequence[float], values: Sequence[float]) -> float:
    """Order p of values on three meshes, by bisection; nan of values that are not monotone or of no p > 0."""
    first, second = values[0] - values[1], values[1] - values[2]
    if first * second <= 0.0:
        return np.nan
    inverse = np.log(nodes[1] / np.asarray(nodes, float))

    def excess(p: float) -> float:
        powers = np.exp(p * inverse)
        return (powers[0] - powers[1]) / (powers[1] - powers[2]) - first / second

    low, high = 1e-3, 20.0
    if excess(low) > 0.0 or excess(high) < 0.0:
        return np.nan
    while high - low > 1e-10:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    return 0.5 * (low + high)


def extrapolated(nodes: Sequence[float], values: Sequence[float], order: float) -> float:
    """Limit of an order by the values on the coarsest and the finest mesh."""
    return values[-1] + (values[-1] - values[0]) / ((nodes[-1] / nodes[0]) ** order - 1.0)


def limit(nodes: Sequence[float], values: Sequence[float], least: float = LEAST_ORDER) -> Limit:
    """Limit of values on three meshes, the coarsest first.

    `nodes`: along a length. `least`: lowest order of the extrapolation.
    """
    spread = float(np.ptp(values))
    if spread <= RELATIVE_ROUNDING * max(map(abs, values)):
        return Limit(np.nan, values[-1], spread, EQUAL)
    observed = observed_order(nodes, values)
    if not OBSERVED[0] <= observed <= OBSERVED[1]:
        is_monotone = (values[0] - values[1]) * (values[1] - values[2]) > 0.0
        return Limit(np.nan, values[-1], spread, NO_ORDER if is_monotone else NOT_MONOTONE)
    used = min(max(observed, least), HIGHEST_ORDER)
    orders = used, used - SPREAD, max(used + SPREAD, observed)
    value, *others = (extrapolated(nodes, values, p) for p in orders)
    return Limit(observed, value, max(abs(other - value) for other in others))


class Convergence(NamedTuple):
    """Quantities of a case on three meshes.

    `name`: values in which it differs from others of a series, "" of one case.
    `points`: per half-width along. `seconds`: of the time steps of each run, on one core.
    `values`: on the meshes, by quantity. `limits`: by quantity.
    """

    name: str
    points: list[int]
    seconds: list[float]
    values: dict[str, list[float]]
    limits: dict[str, Limit]


def convergence(results: Sequence[Result]) -> list[Convergence]:
    """Convergence of each case from its results on three meshes; cases without all of them are left out."""
    found = groups(list(results), MESH_KEY)
    return [_of_case(name, members) for name, members in found.items() if len(members) == MESHES]


def _of_case(name: str, results: list[Result]) -> Convergence:
    results = sorted(results, key=lambda result: result.case.mesh.points_per_half_width)
    points = [result.case.mesh.points_per_half_width for result in results]
    runs = [_quantities(result) for result in results]
    common = [key for key in runs[0] if all(key in run for run in runs)]
    values = {key: [run[key] for run in runs] for key in common}
    of_spots = SPOT_ORDER if max(values.get("contact_share", [0.0])) > MIN_SHARE else LEAST_ORDER
    limits = {key: limit_of(key, points, row, of_spots) for key, row in values.items()}
    return Convergence(name, points, [float(r.steps("wall").sum()) for r in results], values, limits)


def limit_of(name: str, points: Sequence[float], values: Sequence[float], of_spots: float) -> Limit:
    """Limit of a quantity; that of an extreme has no order, as it is that of a single node.

    `of_spots`: lowest order of friction, load on the solids and damage.
    """
    if name in EXTREMES:
        return Limit(np.nan, values[-1], float(np.ptp(values)), SINGLE_NODE)
    found = limit(points, values, of_spots if name.startswith(OF_SPOTS) else LEAST_ORDER)
    if name.startswith(DAMAGE):
        found = found._replace(bar=max(found.bar, abs(found.value - values[-1])))
    return found


def _quantities(result: Result) -> dict[str, float]:
    """Means of a run, its smallest film, largest pressure and mean damage of its surfaces, by name."""
    scalars = run_scalars(result)
    found = {name: scalars[name] for name in (*MEANS, "h_min", "p_max") if name in scalars}
    post = damage_beside(result)
    return found | _damage(post) if post else found


def _damage(post: PostResult) -> dict[str, float]:
    return {
        f"damage_{surface} z/a={depth:g}": float(row.mean())
        for surface in post.surfaces
        for depth, row in zip(post.z, post.passed(surface), strict=True)
        if row.size
    }


def columns(points: Sequence[int]) -> list[str]:
    """Names of the columns of :func:`rows`."""
    return ["case", "quantity", *(f"on {n}" for n in points), "order", "extrapolated", "bar", "remark"]


def rows(cases: Sequence[Convergence]) -> list[list[str]]:
    """A row for each quantity of each case; SI units."""
    return [
        [
            case.name,
            name,
            *(f"{value:.6g}" for value in values),
            "" if np.isnan(found.order) else f"{found.order:.2f}",
            f"{found.value:.6g}",
            f"{found.bar:.2g}",
            found.remark,
        ]
        for case in cases
        for name, values, found in _joined(case.values, case.limits)
    ]


def _joined(
    values: Mapping[str, list[float]], limits: Mapping[str, Limit]
) -> list[tuple[str, list[float], Limit]]:
    return [(name, row, limits[name]) for name, row in values.items()]
