"""Member of a series: its name, its files and their state."""

import re

from ehlpetsc.errors import OutputError
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.restart_file import load_restart
from ehlpetsc.results.series_index import flat_keys
from ehlpetsc.results.totals import Totals
from ehlpetsc.run.preview.forecast import steps

MAX_NAME_LENGTH = 60  # characters of a name


def named(settings):
    """Names of the members of a series: of its keys, the values in which members differ.

    A table among the values is named by the entries that differ; where that makes no name, one too long or
    one twice, the member has its number.

    Parameters
    ----------
    settings : list of list of (list of str, value)
        Of each member, see `ehlpetsc.case.combinations.settings_of`.

    Returns
    -------
    list of str
        As ``viscosity=0.002`` or ``viscosity=0.002,entrainment_speed=5.0``.
    """
    flat = [flat_keys({".".join(keys): value for keys, value in one}) for one in settings]
    every = dict.fromkeys(key for one in flat for key in one)
    differing = [key for key in every if any(one.get(key) != flat[0].get(key) for one in flat)] or list(every)
    last = settings[0][0][0][-1] if len(settings[0]) == 1 else "member"
    names = []
    for number, one in enumerate(flat, 1):
        shown = {key.rpartition(".")[2]: one[key] for key in differing if key in one}
        text = ",".join(f"{word}={value}" for word, value in shown.items())
        usable = (
            shown and len(text) <= MAX_NAME_LENGTH and not any(isinstance(v, list) for v in shown.values())
        )
        names.append(text if usable else f"{last}={number}")
    if len(set(names)) < len(names):
        names = [f"{last}={number}" for number in range(1, len(names) + 1)]
    return names


class Member:
    """One member: its value, case and files.

    Attributes
    ----------
    name : str
        As in ``viscosity=0.002``.
    output, restart : Path
    """

    def __init__(self, name, value, case, output):
        self.value, self.case, self.name = value, case, name
        plain = re.sub(r"[^A-Za-z0-9.+-]", "_", name)
        self.output = output.with_name(f"{output.stem}_{plain}.h5")
        self.restart = self.output.with_suffix(".restart.h5")

    def state_of_files(self):
        """State of its files, of the same case: "done", "begun" (a restart file) or "waiting".

        Damaged files are computed again: a result damaged anywhere, a restart file with a wrong checksum.
        """
        try:
            with read_result(self.output) as result:
                if result.attrs["case"] != self.case.text:
                    return "waiting"
                result.check()
                if result.attrs["status"] == "done":
                    return "done"
            if load_restart(self.restart)[1]["case"] == self.case.text:
                return "begun"
        except (OutputError, KeyError):
            pass
        return "waiting"

    def is_of_another_case(self):
        """Whether its result file is that of another case."""
        try:
            with read_result(self.output) as result:
                return result.attrs["case"] != self.case.text
        except (OutputError, KeyError):
            return False  # none, or a damaged one: it is computed again

    def weight(self):
        """Sort key that puts the longest members first: nodes times steps, then the thinner film."""
        scales = Scales.of(self.case)
        film = smooth_films(self.case.fluid, scales.E, scales.conditions)[1] if self.case.fluid else 0.0
        return scales.nx * (steps(scales) if self.case.time else 1), -film

    def totals(self):
        """Totals of its run, from the result file; none without one."""
        try:
            with read_result(self.output) as result:
                return Totals.of_result(result)
        except OutputError:
            return Totals()
