"""Every case of cases/ in a short form, and the scalars of its result compared with stored ones.

Refresh after a change that is meant to move results, and say in the commit why they move::

    /usr/bin/python3 tests/regression/short_cases.py [CASE ...]

It prints what moved and writes expected.json: all cases, or those named.
"""

import json
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[2]), str(HERE.parents[1])]  # also when called as a command, outside pytest
from support import ROOT
from support.running import run, settings

from ehlpetsc.results.reader import read_result

EXPECTED = HERE.with_name("expected.json")

# the inlet near the contact, so that a few steps carry the roughness into it
QUICK = ("mesh.inlet=-1.4", "mesh.outlet=1.3", "mesh.points_per_half_width=50", "time.travel=0.6")
VISCOSITIES = "series.values=[0.010, 0.006]"
MESHES = "series.values=[40, 60]"
SHORT = {
    "ball": ("mesh.points_per_half_width=12", "time.travel=1.5", "surface.1.synthetic.sq=0.05e-6"),
    "cam": ("mesh.points_per_half_width=25",),
    "cmod": ("mesh.points_per_half_width=25", "time.travel=1.0"),
    "coated_ball": ("mesh.points_per_half_width=8", "time.travel=0.3", "series.values=[207e9, 150e9]"),
    "compliant_mixed": (*QUICK, "fluid.viscosity=0.001"),
    "discs": ("series.values=[0.01, 0.1]",),
    "dry_hertz": (),
    "dry_rough": ("mesh.points_per_half_width=100",),
    "fig1": (*QUICK, VISCOSITIES),
    "fig2": (*QUICK, VISCOSITIES),
    "fig3": (*QUICK, VISCOSITIES),
    "fig4": (*QUICK, VISCOSITIES),
    "fig5": QUICK,
    "fig6": (*QUICK, MESHES),
    "fig7": (*QUICK, MESHES, "output.every=10"),
    "fzg": ("mesh.points_per_half_width=25", "time.travel=1.0"),
    "fzg_relief": ("mesh.points_per_half_width=25", "time.travel=1.0"),
    "fzg_strip": ("mesh.points_per_half_width=16", "time.travel=0.5"),
    "fzg_stages": ("mesh.points_per_half_width=25", "time.travel=1.0", "series.values=[70.0, 265.1]"),
    "groove_ball": ("mesh.points_per_half_width=[8, 16]",),
    "life": ("time.travel=0.6",),
    "micropitting": ("mesh.points_per_half_width=12", "time.travel=0.5"),
    "mixed": QUICK,
    "moes": (),
    "optical": ("mesh.points_per_half_width=16",),
    "resolved_mixed": (*QUICK, "fluid.viscosity=0.001"),
    "ridge": (*QUICK, "surface.2.synthetic.position=0.0"),
    "roller": ("mesh.points_per_half_width=[10, 40]",),
    "roller_end": ("mesh.points_per_half_width=[10, 160]", "time.travel=0.2", "time.start='smooth'"),
    "tapered_roller": ("mesh.points_per_half_width=[10, 40]",),
    "running_in": (*QUICK, "time.travel=1.2", "time.passes=2", "contact.yield_pressure=1.1e9"),
    "stribeck": (
        *(*QUICK, "series.values=[5.0, 0.05]", "contact.asperity_height=10e-9"),
        *("surface.1.short_cutoff=8e-6", "surface.2.short_cutoff=8e-6"),
    ),
    "superfinished": QUICK,
    "table1_damage": QUICK,
    "table1_heat": QUICK,
    "table1_mixed": QUICK,
    "table1_rough": QUICK,
    "table1_smooth": (),
    "traction": ("mesh.points_per_half_width=50", "series.values=[0.01, 0.1]"),
    "waviness": (*QUICK[:3], "time.travel=1.0"),
    "wear_and_pits": ("time.travel=0.5",),
}

RTOL = 1e-5
"""Newton stops at a residual of 1e-7, which leaves films and pressures certain to about 1e-6 of their scale;
other processors and numbers of ranks change them by 1e-13. No short form halves a step, where a change in
the last digits may take another path."""

NEWTON_SLACK = 1.25, 3
"""Iterations may grow by a quarter and three before it counts as a loss: they are a cost and no result."""


def middle_row(frame):
    """Row along x through the middle of a frame; that of a line contact."""
    return frame if frame.ndim == 1 else frame[len(frame) // 2]


def scalars(path):
    """Figures of one result file."""
    with read_result(path) as result:
        last = len(result.time) - 1
        central = int(np.argmin(np.abs(result.x)))
        steps = {name: result.steps(name) for name in ("h_min", "p_max", "contacts", "newton", "friction")}
        return {
            "steps": len(steps["newton"]),
            "newton": int(steps["newton"].sum()),
            "contacts": int(steps["contacts"].sum()),
            "h_min": float(steps["h_min"].min()),
            "p_max": float(steps["p_max"].max()),
            "friction": float(steps["friction"][-1]),
            "approach": float(result.steps("approach")[-1]),
            "h_central": float(middle_row(result.frame("film_thickness", last))[central]),
            "p_central": float(middle_row(result.frame("pressure", last))[central]),
            "retries": int(result.steps("retries").sum()),
            "load_error": float(result.steps("load_error").max()),
        }


def results(name, folder):
    """Run a case in its short form; scalars by result file, several for a series.

    Raises
    ------
    RuntimeError
        It did not run to its end.
    """
    done = run(ROOT / "cases" / f"{name}.toml", *settings(*SHORT[name]), cwd=folder)
    if done.returncode != 0:
        raise RuntimeError(f"{name}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    files = [path for path in sorted(Path(folder).rglob("*.h5")) if not path.name.endswith(".restart.h5")]
    return {path.stem: scalars(path) for path in files}


def refresh(names):
    """Run the cases named, all where none is, and store their scalars."""
    before = json.loads(EXPECTED.read_text()) if EXPECTED.exists() else {}
    now = {name: before[name] for name in SHORT if names and name in before and name not in names}
    for name in names or SHORT:
        with tempfile.TemporaryDirectory() as folder:
            now[name] = results(name, folder)
        for file, figures in now[name].items():
            old = before.get(name, {}).get(file, {})
            moved = [f"{k} {old.get(k)} -> {v}" for k, v in figures.items() if old.get(k) != v]
            print(f"{file}: {'; '.join(moved) or 'as before'}", flush=True)
    EXPECTED.write_text(json.dumps({name: now[name] for name in SHORT}, indent=1) + "\n")


if __name__ == "__main__":
    sys.exit(refresh(sys.argv[1:]))
