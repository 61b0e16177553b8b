"""Files of a table over conditions: CSV, HDF5, Python without dependencies, a script of MASTA, fits."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.analysis.tabulation import Axis, Point, Table
from ehlpetsc.analysis.traction_fits import Stribeck, Traction, fitted_stribeck, fitted_traction
from ehlpetsc.results.output_guard import replacing

FUNCTION = '''"""{title}: {names} by a table of ehlpetsc {version}.

Multilinear between the lines, in logarithms where marked; errors at points between them: {errors}.
Arguments, in this order: {arguments}. Outside the table its border counts.
"""

from math import exp, log

AXES = {axes}
LOGARITHMIC = {logarithmic}
VALUES = {values}  # logarithms of what is positive; the last axis fastest
POSITIVE = {positive}


def at(name, *conditions):
    """Value of a quantity, one of {names}."""
    place, weights = 0, [(0, 1.0)]
    for axis, is_log, x in zip(AXES, LOGARITHMIC, conditions):
        x = min(max(x, axis[0]), axis[-1])
        k = max(j for j in range(len(axis) - 1) if axis[j] <= x)
        low, high, x = (log(v) if is_log else v for v in (axis[k], axis[k + 1], x))
        share = (x - low) / (high - low)
        weights = [
            (n * len(axis) + k + step, w * part)
            for n, w in weights
            for step, part in ((0, 1.0 - share), (1, share))
        ]
    value = sum(w * VALUES[name][n] for n, w in weights if w)
    return exp(value) if POSITIVE[name] else value
'''

# what `at` needs, from the properties of a mesh in MASTA
OF_MESH = {
    "pressure": "(modulus * mesh.normal_load / mesh.contact_length / (2 * pi * radius)) ** 0.5",
    "speed": "speed",
    "slide_roll": "abs(mesh.sliding_velocity) / speed",
    "temperature": "TEMPERATURE",
}
SCRIPT = '''

# Friction in the gear meshes of MASTA, by its script for the coefficient of friction. The properties of a
# mesh are taken in SI units, the entrainment velocity as the mean of both surfaces. MASTA has not run this
# file yet.

from math import pi

from mastapy import masta_property
from mastapy.gears.materials import ScriptCoefficientOfFrictionCalculator

{constants}

@masta_property(name="Friction by ehlpetsc", description="Coefficient of friction by a table of ehlpetsc")
def friction_by_ehlpetsc(mesh: ScriptCoefficientOfFrictionCalculator) -> float:
    """Coefficient of friction by a table of ehlpetsc."""
    speed = max(abs(mesh.entrainment_velocity), 1e-9)
    radius, modulus = mesh.combined_radius_of_curvature, REDUCED_MODULUS
    return at("friction_coefficient", {arguments})
'''


def columns(axes: Sequence[Axis], names: Sequence[str], units: Sequence[str]) -> list[str]:
    """Names of the columns of the CSV file, with units."""
    conditions = [f"{axis.name} [{axis.unit}]" for axis in axes]
    return [*conditions, *(f"{name} [{unit}]" for name, unit in zip(names, units, strict=True)), "limits"]


def csv_text(table: Table, units: Sequence[str], limits: Mapping[Point, Sequence[str]]) -> str:
    """A row for each crossing; its limits of validity in the last column."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns(table.axes, table.names, units))
    for point in table.points:
        values = [f"{value:.6g}" for value in (*point, *table.found[point])]
        writer.writerow([*values, "; ".join(limits.get(point, ()))])
    return text.getvalue()


def python_text(table: Table, title: str, version: str) -> str:
    """Source text of a module with the function `at`."""
    values, positive = table.logarithms.reshape(-1, len(table.names)), table.positive
    return FUNCTION.format(
        title=title.replace('"', "'").replace("\\", "/"),
        names=", ".join(table.names),
        version=version,
        errors=", ".join(
            f"{name} {100 * e:.2g} %" for name, e in zip(table.names, table.errors, strict=True)
        ),
        arguments=", ".join(f"{axis.name} [{axis.unit}]" for axis in table.axes),
        axes=[list(line) for line in table.lines],
        logarithmic=[axis.is_logarithmic for axis in table.axes],
        values={name: [float(f"{v:.6g}") for v in values[:, k]] for k, name in enumerate(table.names)},
        positive={name: bool(flag) for name, flag in zip(table.names, positive, strict=True)},
    )


def masta_text(table: Table, title: str, version: str, modulus: float) -> str:
    r"""Source text of :func:`python_text` with a property by which MASTA asks for friction in gears.

    The pressure is that of a line, :math:`p_0=\sqrt{wE'/(2\pi R)}`.

    `modulus`: E' of the bodies of the table [Pa].
    """
    constants = f"REDUCED_MODULUS = {modulus:.6g}  # [Pa]\n"
    for axis in table.axes:
        if axis.name == "temperature":
            middle, ends = 0.5 * (axis.low + axis.high), f"{axis.low:g} to {axis.high:g}"
            constants += f"TEMPERATURE = {middle:g}  # [K], of the oil, to be entered: {ends}\n"
    arguments = ", ".join(OF_MESH[axis.name] for axis in table.axes)
    return python_text(table, title, version) + SCRIPT.format(constants=constants, arguments=arguments)


def write_hdf5(
    path: Path,
    table: Table,
    units: Sequence[str],
    limits: Mapping[Point, Sequence[str]],
    attributes: Mapping[str, str],
) -> None:
    """Lines as dimension scales, a dataset for each quantity with its unit and error, limits by point."""
    with replacing(path) as temporary, h5py.File(temporary, "w") as file:
        file.attrs.update(attributes)
        for axis, line in zip(table.axes, table.lines, strict=True):
            scale = file.create_dataset(axis.name, data=np.array(line))
            scale.make_scale(axis.name)
            scale.attrs["units"] = axis.unit
        shape = table.values.shape[:-1]
        for number, (name, unit) in enumerate(zip(table.names, units, strict=True)):
            dataset = file.create_dataset(name, data=table.values[..., number])
            dataset.attrs.update({"units": unit, "error": table.errors[number]})
        texts = ["; ".join(limits.get(point, ())) for point in table.points]
        file.create_dataset("limits", data=np.array(texts, object).reshape(shape), dtype=h5py.string_dtype())
        for name in (*table.names, "limits"):
            for number, axis in enumerate(table.axes):
                file[name].dims[number].attach_scale(file[axis.name])


def fits(table: Table, speed: float | None) -> list[tuple[dict[str, float], Traction | Stribeck]]:
    """Fits of friction over slide/roll ratio and over speed, at each crossing of the other axes.

    `speed`: entrainment speed [m/s], where it is no axis.
    """
    names = [axis.name for axis in table.axes]
    friction = table.values[..., list(table.names).index("friction_coefficient")]
    found: list[tuple[dict[str, float], Traction | Stribeck]] = []
    for number, name in enumerate(names):
        if name not in ("slide_roll", "speed") or len(table.lines[number]) < 3:
            continue
        others = [line for n, line in enumerate(table.lines) if n != number]
        along = np.moveaxis(friction, number, -1).reshape(-1, friction.shape[number])
        line = np.array(table.lines[number])
        for values, curve in zip(product(*others), along, strict=True):
            at = dict(zip((n for n in names if n != name), values, strict=True))
            if name == "speed" and "contact_share" in table.names:  # full films have no descending branch
                found.append((at, fitted_stribeck(line, curve)))
            elif name == "slide_roll" and line[0] > 0.0:
                found.append((at, fitted_traction(line * at.get("speed", speed), curve)))
    return found


def fits_text(table: Table, speed: float | None) -> str:
    """Constants of all fits as CSV: the law, the conditions at which it holds, its constants."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["law", "at", "constants"])
    for at, fit in fits(table, speed):
        pairs = ("; ".join(f"{k} = {v:.6g}" for k, v in of.items()) for of in (at, fit._asdict()))
        writer.writerow([type(fit).__name__.lower(), *pairs])
    return text.getvalue()
