"""Point contacts at the edge of the ranges: ``python3 tests/benchmarks/extremes_plane.py [--only K]``.

A Latin hypercube: Hertz pressure 0.1 to 3 GPa, U 1e-13 to 1e-9, L to 25, Eyring stress 1 to 30 MPa, ratio of
the radii 1/8 to 8, roughness 0 to 1 um, slide/roll ratio 0 to 2. Steel in mixed contact with a compliant
layer. Each case is a steady start, a ramp of the roughness over a half-width and the travel that follows.
Inlet, sides and outlet lie where the gap is some films wide, so that they flood the contact, and some rms
heights, so that no asperity touches there.

One row each: Newton iterations of the start, those a step, halved steps, central film, share of the solids,
maximum pressure over that of Hertz, or the reason why there is no solution.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
from ehlpetsc.base import environment

environment.need_solver()
import petsc4py

petsc4py.init(sys.argv[:1])
from scipy.optimize import brentq
from scipy.stats import qmc

from ehlpetsc.base.errors import NotConverged
from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.contact.hertz import hertz_ellipse
from ehlpetsc.physics.film_formulas import expected_film, points_for_opening
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation

MODULUS, RADIUS, VISCOSITY = 2.2e11, 0.0125, 0.04  # E' [Pa], R along x [m], eta0 [Pa s]
MAX_COEFFICIENT = 40e-9  # pressure-viscosity coefficient [1/Pa], which limits L at low speed
FLOODED = 20.0  # gap at the inlet in central films
BESIDE, BEHIND = 10.0, 4.0  # the same at the sides and the outlet
ABOVE = 5.0  # the same in rms heights
MAX_DISTANCE = 24.0  # half-widths: a film beyond is far thicker than the deformation, and the mesh starves it
NODES = 128  # along and across, about, of a large domain
MAX_OPENING = 2.5  # films by which the gap opens from one node to the next beside the contact

COLUMNS = ("case", "p0, GPa", "U", "M", "L", "Eyring, MPa", "Ry/Rx", "rms, um", "xi", "nodes", "outcome", "s")


@dataclass(frozen=True)
class Extreme:
    """Point of the hypercube: p0 [Pa], U, L, Eyring stress [Pa], Ry/Rx, rms height [m], slide/roll ratio."""

    p0: float
    U: float
    L: float
    stress: float
    ratio: float
    sq: float
    xi: float

    @classmethod
    def of(cls, point: list[float]) -> Extreme:
        """Case of a point of the unit cube."""
        p0, U = 0.1e9 * 30.0 ** point[0], 1e-13 * 1e4 ** point[1]
        L = 1.0 + (min(25.0, MAX_COEFFICIENT * MODULUS * (2.0 * U) ** 0.25) - 1.0) * point[2]
        return cls(
            p0, U, L, 1e6 * 30.0 ** point[3], 8.0 ** (2.0 * point[4] - 1.0), 1e-6 * point[5], 2.0 * point[6]
        )

    def load(self) -> float:
        """Load [N] of the Hertz pressure."""

        def excess(logarithm: float) -> float:
            return hertz_ellipse(math.exp(logarithm), RADIUS, RADIUS * self.ratio, MODULUS).p0 - self.p0

        return math.exp(brentq(excess, -25.0, 25.0))

    def case(self, points: int, travel: float) -> Case:
        """Case on a mesh of `points` nodes a half-width.

        More under a thin film, fewer where the domain is large.
        """
        tables = {
            "title": "extreme",
            "contact": {
                "radius": [RADIUS, RADIUS * self.ratio],
                "load": self.load(),
                "youngs_modulus": 0.91 * MODULUS,
                "poisson_ratio": 0.3,
                "model": "mixed",
                "asperity_height": 20e-9,
                "adsorbed_film": 1e-9,
                "boundary_friction": 0.1,
            },
            "fluid": {
                "viscosity": VISCOSITY,
                "law": "roelands",
                "roelands_z": 0.68,
                "pressure_viscosity": self.L / (MODULUS * (2.0 * self.U) ** 0.25),
                "density": "dowson-higginson",
                "eyring_stress": self.stress,
            },
            "motion": {
                "entrainment_speed": self.U * MODULUS * RADIUS / VISCOSITY,
                "slide_roll_ratio": self.xi,
            },
            "mesh": {"inlet": -2.5, "outlet": 1.5, "points_per_half_width": points},
        }
        scales = Scales.of(load(tables))
        film, across = expected_film(load(tables), scales), scales.b / scales.a
        highest = ABOVE * self.sq * RADIUS / scales.a**2
        inlet, beside, outlet = (
            min(max(least, math.sqrt(1.0 + 2.0 * max(gap * film, highest))), MAX_DISTANCE)
            for least, gap in ((2.5, FLOODED), (2.0 * across / math.sqrt(self.ratio), BESIDE), (1.5, BEHIND))
        )
        side = beside * math.sqrt(self.ratio) / across
        finest = max(points, math.ceil(points_for_opening(film, MAX_OPENING)))
        points, points_across = (
            max(min(finest, math.ceil(max(NODES, 4 * finest) / length)), 4)
            for length in (inlet + outlet, 2.0 * side)
        )
        tables["mesh"] = {
            "inlet": -math.ceil(inlet * points) / points,
            "outlet": math.ceil(outlet * points) / points,
            "width": 2.0 * side,
            "points_per_half_width": [points, points_across],
        }
        if self.sq:
            waves = {"roll_off": max(scales.a, 100e-6), "short_cutoff": max(0.4 * scales.a, 25e-6)}
            surface = {"kind": "self-affine", "sq": self.sq, "hurst": 0.8, "seed": 1, **waves}
            tables |= {
                "surface": {"1": {"synthetic": surface}},
                "time": {"travel": travel, "start": "rough", "ramp": "coarse", "courant": 1.0},
            }
        return load(tables)


def drawn(count: int) -> list[Extreme]:
    """Cases of the hypercube."""
    return [Extreme.of(list(point)) for point in qmc.LatinHypercube(7, seed=1).random(count)]


def outcome(case: Case, seconds: float) -> tuple[bool, str]:
    """Whether a case converges, and its figures or the reason."""
    steps, newton, halved, end = 0, 0, 0, time.process_time() + seconds

    def watch() -> None:
        if time.process_time() > end:
            raise NotConverged(f"{steps} steps in {seconds:g} s, the limit")

    try:
        simulation = Simulation(case)
        state = simulation.advance(watch=watch)
        start = state.newton
        while not simulation.finished:
            state = simulation.advance(watch=watch)
            steps, newton, halved = steps + 1, newton + state.newton, halved + state.retries
    except NotConverged as error:
        return False, str(error)
    share, ratio = getattr(state, "contact_share", 0.0), state.p_max / simulation.scales.p0
    return True, (
        f"start {start}, {newton / max(steps, 1):.1f} a step, halved {halved}, "
        f"h_c {1e9 * state.film_central:.3g} nm, solids {share:.3f}, p_max {ratio:.2f} p0"
    )


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--points", type=int, default=16, help="nodes a half-width")
    parser.add_argument("--travel", type=float, default=0.25, help="half-widths after the start")
    parser.add_argument("--seconds", type=float, default=300.0, help="limit of the processor time of a case")
    parser.add_argument("--only", type=int, nargs="+", help="numbers of cases")
    parser.add_argument("--smooth", action="store_true", help="without roughness")
    chosen = parser.parse_args()
    done, cases = 0, drawn(chosen.count)
    numbers = chosen.only or range(len(cases))
    print(f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}")
    for k in numbers:
        extreme, begun = replace(cases[k], **({"sq": 0.0} if chosen.smooth else {})), time.process_time()
        case = extreme.case(chosen.points, chosen.travel)
        scales = Scales.of(case)
        converged, text = outcome(case, chosen.seconds)
        done += converged
        values = (1e-9 * extreme.p0, extreme.U, scales.moes_m, extreme.L, 1e-6 * extreme.stress)
        values += (extreme.ratio, 1e6 * extreme.sq, extreme.xi)
        cells = [str(k), *(f"{value:.3g}" for value in values), " x ".join(map(str, scales.grid.shape[::-1]))]
        cells += [text if converged else f"NO SOLUTION: {text}", f"{time.process_time() - begun:.1f}"]
        print(f"| {' | '.join(cells)} |", flush=True)
    print(f"{done} of {len(numbers)} cases converged")


if __name__ == "__main__":
    main()
