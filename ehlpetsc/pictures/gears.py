"""Pictures of gears: a path of contact, a run along it, damage of both flanks."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.analysis.gear_run import FLANKS, SCALARS
from ehlpetsc.pictures import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ehlpetsc.analysis.gear_run import FlankDamage, GearRun
    from ehlpetsc.gears.geometry import GearPair
    from ehlpetsc.gears.path import Path as ContactPath

MAX_DEPTHS = 4
OF_FLANKS = {f"temperature_{side}_max": style.SURFACES[side] for side in "12"}


def draw(path: ContactPath, hertz: tuple[np.ndarray, np.ndarray] | None, target: Path, title: str) -> None:
    """Draw load, radius, speeds and slide/roll ratio along the line of action.

    `hertz` contains half width [m] and maximum pressure [Pa] along the path; None without moduli.
    """
    position = 1e3 * (path.rho - path.pair.points["C"])
    figure = Figure(figsize=(7.0, 7.5), layout="constrained")
    load, radius, speed = figure.subplots(3, 1, sharex=True)
    load.plot(position, 1e-3 * path.load, color=style.SINGLE)
    load.set_ylabel("load [kN/m]")
    load.set_ylim(bottom=0.0)
    if hertz is not None:
        pressure = load.twinx()
        pressure.plot(position, 1e-9 * hertz[1], color=style.SECOND)
        pressure.set_ylabel("Hertz pressure [GPa]", color=style.SECOND)
        pressure.set_ylim(bottom=0.0)
    radius.plot(position, 1e3 * path.radius, color=style.SINGLE)
    radius.set_ylabel("radius of relative\ncurvature [mm]")
    for values, label, colour in (
        (path.speed_1, "flank 1 (pinion)", style.SURFACES["1"]),
        (path.speed_2, "flank 2 (wheel)", style.SURFACES["2"]),
        (path.speed_1 - path.speed_2, "sliding", "#7f7f7f"),
    ):
        speed.plot(position, values, label=label, color=colour)
    speed.set_ylabel("speed [m/s]")
    speed.set_xlabel("position on the line of action from the pitch point [mm]")
    speed.legend(fontsize=8)
    places = {name: 1e3 * (rho - path.pair.points["C"]) for name, rho in path.pair.points.items()}
    for axes in (load, radius, speed):
        _mark(axes, places, with_names=axes is load)
    figure.suptitle(title, fontsize=10)
    style.save(figure, target)


def draw_run(run: GearRun, target: Path) -> None:
    """Draw the scalars of a run along the line of action into a file."""
    rows = [row for row in SCALARS if row[0] in run.scalars and np.isfinite(run.scalars[row[0]]).any()]
    figure = Figure(figsize=(7.0, 1.0 + 1.2 * len(rows)), layout="constrained")
    axes = figure.subplots(len(rows), 1, sharex=True, squeeze=False)[:, 0]
    for axis, (name, factor, label) in zip(axes, rows, strict=True):
        values, colour = factor * run.scalars[name], OF_FLANKS.get(name, style.SINGLE)
        axis.plot(1e3 * run.position, values, color=colour, alpha=0.3, linewidth=0.5)
        axis.plot(1e3 * run.position, run.averaged(values), color=colour, linewidth=1.5)
        axis.set_ylabel(label, fontsize=7)
    c = run.path.pair.points["C"]
    for axis in axes:
        places = {name: 1e3 * (rho - c) for name, rho in run.path.pair.points.items()}
        _mark(axis, places, with_names=axis is axes[0])
    axes[-1].set_xlabel("position on the line of action from the pitch point [mm]")
    figure.suptitle(run.title, fontsize=10)
    style.save(figure, target)


def draw_damage(flanks: FlankDamage, pair: GearPair, target: Path, title: str) -> None:
    """Draw the damage along both flanks into a file."""
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    chosen = np.unique(np.linspace(0, len(flanks.depths) - 1, MAX_DEPTHS).round().astype(int))
    for k, axis in enumerate(figure.subplots(2, 1)):
        curves = zip(style.shades(len(chosen)), chosen, strict=True)
        for colour, depth in curves if flanks.damage[k] is not None else ():
            label = f"{1e6 * flanks.depths[depth]:.0f} µm deep"
            axis.semilogy(
                1e3 * flanks.arcs[k], flanks.damage[k][depth], color=colour, linewidth=0.7, label=label
            )
        _mark(axis, {name: 1e3 * float(pair.flank_arcs(rho)[k]) for name, rho in pair.points.items()})
        axis.set_ylabel(f"damage of an engagement,\n{FLANKS[k]}")
        axis.set_xlabel("arc length along the flank from A [mm]")
    if flanks.damage[0] is not None:
        figure.axes[0].legend(fontsize=8)
    figure.suptitle(title, fontsize=10)
    style.save(figure, target)


def _mark(axis: Axes, places: dict[str, float], with_names: bool = True) -> None:
    """Mark the points A to E of the path."""
    axis.grid(alpha=0.3)
    for name, x in places.items():
        axis.axvline(x, color="0.7", linewidth=0.8)
        if with_names:
            axis.annotate(name, (x, 1.02), xycoords=("data", "axes fraction"), ha="center")
