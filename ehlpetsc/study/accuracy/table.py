r"""Error over run time: one setting of a case varied at a time, compared with a finer reference.

The reference has half the smallest spacing, half the smallest Courant number and the tightest tolerances of
all runs. Its error is estimated by Richardson extrapolation from two runs with 2 and 4 times its spacing
and time step: :math:`e=|f_1-f_2|/(2^p-1)`, p the observed order of the three, limited to 0.5 to 2.
"""

from pathlib import Path

from ehlpetsc.case.loading import load
from ehlpetsc.errors import ExitStatus, NotConverged
from ehlpetsc.study.accuracy.errors import MEASURES, NO_MEASURES, errors, measures, uncertainty
from ehlpetsc.study.runs import csv_table, run
from ehlpetsc.study.setting import ATOL, MESH, NEAR, RANKS, RTOL, STEP, stored

NAMES = {
    MESH: "mesh",
    STEP: "time step",
    NEAR: "near field",
    ATOL: "Newton tolerance",
    RTOL: "Krylov tolerance",
    RANKS: "ranks",
}
COLUMNS = ("varied", "value", "converged", "wall_s", "newton", "steps", *MEASURES)


class Study:
    """Runs of one case and their table.

    Parameters
    ----------
    path : path-like
        Case file.
    overrides : sequence of str
        Common overrides of all runs.
    folder : path-like
        Folder of the result files.
    limit : float
        Wall clock time of one run [s].
    damage : bool
    """

    def __init__(self, path, overrides, folder, limit, damage=False):
        self.path, self.overrides, self.folder = path, list(overrides), Path(folder)
        self.limit, self.damage = limit, damage
        self.case = load(path, overrides)
        self._outcomes = {}

    def run(self, setting, number):
        """Outcome and measures of one run, None if it did not converge; equal runs are run once."""
        key = tuple(setting.values.items())
        if key in self._outcomes:
            return self._outcomes[key]
        shear = ("shear_stress_1", "shear_stress_2") if self.damage else ()
        output = stored(("pressure", "film_thickness", *shear), 1 if self.damage else self._steps(setting))
        outcome = run(
            self.path,
            [*self.overrides, *setting.overrides(), *output],
            options=setting.options(),
            ranks=setting.ranks,
            folder=self.folder,
            name=f"run{number}",
            limit=self.limit,
        )
        measured = measures(outcome.result, self.damage) if outcome.status == ExitStatus.DONE else None
        self._outcomes[key] = outcome, measured
        return outcome, measured

    def _steps(self, setting):
        """Steps of the whole run, so that its last state is a frame."""
        if not self.case.time:
            return 1
        return max(round(self.case.time.travel * setting.values[MESH] / setting.values[STEP]), 1)

    def table(self, references, runs, csv_path, say=print):
        """Run all; return rows with the keys `COLUMNS`, first the reference with its estimated error."""
        finest = [self.run(setting, -number) for number, setting in enumerate(references, 1)]
        if finest[0][1] is None:
            raise NotConverged(f"the reference: {finest[0][0].message}")
        true = finest[0][1]
        rows = [row(references[0], finest[0][0], uncertainty(*(f for _, f in finest)))]
        say(text(dict(zip(COLUMNS, COLUMNS, strict=True))))
        say(text(rows[0]))
        for number, setting in enumerate(runs):
            outcome, measured = self.run(setting, number)
            rows.append(row(setting, outcome, errors(measured, true) if measured else NO_MEASURES))
            say(text(rows[-1]))
        with csv_table(csv_path, COLUMNS) as append:
            for entries in rows:
                append(entries)
        return rows


def row(setting, outcome, measured):
    """One row of the table."""
    return {
        "varied": NAMES.get(setting.varied, setting.varied),
        "value": setting.label,
        "converged": "yes" if outcome.status == ExitStatus.DONE else f"exit {outcome.status}",
        "wall_s": outcome.wall,
        "newton": outcome.newton,
        "steps": outcome.steps,
        **measured,
    }


def text(row):
    """Row as printed text."""

    def shown(value):
        return f"{value:.2e}" if isinstance(value, float) else str(value)

    widths = (17, 9, 9, 9, 7, 6, *[9] * len(MEASURES))
    return " ".join(f"{shown(row[name]):>{width}}" for name, width in zip(COLUMNS, widths, strict=True))
