"""Pressure and film or another field over time as a GIF, with common axes and colours."""

from __future__ import annotations

import argparse
from pathlib import Path

from matplotlib.animation import PillowWriter
from matplotlib.figure import Figure

from ehlpetsc.pictures import frames, style
from ehlpetsc.pictures.frame_data import common
from ehlpetsc.results.output_guard import replacing
from ehlpetsc.results.reader import Result

MAX_FRAMES = 150
RATE = 15  # frames per second
DPI = 80


def save_movie(results: list[Result], options: argparse.Namespace, path: Path) -> None:
    """Write at most `MAX_FRAMES` frames of the first result, of others those at the same travel."""
    window, first = frames.view(results, options.window), results[0]
    chosen = [
        frames.Choice(results, frames.choose_frames(results, time=first.time[k]), window, options.field)
        for k in style.spread(len(first.time), MAX_FRAMES)
    ]
    limits = common(frame.limits for choice in chosen for frame in choice.frames)
    figure, kind = Figure(layout="constrained"), chosen[0].module
    axes = kind.movie_panels(figure, chosen[0].frames[0], limits)
    writer = PillowWriter(fps=RATE)
    with replacing(path) as temporary, writer.saving(figure, temporary, DPI):
        for choice in chosen:
            for panel in axes:
                panel.clear()
            kind.fill(axes, choice, limits)
            style.set_title(figure, *choice.title)
            if choice is chosen[0]:  # one layout for all frames
                figure.draw_without_rendering()
                figure.set_layout_engine("none")
            writer.grab_frame()
