"""Warning when a run becomes several times slower than at its beginning."""

import statistics

MEDIAN_STEPS = 20  # steps of a median
SKIPPED_STEPS = 3  # first steps, which include loading and compilation
SLOWDOWN = 3.0  # ratio that causes the warning; contact and thin films alone may double an iteration's time


class SlowSteps:
    """Output that warns when an iteration takes several times as long as at the beginning.

    Ranks wait for each other about twenty times an iteration: if they share cores with other processes, each
    wait lasts until the other rank is scheduled.

    Parameters
    ----------
    ranks : int
    show : callable
        Prints a line.
    """

    def __init__(self, ranks, show):
        self._ranks, self._show = ranks, show
        self._seen, self._first, self._latest, self._warned = 0, [], [], False

    def write(self, state):
        """Compare the latest steps with the first ones, without the steady start."""
        scalars = state.scalars
        if scalars["step"] == 0 or not scalars["newton"]:
            return
        self._seen += 1
        if self._seen <= SKIPPED_STEPS:
            return
        time = scalars["wall"] / scalars["newton"]
        if len(self._first) < MEDIAN_STEPS:
            self._first.append(time)
            return
        self._latest = [*self._latest[1 - MEDIAN_STEPS :], time]
        if len(self._latest) == MEDIAN_STEPS and not self._warned:
            self._compare()

    def close(self, status):
        """Do nothing."""

    def _compare(self):
        now, begun = statistics.median(self._latest), statistics.median(self._first)
        if now < SLOWDOWN * begun:
            return
        self._warned = True
        cure = (
            "one rank waits for no other: -n 1" if self._ranks > 1 else "other work on its core slows it down"
        )
        self._show(
            f"warning: an iteration takes {1e3 * now:.3g} ms, {now / begun:.1f} times what the first steps "
            f"took; is the machine busy otherwise? {cure}"
        )
