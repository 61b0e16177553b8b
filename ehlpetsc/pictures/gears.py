"""Pictures of gears, legible in a column of 85 mm: a path of contact, runs along it, damage, load stages."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.analysis.gear_run import FLANKS, SCALARS, GearRun
from ehlpetsc.gears.geometry import GearPair
from ehlpetsc.gears.load_sharing import RULES, share
from ehlpetsc.gears.path import Path as ContactPath
from ehlpetsc.gears.standards import Rating, values_of
from ehlpetsc.gears.table import hertz
from ehlpetsc.pictures import style

WIDTH, PANEL, FONT, DPI = 3.35, 0.95, 8, 300  # inches, points, dots per inch: one column
POSITION = "position from the pitch point [mm]"
MAX_DEPTHS = 4
OF_FLANKS = {f"temperature_{side}_max": style.SURFACES[side] for side in "12"}
STANDARD = dict(color="0.4", linestyle=":", linewidth=1.2)
STAGES = (  # figure of a run, label
    ("mean film", "mean film\n[µm]"),
    ("mean friction coefficient", "friction\ncoefficient"),
    ("mean share of the load on the solids", "share of load\non the solids"),
)


def draw(path: ContactPath, modulus: float, rating: Rating | None, target: Path, title: str) -> None:
    """Draw load, pressure, radius, speeds, and film and flash temperature of standards along the path."""
    pair, position = path.pair, 1e3 * (path.rho - path.pair.points["C"])
    panels = [("load\n[kN/m]", [(rule, values, look) for rule, values, look in _sharings(path)])]
    panels.append(("Hertz pressure\n[GPa]", [("", 1e-9 * hertz(path, modulus)[1], {})]))
    speeds = (path.speed_1, path.speed_2, path.speed_1 - path.speed_2)
    colours, names = (style.SURFACES["1"], style.SURFACES["2"], "0.5"), ("pinion", "wheel", "sliding")
    panels += [
        ("radius of\ncurvature [mm]", [("", 1e3 * path.radius, {})]),
        ("speed [m/s]", [(n, v, {"color": c}) for n, v, c in zip(names, speeds, colours, strict=True)]),
    ]
    standards = values_of(rating) if rating is not None else {}
    for name, label in (("mean film", "film [µm]"), ("maximum flash temperature", "flash [K]")):
        if name in standards:
            panels.append((label, [("ISO/TS 6336-22" if "film" in name else "Blok", standards[name], {})]))
    figure, axes = _panels(len(panels), title)
    for axis, (label, curves) in zip(axes, panels, strict=True):
        for name, values, look in curves:
            axis.plot(
                position, values, label=name or None, **({"color": style.SINGLE, "linewidth": 1.2} | look)
            )
        axis.set_ylabel(label, fontsize=FONT)
        _mark(axis, pair, with_names=axis is axes[0])
        if curves[0][0]:
            axis.legend(fontsize=FONT - 1, frameon=False, labelspacing=0.2)
    axes[0].set_ylim(bottom=0.0)
    _finish(figure, axes, target)


def _sharings(path: ContactPath) -> list[tuple[str, np.ndarray, dict]]:
    """Load of a pair along the path by each rule, the one of the case first."""
    pair = path.pair
    curves: list[tuple[str, np.ndarray, dict]] = [(pair.rule, 1e-3 * path.load, {})]
    others = zip(RULES, ("--", ":", "-."), strict=True)
    for rule, dashes in others if pair.load is None else ():
        given = {key: value for key, value in vars(pair).items() if key != "given"} | {"load_sharing": rule}
        other = GearPair(**given)
        if rule != pair.rule and not other.faults():
            load = 1e-3 * share(other, path.rho) * pair.normal_load
            curves.append((rule, load, {"color": "0.4", "linestyle": dashes, "linewidth": 1.0}))
    return curves


def draw_runs(runs: list[GearRun], target: Path, *, names: Sequence[str]) -> None:
    """Draw scalars of runs along the line of action, with those of the standards, into a file."""
    rows = [row for row in SCALARS if row[0] in names]
    figure, axes = _panels(len(rows), runs[0].title if len(runs) == 1 else "")
    for axis, (name, factor, label) in zip(axes, rows, strict=True):
        colours = [OF_FLANKS.get(name, style.SINGLE)] if len(runs) == 1 else style.shades(len(runs))
        for run, colour in zip(runs, colours, strict=True):
            values, position = factor * run.scalars[name], 1e3 * run.position
            axis.plot(position, values, color=colour, alpha=0.25, linewidth=0.3)
            axis.plot(position, run.averaged(values), color=colour, linewidth=1.2, label=run.title)
        _draw_standard(axis, runs[0], name)
        axis.set_ylabel(label, fontsize=FONT)
        _mark(axis, runs[0].path.pair, with_names=axis is axes[0])
    if len(runs) > 1:
        _legend_above(axes[0], 1)
    _finish(figure, axes, target)


def _draw_standard(axis: Axes, run: GearRun, name: str) -> None:
    """Draw the value of a standard beside a scalar, where there is one."""
    found, position = run.standards, 1e3 * (run.path.rho - run.path.pair.points["C"])
    if name == "film_central" and "mean film" in found:
        axis.plot(position, found["mean film"], **STANDARD)
    elif name == "friction_coefficient" and "mean friction coefficient" in found:
        axis.plot(position, np.full_like(position, found["mean friction coefficient"]), **STANDARD)
    elif name in OF_FLANKS and "maximum flash temperature" in found:
        axis.plot(position, run.bulk + found["maximum flash temperature"], **STANDARD)


def draw_damage(runs: list[GearRun], target: Path) -> None:
    """Draw the damage along both flanks into a file: of one run at several depths, of more the maximum."""
    figure, axes = _panels(2, runs[0].title if len(runs) == 1 else "", height=1.8, shared=False)
    first = runs[0].damage
    chosen = np.unique(np.linspace(0, len(first.depths) - 1, MAX_DEPTHS).round().astype(int))
    for k, axis in enumerate(axes):
        if first.damage[k] is not None and len(runs) == 1:
            for colour, depth in zip(style.shades(len(chosen)), chosen, strict=True):
                label = f"{1e6 * first.depths[depth]:.0f} µm"
                look = dict(color=colour, linewidth=0.5, label=label)
                axis.semilogy(1e3 * first.arcs[k], first.damage[k][depth], **look)
        for run, colour in zip(runs, style.shades(len(runs)), strict=True) if len(runs) > 1 else ():
            if run.damage.damage[k] is not None:
                deepest = np.nan_to_num(run.damage.damage[k]).max(axis=0)
                look = dict(color=colour, linewidth=0.5, label=run.title)
                axis.semilogy(1e3 * run.damage.arcs[k], np.where(deepest > 0.0, deepest, np.nan), **look)
        pair = runs[0].path.pair
        places = {name: float(pair.flank_arcs(rho)[k]) for name, rho in pair.points.items()}
        _mark(axis, pair, places)
        axis.set_ylabel(f"damage of an\nengagement, {FLANKS[k]}", fontsize=FONT)
    _legend_above(axes[0], MAX_DEPTHS if len(runs) == 1 else 1)
    _finish(figure, axes, target, "arc length along the flank from A [mm]")


def draw_stages(runs: list[GearRun], target: Path) -> None:
    """Draw film, friction, contact share and damage of runs over the torque of the pinion into a file."""
    torque, figures = [run.path.pair.torque for run in runs], [run.figures() for run in runs]
    flanks = [flank for flank in FLANKS if all(f"maximum damage of the {flank}" in row for row in figures)]
    names = [row for row in STAGES if all(np.isfinite(one[row[0]]) for one in figures)]
    figure, axes = _panels(len(names) + bool(flanks), "")
    for axis, (name, label) in zip(axes, names, strict=False):
        axis.plot(torque, [row[name] for row in figures], "o-", color=style.SINGLE, markersize=4)
        if all(name in run.standards for run in runs):
            axis.plot(
                torque, [np.nanmean(run.standards[name]) for run in runs], "s", **STANDARD, markersize=3
            )
        axis.set_ylabel(label, fontsize=FONT)
        axis.set_ylim(0.0, 1.1 * axis.dataLim.y1)
    for side, flank in zip("12", flanks, strict=False):
        damage = [row[f"maximum damage of the {flank}"] for row in figures]
        axes[-1].semilogy(torque, damage, "o-", color=style.SURFACES[side], markersize=4, label=flank)
        axes[-1].set_ylabel("damage of an\nengagement", fontsize=FONT)
        axes[-1].legend(fontsize=FONT, frameon=False)
    for axis in axes:
        axis.grid(alpha=0.3)
    _finish(figure, axes, target, "torque on the pinion [N m]")


def _panels(count: int, title: str, height: float = PANEL, shared: bool = True) -> tuple[Figure, np.ndarray]:
    """Figure of a column and its panels."""
    figure = Figure(figsize=(WIDTH, 0.6 + height * count), layout="constrained")
    axes = figure.subplots(count, 1, sharex=shared, squeeze=False)[:, 0]
    for axis in axes:
        axis.tick_params(labelsize=FONT)
    if title:
        figure.suptitle(title, fontsize=FONT)
    return figure, axes


def _finish(figure: Figure, axes: np.ndarray, target: Path, label: str = POSITION) -> None:
    figure.align_ylabels(list(axes))
    axes[-1].set_xlabel(label, fontsize=FONT)
    style.save(figure, target, dpi=DPI)


def _legend_above(axis: Axes, columns: int) -> None:
    """Legend in the column above the names of the points."""
    position = dict(loc="lower center", bbox_to_anchor=(0.5, 1.1), ncol=columns)
    axis.legend(fontsize=FONT - 1, frameon=False, columnspacing=0.8, handlelength=1.2, **position)


def _mark(
    axis: Axes, pair: GearPair, places: dict[str, float] | None = None, with_names: bool = True
) -> None:
    """Mark the points A to E, by default on the line of action, at places in metres."""
    axis.grid(alpha=0.3)
    places = places or {name: rho - pair.points["C"] for name, rho in pair.points.items()}
    for name, x in places.items():
        axis.axvline(1e3 * x, color="0.7", linewidth=0.8)
        if with_names:
            at = dict(xycoords=("data", "axes fraction"), ha="center", fontsize=FONT)
            axis.annotate(name, (1e3 * x, 1.03), **at)
