"""Totals of the scalars of all steps of a run, and of several runs."""

import numpy as np

from ehlpetsc.quantities import MEANS, REDUCTIONS, STEP_SCALARS
from ehlpetsc.results.filling import both_fill

OF_ALL = ("sum", "min", "max")  # reductions that are meaningful over several runs
REDUCED = {name: figure for name, figure in STEP_SCALARS.items() if figure.over_run}


class Totals:
    """Totals of a run.

    Parameters
    ----------
    values : dict of str to number, optional
        Of the steps so far, keys of `REDUCED`.
    means : dict of str to float, optional
        Over the time in which both surfaces fill the contact, keys of `ehlpetsc.quantities.MEANS`.
    """

    def __init__(self, values=(), means=()):
        self.values, self.means = dict(values), dict(means)

    @classmethod
    def of_result(cls, result):
        """Totals of a stored run.

        Parameters
        ----------
        result : ehlpetsc.results.reader.Result
        """
        names = [name for name in REDUCED if name in result.scalars]
        steps = {name: result.steps(name).tolist() for name in names}
        return cls({n: REDUCTIONS[REDUCED[n].over_run](v) for n, v in steps.items() if v}, means(result))

    @classmethod
    def of_series(cls, runs):
        """Sums and extremes of several runs.

        Parameters
        ----------
        runs : iterable of Totals
        """
        known = [run.values for run in runs]
        named = {name: figure.over_series or figure.over_run for name, figure in REDUCED.items()}
        names = [n for n, how in named.items() if how in OF_ALL and any(n in values for values in known)]
        of_all = {name: [values[name] for values in known if name in values] for name in names}
        return cls({name: REDUCTIONS[named[name]](values) for name, values in of_all.items()})

    def add(self, scalars):
        """Add the scalars of the next step.

        Parameters
        ----------
        scalars : dict of str to number
        """
        for name in REDUCED.keys() & scalars.keys():
            one, other = self.values.get(name, scalars[name]), scalars[name]
            both = [one, other] if name in self.values else [other]
            self.values[name] = REDUCTIONS[REDUCED[name].over_run](both)

    def __str__(self):
        """``name=value`` of the summary, the means at its end; 0 where no step was taken."""
        shown = [
            (figure.label or name, self.values.get(name, 0), figure.summary)
            for name, figure in REDUCED.items()
            if figure.summary and (name in self.values or not figure.only)
            if not (name in MEANS and figure.over_run == "last")
        ]
        shown += [(name, value, ".4g") for name, value in self.means.items()]
        return " ".join(f"{label}={value:{form}}" for label, value, form in shown)


def _sliding_reverses(result):
    """Whether the sliding speed changes sign during the run: means of friction are then of its magnitude."""
    if "speed_1" not in result.scalars:
        return False
    sliding = result.steps("speed_1") - result.steps("speed_2")
    return bool((sliding > 0.0).any() and (sliding < 0.0).any())


def means(result):
    """Means over the time in which both surfaces fill the contact, by name; a steady run has its values.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result

    Returns
    -------
    dict of str to float
        Empty where the run ends before.
    """
    time, dt = result.steps("time"), np.nan_to_num(result.steps("dt"))
    weights = np.ones(1) if len(time) == 1 else np.where(both_fill(result, time), dt, 0.0)
    found = {}
    for name in MEANS if weights.any() else ():
        values = result.steps(name).astype(float) if name in result.scalars else np.full(len(time), np.nan)
        if name == "friction_coefficient" and _sliding_reverses(result):
            values = np.abs(values)
        known = np.isfinite(values)
        if weights[known].any():
            found[name] = float(np.average(values[known], weights=weights[known]))
    return found
