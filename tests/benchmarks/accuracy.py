"""Error over processor time: ``python3 tests/benchmarks/accuracy.py CASE.toml [--set TABLE.KEY=VALUE ...]``.

One setting of the case is varied at a time: mesh, time step, near field, tolerances of Newton's method and of
the Krylov solver. Errors are relative to a reference with half the smallest spacing and Courant number
and tighter tolerances. The error of the reference is estimated by Richardson extrapolation from two
runs with 2 and 4 times its spacing and time step, e = |f1 - f2|/(2^p - 1), p the observed order of the three,
within 0.5 to 2. Writes CASE.accuracy.csv and CASE.accuracy.png.
"""

from __future__ import annotations

import argparse
import csv
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import numpy as np
from matplotlib.ticker import LogLocator, NullLocator

import ehlpetsc
from ehlpetsc.case.loading import load
from ehlpetsc.pictures import style
from ehlpetsc.results.post_result import PostResult, post_path
from ehlpetsc.run import simulation
from ehlpetsc.stepping import observables

for module in (simulation, observables):  # `wall` of the steps becomes processor time
    module.clock = SimpleNamespace(monotonic=time.process_time)

MESH, STEP, NEAR = "mesh.points_per_half_width", "time.courant", "mesh.near_field"
NEWTON, KRYLOV = "snes_atol", "ksp_rtol"
NAMES = {MESH: "mesh", STEP: "time step", NEAR: "near field"}
NAMES |= {NEWTON: "Newton tolerance", KRYLOV: "Krylov tolerance"}
TOLERANCES = {NEWTON: (1e-2, 1e-3, 1e-4, 1e-5, 1e-7), KRYLOV: (1e-1, 1e-2, 1e-4, 1e-6, 1e-8)}
REFERENCE_TOLERANCES = {NEWTON: 1e-9, KRYLOV: 1e-10}
MEASURES = {
    "h_min": "minimum film",
    "h_c": "central film",
    "p_max": "maximum pressure",
    "film": "local film, maximum norm",
    "contact": "length in contact",
    "damage": "damage, decades",
}
COLUMNS = ("varied", "value", "cpu_s", "newton", "steps", *MEASURES)
ORDERS = (0.5, 2.0)  # limits of the observed order


def run(case: Path, overrides: list[str], values: dict[str, float], damage: bool, folder: Path) -> dict:
    """Run a case with these values of keys and, without a dot in the name, of PETSc options.

    Cost, x/a and film of the last frame [m], minimum and central film [m], maximum pressure [Pa], mean
    contact length [a], log10 of the maximum damage on surface 2.
    """
    keys = [f"{key}={value}" for key, value in values.items() if "." in key]
    options = {name: value for name, value in values.items() if "." not in name}
    fields = ("pressure", "film_thickness", *(("shear_stress_1", "shear_stress_2") if damage else ()))
    whole = load(case, overrides).time
    every = max(round(whole.travel * values[MESH] / values[STEP]), 1) if whole and not damage else 1
    stored = [f"output.every={every}", f"output.fields={list(fields)}".replace("'", '"')]
    output, given = folder / "run.h5", load(case, [*overrides, *keys, *stored])
    result = ehlpetsc.solve(given, output, options, overwrite=True, progress=False)
    steps, x = result.steps, result.x / result.attrs["a"]
    h, dt = result.frame("film_thickness", -1), steps("dt")
    return {
        "cpu_s": float(steps("wall").sum()),
        "newton": int(steps("newton").sum()),
        "steps": len(dt) - 1,
        "x": x,
        "h": h,
        "h_min": steps("h_min").min(),
        "h_c": h[np.argmin(np.abs(x))],
        "p_max": steps("p_max").max(),
        "contact": (steps("contacts") * dt).sum() / dt.sum() * (x[1] - x[0]) if dt.sum() else 0.0,
        "damage": _damage(output) if damage else np.nan,
    }


def _damage(path: Path) -> float:
    """log10 of the maximum damage on surface 2."""
    words = [sys.executable, "-m", "ehlpetsc", "post", path, "--surface", "2", "--overwrite"]
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, cwd=ROOT)
    return float(np.log10(PostResult(post_path(path)).passed("2").max()))


def errors(found: dict, true: dict) -> dict[str, float]:
    """Relative errors by measure; film: local maximum over h_c, damage: difference in decades."""
    inside = np.abs(found["x"]) <= 1.0
    local = np.abs(found["h"] - np.interp(found["x"], true["x"], true["h"]))[inside].max() / true["h_c"]
    relative = {
        name: abs(found[name] / true[name] - 1.0) if true[name] else np.nan
        for name in ("h_min", "h_c", "p_max", "contact")
    }
    return {**relative, "film": local, "damage": abs(found["damage"] - true["damage"])}


def uncertainty(fine: dict, middle: dict, coarse: dict) -> dict[str, float]:
    """Estimated error of the finest of three runs, by measure."""
    first, second = errors(middle, fine), errors(coarse, fine)
    estimates = {}
    for name in MEASURES:
        change, coarser = first[name], second[name] - first[name]  # |f1 - f2|, |f2 - f3|
        order = np.log2(coarser / change) if min(change, coarser) > 0.0 else ORDERS[0]
        estimates[name] = change / (2.0 ** np.clip(order, *ORDERS) - 1.0)
    return estimates


def table(
    case: Path, overrides: list[str], meshes: list[int], courant: list[float], damage: bool
) -> list[dict]:
    """Rows by column: the reference with its estimated error, the case as it is, then each varied setting."""
    settings = load(case, overrides)
    base = {MESH: settings.mesh.points_per_half_width, NEAR: settings.mesh.near_field}
    varied = {MESH: meshes, NEAR: (5, 10, 20, 40), **TOLERANCES}
    finest = REFERENCE_TOLERANCES
    if settings.time:
        base[STEP], varied[STEP], finest = settings.time.courant, courant, finest | {STEP: 0.5 * min(courant)}
    print("".join(f"{name:>17}" for name in COLUMNS))
    rows = []

    def add(varied: str, value: object, found: dict) -> None:
        row = dict.fromkeys(COLUMNS, np.nan) | {"varied": varied, "value": value} | found
        rows.append(row)
        cells = (f"{row[name]:.3g}" if isinstance(row[name], float) else row[name] for name in COLUMNS)
        print("".join(f"{cell:>17}" for cell in cells), flush=True)

    with tempfile.TemporaryDirectory() as folder:

        def measured(values: dict[str, float]) -> dict:
            return run(case, overrides, base | values, damage, Path(folder))

        references = [measured({**finest, MESH: 2 * max(meshes) // coarser}) for coarser in (1, 2, 4)]
        add("reference", "", references[0] | uncertainty(*references))
        runs = [("", "as it is", {})]
        runs += [
            (NAMES[key], value, {key: value})
            for key, values in varied.items()
            for value in sorted({*values, base[key]} if key in base else values)
        ]
        for name, value, changed in runs:
            try:
                found = measured(changed)
                add(name, value, found | errors(found, references[0]))
            except ehlpetsc.NotConverged:
                add(name, value, {"steps": "not converged"})
    return rows


def draw(rows: list[dict], path: Path, title: str) -> None:
    """Picture of the errors over processor time and over Newton iterations, a column for each measure."""
    reference, base, *others = rows
    shown = [name for name in MEASURES if any(row[name] > 0.0 for row in rows[1:])]
    figure, axes = style.new_figure(2, len(shown), (2.8 * len(shown), 6.0), sharey="col", squeeze=False)
    costs = {"cpu_s": "processor time [s]", "newton": "Newton iterations"}
    for column, name in zip(axes.T, shown, strict=True):
        for panel, (cost, label) in zip(column, costs.items(), strict=True):
            for marker, varied in zip("osD^v", dict.fromkeys(row["varied"] for row in others), strict=False):
                chosen = [row for row in others if row["varied"] == varied and np.isfinite(row[cost])]
                values = [(row[cost], max(row[name], 1e-8)) for row in chosen]
                panel.loglog(*np.transpose(values), marker=marker, ms=4, lw=0.8, label=varied)
            panel.loglog(base[cost], max(base[name], 1e-8), "k*", ms=11, label="the case as it is")
            panel.axhline(reference[name], color="0.5", ls="--", lw=0.8, label="uncertainty of the reference")
            panel.set_xlabel(label)
            panel.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            panel.xaxis.set_major_formatter("{x:g}")
            panel.xaxis.set_minor_locator(NullLocator())
            panel.grid(True, lw=0.3)
        column[0].set_title(MEASURES[name], fontsize="medium")
    for panel in axes[:, 0]:
        panel.set_ylabel("relative error")
    style.set_title(figure, title)
    figure.get_layout_engine().set(rect=(0.0, 0.1, 1.0, 0.9))
    handles, names = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, names, loc="lower center", ncols=4, frameon=False, fontsize="small")
    style.save(figure, path)


def main() -> None:
    """Run the command."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    add = parser.add_argument
    add("case", type=Path)
    add("--set", action="append", default=[], metavar="TABLE.KEY=VALUE", help="for all runs")
    add("--meshes", type=int, nargs="+", default=[50, 100, 200, 400], help="points per half-width")
    add("--courant", type=float, nargs="+", default=[0.5, 1.0, 2.0, 4.0])
    add("--damage", action="store_true", help="damage of surface 2, which must pass the whole mesh")
    chosen = parser.parse_args()
    rows = table(chosen.case, chosen.set, chosen.meshes, chosen.courant, chosen.damage)
    with open(f"{chosen.case.stem}.accuracy.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, Path(f"{chosen.case.stem}.accuracy.png"), load(chosen.case).title)
    print(f"{chosen.case.stem}.accuracy.csv, {chosen.case.stem}.accuracy.png")


if __name__ == "__main__":
    main()
