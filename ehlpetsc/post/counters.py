"""Counters of stress histories: damage of the paper, then other criteria."""

import numpy as np

from ehlpetsc.post.fatigue.accumulate import Counter

PAPER = Counter.columns


class Counters:
    """Columns of results from blocks of histories.

    Parameters
    ----------
    settings : ehlpetsc.post.inputs.settings.Settings
    surface : str
    counting : Counting
    criteria : sequence of str
        Names in :data:`ehlpetsc.post.criteria.CRITERIA`.
    samples : int
        Longest history.
    """

    def __init__(self, settings, surface, counting, criteria, samples):
        material = settings.material(surface)
        self.parts = [(Counter(material, counting, samples), len(PAPER))]
        for name in criteria:
            from ehlpetsc.post.criteria.search import counter_of  # slow to compile: only if requested

            counter = counter_of(
                name, material, settings.criteria, counting.residue, counting.strain, samples
            )
            self.parts.append((counter, len(counter.columns)))

    def __call__(self, stress, lengths, out, residual=0.0):
        """Stress (points, 3, samples), lengths (points,) -> out (points, columns); `residual` in Pa."""
        first = 0
        for counter, width in self.parts:
            values = np.empty((len(out), width))
            counter(stress, lengths, values, residual)
            out[:, first : first + width] = values
            first += width


def columns(criteria):
    """Pairs (criterion, column) of the other criteria, in the order of the results."""
    if not criteria:
        return []
    from ehlpetsc.post.criteria.search import columns_of  # as above

    return [(name, column) for name in criteria for column in columns_of(name)]
