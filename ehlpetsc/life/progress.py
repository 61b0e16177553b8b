"""Progress of a life: a line before it and one after each solved round."""

PACE_WEIGHT = 0.5  # of the last round in the mean time of a round


def opening_line(case, scales, scene, positions):
    """Line before the first round: passes of a round, steps and expected run time of a pass.

    Parameters
    ----------
    case : case.loading.Case
    scales : physics.scales.Scales
    scene : effects.effect.Scene
    positions : int
        Of surface 2.
    """
    from ehlpetsc.run.preview import forecast

    seconds = forecast.work_time(case, scales, scene.roughness)
    rounds = f"rounds of {positions} passes" if positions > 1 else "rounds of one pass"
    steps = scene.operation.step_count(scales.dt)
    return f"{rounds}, each of {steps} steps and {_time(seconds)} on one rank"


class Progress:
    """Lines after solved rounds, with the expected number of remaining rounds and their time.

    Parameters
    ----------
    passes : int
        Of the life.
    """

    def __init__(self, passes):
        self.passes, self._pace, self._rounds = passes, 0.0, 0

    def line(self, history, seconds, remaining):
        """Line of the last row.

        Parameters
        ----------
        history : history.LifeHistory
        seconds : float
            Wall clock time of its round.
        remaining : (int, int)
            Least and largest number of rounds expected, as of `jumps.Jumps.expected_rounds`.
        """
        # the first round also loads compiled code
        self._pace = seconds if self._rounds < 2 else PACE_WEIGHT * seconds + (1.0 - PACE_WEIGHT) * self._pace
        self._rounds += 1
        row = history.rows[-1]
        shown = [f"{row['passes']:.4g} passes of {self.passes:.4g}, {history.solved} solved"]
        for k in (1, 2):
            shown.append(
                f"surface {k}: D {row[f'damage_{k}']:.3g}, {row[f'pits_{k}']} pits on "
                f"{row[f'pitted_share_{k}']:.1%}, worn {1e12 * row[f'wear_volume_{k}']:.4g} um^2, "
                f"Ra {1e6 * row[f'ra_{k}']:.4f} um"
            )
        shown.append(f"friction {row['friction']:.4f}, {_time(seconds)}")
        fewest, most = remaining
        if most:
            rounds = f"{fewest} to {most}" if fewest < most else f"{most}"
            shown.append(f"remaining: {rounds} rounds, {_time(fewest * self._pace)} or more")
        return "; ".join(shown)


def _time(seconds):
    if seconds < 90.0:
        return f"{seconds:.0f} s" if seconds >= 10.0 else f"{seconds:.1f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
