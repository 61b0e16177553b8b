"""Pictures of gears, legible in a column of 85 mm: a path of contact, runs along it, damage, load stages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes

from ehlpetsc.analysis.gear_run import FLANKS, SCALARS, GearRun
from ehlpetsc.gears.faults import faults
from ehlpetsc.gears.geometry import GearPair
from ehlpetsc.gears.load_sharing import RULES, share
from ehlpetsc.gears.path import Path as ContactPath
from ehlpetsc.gears.path import hertz
from ehlpetsc.gears.standards import Rating, values_of
from ehlpetsc.pictures import style

COLUMN, PANEL, COLUMN_DPI = 3.35, 0.95, 300  # inches, dots per inch: one column
FONTS = {"font.size": 8, "figure.titlesize": 8, "legend.fontsize": 7, "legend.frameon": False}
GRID = {"axes.grid": True, "grid.alpha": 0.3}
LEGEND = dict(loc="lower center", bbox_to_anchor=(0.5, 1.1), handlelength=1.2)  # the names of the points
POSITION = "position from the pitch point [mm]"
LINES = ("-", "--", ":")  # of the curves of a panel
COLOURS = {"pinion": style.SURFACES["1"], "wheel": style.SURFACES["2"]}
OF_STANDARDS = {  # beside scalars of a run
    "film_central": "mean film",
    "friction_coefficient": "mean friction coefficient",
    "temperature_1_max": "maximum flash temperature",
    "temperature_2_max": "maximum flash temperature",
}
STANDARD = dict(color="0.4", linestyle=":", linewidth=1.2)
STAGES = (  # figure of a run, label
    ("mean film", "mean film\n[µm]"),
    ("mean friction coefficient", "friction\ncoefficient"),
    ("mean share of the load on the solids", "share of load\non the solids"),
)


def draw(path: ContactPath, modulus: float, rating: Rating | None, target: Path, title: str) -> None:
    """Draw load, pressure, radius, speeds, and film and flash temperature of standards along the path."""
    position, standards = 1e3 * (path.rho - path.pair.points["C"]), values_of(rating) if rating else {}
    sliding = path.speed_1 - path.speed_2
    panels = {
        "load\n[kN/m]": _sharings(path),
        "Hertz pressure\n[GPa]": {"": 1e-9 * hertz(path, modulus)[1]},
        "radius of\ncurvature [mm]": {"": 1e3 * path.radius},
        "speed [m/s]": {"pinion": path.speed_1, "wheel": path.speed_2, "sliding": sliding},
    }
    if "mean film" in standards:
        panels["film [µm]"] = {"ISO/TS 6336-22": standards["mean film"]}
    if "maximum flash temperature" in standards:
        panels["flash [K]"] = {"Blok": standards["maximum flash temperature"]}
    with _column(len(panels), target, title) as axes:
        for axis, (label, curves) in zip(axes, panels.items(), strict=True):
            for number, (name, values) in enumerate(curves.items()):
                colour = COLOURS.get(name, "0.4" if number else style.SINGLE)
                axis.plot(position, values, LINES[number], color=colour, linewidth=1.2, label=name)
            axis.set_ylabel(label)
            _mark(axis, path.pair, with_names=axis is axes[0])
            if all(curves):
                axis.legend(labelspacing=0.2)
        axes[0].set_ylim(bottom=0.0)


def _sharings(path: ContactPath) -> dict[str, np.ndarray]:
    """Load of a pair along the path [kN/m] by each rule, the one of the case first."""
    curves = {path.pair.rule: 1e-3 * path.load}
    for rule in RULES if path.pair.load is None else ():
        other = replace(path.pair, load_sharing=rule)
        if rule not in curves and not faults(other):
            curves[rule] = 1e-3 * share(other, path.rho) * other.normal_load
    return curves


def draw_runs(runs: list[GearRun], target: Path, *, names: Sequence[str]) -> None:
    """Draw scalars of runs along the line of action, with those of the standards, into a file."""
    rows = [row for row in SCALARS if row[0] in names]
    with _column(len(rows), target, runs[0].title if len(runs) == 1 else "") as axes:
        for axis, (name, factor, label) in zip(axes, rows, strict=True):
            for run, colour in zip(runs, style.shades(len(runs)), strict=True):
                values, position = factor * run.scalars[name], 1e3 * run.position
                axis.plot(position, values, color=colour, alpha=0.25, linewidth=0.3)
                axis.plot(position, run.averaged(values), color=colour, linewidth=1.2, label=run.title)
            _draw_standard(axis, runs[0], name)
            axis.set_ylabel(label)
            _mark(axis, runs[0].path.pair, with_names=axis is axes[0])
        if len(runs) > 1:
            axes[0].legend(**LEGEND)


def _draw_standard(axis: Axes, run: GearRun, name: str) -> None:
    """Draw the value of a standard beside a scalar, where there is one."""
    values = run.standards.get(OF_STANDARDS.get(name))
    if values is not None:
        position = 1e3 * (run.path.rho - run.path.pair.points["C"])
        values = values + (run.bulk if "temperature" in name else 0.0)
        axis.plot(position, np.broadcast_to(values, position.shape), **STANDARD)


def draw_damage(runs: list[GearRun], target: Path) -> None:
    """Draw the maximum damage over the depths along both flanks into a file."""
    pair = runs[0].path.pair
    with _column(2, target, "", "arc length along the flank from A [mm]", 1.8, sharex=False) as axes:
        for k, axis in enumerate(axes):
            for run, colour in zip(runs, style.shades(len(runs)), strict=True):
                if run.damage.damage[k] is not None:
                    maximum = np.nan_to_num(run.damage.damage[k]).max(axis=0)
                    look = dict(color=colour, linewidth=0.5, label=run.title)
                    axis.semilogy(1e3 * run.damage.arcs[k], np.where(maximum > 0.0, maximum, np.nan), **look)
            places = {name: float(pair.flank_arcs(rho)[k]) for name, rho in pair.points_on_path.items()}
            _mark(axis, pair, places)
            axis.set_ylabel(f"damage of an\nengagement, {FLANKS[k]}")
        axes[0].legend(**LEGEND)


def draw_stages(runs: list[GearRun], target: Path) -> None:
    """Draw film, friction, contact share and damage of runs over the torque of the pinion into a file."""
    torque, figures = [run.path.pair.torque for run in runs], [run.figures() for run in runs]
    flanks = [flank for flank in FLANKS if all(f"maximum damage of the {flank}" in row for row in figures)]
    names = [row for row in STAGES if all(np.isfinite(one[row[0]]) for one in figures)]
    with _column(len(names) + bool(flanks), target, "", "torque on the pinion [N m]") as axes:
        for axis, (name, label) in zip(axes, names, strict=False):
            axis.plot(torque, [row[name] for row in figures], "o-", color=style.SINGLE, markersize=4)
            if all(name in run.standards for run in runs):
                means = [np.nanmean(run.standards[name]) for run in runs]
                axis.plot(torque, means, "s", **STANDARD, markersize=3)
            axis.set_ylabel(label)
            axis.set_ylim(0.0, 1.1 * axis.dataLim.y1)
        for flank in flanks:
            damage = [row[f"maximum damage of the {flank}"] for row in figures]
            axes[-1].semilogy(torque, damage, "o-", color=COLOURS[flank], markersize=4, label=flank)
            axes[-1].set_ylabel("damage of an\nengagement")
            axes[-1].legend()


@contextmanager
def _column(
    count: int, target: Path, title: str, label: str = POSITION, height: float = PANEL, sharex: bool = True
) -> Iterator[np.ndarray]:
    """Panels of a column, which are saved at the end."""
    with rc_context(FONTS | GRID):
        size = (COLUMN, 0.6 + height * count)
        figure, axes = style.new_figure(count, 1, size, sharex=sharex, squeeze=False)
        if title:
            figure.suptitle(title)
        yield axes[:, 0]
        figure.align_ylabels(list(axes[:, 0]))
        axes[-1, 0].set_xlabel(label)
        style.save(figure, target, dpi=COLUMN_DPI)


def _mark(
    axis: Axes, pair: GearPair, places: dict[str, float] | None = None, with_names: bool = True
) -> None:
    """Mark the points A to E, by default on the line of action, at places in metres."""
    places = places or {name: rho - pair.points["C"] for name, rho in pair.points_on_path.items()}
    for name, x in places.items():
        axis.axvline(1e3 * x, color="0.7", linewidth=0.8)
        if with_names:
            at = dict(xycoords=("data", "axes fraction"), ha="center")
            axis.annotate(name, (1e3 * x, 1.03), **at)
