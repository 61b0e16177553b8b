"""The figures of all steps put together to those of a run, and of several runs, as their table says."""

from ehlpetsc.quantities import REDUCTIONS, STEP_SCALARS

REDUCED = {name: figure for name, figure in STEP_SCALARS.items() if figure.over_run}


class Totals:
    """Figures of a run.

    Parameters
    ----------
    values : dict of str to number, optional
        Of the steps so far, keys of `REDUCED`.
    """

    def __init__(self, values=()):
        self.values = dict(values)

    @classmethod
    def of_result(cls, result):
        """Those of a stored run.

        Parameters
        ----------
        result : ehlpetsc.results.reader.Result
        """
        names = [name for name in REDUCED if name in result.figures]
        steps = {name: result.steps(name).tolist() for name in names}
        return cls({n: REDUCTIONS[REDUCED[n].over_run](v) for n, v in steps.items() if v})

    @classmethod
    def of_series(cls, runs):
        """Those of several runs.

        Parameters
        ----------
        runs : iterable of Totals
        """
        known = [run.values for run in runs]
        names = [name for name in REDUCED if any(name in values for values in known)]
        of_all = {name: [values[name] for values in known if name in values] for name in names}
        return cls(
            {n: REDUCTIONS[REDUCED[n].over_series or REDUCED[n].over_run](v) for n, v in of_all.items()}
        )

    def add(self, figures):
        """Take those of the next step.

        Parameters
        ----------
        figures : dict of str to number
        """
        for name in REDUCED.keys() & figures.keys():
            one, other = self.values.get(name, figures[name]), figures[name]
            both = [one, other] if name in self.values else [other]
            self.values[name] = REDUCTIONS[REDUCED[name].over_run](both)

    def __str__(self):
        """Those of the summary, ``name=value``; 0 for what every run has where no step was taken."""
        shown = [
            (figure.label or name, self.values.get(name, 0), figure.summary)
            for name, figure in REDUCED.items()
            if figure.summary and (name in self.values or not figure.only)
        ]
        return " ".join(f"{label}={value:{form}}" for label, value, form in shown)
