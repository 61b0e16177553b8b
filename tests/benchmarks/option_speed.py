"""PETSc options on the measured contact: ``python3 tests/benchmarks/option_speed.py [--ranks N]``.

Steps of cases/table1_rough.toml with both surfaces rough in half of the contact, all from a restart file,
each with one option changed (on more ranks: a preconditioner): wall time over that of the defaults, runs
in turns, medians; Newton iterations, halved steps, maximum change of pressure in p0.
"""

import argparse
import statistics
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[2]), str(HERE.parents[1])]
from support import ROOT
from support.running import run, settings

from ehlpetsc.results.reader import read_result

BEGIN = 2.5  # half-widths travelled before
NEAR = "--set mesh.near_field=8"  # what is best without the far field in the preconditioner
LU, PARTS = "-pc_type lu", "-pc_type bjacobi -sub_pc_type"
ONE_RANK = [
    "",
    *(f"-snes_atol {size}" for size in ("1e-3", "1e-7", "1e-10")),
    "-ksp_rtol 1e-2",
    "-ksp_rtol 1e-8",
]
ONE_RANK += [f"{LU} {NEAR}", LU, f"{LU} --set mesh.near_field=20", f"-pc_type ilu -pc_factor_levels 1 {NEAR}"]
ONE_RANK += [f"{LU} -pc_factor_mat_solver_type mumps {NEAR}", "-ksp_type gmres", "-ksp_type bcgs"]
ONE_RANK += ["-snes_linesearch_type bt", "-snes_linesearch_type l2"]
MORE_RANKS = ["", f"{PARTS} lu {NEAR}", f"-pc_type asm -pc_asm_overlap 8 -sub_pc_type lu {NEAR}"]
MORE_RANKS += [f"{LU} -pc_factor_mat_solver_type {name} {NEAR}" for name in ("mumps", "superlu_dist")]
MORE_RANKS += [f"{PARTS} ilu -sub_pc_factor_levels 1 {NEAR}"]


def start(case, folder):
    """Run to travel BEGIN; the name of the restart file."""
    sets = settings(f"time.travel={BEGIN}", "output.checkpoint=1e-5", "output.every=100000")
    done = run(*case, *sets, "--output", "begin.h5", cwd=folder)
    assert done.returncode == 0, done.stderr
    return "begin.restart.h5"


def advance(case, options, ranks, folder, restart):
    """Seconds, Newton iterations, halved steps, contact node-steps and last pressures; None if it failed."""
    words = [*case, "--restart", restart, "--output", "run.h5", *options.split()]
    done = run(*words, cwd=folder, ranks=ranks if ranks > 1 else 0)
    if done.returncode:
        return None
    with read_result(folder / "run.h5") as result:
        wall, newton, retries, touching = (result.steps(k) for k in ("wall", "newton", "retries", "contacts"))
        pressure = result.frame("pressure", len(result.time) - 1) / result.attrs["p0"]
        return wall.sum(), int(newton.sum()), int(retries.sum()), int(touching.sum()), pressure


def main(ranks, points, steps, repeats):
    recipes = ONE_RANK if ranks == 1 else MORE_RANKS
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        mesh = f"mesh.points_per_half_width={points}"
        case = [ROOT / "cases" / "table1_rough.toml", *settings(mesh)]
        restart = start(case, folder)
        case += settings(f"time.travel={BEGIN + 0.5 * steps / points}", f"output.every={steps}")
        found = {recipe: [] for recipe in recipes}
        for _ in range(repeats):
            for recipe in recipes:
                if not found[recipe] or found[recipe][-1] is not None:
                    found[recipe].append(advance(case, recipe, ranks, folder, restart))
    base = statistics.median(out[0] for out in found[""])
    *_, touching, pressure = found[""][0]
    print(
        f"a/{points}, {ranks} rank(s), {steps} steps with {touching} contact node-steps, defaults "
        f"{1e3 * base / steps:.1f} ms a step\n  time  newton  halved  change/p0  options"
    )
    for recipe, outs in found.items():
        if outs[-1] is None:
            print(f"     -       -       -          -  {recipe}: did not converge")
            continue
        seconds, (_, newton, retries, _, other) = statistics.median(out[0] for out in outs), outs[0]
        change = np.abs(other - pressure).max()
        print(f"{seconds / base:6.2f}{newton:8d}{retries:8d}{change:11.1e}  {recipe or 'defaults'}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--points", type=int, default=200, help="per half-width (default: 200)")
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--repeats", type=int, default=3)
    main(**vars(parser.parse_args()))
