"""Amount of contact in result files or the index of a series.

``ehlpetsc contacts RESULT.h5 [...]``

One line for each result: contacts per millisecond and node (Q of Holmes et al. 2005, figure 7) in the Hertz
contact, in its inlet quarter and in its exit half, and relative to the first result; mean length in contact
and mean fraction of the load carried there, which do not depend on the number of nodes and steps.
"""

import sys

import numpy as np

from ehlpetsc.analysis.collisions import points_in_contact
from ehlpetsc.results.series_index import command, distinguishing_names, in_order, series_values


def mean_rate(result, low=-1.0, high=1.0):
    """Contacts per millisecond and node, mean over low <= x/a <= high.

    Raises
    ------
    OutputError
        The result is steady.
    """
    x = result.x / result.attrs["a"]
    return float(result.contact_rate()[(x >= low) & (x <= high)].mean())


def contact_length(result):
    """Length in contact [m], mean over time."""
    dt, nodes = result.steps("dt")[1:], result.steps("contacts")[1:]
    return float((dt * nodes).sum() / dt.sum() * np.diff(result.x).mean())


def load_share(result):
    """Fraction of the load carried by contact nodes, mean over the stored frames."""
    frames, nodes = points_in_contact(result)
    force = np.zeros(len(result.time))
    for frame in np.unique(frames):
        force[frame] = result["pressure"][int(frame)].astype(float)[nodes[frames == frame]].sum()
    return float(force.mean() * np.diff(result.x).mean() / np.nanmean(result.steps("load")))


def report(results):
    """Table of the results, one line each."""
    key, values = series_values(results)
    stems = [result.path.stem for result in results]
    names = [f"{value:g}" for value in values] if key else distinguishing_names(results) or stems
    width = max(len(key or "result"), *map(len, names))
    lines = [
        f"{key or 'result':>{width}}    Q/ms  inlet quarter  exit half  to the first"
        "  length/a  load share  p_max/GPa  steps  of them halved"
    ]
    rates = [mean_rate(result) for result in results]
    for name, rate, result in zip(names, rates, results, strict=True):
        steps = len(result.steps("dt")) - 1
        dt = result.steps("dt")[1:]
        halved = int(np.count_nonzero(dt < 0.999 * dt.max()))
        to_first = rate / rates[0] if rates[0] else np.nan
        inlet, end, length = mean_rate(result, -1.0, -0.5), mean_rate(result, 0.0), contact_length(result)
        lines.append(
            f"{name:>{width}} {rate:7.2f} {inlet:14.2f} {end:10.2f} {to_first:13.2f} "
            f"{length / result.attrs['a']:9.5f} {load_share(result):11.5f} "
            f"{1e-9 * np.nanmax(result.steps('p_max')):10.3f} {steps:6d} {halved:15d}"
        )
    return lines


def main(arguments=None):
    """Run the command; returns its exit status: 0 done, 2 bad input."""
    description = __doc__.split("\n")[0]
    name = "ehlpetsc.analysis.contact_statistics"
    return command(name, description, lambda results: report(in_order(results)), arguments)


if __name__ == "__main__":
    sys.exit(main())
