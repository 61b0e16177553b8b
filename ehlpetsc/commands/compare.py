"""Compare two result files field by field: ``ehlpetsc compare A.h5 B.h5 [--rtol R]``.

If meshes or stored times differ, the nodes and times that both have are compared, and no numbers of nodes. A
quantity is equal if its maximum difference is within ``rtol scale``, where the scale is the maximum magnitude
in either file. Scalars of the solution process (iterations, time steps, wall clock) are not compared.

Exit status: 0 equal, 1 different, 2 the files cannot be compared.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from ehlpetsc.analysis.compare import common, common_nodes, compare, table
from ehlpetsc.base.command_line import CommandParser, exit_status, number
from ehlpetsc.results.reader import read_result

RTOL = 1e-6  # default of --rtol


def main(words: Sequence[str]) -> int:
    """Run the command; returns its exit status."""
    parser = CommandParser("compare", __doc__, "")
    parser.add_argument("one", metavar="A.h5")
    parser.add_argument("other", metavar="B.h5")
    parser.add_argument(
        "--rtol", type=number(0.0, 1.0), default=RTOL, help="tolerance over the scale [%(default)s]"
    )
    options = parser.parse_args(words)
    return exit_status("compare", lambda: _compare_files(options))


def _compare_files(options: argparse.Namespace) -> int:
    with read_result(options.one) as one, read_result(options.other) as other:
        differences = list(compare(one, other))
        faults = [
            f"{name} is stored in one file alone" for name in sorted(set(one.fields) ^ set(other.fields))
        ]
        if one.attrs["status"] != other.attrs["status"]:
            faults.append(f"one run is {one.attrs['status']}, the other {other.attrs['status']}")
        print(f"{one.path}: {one!r}", f"{other.path}: {other!r}", sep="\n")
        nodes, frames = len(common_nodes(one, other)[0]), len(common(one.time, other.time, "")[0])
        print(f"compared: {nodes} nodes and {frames} frames that both have")
        print(table(differences, float(one.attrs["a"]), options.rtol))
    faults += [d.name for d in differences if not d.same(options.rtol)]
    print(f"different: {'; '.join(faults)}" if faults else "same", f"(rtol {options.rtol:g})")
    return 1 if faults else 0
