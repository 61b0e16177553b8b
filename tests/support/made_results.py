"""Result files with plausible analytic values, for tests of their readers."""

import shutil
import tempfile
import tomllib
from functools import cache
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.base.quantities import FIELDS, of_every_case
from ehlpetsc.case.loading import load
from ehlpetsc.life.history import LifeFile
from ehlpetsc.results.writer import Layout, ResultWriter, StoredSurface

A, P0, RADIUS = 3.357e-4, 1e9, 0.0191
TABLE_1 = """title = "made up"
[contact]
radius = 0.0191
load = 527e3
youngs_modulus = [207e9, 207e9]
poisson_ratio = [0.3, 0.3]
boundary_friction = 0.12
[fluid]
viscosity = {viscosity}
law = "roelands"
pressure_viscosity = 11.1e-9
density = "dowson-higginson"
[motion]
entrainment_speed = {speed}
[mesh]
inlet = -2.5
outlet = 1.5
points_per_half_width = 40
[time]
travel = 4.0
"""
BOUNDARY_FILM = 10e-9

FOLDER = tempfile.TemporaryDirectory()
DIRECT = (*of_every_case(FIELDS), "void_fraction")  # what a direct contact stores


def fields_at(x, time, viscosity):
    """Fields of a Hertz pressure with a ripple that travels through it, and its film; `x` in half-widths."""
    inside = np.sqrt(np.maximum(1 - x**2, 0))
    ripple = np.cos(2 * np.pi * (x - time / 40e-6) * 3)
    pressure = P0 * inside * (1 + 0.4 * inside * ripple)
    film = np.maximum(20 * viscosity * 1e-6 * (1 - 1.4 * inside * ripple), 0)
    outside = np.maximum(np.abs(x), 1)
    film = film + A**2 / (2 * RADIUS) * (outside * np.sqrt(outside**2 - 1) - np.arccosh(outside))
    shear = 0.05 * pressure
    contact = film == 0
    return {
        "pressure": pressure,
        "film_thickness": film,
        "void_fraction": np.where(x > 1.05, 0.3, 0.0),
        "shear_stress_1": -shear,
        "shear_stress_2": shear,
        "in_contact": contact,
    }, contact


def make_result(path, **choices):
    """Copy the result that `made` finds for these choices."""
    shutil.copyfile(made(**choices), path)
    return path


@cache
def made(
    *,
    nodes=161,
    steps=41,
    viscosity=0.005,
    factor=1.0,
    every=1,
    status="done",
    fields=DIRECT,
    speed=5.0,
    title="made up",
    p0=P0,
    rough=False,
):
    """Write a result over 40 us; `factor` scales its pressure, `rough` gives both surfaces a profile.

    The same choices are written once: many tests ask for them.
    """
    path = Path(tempfile.mkdtemp(dir=FOLDER.name), "made.h5")
    x = np.linspace(-2.5, 1.5, nodes)
    s = np.linspace(-3.5, -2.5, 50) * A
    attrs = {"title": title, "case": TABLE_1.format(viscosity=viscosity, speed=speed), "a": A, "p0": p0}
    attrs |= {"h_scale": A**2 / RADIUS, "u1": 1.12 * speed, "u2": 0.88 * speed}
    attrs |= {"ranks": 1, "petsc_options": ""}
    surface = StoredSurface(s, 1e-7 * np.cos(s / 1e-5), speed)
    surfaces = {side: surface for side in ("1", "2") if rough}
    writer = ResultWriter(path, Layout(x * A, list(fields), surfaces=surfaces), attrs)
    for step, time in enumerate(np.linspace(0, 40e-6, steps)):
        values, contact = fields_at(x, time, viscosity)
        values["pressure"] = factor * values["pressure"]
        scalars = {"dt": 40e-6 / (steps - 1) if steps > 1 else 0.0, "contacts": contact.sum()}
        scalars |= {"h_min": values["film_thickness"].min(), "p_max": values["pressure"].max()}
        scalars |= {"newton": 5, "load": 527e3, "approach": 1e-6, "wall": 0.02}
        writer.append(step, time, values, scalars, contact, step % every == 0)
    writer.close(status)
    return path


def changed_case(text, changes):
    """Text of a case with other values by dotted key; None removes a key or table."""
    tables = tomllib.loads(text)
    for key in [key for key, value in changes.items() if value is None]:
        tables.pop(key, None)
    return load(tables, {key: value for key, value in changes.items() if value is not None}).text


def change_case(path, changes):
    """Change the case in a result file."""
    with h5py.File(path, "r+", libver="latest") as file:
        text = file.attrs["case"]
        file.attrs["case"] = changed_case(text.decode() if isinstance(text, bytes) else text, changes)
    return path


def with_solids(path, share=0.3, coefficient=0.08, scatter=0.2):
    """Add the fields of mixed contact to a result; `share` is the load fraction on the solids.

    The figures of the steps swing about their mean by `scatter` of it.
    """
    with h5py.File(path, "r+", libver="latest") as file:
        touching = file["film_thickness"][:] < BOUNDARY_FILM
        file["film_thickness"][:] = np.maximum(file["film_thickness"][:], BOUNDARY_FILM)
        file["contact_pressure"] = np.where(touching, 0.8, 0.0) * file["pressure"][:]
        steps = file["steps"]
        swing = 1.0 + scatter * np.cos(np.arange(steps["time"].size) * 2.399)
        for name, value in (
            ("friction_coefficient", coefficient),
            ("contact_share", share),
            ("lambda_ratio", 0.5),
            ("mean_gap_ratio", 1.0 / max(share, 1e-3)),
        ):
            if name in steps:
                del steps[name]
            steps.create_dataset(name, data=value * swing, maxshape=(None,))
    return path


def save_life(life, path):
    """Write all rows of a life."""
    file = LifeFile(path)
    file.store(life)
    file.close("done")


def make_plane(path, *, kind="point", ratio=2.0, nodes=(41, 57), steps=5, attrs=None):
    """Write a result of an elliptic contact with solids, of b = `ratio` a, or of a strip, over 40 us.

    Its fields are those of a line contact at the same distance from the middle, thinner towards the sides.
    """
    n_y, n_x = nodes
    x, edge = np.linspace(-2.5, 1.5, n_x), 1.0 if kind == "strip" else 2.0 * ratio
    y = np.linspace(-edge, edge, n_y)
    b = np.inf if kind == "strip" else ratio
    case = changed_case(TABLE_1.format(viscosity=0.005, speed=5.0), PLANES[kind])
    root = {"title": "made up", "case": case, "a": A, "b": b * A, "p0": P0, "h_scale": A**2 / RADIUS}
    root |= {"u1": 5.6, "u2": 4.4, "ranks": 1, "petsc_options": ""} | (attrs or {})
    layout = Layout(x * A, [*DIRECT, "contact_pressure"], y=y * A, kind=kind)
    writer = ResultWriter(path, layout, root)
    distance = np.hypot(x, y[:, np.newaxis] / b) * np.where(x < 0.0, -1.0, 1.0)
    for step, time in enumerate(np.linspace(0, 40e-6, steps)):
        values, contact = fields_at(distance, time, 0.005)
        values["contact_pressure"] = np.where(contact, 0.8 * values["pressure"], 0.0)
        scalars = {"dt": 10e-6, "contacts": contact.sum(), "p_max": values["pressure"].max()}
        writer.append(step, time, values, scalars | {"h_min": 0.0, "load": 100.0}, contact)
    writer.close("done")
    return path


PLANES = {  # keys beside those of `TABLE_1`
    "point": {"contact.radius": [RADIUS, 3.0 * RADIUS], "contact.load": 100.0},
    "strip": {"mesh.width": 2.0},
}
