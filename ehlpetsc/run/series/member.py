"""One member of a series: its name, its files, what they hold already."""

import re

from ehlpetsc.errors import OutputError
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.restart_file import load_restart
from ehlpetsc.results.totals import Totals
from ehlpetsc.run.forecast import dowson_higginson, steps


class Member:
    """One member: its value, case and files.

    Attributes
    ----------
    name : str
        As in ``viscosity=0.002``.
    output, restart : Path
    """

    def __init__(self, number, key, value, case, output):
        word = key.rpartition(".")[2]
        shown = str(value)
        if isinstance(value, dict | list) or len(shown) > 40:
            shown = str(number + 1)
        self.value, self.case, self.name = value, case, f"{word}={shown}"
        plain = re.sub(r"[^A-Za-z0-9.+-]", "_", shown)
        self.output = output.with_name(f"{output.stem}_{word}_{plain}.h5")
        self.restart = self.output.with_suffix(".restart.h5")

    def state_of_files(self):
        """What its files hold of the same case: "done", "begun" (a restart file) or "waiting".

        What is damaged is computed again: a result anywhere, a restart file by its checksum.
        """
        try:
            if self.output.exists():
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

    def is_foreign(self):
        """Whether in the place of its result there is that of another case."""
        try:
            with read_result(self.output) as result:
                return result.attrs["case"] != self.case.text
        except (OutputError, KeyError):
            return False  # none, or a damaged one: it is computed again

    def weight(self):
        """For dealing the longest first: nodes times steps; of equals, the thinner film."""
        scales = Scales.of(self.case)
        film = dowson_higginson(scales, self.case.fluid.pressure_viscosity) if self.case.fluid else 0.0
        return scales.nx * (steps(scales) if self.case.time else 1), -film

    def totals(self):
        """Figures of its run, from the result file; none without one."""
        try:
            with read_result(self.output) as result:
                return Totals.of_result(result)
        except OutputError:
            return Totals()
