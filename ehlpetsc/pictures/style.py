"""Style of all pictures: colours, names, titles, conditions, legends, and the one function that saves."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.base.case import KINDS
from ehlpetsc.elasticity.bodies import reduced_modulus
from ehlpetsc.physics.contact.geometry import Dry
from ehlpetsc.results.index import distinguishing_names, series_values
from ehlpetsc.results.output_guard import replacing
from ehlpetsc.results.reader import Result

SURFACES = {"1": "#b35806", "2": "#1f4e79"}  # orange and blue, in every picture; pinion and wheel of gears
SINGLE = "#1f4e79"  # one curve, of the contact
FILM = "#228833"  # of film and surfaces, the film
CONTACTS = "#d62728"  # nodes in contact
SOLIDS = "#e08214"  # pressure of the solids
SECOND = "#cc3311"  # a second curve beside `SINGLE`
DARK = "#222222"
FAINT = "0.65"
EQUAL = 1e-3  # relative difference up to which both half-widths are shown as one
DPI = 160
ACROSS = "x/a"
SMALL = dict(fontsize="small", title_fontsize="small")  # of legends
LEGEND_ENTRIES = 12
LETTERS = 12.0  # of a title in an inch, in the usual size
FULL_WIDTH, MIN_FONT = 6.0, 0.65  # width [inches] below which text shrinks with it, down to this fraction


def new_figure(rows: int, columns: int, size: tuple[float, float], **shared: object) -> tuple[Figure, Axes]:
    """Figure and axes without pyplot, so that a notebook does not display the figure; `size` in inches."""
    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(rows, columns, **shared)


def leave_out(panels: np.ndarray, count: int) -> None:
    """Hide all but `count` panels of shape (rows, columns); the last one of each column has tick labels."""
    for axes in panels.flat[count:]:
        axes.set_visible(False)
    for column in panels.T:
        shown = [axes for axes in column if axes.get_visible()]
        for axes in shown[-1:]:
            axes.tick_params(labelbottom=True)


def set_title(figure: Figure, *lines: str) -> None:
    """Set the title above all panels; empty lines are left out."""
    text = folded("\n".join(filter(None, lines)), figure.get_figwidth())
    figure.suptitle(text, fontsize="medium")


def fonts(size: Sequence[float] | None) -> AbstractContextManager:
    """Context in which the text of narrow figures is smaller; `size` in inches, None: usual."""
    factor = min(1.0, max(MIN_FONT, size[0] / FULL_WIDTH)) if size else 1.0
    return matplotlib.rc_context({"font.size": factor * matplotlib.rcParams["font.size"]})


def save(
    figure: Figure, *paths: str | Path, chosen: argparse.Namespace | None = None, dpi: float = DPI
) -> None:
    """Write a figure, in the format of each file name; `chosen` are the options of the command."""
    if chosen:
        dpi = chosen.dpi
        if chosen.size:
            figure.set_size_inches(chosen.size)
            for title in figure.texts:
                title.set_text(folded(title.get_text(), chosen.size[0]))
        if chosen.no_title:
            figure.suptitle("")
    for path in paths:
        with replacing(Path(path)) as temporary:
            figure.savefig(temporary, dpi=dpi)


def folded(text: str, width: float) -> str:
    """Text whose lines are broken after commas to fit a width [inches] in the font of :func:`fonts`."""
    letters = int(LETTERS * width / min(1.0, max(MIN_FONT, width / FULL_WIDTH)))
    kept = [line.replace(" ", "\xa0").replace(",\xa0", ", ") for line in text.splitlines()]
    lines = [textwrap.fill(line, letters, break_long_words=False) for line in kept]
    return "\n".join(lines).replace("\xa0", " ")


def shades(count: int) -> list:
    """Colours of the members of a series, or of depths; the light end of the map is not visible on white."""
    if count <= 2:
        return [SINGLE, SECOND][:count]
    return [matplotlib.colormaps["viridis"](0.9 * k / (count - 1)) for k in range(count)]


def legend_beside(axes: Axes, handles: Sequence[Artist] | None = None, title: str | None = None) -> None:
    """Legend right of the axes; by default of all labelled artists, of many every second or third."""
    handles = axes.get_legend_handles_labels()[0] if handles is None else handles
    if handles:
        every = -(-len(handles) // LEGEND_ENTRIES)
        position = dict(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
        axes.legend(handles=list(handles)[::every], title=title, **SMALL, **position)


def legend_above(axes: Axes, *others: Axes, title: str | None = None) -> None:
    """Legend of the axes and of others in a row above the axes."""
    handles = [handle for panel in (axes, *others) for handle in panel.get_legend_handles_labels()[0]]
    position = dict(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3, frameon=False)
    axes.legend(handles=handles, title=title, **SMALL, **position)


def scale_above(axes: Axes, factor: float, label: str) -> None:
    """Add an axis above of the abscissa times a factor."""
    above = axes.secondary_xaxis("top", functions=(lambda x: x * factor, lambda x: x / factor))
    above.tick_params(labelsize="small")
    above.set_xlabel(label, fontsize="small")


def spread(count: int, most: int) -> np.ndarray:
    """Indices of at most so many of `count` entries, from the first to the last."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))


def in_view(x: np.ndarray, window: Sequence[float]) -> slice:
    """Nodes with x/a within the limits of a view."""
    nodes = np.flatnonzero((x >= window[0]) & (x <= window[1]))
    return slice(nodes[0], nodes[-1] + 1)


def reach_across(result: Result, window: Sequence[float]) -> float:
    """Distance from the middle of a plane to the edge of its view across [m].

    Half the width of the limits of x/a, times b, of a strip times a; of a roller all of it.
    """
    if KINDS[result.case.kind].has_ends:
        return np.inf
    b = result.attrs["b"]
    return 0.5 * (window[1] - window[0]) * float(b if np.isfinite(b) else result.attrs["a"])


LABELS = {
    "fluid.viscosity": "viscosity [Pa s]",
    "motion.entrainment_speed": "entrainment speed [m/s]",
    "motion.slide_roll_ratio": "slide/roll ratio",
    "mesh.points_per_half_width": "nodes per half-width",
}


def series_colours(results: list[Result]) -> tuple[list, list[str], str | None]:
    """Colours of results, labels by the keys that differ or the file names, and the key if it is one."""
    if len(results) == 1:
        return [SINGLE], [results[0].path.stem], None
    key, values = series_values(results)
    names = [f"{value:g}" for value in values] if key else distinguishing_names(results)
    return shades(len(results)), names or [result.path.stem for result in results], key


def speeds_at(result: Result, frame: int) -> tuple[float, float]:
    """Speeds of both surfaces at a stored frame [m/s]."""
    if "speed_1" not in result.scalars:
        return float(result.attrs["u1"]), float(result.attrs["u2"])
    return _at(result, "speed_1", frame), _at(result, "speed_2", frame)


def hertz_at(result: Result, frame: int) -> tuple[float, float]:
    """Half-width [m] and Hertz pressure [Pa] of the conditions at a stored frame, of a section at its y.

    Of a roller those of the mean load.
    """
    a, b, p0 = _whole_hertz_at(result, frame)
    if KINDS[result.case.kind].has_ends:
        return a, p0
    place = getattr(result, "place", None) or 0.0
    share = float(np.sqrt(max(1.0 - (place / b) ** 2, 1e-12)))  # not 0: widths divide
    return share * a, share * p0


def _whole_hertz_at(result: Result, frame: int) -> Dry:
    if "load_given" not in result.scalars:
        return Dry(*(float(result.attrs.get(name, np.inf)) for name in Dry._fields))
    contact = result.case.contact
    modulus = reduced_modulus(contact.youngs_modulus, contact.poisson_ratio)
    load, radius = _at(result, "load_given", frame), _at(result, "radius", frame)
    across = contact.radius_across and radius * contact.radius_across / contact.radius
    given = contact.copy({"load": load, "radius": radius, "radius_across": across})
    return KINDS[result.case.kind].part("geometry").dry(given, modulus)


def _at(result: Result, name: str, frame: int) -> float:
    """Scalar of the step of a stored frame."""
    return float(result.steps(name)[np.searchsorted(result.steps("step"), result.step[frame])])


def conditions(results: list[Result], frames: Sequence[int] | None = None) -> str:
    """Common speed, sliding, Hertz contact and oil of all results, at stored frames or of the whole run."""
    frames = frames or [None] * len(results)
    of_each = [_conditions(result, frame) for result, frame in zip(results, frames, strict=True)]
    return ", ".join(text for text in of_each[0] if all(text in other for other in of_each))


def _conditions(result: Result, frame: int | None) -> list[str]:
    case, texts = result.case, []
    varies = "speed_1" in result.scalars
    if varies and frame is None:
        texts.append("conditions over time; at the widest contact")
    elif varies or case.motion:
        u1, u2 = speeds_at(result, frame or 0)
        u = 0.5 * (u1 + u2)
        ratio = f"slide/roll ratio {(u1 - u2) / u + 0.0:.4g}" if u else "no entrainment"
        texts += [f"u = {u:.4g} m/s", ratio]
    a, p0 = result.attrs["a"], result.attrs["p0"]
    texts.append(f"a = {1e3 * a:.3g} mm")
    b = result.attrs.get("b", np.inf)
    if np.isfinite(b) and abs(b / a - 1.0) > EQUAL:
        texts.append(f"b = {1e3 * b:.3g} mm")
    if "load_given" in result.scalars and frame is not None:  # a, of the widest contact, is the unit of x
        width, _, p0 = _whole_hertz_at(result, frame)
        texts.append(f"half-width {width / a:.3g} a")
    texts.append(f"p0 = {1e-9 * p0:.3g} GPa")
    texts.append(f"oil {1e3 * case.fluid.viscosity:.4g} mPa s" if case.fluid else "dry")
    if (place := getattr(result, "place", None)) is not None:
        texts.append(f"section at y = {place / a:.3g} a" if place else "section at y = 0")
    return texts
