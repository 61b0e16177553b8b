"""Windows of rollers: maps of pressure and film, sections along the roller; y in mm."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames.choice import Choice
from ehlpetsc.pictures.frames.plane import fill, movie_panels
from ehlpetsc.pictures.frames.roller import ALONG, draw_maps, draw_sections, limits_of

__all__ = ["draw_frame", "fill", "movie_panels"]
SIZE = (7.4, 6.6)  # inches


def draw_frame(figure: Figure, choice: Choice) -> None:
    """Draw maps and sections of pressure and film, or another field, into an empty figure.

    The line in the maps is Hertz' half-width under the load of each row.
    """
    [frame], [result], [index] = choice.frames, choice.results, choice.indices
    loads, contact = result.roller(index), result.case.contact
    figure.set_size_inches(SIZE)
    axes, limits = figure.subplots(2, 2, height_ratios=(1.6, 1.0)), limits_of(frame)
    edge = frame.half_widths[0] * np.sqrt(np.maximum(loads.w, 0.0) * contact.length / contact.load)
    draw_maps(figure, axes[0], choice, limits, loads, edge)
    draw_sections(axes[1], frame, loads, limits)
    for panel in axes[1]:
        panel.set(xlim=(1e3 * loads.y[0], 1e3 * loads.y[-1]), xlabel=ALONG)
        panel.legend(loc="best", frameon=False, handlelength=1.4, **style.SMALL)
