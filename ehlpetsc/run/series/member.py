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

MAX_NAME_LENGTH = 60  # characters


def named(settings):
    """Names of the members of a series, from the values in which members differ.

    A table among the values is named by the entries that differ. Members have numbers if the names are empty,
    too long or not unique.

    Parameters
    ----------
    settings : list of list of (list of str, value)
        Settings of each member, see `ehlpetsc.case.combinations.settings_of`.

    Returns
    -------
    list of str
        For example ``viscosity=0.002`` or ``viscosity=0.002,entrainment_speed=5.0``.
    """
    flat = [flat_keys({".".join(keys): value for keys, value in member}) for member in settings]
    keys = dict.fromkeys(key for member in flat for key in member)
    differing = [key for key in keys if any(member.get(key) != flat[0].get(key) for member in flat)] or list(
        keys
    )
    label = settings[0][0][0][-1] if len(settings[0]) == 1 else "member"
    names = []
    for number, member in enumerate(flat, 1):
        values = {key.rpartition(".")[2]: member[key] for key in differing if key in member}
        text = ",".join(f"{key}={value}" for key, value in values.items())
        has_list = any(isinstance(value, list) for value in values.values())
        usable = values and len(text) <= MAX_NAME_LENGTH and not has_list
        names.append(text if usable else f"{label}={number}")
    if len(set(names)) < len(names):
        names = [f"{label}={number}" for number in range(1, len(names) + 1)]
    return names


class Member:
    """Member of a series: its value, case and files.

    Attributes
    ----------
    name : str
        For example ``viscosity=0.002``.
    output, restart : Path
    """

    def __init__(self, name, value, case, output):
        self.value, self.case, self.name = value, case, name
        suffix = re.sub(r"[^A-Za-z0-9.+-]", "_", name)
        self.output = output.with_name(f"{output.stem}_{suffix}.h5")
        self.restart = self.output.with_suffix(".restart.h5")

    def state_of_files(self):
        """State of the files: "done", "begun" (with a restart file) or "waiting".

        Files of another case, damaged results and restart files with a wrong checksum count as "waiting".
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
        """Whether the result file belongs to another case."""
        try:
            with read_result(self.output) as result:
                return result.attrs["case"] != self.case.text
        except (OutputError, KeyError):
            return False  # no file, or a damaged one, which is computed again

    def weight(self):
        """Sort key that puts the longest members first: nodes times steps, then the thinner film."""
        scales = Scales.of(self.case)
        film = smooth_films(self.case.fluid, scales.E, scales.conditions)[1] if self.case.fluid else 0.0
        return scales.nx * (steps(scales) if self.case.time else 1), -film

    def totals(self):
        """Totals of the run from the result file; empty without a file."""
        try:
            with read_result(self.output) as result:
                return Totals.of_result(result)
        except OutputError:
            return Totals()
