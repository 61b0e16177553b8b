r"""Error against run time: one setting of a case varied at a time, held against a reference finer than all.

The reference has twice the finest mesh, half the least Courant number and the tightest tolerances of those
tried. Its own error is estimated by Richardson extrapolation from two runs with 2 and 4 times its mesh and
time step: :math:`e=|f_1-f_2|/(2^p-1)`, p the order that the three show, held within 0.5 and 2.
"""

import csv
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ehlpetsc.case.loading import load
from ehlpetsc.errors import ExitStatus
from ehlpetsc.results.reader import read_result
from ehlpetsc.study.runs import run

MEASURES = ("h_min", "h_c", "p_max", "film", "contact", "damage")
MESH, STEP, NEAR = "mesh.points_per_half_width", "time.courant", "mesh.near_field"
ATOL, RTOL = "-snes_atol", "-ksp_rtol"
TOLERANCES = {ATOL: (1e-2, 1e-3, 1e-4, 1e-5, 1e-7), RTOL: (1e-1, 1e-2, 1e-4, 1e-6, 1e-8)}
TIGHT = {ATOL: 1e-9, RTOL: 1e-10}
NEAR_FIELDS = (5, 10, 20, 40)
NAMES = {
    MESH: "mesh",
    STEP: "time step",
    NEAR: "near field",
    ATOL: "Newton tolerance",
    RTOL: "Krylov tolerance",
    "ranks": "ranks",
}
HEAD = ("varied", "value", "converged", "wall_s", "newton", "steps", *MEASURES)


NOTHING = dict.fromkeys(MEASURES, np.nan)


@dataclass
class Setting:
    """One run of the study: which setting is varied, to what, and all values."""

    varied: str
    value: object
    values: dict = field(default_factory=dict)

    @property
    def ranks(self):
        return self.values["ranks"]

    def overrides(self):
        """Settings of the case file."""
        return [f"{key}={value}" for key, value in self.values.items() if "." in key]

    def options(self):
        """Options of PETSc."""
        pairs = [(key, f"{value:g}") for key, value in self.values.items() if key.startswith("-")]
        return [word for pair in pairs for word in pair]


def plan(case, meshes, steps, ranks):
    """Runs of the study: references first, then each setting varied about the case as it is.

    Parameters
    ----------
    case : case.loading.Case
    meshes : sequence of int
        Points per half width.
    steps : sequence of float
        Courant numbers; not used by a steady case.
    ranks : sequence of int

    Returns
    -------
    references : list of Setting
        Finest first.
    runs : list of Setting
    """
    base = {MESH: case.mesh.points_per_half_width, NEAR: case.mesh.near_field, "ranks": 1}
    finest = {MESH: 2 * max(meshes), **TIGHT}
    varied = [(MESH, meshes), (NEAR, NEAR_FIELDS), *TOLERANCES.items(), ("ranks", ranks)]
    if case.time:
        base[STEP], finest[STEP] = case.time.courant, 0.5 * min(steps)
        varied.insert(1, (STEP, steps))
    references = []
    for coarser in (1, 2, 4):
        values = {**base, **finest, MESH: finest[MESH] // coarser}
        if case.time:
            values[STEP] = finest[STEP]  # dt goes with dx
        references.append(Setting("reference", f"{coarser}", values))
    runs = [Setting("", "as it is", base)]
    for key, values in varied:
        known = {*values, base[key]} if key in base else values
        runs += [Setting(key, value, {**base, key: value}) for value in sorted(known)]
    return references, runs


@dataclass
class Figures:
    """What is compared of one run."""

    x: np.ndarray
    h: np.ndarray
    h_min: float
    h_c: float
    p_max: float
    contact: float
    damage: float | None = None


def figures(path, damage=False):
    """Figures of a result file: films at its last frame, extremes and contact of the whole run.

    Contact is the length of the contacts times their duration over that of the whole run [m s/s]; damage the
    greatest on the slow surface, by ``ehlpetsc.post``.
    """
    with read_result(path) as result:
        x = np.asarray(result.x) / result.attrs["a"]
        h = np.asarray(result.frame("film_thickness", -1))
        dt = np.asarray(result.steps("dt"))
        contact = (result.steps("contacts") * dt).sum() / dt.sum() if dt.sum() else 0.0
        return Figures(
            x,
            h,
            float(result.steps("h_min").min()),
            float(h[np.argmin(np.abs(x))]),
            float(result.steps("p_max").max()),
            float(contact * (x[1] - x[0])),
            _damage(path) if damage else None,
        )


def _damage(path):
    import h5py

    output = Path(path).with_suffix(".post.h5")
    subprocess.run(
        [sys.executable, "-m", "ehlpetsc.post", str(path), "-o", str(output), "--surface", "slow"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    with h5py.File(output) as file:
        return float(np.log10(np.nanmax(file["damage/slow"])))


def errors(ours, reference):
    """Relative errors; film is the greatest local one over h_c, damage the difference in decades."""
    inside = np.abs(ours.x) <= 1.0
    film = np.abs(ours.h - np.interp(ours.x, reference.x, reference.h))[inside].max() / reference.h_c
    found = {"film": film, "damage": np.nan, "contact": np.nan}
    for name in ("h_min", "h_c", "p_max", "contact"):
        true = getattr(reference, name)
        if true > 0.0:
            found[name] = abs(getattr(ours, name) / true - 1.0)
    if reference.damage is not None:
        found["damage"] = abs(ours.damage - reference.damage)
    return {name: found.get(name, np.nan) for name in MEASURES}


def uncertainty(fine, middle, coarse):
    """Estimated error of the finest of three runs, for each measure."""
    one, two = errors(middle, fine), errors(coarse, fine)
    estimate = {}
    for name in MEASURES:
        # |f1-f3|/|f1-f2| = 1 + 2^p
        growth = two[name] / one[name] - 1.0 if one[name] > 0.0 else np.inf
        order = np.clip(np.log2(growth), 0.5, 2.0) if growth > 0.0 else 0.5
        estimate[name] = one[name] / (2.0**order - 1.0)
    return estimate


class Study:
    """Runs of one case and their table.

    Parameters
    ----------
    path : path-like
        The case file.
    overrides : sequence of str
        Changes of the case that all runs share.
    folder : path-like
        Where the result files go.
    limit : float
        Wall clock time of one run [s].
    damage : bool
    """

    def __init__(self, path, overrides, folder, limit, damage=False):
        self.path, self.overrides, self.folder = path, list(overrides), Path(folder)
        self.limit, self.damage = limit, damage
        self.case = load(path, overrides)
        self._known = {}

    def run(self, setting, number):
        """Outcome and figures of one run; None where it did not converge. The same run is not run twice."""
        known = tuple(setting.values.items())
        if known in self._known:
            return self._known[known]
        fields = '["pressure", "film_thickness"]'
        if self.damage:
            fields = '["pressure", "film_thickness", "shear_stress_fast", "shear_stress_slow"]'
        overrides = [
            *self.overrides,
            *setting.overrides(),
            f"output.fields={fields}",
            f"output.every={1 if self.damage else self._steps(setting)}",
        ]
        outcome = run(
            self.path,
            overrides,
            options=setting.options(),
            ranks=setting.ranks,
            folder=self.folder,
            name=f"run{number}",
            limit=self.limit,
        )
        found = figures(outcome.result, self.damage) if outcome.status == ExitStatus.DONE else None
        self._known[known] = outcome, found
        return outcome, found

    def _steps(self, setting):
        """Of the whole run, so that its last state is a frame."""
        if not self.case.time:
            return 1
        return max(round(self.case.time.travel * setting.values[MESH] / setting.values[STEP]), 1)

    def table(self, references, runs, csv_path, say=print):
        """Run all; rows by the names of `HEAD`, the reference with its estimated error first."""
        finest = [self.run(setting, -number) for number, setting in enumerate(references, 1)]
        if finest[0][1] is None:
            raise RuntimeError(f"the reference did not converge: {finest[0][0].words}")
        true = finest[0][1]
        rows = [row(references[0], finest[0][0], uncertainty(*(f for _, f in finest)))]
        say(text(dict(zip(HEAD, HEAD, strict=True))))
        say(text(rows[0]))
        for number, setting in enumerate(runs):
            outcome, found = self.run(setting, number)
            rows.append(row(setting, outcome, errors(found, true) if found else NOTHING))
            say(text(rows[-1]))
        with open(csv_path, "w", newline="") as file:
            writer = csv.DictWriter(file, HEAD)
            writer.writeheader()
            writer.writerows(rows)
        return rows


def row(setting, outcome, measured):
    """One row of the table."""
    return {
        "varied": NAMES.get(setting.varied, setting.varied),
        "value": setting.value,
        "converged": "yes" if outcome.status == ExitStatus.DONE else f"exit {outcome.status}",
        "wall_s": outcome.wall,
        "newton": outcome.newton,
        "steps": outcome.steps,
        **measured,
    }


def text(row):
    """A row for the eye."""

    def shown(value):
        return f"{value:.2e}" if isinstance(value, float) else str(value)

    widths = (17, 9, 9, 9, 7, 6, *[9] * len(MEASURES))
    return " ".join(f"{shown(row[name]):>{width}}" for name, width in zip(HEAD, widths, strict=True))
