"""A smooth ball beside slippy, another open program: processor time and error of the film on one mesh.

``python3 tests/benchmarks/peer.py --peer PEER/bin/python [--meshes 65 129]``: the ball of slippy's own
example of smooth films (radius 19.05 mm, 800 N, 4 m/s), by both programs on the same nodes. Each is a process
of its own; processor time is that of the solution, without imports and what this program compiles once.
Errors are of the film in the middle, over the limit of this program's on 129 and 257 nodes a side, of second
order. Without `--peer`, or where slippy is not in its environment, the row says so.

slippy 0.5.2 asks for a Python below 3.11. On 3.11 it runs in an environment made by::

    python3 -m venv PEER
    PEER/bin/pip install --no-deps slippy
    PEER/bin/pip install 'numpy<1.26' 'scipy<1.12' numba matplotlib tinydb scikit-image sympy pyfftw
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import time
from pathlib import Path

R, LOAD, SPEED, E, NU = 0.01905, 800.0, 4.0, 200e9, 0.3
ETA0, P_R, Z = 0.096, 1.0 / 5.1e-9, 0.68  # of Roelands' law
MESHES_OF_LIMIT = 129, 257
PEER = f"""
import contextlib, io, json, sys, time, warnings
warnings.simplefilter("ignore")
import numpy as np
np.bool, np.int, np.float = bool, int, float  # names that NumPy has given up
import slippy
slippy.CUDA = False
import slippy.contact as c, slippy.surface as s
n, begun = int(sys.argv[1]), time.process_time()
hertz = c.hertz_full([{R}] * 2, [float("inf")] * 2, [{E}] * 2, [{NU}] * 2, {LOAD})
p0, a = hertz["max_pressure"], hertz["contact_radii"][0]
ball = s.RoundSurface(({R},) * 3, shape=(n, n), extent=(4 * a, 4 * a), generate=True)
flat, steel = s.FlatSurface(), c.Elastic("steel", dict(E={E}, v={NU}))
ball.material = flat.material = steel
oil = c.Lubricant("oil")
oil.add_sub_model("nd_viscosity", c.lubricant_models.nd_roelands({ETA0}, {P_R}, p0, {Z}))
oil.add_sub_model("nd_density", c.lubricant_models.nd_dowson_higginson(p0))
model = c.ContactModel("ball", ball, flat, oil)
reynolds = c.UnifiedReynoldsSolver(time_step=0, grid_spacing=ball.grid_spacing, hertzian_pressure=p0,
    radius_in_rolling_direction={R}, hertzian_half_width=a, dimentional_viscosity={ETA0},
    dimentional_density=872)
x, y = (values + shift for values, shift in zip(ball.get_points_from_extent(), ball._total_shift))
guess = [hertz["total_deflection"], hertz["pressure_f"](x, y)]
model.add_step(c.IterSemiSystem("main", reynolds, {SPEED}, 1, no_time=True, normal_load={LOAD},
    initial_guess=guess, relaxation_factor=0.05, max_it_interference=3000))
with contextlib.redirect_stdout(io.StringIO()):
    state = model.solve()
found = dict(film=float(state["gap"][n // 2, n // 2]), seconds=time.process_time() - begun)
print(json.dumps(found | dict(converged=bool(state["converged"]))))
"""


def tables(side: int) -> dict:
    """Case of the ball on `side` x `side` nodes from -2 to 2 half-widths."""
    return {
        "title": "Ball of slippy's example",
        "contact": {"radius": [R, R], "load": LOAD, "youngs_modulus": [E, E], "poisson_ratio": [NU, NU]}
        | {"model": "mixed", "boundary_film": 1e-9},
        "fluid": {"viscosity": ETA0, "law": "roelands", "roelands_pressure": P_R, "roelands_z": Z}
        | {"pressure_viscosity": Z * (math.log(ETA0) + 9.67) / P_R}
        | {"density": "dowson-higginson", "gamma": 1.34 / 5.9e8, "lambda": 1.0 / 5.9e8},
        "motion": {"entrainment_speed": SPEED, "slide_roll_ratio": 0.0},
        "mesh": {"inlet": -2.0, "outlet": 2.0, "width": 4.0, "points_per_half_width": (side - 1) // 4},
    }


def inside(side: int) -> None:
    """Solve the ball twice, the first time to compile, and print film and processor time."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    from ehlpetsc.base import environment

    environment.need_solver()
    import ehlpetsc

    ehlpetsc.Simulation(tables(33)).advance()
    begun = time.process_time()
    film = ehlpetsc.Simulation(tables(side)).advance().film_thickness
    found = {"film": float(film[side // 2, side // 2]), "seconds": time.process_time() - begun}
    print(json.dumps(found | {"converged": True}))


def solved(command: list[str]) -> dict | str:
    """Figures that a process prints, or the last line of its error."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        return done.stderr.strip().rpartition("\n")[2]
    return json.loads(done.stdout.splitlines()[-1])


def row(name: str, side: int, found: dict | str, limit: float) -> str:
    """Row of the table."""
    if isinstance(found, str):
        return f"| {name} | {side} | {found} | |"
    error = f"{100.0 * (found['film'] / limit - 1.0):+.2g}" if found["converged"] else "not converged"
    return f"| {name} | {side} | {found['seconds']:.2g} | {error} |"


def main() -> None:
    """Run the command."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("--peer", help="Python of an environment with slippy")
    parser.add_argument("--meshes", type=int, nargs="+", default=[65, 129], help="nodes a side, 4 k + 1")
    parser.add_argument("--inside", type=int, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.inside:
        return inside(chosen.inside)
    ours = {
        side: solved([sys.executable, __file__, "--inside", str(side)])
        for side in {*chosen.meshes, *MESHES_OF_LIMIT}
    }
    coarse, fine = (ours[side] for side in MESHES_OF_LIMIT)
    if isinstance(coarse, str) or isinstance(fine, str):
        raise SystemExit(f"no limit of the film: {coarse}, {fine}")
    limit = fine["film"] + (fine["film"] - coarse["film"]) / 3.0
    print(
        "| program | nodes a side | processor time, s | error of the central film, % |",
        "|---" * 4 + "|",
        sep="\n",
    )
    for side in chosen.meshes:
        print(row("ehlpetsc", side, ours[side], limit))
        peer = "no --peer given"
        found: dict | str = solved([chosen.peer, "-c", PEER, str(side)]) if chosen.peer else peer
        print(row("slippy", side, found, limit), flush=True)


if __name__ == "__main__":
    main()
