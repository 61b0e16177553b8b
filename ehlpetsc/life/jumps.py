"""Jumps: both bodies after many passes like those of a solved round, and how many rounds are to come."""

import numpy as np

from ehlpetsc.life import laws

MOST_EXPECTED = 200  # rounds looked ahead one by one


class Jumps:
    """Size of the jumps of a life, and bodies after them.

    Parameters
    ----------
    life : case.tables.life.Life
    rq : float
        Combined root mean square roughness [m].
    """

    def __init__(self, life, rq):
        self.life, self.passes = life, int(life.passes)
        self.wear_allowed = life.wear_jump * rq

    def is_yielding(self, yielded):
        """Whether passes yield so much [m] that each is solved: plastic deformation is not multiplied."""
        return yielded > self.wear_allowed

    def take(self, bodies, one, done):
        """Jump with a solved round.

        Parameters
        ----------
        bodies : pair of body.LifeBody
        one : rounds.Round
        done : int
            Passes before it.

        Returns
        -------
        bodies : pair of body.LifeBody
        jump : int
            Passes of the jump, those of the round among them.
        rates : pair of (ndarray, ndarray, float)
            As of `rounds.Round.rates`.
        """
        rates, left = one.rates(bodies), self.passes - done
        jump = left
        for body, (wear, added, _) in zip(bodies, rates, strict=True):
            there = np.where(body.is_there, body.damage, np.nan)
            allowed = self.wear_allowed, self.life.damage_jump
            jump = laws.passes_to_jump(jump, wear, allowed[0], added, there, allowed[1])
        jump = min(left, max(1 if self.is_yielding(one.yielded) else jump, len(one.passes)))
        after = tuple(
            body.after(wear, added, jump, done, self.life.pits, volume)
            for body, (wear, added, volume) in zip(bodies, rates, strict=True)
        )
        return after, jump, rates

    def expected_rounds(self, bodies, one, done):
        """Rounds to be solved until the life is over, if all are like this one.

        Parameters
        ----------
        bodies : pair of body.LifeBody
        one : rounds.Round
        done : int
        """
        rounds, jump = 0, 1
        while done < self.passes and rounds < MOST_EXPECTED:
            bodies, jump, _ = self.take(bodies, one, done)
            rounds, done = rounds + 1, done + jump
        return rounds + -(-(self.passes - done) // jump)
