"""Oil trapped between two contacts, a pressure maximum there: figure 5 of Holmes et al. (2005).

``./run_mpi.sh python cases/paper/entrapment.py fig5.h5 [-o PICTURE]`` draws the strongest one at four
instants.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.api import Result, read_result
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames import line
from ehlpetsc.pictures.frames.data import PRESSURE_LABEL

MIN_GAP_NODES = 3  # mesh spacings between the contacts: two nodes of oil
MAX_GAP = 0.05  # half-widths between the contacts
INTERVAL = 30  # time steps between two instants of the picture
VIEW = 0.12  # half-widths


@dataclass(frozen=True)
class Entrapment:
    """Nodes of two contacts in one frame and of the pressure maximum between them."""

    frame: int
    left: int
    right: int
    peak: int
    excess: float  # maximum over the higher pressure of both contacts, minus 1


def find(result: Result) -> list[Entrapment]:
    """Entrapments of all stored frames, in the order of falling excess pressure."""
    frames, nodes = np.nonzero(result.contacts_at(slice(0, len(result.time))))
    widest = MAX_GAP * result.attrs["a"] / float(np.diff(result.x).min())
    gaps = np.diff(nodes)
    pairs = np.flatnonzero((np.diff(frames) == 0) & (gaps >= MIN_GAP_NODES) & (gaps <= widest))
    found = []
    for frame, left, right in zip(frames[pairs], nodes[pairs], nodes[pairs + 1], strict=True):
        pressure = result["pressure"][frame, left : right + 1].astype(float)
        peak, highest, rise = int(np.argmax(pressure)), max(pressure[0], pressure[-1]), np.diff(pressure)
        is_single = (rise[:peak] > 0.0).all() and (rise[peak:] < 0.0).all()
        if 0.0 < highest < pressure[peak] and is_single:
            event = Entrapment(
                int(frame), int(left), int(right), int(left) + peak, float(pressure[peak] / highest - 1.0)
            )
            found.append((event.excess * pressure[peak], event))
    return [event for _, event in sorted(found, key=lambda pair: -pair[0])]


def instants(result: Result, event: Entrapment, interval: int = INTERVAL) -> list[tuple[int, float]]:
    """Four frames, of which the third shows the entrapment, and the position [m] of its oil in each."""
    at, x = result.time[event.frame], result.x[event.peak]
    speed, step = 0.5 * (result.attrs["u1"] + result.attrs["u2"]), float(np.nanmax(result.steps("dt")))
    frames = [result.nearest_frame(time=at + interval * step * k) for k in (-2, -1, 0, 1)]
    return [(frame, float(x + speed * (result.time[frame] - at))) for frame in frames]


def draw(result: Result, event: Entrapment) -> Figure:
    """Pressure and both deformed surfaces at four instants, contacts marked."""
    figure, axes = style.new_figure(2, 4, (13.4, 5.6), sharex="col", sharey="row")
    x, a = result.x / result.attrs["a"], result.attrs["a"]
    heights = []
    for (upper, lower), (frame, centre) in zip(axes.T, instants(result, event), strict=True):
        view = np.abs(x - centre / a) <= 0.5 * VIEW
        touching = result.contacts_at(frame) & view
        pressure, (below, _) = 1e-9 * result.frame("pressure", frame), line.deformed_heights(result, frame)
        line.deformed_surfaces(lower, result, frame, (x[view][0], x[view][-1]))
        lower.get_legend().remove()
        heights += lower.get_ylim()
        upper.plot(x[view], pressure[view], color=style.SINGLE, lw=1.1)
        marks = dict(color=style.CONTACTS, ms=4)
        upper.plot(x[touching], pressure[touching], "v", **marks)
        lower.plot(x[touching], 1e6 * below[touching], "v", **marks)
        upper.set_title(f"{1e6 * result.time[frame]:.1f} µs", fontsize="medium")
        upper.set_xlim(x[view][0], x[view][-1])
    axes[0, 0].set_ylim(bottom=0.0)
    axes[1, 0].set_ylim(min(heights), max(heights))
    axes[0, 0].set_ylabel(PRESSURE_LABEL)
    for panel in axes[1, 1:]:
        panel.set_ylabel("")
    style.set_title(figure, str(result.attrs["title"]), style.conditions([result]))
    return figure


def main(words: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("result", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("entrapment.png"))
    chosen = parser.parse_args(words)
    with read_result(chosen.result) as result:
        found = find(result)
        if not found:
            raise SystemExit(
                f"{chosen.result}: no pressure maximum between two contacts {MAX_GAP} a apart or less"
            )
        style.save(draw(result, found[0]), chosen.output)
        print(chosen.output)


if __name__ == "__main__":
    main()
