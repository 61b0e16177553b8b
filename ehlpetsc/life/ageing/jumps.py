"""Jumps: both bodies after many passes like those of a solved round, and how many rounds are to come."""

from ehlpetsc.life.ageing.rates import LONGER

AWAITED = 1.1  # times what is allowed: a break-out so late still ends the jump
MOST_EXPECTED = 200  # rounds looked ahead one by one


class Jumps:
    """Size of the jumps of a life, and bodies after them.

    Parameters
    ----------
    life : case.tables.post.Life
    rq : float
        Combined root mean square roughness [m].
    """

    def __init__(self, life, rq):
        self.life, self.passes = life, int(life.passes)
        self.wear_allowed = life.wear_jump * rq

    def is_yielding(self, yielded):
        """Whether passes yield so much [m] that each is solved: plastic deformation is not multiplied."""
        return yielded > self.wear_allowed

    def take(self, bodies, one, done, before=0):
        """Jump with a solved round, until the allowed wear or damage is reached or a cell breaks out.

        Parameters
        ----------
        bodies : pair of body.LifeBody
        one : rounds.Round
        done : int
            Passes before it.
        before : int
            Passes of the jump before, where rates go on from it smoothly.

        Returns
        -------
        bodies : pair of body.LifeBody
        jump : int
            Passes of the jump, those of the round among them.
        rates : pair of rates.Rates
        """
        rates, most = one.rates(bodies), self.passes - done
        if before:
            rates = tuple(
                rate.continued((body.wear_rate, body.damage_rate, body.volume_rate), before)
                for rate, body in zip(rates, bodies, strict=True)
            )
            most = min(most, int(LONGER * before))
        jump = self._allowed(bodies, rates, one, most)
        return self._after(bodies, rates, jump, done), jump, rates

    def _after(self, bodies, rates, jump, done):
        return tuple(
            body.after(rate, jump, done, self.life.pits) for body, rate in zip(bodies, rates, strict=True)
        )

    def _allowed(self, bodies, rates, one, left):
        """Passes until the allowed wear or damage is reached or a cell breaks out, `left` at most."""
        most = 1 if self.is_yielding(one.yielded) else left
        for body, rate in zip(bodies, rates, strict=True):
            most = min(most, body.passes_to(rate, self.wear_allowed, self.life.damage_jump))
        most = max(int(most), 1)
        if self.life.pits:
            late = min(left, int(AWAITED * most))
            ends = min(body.passes_to_break_out(rate, late) for body, rate in zip(bodies, rates, strict=True))
            most = ends if ends < late else most
        return min(left, max(most, len(one.passes)))

    def expected_rounds(self, bodies, one, done):
        """Rounds to be solved until the life is over, if all are like this one.

        Columns that break out on the way are taken to carry no more: a pit relieves them.

        Parameters
        ----------
        bodies : pair of body.LifeBody
        one : rounds.Round
        done : int
        """
        rounds, jump, begin = 0, 1, bodies
        while done < self.passes and rounds < MOST_EXPECTED:
            rates = tuple(
                rate.without(body.pit > new.pit)
                for rate, body, new in zip(one.rates(bodies), bodies, begin, strict=True)
            )
            jump = self._allowed(bodies, rates, one, self.passes - done)
            bodies = self._after(bodies, rates, jump, done)
            rounds, done = rounds + 1, done + jump
        return rounds + -(-(self.passes - done) // jump)
