"""Error of the quantities of a case against the time that its meshes take."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ehlpetsc.analysis.convergence import Convergence
from ehlpetsc.pictures import style

PANEL_WIDTH, HEIGHT = 4.2, 4.0  # inches
MIN_ERROR = 1e-4  # drawn of smaller ones [%]


def draw(title: str, cases: Sequence[Convergence], path: Path) -> None:
    """Draw a panel for each case: errors on three meshes, and the bar of the extrapolated value at their sum.

    Quantities without an order are left out.
    """
    figure, panels = style.new_figure(1, len(cases), (PANEL_WIDTH * len(cases) + 1.5, HEIGHT), sharey=True)
    for panel, case in zip([panels] if len(cases) == 1 else panels, cases, strict=True):
        shown = [name for name, found in case.limits.items() if found.is_extrapolated and found.value]
        for name, colour in zip(shown, style.shades(len(shown)), strict=True):
            found = case.limits[name]
            errors = [max(100.0 * abs(value / found.value - 1.0), MIN_ERROR) for value in case.values[name]]
            panel.plot(case.seconds, errors, "o-", color=colour, lw=1.2, ms=4, label=name)
            bar = max(100.0 * abs(found.bar / found.value), MIN_ERROR)
            panel.plot(sum(case.seconds), bar, "D", color=colour, ms=5, mfc="none")
        panel.set(xscale="log", yscale="log", xlabel="time of the steps [s]", title=case.name)
        panel.set_xticks([*case.seconds, sum(case.seconds)])
        panel.xaxis.set_major_formatter("{x:.3g}")
        panel.set_xticks([], minor=True)
        panel.yaxis.set_major_formatter("{x:g}")
        panel.grid(lw=0.3)
        if shown:
            style.legend_beside(panel, title="dots: meshes\ndiamond: all three,\nbar of the limit")
    (panels if len(cases) == 1 else panels[0]).set_ylabel("error [%]")
    style.set_title(figure, title)
    style.save(figure, path)
