"""Table of extremes: a run and a row for each case, printed and in a CSV file."""

import tempfile
from dataclasses import replace
from pathlib import Path

from ehlpetsc.errors import ExitStatus
from ehlpetsc.study.cases import read_cases
from ehlpetsc.study.diagnosis import diagnosis
from ehlpetsc.study.runs import csv_table, run

COLUMNS = (
    "axis",
    "value",
    "converged",
    "steps",
    "retries",
    "newton",
    "h_min_um",
    "p_max_GPa",
    "load_error",
    "mass_error",
    "viscosity_Pa_s",
    "seconds",
    "reason",
)
LAWS, LAYER = {"compliant": "mixed"}, "contact.asperity_height=10e-9"
COARSE_MESH = ("mesh.points_per_half_width=50",)
BRIEF = ("time.travel=1.0",)  # from an inlet at -1.5, the roughness just reaches the contact
LONG_STEPS = ("time.courant=1.0",)  # of cases without a time step, and of first runs


def cases(short=False, far=False, model=None):
    """Cases of the table; in the short form with coarser meshes and fewer steps.

    Parameters
    ----------
    short : bool
    far : bool
        Forty cases far beyond the ranges, instead of the cases at their edge.
    model : str, optional
        Contact model of all cases that do not set one: "direct", "mixed" or "compliant".
    """
    selected = read_cases("far") if far else read_cases("steady", "time")
    if short:
        selected = [_shortened(case) for case in selected if case.short]
    return [_of_model(case, model) for case in selected] if model else selected


def _of_model(case, model):
    chosen = (f"contact.model={LAWS.get(model, model)}",)
    chosen += (LAYER,) if model == "compliant" else ()
    sets_model = any(override.startswith("contact.model") for override in case.overrides)
    before = case.before and (*chosen, *case.before)
    return case if sets_model else replace(case, overrides=(*chosen, *case.overrides), before=before)


def _shortened(case):
    keys = {override.partition("=")[0] for override in case.overrides}
    brief = BRIEF if "time.travel" in keys else ()
    brief += LONG_STEPS if brief and "time.courant" not in keys else ()
    coarse = () if "mesh.points_per_half_width" in keys else COARSE_MESH
    before = case.before and (*case.before, *coarse, *LONG_STEPS)  # both runs have the same mesh
    return replace(case, overrides=(*case.overrides, *coarse, *brief), before=before)


def table(path, short=False, limit=300.0, say=print, *, far=False, model=None):
    """Run the table.

    Parameters
    ----------
    path : path-like
        CSV file.
    short, far, model
        See :func:`cases`.
    limit : float
        Wall clock time of a run [s].
    say : callable
        Prints each row at the end of its run.

    Returns
    -------
    list of dict
        Rows with the keys `COLUMNS`.
    """
    rows = []
    say(_text(dict(zip(COLUMNS, COLUMNS, strict=True))))
    with tempfile.TemporaryDirectory() as folder, csv_table(path, COLUMNS) as append:
        for case in cases(short, far, model):
            rows.append(row(case, Path(folder), limit))
            append(rows[-1])
            say(_text(rows[-1]))
    done = sum(r["converged"] == "yes" for r in rows)
    say(f"{done} of {len(rows)} cases converged ({100 * done / len(rows):.0f} %)")
    return rows


def row(case, folder, limit):
    """Row of one case."""
    path = folder / "case.toml"
    path.write_text(case.text)
    options = ()
    if case.before:
        first = run(path, case.before, folder=folder, name="before", limit=limit)
        if first.status != ExitStatus.DONE:
            return _row(case, first, f"the run before: {first.message}")
        options = ("-ehl_restart", str(folder / "before.restart.h5"))
    outcome = run(path, case.overrides, options=options, folder=folder, limit=limit)
    reason = "" if outcome.status == ExitStatus.DONE else diagnosis(outcome, path, case.overrides)
    return _row(case, outcome, reason)


def _row(case, o, reason):
    return {
        "axis": case.axis,
        "value": case.value,
        "converged": "yes" if o.status == ExitStatus.DONE else f"no, exit {o.status}",
        "steps": o.steps,
        "retries": o.retries,
        "newton": o.newton,
        "h_min_um": f"{1e6 * o.h_min:.4g}",
        "p_max_GPa": f"{1e-9 * o.p_max:.4g}",
        "load_error": f"{o.load_error:.1e}",
        "mass_error": f"{o.mass_error:.1e}",
        "viscosity_Pa_s": f"{o.viscosity:.1e}",
        "seconds": f"{o.seconds:.1f}",
        "reason": reason,
    }


WIDTHS = (13, 42, 10, 6, 7, 7, 9, 9, 10, 10, 14, 7, 0)


def _text(row):
    cells = (str(row[name]) for name in COLUMNS)
    return " ".join(
        f"{cell:<{w}}" if i < 3 else f"{cell:>{w}}"
        for i, (cell, w) in enumerate(zip(cells, WIDTHS, strict=True))
    ).rstrip()
