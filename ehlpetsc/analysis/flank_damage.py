"""Fatigue damage of both flanks by arc length, from a post-processed gear run."""

from pathlib import Path

import numpy as np

from ehlpetsc.results.post_result import PostResult

FLANKS = ("pinion", "wheel")  # surfaces 1 and 2
MAX_DEPTHS = 4  # in the picture


class FlankDamage:
    """Damage of one engagement along both flanks, from ``RESULT.post.h5``.

    Attributes
    ----------
    depths
        [m], shape (nz,).
    arcs
        Arc lengths from A along the flanks of pinion and wheel [m], increasing.
    damage
        Of pinion and wheel, shape (nz, ns); nan for points that did not pass the whole contact, None for a
        flank without damage.
    """

    def __init__(self, file: str | Path, profile_offsets: tuple[float, float]) -> None:
        """`profile_offsets` are the arc lengths from A at which the flanks are at x = 0 at time 0 [m]."""
        post = PostResult(file)
        self.depths = post.z * post.a
        self.damage = [post.damage[side][:, ::-1] if side in post.damage else None for side in ("1", "2")]
        self.arcs = [begin - post.s[::-1] for begin in profile_offsets]

    def lines(self) -> list[str]:
        """Lines of text: maximum damage of each flank with its position and depth."""
        lines = []
        for flank, damage, arc in zip(FLANKS, self.damage, self.arcs, strict=True):
            if damage is None or not np.isfinite(damage).any():
                continue
            depth, point = np.unravel_index(np.nanargmax(damage), damage.shape)
            lines.append(
                f"largest damage of the {flank}: {damage[depth, point]:.3g} at an arc length of "
                f"{1e3 * arc[point]:.3f} mm from A, {1e6 * self.depths[depth]:.1f} um deep"
            )
        return lines

    def draw(self, pair, target, title):
        """Draw the damage along both flanks into a file.

        Parameters
        ----------
        pair : ehlpetsc.gears.geometry.GearPair
        target : path-like
        title : str
        """
        import matplotlib as mpl
        from matplotlib.figure import Figure

        figure = Figure(figsize=(7.0, 6.0), layout="constrained")
        chosen = np.unique(np.linspace(0, len(self.depths) - 1, MAX_DEPTHS).round().astype(int))
        for k, axis in enumerate(figure.subplots(2, 1)):
            for number, depth in enumerate(chosen):
                if self.damage[k] is not None:
                    colour = mpl.colormaps["viridis"](0.9 * number / max(len(chosen) - 1, 1))
                    label = f"{1e6 * self.depths[depth]:.0f} um deep"
                    axis.semilogy(
                        1e3 * self.arcs[k], self.damage[k][depth], color=colour, linewidth=0.7, label=label
                    )
            for name, rho in pair.points.items():
                arc = 1e3 * float(pair.flank_arcs(rho)[k])
                axis.axvline(arc, color="0.7", linewidth=0.8)
                axis.annotate(name, (arc, 1.02), xycoords=("data", "axes fraction"), ha="center")
            axis.set_ylabel(f"damage of an engagement,\n{FLANKS[k]}")
            axis.set_xlabel("arc length along the flank from A [mm]")
            axis.grid(alpha=0.3)
        if self.damage[0] is not None:
            figure.axes[0].legend(fontsize=8)
        figure.suptitle(title, fontsize=10)
        figure.savefig(target, dpi=120)
