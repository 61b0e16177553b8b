"""Advice after a failed write: how to continue the run."""

from ehlpetsc.errors import OutputError
from ehlpetsc.results.restart_file import load_restart


def resume_advice(restart, case, step):
    """Advice on continuing once the cause is removed.

    Parameters
    ----------
    restart : Path
        Restart file of the run; it may be missing or belong to another case.
    case : case.loading.Case
    step : int or None
        Last complete step in the result file; None: there is none.

    Returns
    -------
    str
        The end of a sentence.
    """
    try:
        attributes = load_restart(restart)[1]
        if step is not None and attributes["case"] == case.text and attributes["step"] <= step:
            return f"once this is mended, continue with --restart {restart} (step {attributes['step']})"
    except (OutputError, KeyError):
        pass  # no restart file, a damaged one, or a file of another program
    again = "repeat it with --overwrite" if restart.exists() else "the same command begins at time 0"
    return f"there is no restart file of it: once this is mended, {again}"
