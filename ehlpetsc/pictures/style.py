"""Style of all pictures: colours, names, titles, conditions, legends, and the one function that saves."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ehlpetsc.physics.scales import hertz_line, reduced_modulus
from ehlpetsc.results.index import distinguishing_names, series_values
from ehlpetsc.results.output_guard import replacing
from ehlpetsc.results.reader import Result

SURFACES = {"1": "#b35806", "2": "#1f4e79"}  # orange and blue, in every picture; pinion and wheel of gears
SINGLE = "#1f4e79"  # one curve, of the contact
FILM = "#228833"  # of film and surfaces, the film
CONTACT = "#d62728"  # nodes in contact
SOLIDS = "#e08214"  # pressure of the solids
SECOND = "#cc3311"  # a second curve beside `SINGLE`
DARK = "#222222"
FAINT = "0.65"
DPI = 160
ACROSS = "x/a"
MOVIE_ENDINGS = (".gif", ".mp4", ".webm")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a picture to a command."""
    add = parser.add_argument_group("pictures").add_argument
    add("--dpi", type=float, default=DPI, help="dots per inch of a png [%(default)s]")
    add("--size", type=float, nargs=2, metavar=("WIDTH", "HEIGHT"), help="inches")
    add("--no-title", action="store_true", help="without the title above the panels")


def new_figure(rows: int, columns: int, size: tuple[float, float], **shared: object) -> tuple[Figure, Axes]:
    """Figure and axes without pyplot, so that a notebook does not display the figure; `size` in inches."""
    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(rows, columns, **shared)


def set_title(figure: Figure, *lines: str) -> None:
    """Set the title above all panels; empty lines are left out."""
    figure.suptitle("\n".join(filter(None, lines)), fontsize="medium")


def save(figure: Figure, *paths: str | Path, chosen: argparse.Namespace | None = None) -> None:
    """Write a figure, in the format of each file name; `chosen` has the options of `add_options`."""
    if chosen and chosen.size:
        figure.set_size_inches(chosen.size)
    if chosen and chosen.no_title:
        figure.suptitle("")
    dpi = chosen.dpi if chosen else DPI
    figure.set_dpi(dpi)
    figure.draw_without_rendering()  # one layout for all formats
    figure.set_layout_engine("none")
    for path in map(Path, paths):
        metadata = {"Date": None} if path.suffix == ".svg" else None  # the same file from the same result
        with (
            matplotlib.rc_context({"svg.hashsalt": "ehlpetsc"}),
            replacing(path, keep_ending=True) as temporary,
        ):
            figure.savefig(temporary, dpi=dpi, metadata=metadata)


def shades(count: int) -> list[tuple[float, ...]]:
    """Colours of the members of a series, or of depths; the light end of the map is not visible on white."""
    return [matplotlib.colormaps["viridis"](0.9 * k / max(count - 1, 1)) for k in range(count)]


def legend_beside(axes: Axes, handles: Sequence[Artist] | None = None, title: str | None = None) -> None:
    """Legend right of the axes; by default of all labelled artists."""
    handles = axes.get_legend_handles_labels()[0] if handles is None else handles
    position = dict(loc="center left", bbox_to_anchor=(1.0, 0.5))
    small = dict(fontsize="small", title_fontsize="small", frameon=False)
    axes.legend(handles=list(handles), title=title, **small, **position)


def legend_above(axes: Axes, *others: Axes, title: str | None = None) -> None:
    """Legend of the axes and of others in a row above the axes."""
    handles = [handle for panel in (axes, *others) for handle in panel.get_legend_handles_labels()[0]]
    position = dict(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3, frameon=False)
    if handles:
        axes.legend(handles=handles, title=title, fontsize="small", title_fontsize="small", **position)


def digits(value: float) -> str:
    """Four significant digits without an exponent where it is avoidable: 355.0, 0.1234, 1e-08."""
    return f"{value:.4g}"


def in_view(x: np.ndarray, window: tuple[float, float]) -> slice:
    """Nodes with x/a within the limits of a view."""
    nodes = np.flatnonzero((x >= window[0]) & (x <= window[1]))
    return slice(nodes[0], nodes[-1] + 1)


LEGEND_ENTRIES = 10
UNITS = {
    "fluid.viscosity": "viscosity [Pa s]",
    "motion.entrainment_speed": "entrainment speed [m/s]",
    "motion.slide_roll_ratio": "slide/roll ratio",
    "mesh.points_per_half_width": "nodes per half-width",
}


def series_colours(results: list[Result]) -> tuple[list, list[str], str | None]:
    """Colours and labels of several results, and the key of their series; None if they are none."""
    if len(results) == 1:
        return [SINGLE], [results[0].path.stem], None
    key, values = series_values(results)
    return shades(len(results)), [f"{value:g}" for value in values] if key else names(results), key


def names(results: list[Result]) -> list[str]:
    """Labels of results: titles if they differ, otherwise keys that differ, otherwise file names."""
    titles = [result.attrs["title"] for result in results]
    distinct = distinguishing_names(results)
    if len(set(titles)) == 1 and distinct:
        return distinct
    if len(set(titles)) == len(titles):
        return titles
    if len(set(titles)) == 1:
        return [result.path.stem for result in results]
    return [f"{title} ({result.path.stem})" for title, result in zip(titles, results, strict=True)]


def is_lubricated(result: Result) -> bool:
    """Whether there is oil in the contact."""
    return result.case.fluid is not None


def speeds_at(result: Result, frame: int) -> tuple[float, float]:
    """Speeds of both surfaces at a stored frame [m/s]."""
    if "speed_1" not in result.scalars:
        return float(result.attrs["u1"]), float(result.attrs["u2"])
    row = np.searchsorted(result.steps("step"), result.step[frame])
    return float(result.steps("speed_1")[row]), float(result.steps("speed_2")[row])


def hertz_at(result: Result, frame: int) -> tuple[float, float]:
    """Half-width [m] and Hertz pressure [Pa] of the conditions at a stored frame."""
    if "load_given" not in result.scalars:
        return float(result.attrs["a"]), float(result.attrs["p0"])
    contact = result.case.contact
    row = np.searchsorted(result.steps("step"), result.step[frame])
    modulus = reduced_modulus(contact.youngs_modulus, contact.poisson_ratio)
    return hertz_line(float(result.steps("load_given")[row]), float(result.steps("radius")[row]), modulus)


def conditions(results: list[Result], frames: Sequence[int] | None = None) -> str:
    """Common speed, sliding, Hertz contact and oil of all results, at stored frames or of the whole run."""
    frames = frames or [None] * len(results)
    of_each = [_conditions(result, frame) for result, frame in zip(results, frames, strict=True)]
    return ", ".join(text for text in of_each[0] if all(text in other for other in of_each))


def _conditions(result: Result, frame: int | None) -> list[str]:
    case, texts = result.case, []
    varies = "speed_1" in result.scalars
    if varies and frame is None:
        texts.append("conditions over time, at most")
    elif varies or case.motion:
        u1, u2 = speeds_at(result, frame or 0)
        u = 0.5 * (u1 + u2)
        texts += [
            f"u = {u:.4g} m/s",
            f"slide/roll ratio {(u1 - u2) / u + 0.0:.4g}" if u else "no entrainment",
        ]
    a, p0 = (result.attrs["a"], result.attrs["p0"]) if frame is None else hertz_at(result, frame)
    texts += [f"a = {1e3 * a:.3g} mm", f"p0 = {1e-9 * p0:.3g} GPa"]
    return [*texts, f"oil {1e3 * case.fluid.viscosity:.4g} mPa s" if case.fluid else "dry"]


def share_hertz_contact(results: list[Result]) -> bool:
    """Whether all results have the same Hertz contact."""
    contacts = np.array([(result.attrs["a"], result.attrs["p0"]) for result in results])
    return np.allclose(contacts, contacts[0], rtol=1e-9, atol=0.0)


def labels_with_hertz(labels: list[str], results: list[Result]) -> list[str]:
    """Labels with the Hertz contact of each result, if these differ."""
    if share_hertz_contact(results):
        return labels
    return [
        f"{label}\na = {1e3 * r.attrs['a']:.3g} mm, p0 = {1e-9 * r.attrs['p0']:.3g} GPa"
        for label, r in zip(labels, results, strict=True)
    ]


def series_legend(
    axes: Axes, colours: list, labels: list[str], title: str | None, handles: Sequence[Artist] = ()
) -> None:
    """Legend of at most `LEGEND_ENTRIES` members, the second of two dashed, and `handles`."""
    step = -(-len(labels) // LEGEND_ENTRIES)
    lines = [Line2D([], [], color=c, label=n) for c, n in list(zip(colours, labels, strict=True))[::step]]
    if len(lines) == 2:
        lines[1].set_linestyle("--")
    legend_beside(axes, [*lines, *handles], title)
