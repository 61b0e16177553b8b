"""Point contacts and strips over time: contacts of the whole passage, movies."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.figure import Figure

from ehlpetsc.base.errors import OutputError
from ehlpetsc.pictures import frames, over_time, plane, style
from ehlpetsc.results.output_guard import replacing
from ehlpetsc.results.reader import Result

CONTACTS_WIDTH, CONTACTS_MARGIN = 4.6, 1.9  # inches
MOVIE_MARGIN = 1.6  # inches above and below the maps


def draw_contacts(result: Result, options: argparse.Namespace) -> Figure:
    """Share of the time steps of a run in which each node is in contact."""
    window = frames.view([result], options.window)
    if not result.contact_count.any():
        raise OutputError(f"{result.path}: no node is in contact in any step")
    part, x, y = plane.in_view(result, window)
    percent = 100.0 * result.contact_count[part] / len(result.steps("time"))
    ratio = float(np.clip(np.ptp(y) / np.ptp(x), *plane.PANEL_RATIOS))
    size = CONTACTS_WIDTH, (CONTACTS_WIDTH - 0.8) * ratio + CONTACTS_MARGIN
    figure, axes = style.new_figure(1, 1, size)
    top = float(np.percentile(percent[percent > 0.0], over_time.COLOUR_PERCENTILE))
    image = plane.draw_map(axes, x, y, percent, cmap="Reds", vmin=0.0, vmax=top)
    figure.colorbar(image, ax=axes, label="steps in contact [%]", extend="max", location="top", aspect=30)
    plane.outline(axes, (1.0, plane.aspect(result)), "k")
    steps = len(result.steps("time"))
    motion, _, rest = style.conditions([result]).rpartition(", a = ")  # too long for one line
    style.set_title(figure, f"{result.attrs['title']}: {steps} steps", motion, f"a = {rest}")
    return figure


def save_movie(result: Result, options: argparse.Namespace, path: Path) -> None:
    """Write maps of pressure and film of at most `over_time.MAX_FRAMES` frames with common colours."""
    chosen, window = (
        style.spread(len(result.time), over_time.MAX_FRAMES),
        frames.view([result], options.window),
    )
    first = plane.PlaneFrame.of(result, 0, window)
    figure, axes = style.new_figure(1, 2, (plane.WIDTH, plane.map_height(first) + MOVIE_MARGIN))
    frame = plane.PlaneFrame.of(result, frames.frame_to_show(result), window)  # which determines the colours
    images = plane.draw_maps(figure, axes, frame)
    writer = PillowWriter(fps=over_time.RATE)
    with replacing(path) as temporary, writer.saving(figure, temporary, over_time.DPI):
        for index in chosen:
            frame = plane.PlaneFrame.of(result, index, window)
            fields = frame.pressure, frame.film, plane.touched(frame.contact)
            for image, values in zip(images, fields, strict=True):
                image.set_data(values)
            style.set_title(figure, *frames.panel_title([result], [index]))
            if index == 0:  # one layout for all frames
                figure.draw_without_rendering()
                figure.set_layout_engine("none")
            writer.grab_frame()
