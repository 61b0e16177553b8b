"""The table of extremes: each line run by itself, told in a line, and in a CSV file."""

import csv
import tempfile
from dataclasses import replace
from pathlib import Path

from ehlpetsc.errors import ExitStatus
from ehlpetsc.study.lines import cases
from ehlpetsc.study.reasons import why
from ehlpetsc.study.runs import run

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
COARSE = ("mesh.points_per_half_width=50",)
BRIEF = ("time.travel=1.0",)  # from an inlet at -1.5: the roughness is just in the contact
SWIFT = ("time.courant=1.0",)  # of lines without a time step of their own, and of runs before: fewer steps


def lines(short=False, far=False, model=None):
    """Lines of the table; the short form coarser and with fewer steps.

    Parameters
    ----------
    short : bool
    far : bool
        Instead of those at the edge of the ranges forty far beyond it.
    model : str, optional
        Contact model of all lines that do not choose their own: "direct", "mixed" or "compliant".
    """
    whole = cases("far") if far else cases("steady", "time")
    if short:
        whole = [_shortened(line) for line in whole if line.short]
    return [_of_model(line, model) for line in whole] if model else whole


def _of_model(line, model):
    chosen = (f"contact.model={LAWS.get(model, model)}",)
    chosen += (LAYER,) if model == "compliant" else ()
    own = any(override.startswith("contact.model") for override in line.overrides)
    before = line.before and (*chosen, *line.before)
    return line if own else replace(line, overrides=(*chosen, *line.overrides), before=before)


def _shortened(line):
    keys = {override.partition("=")[0] for override in line.overrides}
    brief = BRIEF if "time.travel" in keys else ()
    brief += SWIFT if brief and "time.courant" not in keys else ()
    coarse = () if "mesh.points_per_half_width" in keys else COARSE
    before = line.before and (*line.before, *coarse, *SWIFT)  # the mesh of both runs is one
    return replace(line, overrides=(*line.overrides, *coarse, *brief), before=before)


def table(path, short=False, limit=300.0, say=print, *, far=False, model=None):
    """Run the table.

    Parameters
    ----------
    path : path-like
        The CSV file.
    short, far, model
        As of `lines`.
    limit : float
        Wall clock time of a line [s].
    say : callable
        Takes each line as text as it is done.

    Returns
    -------
    list of dict
        A row a line, by the names of `COLUMNS`.
    """
    rows = []
    say(_text(dict(zip(COLUMNS, COLUMNS, strict=True))))
    with tempfile.TemporaryDirectory() as folder, open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for line in lines(short, far, model):
            rows.append(row(line, Path(folder), limit))
            writer.writerow(rows[-1])
            file.flush()
            say(_text(rows[-1]))
    done = sum(r["converged"] == "yes" for r in rows)
    say(f"{done} of {len(rows)} lines converged ({100 * done / len(rows):.0f} %)")
    return rows


def row(line, folder, limit):
    """Figures of one line."""
    case = folder / "case.toml"
    case.write_text(line.text)
    options = ()
    if line.before:
        first = run(case, line.before, folder=folder, name="before", limit=limit)
        if first.status != ExitStatus.DONE:
            return _row(line, first, f"the run before: {first.words}")
        options = ("-ehl_restart", str(folder / "before.restart.h5"))
    outcome = run(case, line.overrides, options=options, folder=folder, limit=limit)
    return _row(
        line, outcome, "" if outcome.status == ExitStatus.DONE else why(outcome, case, line.overrides)
    )


def _row(line, o, reason):
    return {
        "axis": line.axis,
        "value": line.value,
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
