"""Result files with made-up but plausible values, for tests of what reads them."""

import numpy as np

from ehlpetsc.quantities import FIELDS
from ehlpetsc.results.writer import ResultWriter

A, P0, RADIUS = 3.357e-4, 1e9, 0.0191
TABLE_1 = 'title = "made up"\n[fluid]\nviscosity = {viscosity}\n'


def fields_at(x, time, viscosity):
    """Fields of a Hertz pressure with a ripple that travels through it, and its film; `x` in half widths."""
    inside = np.sqrt(np.maximum(1 - x**2, 0))
    ripple = np.cos(2 * np.pi * (x - time / 40e-6) * 3)
    pressure = P0 * inside * (1 + 0.4 * inside * ripple)
    film = np.maximum(20 * viscosity * 1e-6 * (1 - 1.4 * inside * ripple), 0)
    outside = np.maximum(np.abs(x), 1)
    film = film + A**2 / (2 * RADIUS) * (outside * np.sqrt(outside**2 - 1) - np.arccosh(outside))
    shear = 0.05 * pressure
    contact = film == 0
    values = [pressure, film, np.where(x > 1.05, 0.3, 0.0), -shear, shear, contact]
    return dict(zip(FIELDS, values, strict=True)), contact


def make_result(
    path, *, nodes=161, steps=41, viscosity=0.005, factor=1.0, every=1, status="done", fields=FIELDS
):
    """Write a result over 40 us; `factor` scales its pressure.

    Returns
    -------
    path
    """
    x = np.linspace(-2.5, 1.5, nodes)
    attrs = dict(a=A, p0=P0, h_scale=A**2 / RADIUS, u1=5.6, u2=4.4, ranks=1, petsc_options="")
    writer = ResultWriter(
        path,
        case_text=TABLE_1.format(viscosity=viscosity),
        title="made up",
        x=x * A,
        scalars_attrs=attrs,
        fields=list(fields),
        every=every,
        precision="float64",
        profiles={},
    )
    for step, time in enumerate(np.linspace(0, 40e-6, steps)):
        values, contact = fields_at(x, time, viscosity)
        values["pressure"] = factor * values["pressure"]
        scalars = dict(
            dt=0.0 if steps == 1 else 40e-6 / (steps - 1),
            newton=5,
            h_min=values["film_thickness"].min(),
            p_max=values["pressure"].max(),
            contacts=contact.sum(),
            load=527e3,
            approach=-1e-6,
            wall=0.02,
        )
        writer.append(step, time, values, scalars, contact)
    writer.close(status)
    return path
