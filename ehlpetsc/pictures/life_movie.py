"""Movie of a life: both profiles and the damage below them, a frame for each solved round."""

import numpy as np

from ehlpetsc.pictures.life import under_profile
from ehlpetsc.pictures.movies import recording

FRAMES_PER_ROUND = 3  # frames that a round is shown


def save_movie(life, path):
    """Write the movie.

    Parameters
    ----------
    life : history.LifeHistory
    path : Path
        GIF, or MP4 and WebM where ffmpeg is installed.

    Raises
    ------
    OutputError
    """
    from matplotlib import pyplot

    if not life.rows:
        raise OSError(f"{path}: not written, no pass is solved yet")
    figure = pyplot.figure(figsize=(9.0, 6.5), layout="constrained")
    grid = figure.subplots(3, 1, height_ratios=(3, 3, 2))
    try:
        with recording(figure, path) as writer:
            for row in range(len(life.rows)):
                _draw(figure, grid, life, row)
                for _ in range(FRAMES_PER_ROUND):
                    writer.grab_frame()
    finally:
        pyplot.close(figure)


def _draw(figure, grid, life, row):
    for axes in grid:
        axes.clear()
    for k, axes in enumerate(grid[:2]):
        image = under_profile(axes, life.bodies[row][k])
        axes.set_title(f"surface {k + 1}", fontsize="small")
    if row == 0:
        figure.colorbar(image, ax=list(grid[:2]), label="log10 D")
    passes = life("passes")
    for k, colour in zip((1, 2), ("#1f4e79", "#e08214"), strict=True):
        for name, style in (("damage", "-"), ("pitted_share", "--")):
            label = f"{'largest D' if name == 'damage' else 'pitted share'}, surface {k}"
            grid[2].plot(passes, life(f"{name}_{k}"), style, color=colour, lw=1.0, label=label)
    grid[2].axvline(passes[row], color="k", lw=0.8)
    top = 1.05 * max(
        1.0, *(np.max(life(f"{name}_{k}")) for name in ("damage", "pitted_share") for k in (1, 2))
    )
    grid[2].set(xscale="log", xlabel="passes", ylabel="D, share", ylim=(0.0, min(top, 2.0)))
    grid[2].legend(fontsize="x-small", loc="upper left")
    figure.suptitle(f"{life.title}: {passes[row]:,} passes", fontsize=10)
    if row == 0:  # fixed layout: the axes do not move between frames
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
