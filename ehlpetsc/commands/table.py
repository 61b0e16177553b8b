"""Friction and film over conditions, for other programs: ``ehlpetsc table CASE.toml --speed 0.5 20``.

Solves the smooth steady contact at crossings of lines over pressure, speed, slide/roll ratio and temperature,
and adds lines until points between them agree within the tolerance. Writes T.csv with units and limits of
validity, T.h5 with the errors too, T.py, a function of Python without dependencies, T.fits.csv, constants of
traction and Stribeck curves, and of lines T_masta.py, a script for the friction of gears in MASTA. Ranges
that are left out have the value of the case. Under mpirun the ranks share the points.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.environment import need_solver, other_mpi
from ehlpetsc.base.errors import UsageError
from ehlpetsc.base.units import UnitFault, converted
from ehlpetsc.base.version import __version__
from ehlpetsc.case.loading import load
from ehlpetsc.results.output_guard import atomic_write, check_derived, check_new, check_table, inputs_of

if TYPE_CHECKING:
    from ehlpetsc.analysis.tabulation import Axis, Table
    from ehlpetsc.run.conditions_table import ConditionsTable

ENDINGS = ".csv", ".h5", ".py", ".fits.csv"
MASTA = "_masta.py"  # a module that can be imported, of loads per length
TOLERANCE, MIN_TOLERANCE = 0.03, 1e-4


def main(words: Sequence[str]) -> int:
    """Run the command; returns its exit status: 0 done, 2 bad input, 3 no convergence."""
    parser = CommandParser("table", __doc__)
    parser.add_argument("case", help="case file of a smooth contact in oil")
    parser.add_argument("-o", "--output", type=Path, metavar="T.csv", help="default: CASE.table.csv")
    for name, text in (
        ("pressure", "maximum Hertz pressure"),
        ("speed", "entrainment speed"),
        ("slide-roll", "slide/roll ratio"),
        ("temperature", "of the oil, with heat of the bodies"),
    ):
        parser.add_argument(
            f"--{name}", nargs=2, metavar=("LOW", "HIGH"), help=f"{text}; in SI units or with a unit"
        )
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, help="relative error [%(default)s]")
    chosen = parser.parse_args(words)
    return exit_status("table", lambda: _run(chosen), (ImportError,))


def _run(chosen: argparse.Namespace) -> None:
    need_solver()
    from mpi4py import MPI

    from ehlpetsc.analysis.tabulation import tabulate
    from ehlpetsc.run.conditions_table import ConditionsTable
    from ehlpetsc.run.ranks import on_root

    comm = MPI.COMM_WORLD
    if fault := other_mpi(comm.size):
        raise UsageError(fault)
    case, axes = load(chosen.case, chosen.set), _axes(chosen)
    of_case = ConditionsTable(case, [axis.name for axis in axes], comm)
    target = chosen.output or Path(f"{case.path.stem}.table.csv")
    on_root(comm, _check, target, of_case, axes, chosen.overwrite)
    show = print if comm.rank == 0 else lambda text: None
    table = tabulate(axes, of_case.quantities, of_case.compute, chosen.tolerance, show)
    on_root(comm, _write, target, table, of_case)


def _axes(chosen: argparse.Namespace) -> list[Axis]:
    """Axes of the ranges that are given."""
    from ehlpetsc.analysis.tabulation import Axis
    from ehlpetsc.run.conditions_table import CONDITIONS

    axes = []
    for name, (unit, least, most) in CONDITIONS.items():
        if (given := getattr(chosen, name)) is None:
            continue
        option = f"--{name.replace('_', '-')} {' '.join(given)}"
        try:
            low, high = (_number(text, "" if unit == "1" else unit) for text in given)
        except (UnitFault, ValueError):
            raise UsageError(f"{option}: allowed: two numbers in {unit}, or with a unit") from None
        if not least <= low < high <= most:
            raise UsageError(f"{option}: allowed: two that increase, {least:g} to {most:g} {unit}")
        axes.append(Axis(name, unit, low, high))
    if not axes:
        raise UsageError("no range; allowed: one or more of --pressure, --speed, --slide-roll, --temperature")
    if not MIN_TOLERANCE <= chosen.tolerance < 1.0:
        raise UsageError(f"--tolerance {chosen.tolerance:g}: allowed: {MIN_TOLERANCE:g} to 1")
    return axes


def _number(text: str, unit: str) -> float:
    """Number in SI units of a text, with a unit or without."""
    try:
        return float(text)
    except ValueError:
        return float(str(converted(text, unit, False)))


def _check(target: Path, of_case: ConditionsTable, axes: Sequence[Axis], overwrite: bool) -> None:
    """Refuse to replace other files than those of an earlier table."""
    from ehlpetsc.analysis.table_files import columns

    check_derived(target, inputs_of(of_case.case), (".csv",))
    check_table(target, ",".join(columns(axes, of_case.quantities, of_case.units)), overwrite)
    for path in _files(target, of_case)[1:]:
        check_new(path, overwrite or target.exists())


def _files(target: Path, of_case: ConditionsTable) -> list[Path]:
    """Files of a table, that of MASTA last."""
    of_lines = [] if KINDS[of_case.case.kind].is_whole else [target.with_name(target.stem + MASTA)]
    return [*map(target.with_suffix, ENDINGS), *of_lines]


def _write(target: Path, table: Table, of_case: ConditionsTable) -> None:
    """Write all files and print their names."""
    from ehlpetsc.analysis import table_files as files

    case, units, limits = of_case.case, of_case.units, of_case.limits
    attributes = {"title": case.title, "case": case.text, "version": __version__}
    speed = case.motion.entrainment_speed if case.motion else None
    atomic_write(target, files.csv_text(table, units, limits).encode())
    files.write_hdf5(target.with_suffix(".h5"), table, units, limits, attributes)
    atomic_write(target.with_suffix(".py"), files.python_text(table, case.title, __version__).encode())
    atomic_write(target.with_suffix(".fits.csv"), files.fits_text(table, speed).encode())
    written = _files(target, of_case)
    for path in written[len(ENDINGS) :]:
        script = files.masta_text(table, case.title, __version__, of_case.scales.E)
        atomic_write(path, script.encode())
    print(*written, sep="\n")
