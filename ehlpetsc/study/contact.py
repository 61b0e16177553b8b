"""Amount of contact against mesh, time step, boundary film and contact model.

``ehlpetsc study --contact CASE.toml``: one run for each combination, a line each in
table and CSV; means over the time both rough surfaces fill the contact. Where a sequence of meshes halves its
spacing, the observed order and the extrapolated value of each figure follow. ``--damage`` stores every step
and has `ehlpetsc.post` count the damage of surface 1 at z = 0 and 0.01 a.
"""

import itertools
import tomllib
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from ehlpetsc.case.toml_text import toml_text
from ehlpetsc.errors import ExitStatus
from ehlpetsc.results.filling import both_fill
from ehlpetsc.results.reader import read_result
from ehlpetsc.study.convergence import observed_order, richardson_error
from ehlpetsc.study.runs import csv_table, greatest_damage, run
from ehlpetsc.study.setting import FILM, MESH, MODEL, STEP, Setting, stored

DEPTHS = (0.0, 0.01)  # half widths, of the damage
THIN_FILMS = (2.0, 5.0, 10.0)  # boundary films below which a film counts as thin
REPORTED_ORDERS = (
    "length",
    "share",
    "thin_length",
    "thin_share",
    "share_below_5",
    "length_below_10",
    "p_max",
    "p_mean",
)
FIELDS = ("pressure", "film_thickness", "contact_pressure", "in_contact")
SHEAR = ("shear_stress_1", "shear_stress_2")
KEYS = {MODEL: "model", MESH: "mesh", STEP: "courant", FILM: "boundary_film"}
OF_MIXED_CONTACT = ("boundary_film", "yield_pressure")  # keys of [contact] that direct contact refuses


@dataclass(frozen=True)
class Measured:
    """Scalars of a run; lengths in half widths, pressures in GPa, shares of the load.

    Attributes
    ----------
    length, share
        Length where solids touch, and their share of the load; in direct contact that of nodes at the bound.
    thin_length, thin_share, share_below_5, length_below_10
        Where the film is below two boundary films, what is carried there and below five; and below ten.
    p_max, p_mean
        Largest pressure, and the mean over the stored frames of the largest of each.
    iterations, halved, mass_error, seconds
        Newton's a step, steps that had to be halved, largest oil imbalance, processor time of the run.
    damage_at_surface, damage_below
        Largest fatigue damage of surface 1 in a passage, at the depths of `DEPTHS`; nan: not computed.
    """

    length: float
    share: float
    thin_length: float
    thin_share: float
    share_below_5: float
    length_below_10: float
    p_max: float
    p_mean: float
    iterations: float
    halved: int
    mass_error: float
    seconds: float
    damage_at_surface: float = np.nan
    damage_below: float = np.nan


COLUMNS = [*KEYS.values(), *Measured.__dataclass_fields__]


def measured(path, boundary_film, seconds):
    """Figures of a result file.

    Parameters
    ----------
    path : path-like
    boundary_film : float
        [m], also of a direct contact, to which it means nothing by itself.
    seconds : float
        Processor time of the run.
    """
    with read_result(path) as result:
        a, dx = result.attrs["a"], np.diff(result.x).mean()
        frames = np.flatnonzero(both_fill(result, result.time))
        rows = np.array([_of_frame(result, frame, boundary_film) for frame in frames])
        filled = both_fill(result, result.steps("time"))
        dt, load = result.steps("dt"), result.steps("load").mean()
        touching = (result.steps("contacts") * dt)[filled].sum() / dt[filled].sum()
        solids_load, below, thin, below_5, below_10, greatest = rows.mean(axis=0)
        return Measured(
            touching * dx / a,
            solids_load * dx / load,
            below * dx / a,
            thin * dx / load,
            below_5 * dx / load,
            below_10 * dx / a,
            1e-9 * result.steps("p_max")[filled].max(),
            1e-9 * greatest,
            result.steps("newton")[1:].mean(),
            int(np.count_nonzero(result.steps("retries"))),
            result.steps("mass_error").max(),
            seconds,
        )


def _of_frame(result, frame, boundary_film):
    """Solids' load per node, thin nodes, loads where the film is thin, nodes below ten, largest pressure."""
    p, h = result.frame("pressure", frame), result.frame("film_thickness", frame)
    name = "contact_pressure" if "contact_pressure" in result else "pressure"
    solids = result.frame(name, frame)[result["in_contact"][frame].astype(bool)].sum()
    thin, below_5, below_10 = (h < factor * boundary_film for factor in THIN_FILMS)
    return solids, thin.sum(), p[thin].sum(), p[below_5].sum(), below_10.sum(), p.max()


def _damages(path):
    """Largest damage at the two depths, by the names in `Measured`."""
    at_surface, below = greatest_damage(path, "1", DEPTHS)
    return {"damage_at_surface": at_surface, "damage_below": below}


def order(coarse, middle, fine):
    """Observed order and limit of three values at halved spacings; nan where they do not converge."""
    coarse_change, fine_change = coarse - middle, middle - fine
    if coarse_change * fine_change <= 0.0 or abs(fine_change) >= abs(coarse_change):
        return np.nan, np.nan
    exponent = observed_order((abs(coarse_change), abs(fine_change)))
    return exponent, float(fine - richardson_error(fine_change, exponent))


def settings(models, meshes, courants, boundary_films):
    """Settings of every combination; of direct contact with the first boundary film, for :func:`measured`."""
    for model, film, courant, mesh in itertools.product(models, boundary_films, courants, meshes):
        if model == "mixed" or film == boundary_films[0]:
            yield Setting({MODEL: model, MESH: mesh, STEP: courant, FILM: film})


def output_of(setting, damage=False):
    """Overrides of the stored fields; for damage every step, else frames at equal times on all meshes."""
    stride = round(2.0 * setting.values[MESH] / 100 * 0.5 / setting.values[STEP])
    return stored((*FIELDS, *SHEAR) if damage else FIELDS, 1 if damage else max(1, stride))


def for_direct_contact(case, overrides, folder):
    """A case and its overrides for direct contact: without the keys of mixed contact.

    Parameters
    ----------
    case : path-like
    overrides : sequence of str
        ``table.key=value``.
    folder : path-like
        Where the shortened case is written, if the case has such keys.

    Returns
    -------
    path-like, list of str
    """
    names = tuple(f"contact.{key}" for key in OF_MIXED_CONTACT)
    remaining = [override for override in overrides if override.partition("=")[0].strip() not in names]
    try:
        tables = tomllib.loads(Path(case).read_text(encoding="utf-8-sig"))
    except (OSError, ValueError):  # the run reports it
        return case, remaining
    of_contact = tables.get("contact", {})
    if not any(key in of_contact for key in OF_MIXED_CONTACT):
        return case, remaining
    for key in OF_MIXED_CONTACT:
        of_contact.pop(key, None)
    for side in tables.get("surface", {}).values():
        if "file" in side:  # relative to the case, which now lies elsewhere
            side["file"] = str((Path(case).parent / side["file"]).absolute())
    shortened = Path(folder) / f"{Path(case).stem}.direct.toml"
    shortened.write_text(toml_text(tables), encoding="utf-8")
    return shortened, remaining


def table(case, overrides, chosen, path, folder, limit, say=print, damage=False):
    """Run the settings; rows to a CSV file and lines to `say`.

    Returns
    -------
    list of (Setting, Measured or None)
        None: the run did not come to its end.
    """
    rows = []
    say(" ".join(f"{name:>13}" for name in COLUMNS))
    with csv_table(path, COLUMNS) as append:
        for setting in chosen:
            outcome = _run(case, overrides, setting, damage, folder, limit)
            scalars = None
            if outcome.status == ExitStatus.DONE:
                scalars = measured(outcome.result, setting.values[FILM], outcome.processor)
                scalars = replace(scalars, **_damages(outcome.result)) if damage else scalars
            rows.append((setting, scalars))
            row = _described(setting) | (asdict(scalars) if scalars else {})
            append(row)
            shown = [f"{v:.4g}" if isinstance(v, float) else str(v) for v in row.values()]
            say(" ".join(f"{v:>13}" for v in shown) + ("" if scalars else f" {outcome.message}"))
            if outcome.result:
                Path(outcome.result).unlink()
    for line in orders(rows):
        say(line)
    return rows


def _described(setting):
    """Values of a setting by column."""
    return {column: setting.values[key] for key, column in KEYS.items()}


def _run(case, overrides, setting, damage, folder, limit):
    overrides = [*overrides, *setting.overrides(), *output_of(setting, damage)]
    if setting.values[MODEL] == "direct":
        case, overrides = for_direct_contact(case, overrides, folder)
    return run(case, overrides, folder=folder, limit=limit)


def orders(rows):
    """Lines of observed orders and limits, for each three meshes of which one is twice the other."""
    by_setting = {tuple(setting.values.values()): value for setting, value in rows if value}
    for setting, fine in rows:
        mesh = setting.values[MESH]
        coarser = [tuple((setting.values | {MESH: mesh // k}).values()) for k in (4, 2)]
        if not fine or mesh % 4 or not by_setting.keys() >= set(coarser):
            continue
        described = ", ".join(f"{column}={value}" for column, value in _described(setting).items())
        for name in REPORTED_ORDERS:
            exponent, limit = order(*(getattr(by_setting[key], name) for key in coarser), getattr(fine, name))
            yield f"{described}: {name} order {exponent:.2f}, limit {limit:.4g}"
