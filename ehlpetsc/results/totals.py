"""Totals of the scalars of all steps of a run, and of several runs."""

from ehlpetsc.quantities import MEANS, REDUCTIONS, STEP_SCALARS
from ehlpetsc.results.means import means

SERIES_REDUCTIONS = ("sum", "min", "max")  # reductions that are meaningful over several runs
REDUCED = {name: scalar for name, scalar in STEP_SCALARS.items() if scalar.over_run}


class Totals:
    """Totals of a run.

    Parameters
    ----------
    values : dict of str to number, optional
        Totals of the steps so far, keys of `REDUCED`.
    means : dict of str to float, optional
        Means over the time in which both surfaces fill the contact, keys of `ehlpetsc.quantities.MEANS`.
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
        totals = [run.values for run in runs]
        kinds = {name: scalar.over_series or scalar.over_run for name, scalar in REDUCED.items()}
        columns = {
            name: [values[name] for values in totals if name in values]
            for name, kind in kinds.items()
            if kind in SERIES_REDUCTIONS
        }
        return cls({name: REDUCTIONS[kinds[name]](values) for name, values in columns.items() if values})

    def add(self, scalars):
        """Add the scalars of the next step.

        Parameters
        ----------
        scalars : dict of str to number
        """
        for name in REDUCED.keys() & scalars.keys():
            before, value = self.values.get(name, scalars[name]), scalars[name]
            values = [before, value] if name in self.values else [value]
            self.values[name] = REDUCTIONS[REDUCED[name].over_run](values)

    def __str__(self):
        """``name=value`` of the summary, then the means; 0 before the first step."""
        entries = [
            (scalar.label or name, self.values.get(name, 0), scalar.summary)
            for name, scalar in REDUCED.items()
            if scalar.summary and (name in self.values or not scalar.only)
            if not (name in MEANS and scalar.over_run == "last")
        ]
        entries += [(name, value, ".4g") for name, value in self.means.items()]
        return " ".join(f"{label}={value:{form}}" for label, value, form in entries)
