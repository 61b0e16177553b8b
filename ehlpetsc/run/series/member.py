"""One member of a series: its name, its files, what they hold already."""

import re

from ehlpetsc.errors import OutputError
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.restart_file import load_restart
from ehlpetsc.results.totals import Totals
from ehlpetsc.run.preview.forecast import steps

MAX_NAME_LENGTH = 60  # characters of a name


def named(settings):
    """Names of the members of a series: of its keys, the values in which members differ.

    Values that are tables are told by what differs in them; where that makes no name, or one too long, or one
    twice, by the member's number.

    Parameters
    ----------
    settings : list of list of (list of str, value)
        Of each member, see `ehlpetsc.case.combinations.settings_of`.

    Returns
    -------
    list of str
        As ``viscosity=0.002`` or ``viscosity=0.002,entrainment_speed=5.0``.
    """
    flat = [dict(part for keys, value in one for part in _parts(keys, value)) for one in settings]
    every = dict.fromkeys(key for one in flat for key in one)
    differing = [key for key in every if any(one.get(key) != flat[0].get(key) for one in flat)] or list(every)
    last = settings[0][0][0][-1] if len(settings[0]) == 1 else "member"
    names = []
    for number, one in enumerate(flat, 1):
        told = {key[-1]: one[key] for key in differing if key in one}
        text = ",".join(f"{word}={value}" for word, value in told.items())
        usable = told and len(text) <= MAX_NAME_LENGTH and not any(isinstance(v, list) for v in told.values())
        names.append(text if usable else f"{last}={number}")
    if len(set(names)) < len(names):
        names = [f"{last}={number}" for number in range(1, len(names) + 1)]
    return names


def _parts(keys, value):
    """Entries of a value: one, or those of a table."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _parts([*keys, name], inner)
    else:
        yield tuple(keys), value


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
        """What its files hold of the same case: "done", "begun" (a restart file) or "waiting".

        What is damaged is computed again: a result anywhere, a restart file by its checksum.
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
        """Whether in the place of its result there is that of another case."""
        try:
            with read_result(self.output) as result:
                return result.attrs["case"] != self.case.text
        except (OutputError, KeyError):
            return False  # none, or a damaged one: it is computed again

    def weight(self):
        """For beginning with the longest: nodes times steps; of equals, the thinner film."""
        scales = Scales.of(self.case)
        film = smooth_films(self.case.fluid, scales.E, scales.conditions)[1] if self.case.fluid else 0.0
        return scales.nx * (steps(scales) if self.case.time else 1), -film

    def totals(self):
        """Figures of its run, from the result file; none without one."""
        try:
            with read_result(self.output) as result:
                return Totals.of_result(result)
        except OutputError:
            return Totals()
