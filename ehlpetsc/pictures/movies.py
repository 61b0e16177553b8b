"""Pressure and film over time as a movie: GIF, or MP4 and WebM by ffmpeg."""

import contextlib
import subprocess

import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter

from ehlpetsc.errors import OutputError
from ehlpetsc.pictures.figures import fill_frame, two_panels
from ehlpetsc.pictures.frames import choose_frames
from ehlpetsc.results.atomic_write import replacing

MAX_FRAMES = 150
RATE = 15  # frames per second
DPI = 80
EVEN_SIZE = [
    "-vf",
    "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
    "-pix_fmt",
    "yuv420p",
]  # players refuse odd sizes
CODECS = {".mp4": "libx264", ".webm": "libvpx-vp9"}


def save_movie(results, options, path):
    """Write at most `MAX_FRAMES` frames with common axes.

    Raises
    ------
    OutputError
        The file name does not end like a movie, or the encoder is not installed.
    """
    last = len(results[0].time) - 1
    steps = np.unique(np.linspace(0, last, min(last + 1, MAX_FRAMES)).round().astype(int))
    figure, axes = two_panels()
    limits = _limits(results, steps)
    with recording(figure, path) as writer:
        for number, index in enumerate(steps):
            for panel in axes:
                panel.clear()
            fill_frame(axes, results, choose_frames(results, time=results[0].time[index]), options)
            for panel, limit in zip(axes, limits, strict=True):
                panel.set_ylim(0.0, limit)
            if number == 0:  # the layout of the first frame holds for all, so that the axes do not move
                figure.draw_without_rendering()
                figure.set_layout_engine("none")
            writer.grab_frame()


@contextlib.contextmanager
def recording(figure, path):
    """Context manager of the writer of a movie; its `grab_frame()` adds a frame.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    path : Path

    Yields
    ------
    matplotlib.animation.AbstractMovieWriter

    Raises
    ------
    OutputError
        The file name does not end like a movie, or the encoder is not installed.
    """
    writer = _writer(path)
    with replacing(path, keep_ending=True) as temporary, _encoding(path):
        with writer.saving(figure, temporary, DPI):
            yield writer


@contextlib.contextmanager
def _encoding(path):
    """Convert a failure of the encoder, as on a full disk, to an OutputError."""
    try:
        yield
    except subprocess.CalledProcessError as error:
        lines = str(error.stderr or error.output or "").strip().splitlines() or [f"status {error.returncode}"]
        raise OutputError(f"{path}: not written, its encoder ended: {lines[-1]}") from None


def _writer(path):
    ending = path.suffix.lower()
    if ending == ".gif":
        return PillowWriter(fps=RATE)
    if ending not in CODECS:
        raise OutputError(f"{path}: allowed for a movie: .gif, {', '.join(CODECS)}")
    if not FFMpegWriter.isAvailable():
        raise OutputError(f"{path}: {ending} needs ffmpeg, which is not installed; without it, allowed: .gif")
    return FFMpegWriter(fps=RATE, codec=CODECS[ending], extra_args=EVEN_SIZE)


def _limits(results, frames):
    """Upper limits of the axes [GPa, um] for all pressures and for the film inside the contact."""
    film = 1e-9
    for result in results:
        inside = np.abs(result.x) <= result.attrs["a"]
        shown = [index for index in frames if index < len(result.time)]
        film = max(film, *(result.frame("film_thickness", index)[inside].max() for index in shown))
    pressure = max(np.nanmax(result.steps("p_max")) for result in results)
    return 1.05e-9 * pressure, 1.15e6 * film
