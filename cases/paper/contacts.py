"""Contacts per millisecond along the contact: figure 7 of Holmes et al. (2005).

``./run_mpi.sh python cases/paper/contacts.py fig7.series.json [-o PICTURE]`` prints contacts per millisecond
and node (Q, mean of abs(x) < a, of its inlet quarter and exit half), length in contact and maximum pressure,
and draws Q with the paper's polynomial of order 8. Each time step in contact counts: Q rises with their
number.
"""

from __future__ import annotations

import argparse
import contextlib
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.api import Result
from ehlpetsc.pictures import style
from ehlpetsc.results.index import distinguishing_names, in_order, open_all

ORDER = 8  # of the polynomial


def rate(result: Result) -> np.ndarray:
    """Contacts per millisecond at each node, mean over the run, shape (nx,)."""
    return result.contact_count / (1e3 * np.nansum(result.steps("dt")))


def mean_rate(result: Result, low: float = -1.0, high: float = 1.0) -> float:
    """Contacts per millisecond and node, mean over low <= x/a <= high."""
    x = result.x / result.attrs["a"]
    return float(rate(result)[(x >= low) & (x <= high)].mean())


def contact_length(result: Result) -> float:
    """Length in contact [m], mean over time."""
    dt, nodes = result.steps("dt")[1:], result.steps("contacts")[1:]
    return float((dt * nodes).sum() / dt.sum() * np.diff(result.x).mean())


def draw(results: list[Result]) -> Figure:
    """Q along the contact: above as counted, below its polynomial."""
    figure, (upper, lower) = style.new_figure(2, 1, (8.4, 5.6), sharex=True)
    colours, names, key = style.series_colours(results)
    for result, name, colour in zip(results, names, colours, strict=True):
        x, counted = result.x / result.attrs["a"], rate(result)
        inside = np.abs(x) <= 1.0
        fit = np.polynomial.Polynomial.fit(x[inside], counted[inside], ORDER)
        upper.plot(x, counted, color=colour, lw=0.6)
        label = f"{name}: {mean_rate(result):.3g}"
        lower.plot(x[inside], fit(x[inside]), color=colour, lw=1.4, label=label)
    upper.set(ylabel="contacts per ms", xlim=(-1.5, 1.5), ylim=(0.0, None))
    lower.set(ylabel=f"polynomial of order {ORDER}", xlabel=style.ACROSS, ylim=(0.0, None))
    varied = f"{style.LABELS.get(key, key)}: " if key else ""
    style.legend_beside(lower, title=f"{varied}mean\nin abs(x) < a [1/ms]")
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results))
    return figure


def main(words: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("results", nargs="+", type=Path, help="index of a series, or results")
    parser.add_argument("-o", "--output", type=Path, default=Path("contacts.png"))
    chosen = parser.parse_args(words)
    with contextlib.ExitStack() as stack:
        results = in_order(open_all(chosen.results, stack))
        names = distinguishing_names(results) or [result.path.stem for result in results]
        print(f"{'result':30} {'Q, 1/ms':>8} {'inlet':>8} {'exit':>8} {'length/a':>9} {'p_max/GPa':>9}")
        for result, name in zip(results, names, strict=True):
            means = (mean_rate(result), mean_rate(result, -1.0, -0.5), mean_rate(result, 0.0))
            length, highest = contact_length(result) / result.attrs["a"], 1e-9 * result.steps("p_max").max()
            print(f"{name:30} {means[0]:8.2f} {means[1]:8.2f} {means[2]:8.2f} {length:9.5f} {highest:9.3f}")
        style.save(draw(results), chosen.output)
        print(chosen.output)


if __name__ == "__main__":
    main()
