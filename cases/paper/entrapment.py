"""Oil trapped between two contacts, a pressure maximum there: figure 5 of Holmes et al. (2005).

``ehlpetsc python cases/paper/entrapment.py fig5.h5 [-o PICTURE]`` draws the strongest one at four instants.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.api import Result, read_result
from ehlpetsc.pictures.frames import deformed_heights
from ehlpetsc.results.contacts import in_contact

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
    frames, nodes = np.nonzero(in_contact(result, slice(0, len(result.time))))
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
    figure = Figure(figsize=(13.4, 5.6), layout="constrained")
    axes = figure.subplots(2, 4, sharex="col", sharey="row")
    x, a = result.x / result.attrs["a"], result.attrs["a"]
    for (upper, lower), (frame, centre) in zip(axes.T, instants(result, event), strict=True):
        view = np.abs(result.x - centre) <= 0.5 * VIEW * a
        touching = in_contact(result, frame) & view
        pressure = 1e-9 * result.frame("pressure", frame)
        below, above = (1e6 * heights for heights in deformed_heights(result, frame))
        upper.plot(x[view], pressure[view], color="k", lw=1.1)
        upper.plot(x[touching], pressure[touching], "rv", ms=4)
        lower.plot(x[view], above[view], x[view], below[view], color="k", lw=1.0)
        lower.plot(x[touching], below[touching], "rv", ms=4)
        upper.set_title(f"{1e6 * result.time[frame]:.2f} µs", fontsize="medium")
        lower.set(xlabel="x/a", xlim=(centre / a - VIEW / 2.0, centre / a + VIEW / 2.0))
    axes[0, 0].set(ylabel="pressure [GPa]", ylim=(0.0, None))
    axes[1, 0].set_ylabel("surfaces [µm]")
    figure.suptitle(result.attrs["title"], fontsize="medium")
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
        draw(result, found[0]).savefig(chosen.output, dpi=160)


if __name__ == "__main__":
    main()
