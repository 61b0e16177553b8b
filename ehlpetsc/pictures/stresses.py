"""Stresses in a solid at an instant, and the stress history of a body point."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ehlpetsc.pictures import style
from ehlpetsc.post.fatigue.accumulate import damage
from ehlpetsc.post.fatigue.cycles import rainflow
from ehlpetsc.post.loads import Loads
from ehlpetsc.post.prepare import read_settings
from ehlpetsc.post.stresses.body_stress import QUANTUM, history_at
from ehlpetsc.post.stresses.half_plane import stress, von_mises
from ehlpetsc.post.temperatures import temperature_history
from ehlpetsc.results.post_result import PostResult

FIELD_DEPTH = 1.5  # half-widths
COMPONENTS = (r"$\sigma_x$", r"$\sigma_z$", r"$\tau_{xz}$")
COLOURS = ("#4477aa", style.DARK, style.FILM)  # of the components over time
VON_MISES = r"$\sigma_{vM}$"
MARKED_CYCLES = 12


def along_body(result: PostResult, surface: str, s: np.ndarray) -> np.ndarray:
    """Abscissa [mm] of the profile at body points s [m]: distance from the point at the inlet at time 0."""
    passed = result.s[result.complete[surface]]
    if result.attrs.get(f"speed_{surface}", 1.0) < 0.0:
        return 1e3 * (s - result.attrs.get("outlet", passed[0]))
    return 1e3 * (result.attrs.get("inlet", passed[-1]) - s)


def field_picture(path: str, result: PostResult) -> Figure:
    """Pressure, and stresses in the solid of the result's main surface, at the middle stored frame."""
    surface = result.main
    with Loads(path, result.attrs.get("settings", "").splitlines()) as loads:
        frame = loads.time.size // 2
        p, q = (row[0] for row in loads.read(surface, frame, frame + 1))
        nu = read_settings(loads.case).materials[surface].poisson_ratio
        z = FIELD_DEPTH * np.linspace(0.0, 1.0, 121) ** 2
        stresses = stress(loads.x, z * loads.a, p, q, nu)
        x, time, a = loads.x / loads.a, loads.time[frame], loads.a
    figure, (top, *rows) = style.new_figure(5, 1, (8.0, 9.0), sharex=True, height_ratios=(0.7, 1, 1, 1, 1))
    top.plot(x, 1e-9 * p, color=style.SINGLE, lw=0.9)
    top.set_ylabel("p [GPa]")
    fields = zip((*COMPONENTS, VON_MISES), (*stresses, von_mises(*stresses, nu)), strict=True)
    for row, (name, values) in zip(rows, fields, strict=True):
        contours = stress_field(row, x, z, 1e-9 * values, name)
        figure.colorbar(contours, ax=row, label="GPa", pad=0.01)
    mark_maximum(rows[-1], x, z, 1e-9 * values, a)
    rows[-1].set_xlabel(style.ACROSS)
    style.set_title(figure, f"solid of surface {surface}, {style.digits(1e6 * time)} µs")
    return figure


def stress_field(axes: Axes, x: np.ndarray, z: np.ndarray, values: np.ndarray, label: str) -> ContourSet:
    """Draw one stress over x/a and z/a; colours centred on zero unless it has one sign.

    The colours span all but the highest and lowest thousandths, because peaks below single asperities would
    leave all other values in one colour.
    """
    low, high = np.quantile(values, [0.001, 0.999])
    limit, colours = max(-low, high), "viridis"
    if low < -0.1 * limit and high > 0.1 * limit:
        low, high, colours = -limit, limit, "RdBu_r"
    levels = MaxNLocator(25).tick_values(low, high if high > low else low + 1.0)
    contours = axes.contourf(x, z, values, levels=levels, cmap=colours, extend="both")
    axes.set(ylim=(z[-1], z[0]), ylabel="z/a")
    axes.set_title(label, fontsize="small", loc="left")
    return contours


def mark_maximum(axes: Axes, x: np.ndarray, z: np.ndarray, values: np.ndarray, a: float) -> None:
    """Mark the maximum von Mises stress [GPa], with its depth in the title; z in half-widths."""
    k, j = np.unravel_index(values.argmax(), values.shape)
    axes.plot(x[j], z[k], "x", color=style.SECOND, ms=6)
    text = f"{VON_MISES}, maximum {values[k, j]:.3g} GPa at z/a = {z[k]:.3g}, {1e6 * z[k] * a:.3g} µm deep"
    axes.set_title(text, fontsize="small", loc="left")


def history_picture(path: str, result: PostResult) -> Figure:
    """Stress history of the body point of the maximum damage with its cycles; with [heat] its temperature."""
    surface = result.main
    s, z = result.worst_point(surface)
    with Loads(path, result.attrs.get("settings", "").splitlines()) as loads:
        material = read_settings(loads.case).materials[surface]
        time, values = history_at(loads, surface, s, z * loads.a, QUANTUM * loads.p0)
        heat = temperature_history(loads, surface, s) if loads.is_heated(surface) else None
    sx, sz, txz = values
    of_each = [damage(sx, sz, txz, material, count=name).damage for name in ("sx", "sz", "txz")]
    channel = int(np.argmax(of_each))  # of the maximum damage, which is counted
    cycles = rainflow(1e-9 * values[channel])
    rows = 1 if heat is None else 2
    figure, axes = style.new_figure(rows, 1, (8.0, 1.0 + 2.2 * rows), sharex=True, squeeze=False)
    step = time[1] - time[0]  # zero stress before and after
    padded = 1e6 * np.concatenate([[time[0] - step], time, [time[-1] + step]])
    draw_history(axes[0, 0], padded, 1e-9 * values, channel, cycles)
    if heat is not None:
        axes[1, 0].plot(1e6 * time, heat, color=style.SECOND, lw=0.9)
        axes[1, 0].set_ylabel("temperature\nof the surface [K]")
    axes[-1, 0].set_xlabel("time [µs]")
    where = f"{along_body(result, surface, s):.4g} mm (s/a = {s / result.a:.4g}), z/a = {z:g}"
    counted = f"{len(cycles)} cycles of {COMPONENTS[channel]}, damage {np.nanmax(result.damage[surface]):.3g}"
    style.set_title(figure, f"surface {surface}, {where}: {counted}")
    return figure


def draw_history(axes: Axes, time: np.ndarray, values: np.ndarray, channel: int, cycles: np.ndarray) -> None:
    """Draw three components [GPa] over time, and the `MARKED_CYCLES` of maximum range of the counted one."""
    for stresses, name, colour in zip(values, COMPONENTS, COLOURS, strict=True):
        axes.plot(time, stresses, lw=0.9, color=colour, label=name)
    counted = values[channel]
    for row in cycles[np.argsort(-cycles[:, 0])][:MARKED_CYCLES]:
        i, j = row[2:].astype(int)
        axes.plot(time[[i, j]], counted[[i, j]], "o", ms=3, color=style.SECOND)
        axes.vlines(time[j], *sorted((counted[i], counted[j])), color=style.SECOND, lw=0.8)
        axes.hlines(counted[i], *sorted((time[i], time[j])), color=style.SECOND, lw=0.5, ls=":")
    axes.set_ylabel("stress [GPa]")
    style.legend_beside(axes)
