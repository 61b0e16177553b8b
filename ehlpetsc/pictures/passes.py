"""Pictures of passes of one body: damage per pass with its scatter, and passes to Miner's sum 1."""

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.pictures import damage_panels as plots
from ehlpetsc.post.passes import pass_statistics, same_points


def passes_picture(results, surface):
    """Damage per pass along the surface at the worst depth, and fraction of points with Miner's sum 1."""
    s, damages = same_points(results, surface)
    statistics = pass_statistics(damages)
    worst = int(statistics.mean.max(axis=1).argmax())
    figure = Figure(figsize=(8, 5.4), layout="constrained")
    top, bottom = figure.subplots(2, 1, height_ratios=(1.3, 1))
    x = plots.along_body(results[0], surface, s)
    top.fill_between(
        x,
        damages[:, worst].min(axis=0),
        statistics.largest[worst],
        color="#4477aa",
        alpha=0.3,
        lw=0,
        label="least to largest of the passes",
    )
    top.plot(x, statistics.mean[worst], color=plots.DARK, lw=0.8, label="mean D of a pass")
    top.set_yscale("log")
    top.set_xlabel(plots.body_label(surface))
    top.set_ylabel("D of a pass")
    first, scatter = statistics.life[worst].min(), np.median((statistics.deviation / statistics.mean)[worst])
    top.set_title(
        f"surface {surface}, z/a = {results[0].z[worst]:g}, {len(results)} passes, "
        f"{plots.strain_rule(results[0])}: Miner's sum 1 from {first:.3g} passes on\n"
        f"scatter of D from pass to pass, at half of the points below {scatter:.2g} of its mean",
        fontsize=9,
    )
    plots.legend_beside(top)
    fraction = np.arange(1, x.size + 1) / x.size
    with np.errstate(divide="ignore"):
        for row in damages[:, worst]:
            bottom.plot(np.sort(1 / row), fraction, color="0.7", lw=0.7)
    bottom.plot([], [], color="0.7", lw=0.7, label="each pass alone, again and again")
    bottom.plot(
        np.sort(statistics.life[worst]), fraction, color="#cc3311", lw=1.3, label="Miner's sum of all passes"
    )
    bottom.set_xscale("log")
    bottom.set_xlabel("passes: compares points, is no life")
    bottom.set_ylabel("share of points with\nMiner's sum 1 or more")
    bottom.grid(color="0.92")
    plots.legend_beside(bottom)
    return figure
