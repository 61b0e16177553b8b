"""Jumps of a life over the passes in which the rates of a solved round hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ehlpetsc.life.body import MAX_EXTRAPOLATION, LifeBody, Rates
from ehlpetsc.life.rounds import Round

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values

BREAK_OUT_DELAY = 1.1  # longest jump over the allowed one, where it then ends with a break-out


class Jumps:
    r"""Size of the jumps of a life, and bodies after them.

    Rates change smoothly as wear changes the surface, and at once where cells break out. Between two
    break-outs they are extrapolated linearly from the last two rounds,

    .. math:: f(t) = f_n + t\,\frac{f_n-f_{n-1}}{h_{n-1}},\qquad y_{n+1} = y_n + \int_0^{h_n} f\,dt

    (Adams-Bashforth of two steps): the error of wear and damage falls with the square of the jumps. After a
    break-out, in the first jump of all, and if partners drift, rates are constant.

    `rq`: combined root mean square roughness [m].
    """

    def __init__(self, life: Values, rq: float) -> None:
        self.life, self.passes = life, int(life.passes)
        self.wear_allowed = life.wear_jump * rq

    def is_yielding(self, yielded: float) -> bool:
        """Whether a pass yields more [m] than a jump may wear: plastic deformation is not multiplied."""
        return yielded > self.wear_allowed

    def continuous_passes(self, rows: list[dict[str, float]], solved_round: Round) -> int:
        """Passes of the jump of the last row if rates are continuous since the round before it; else 0.

        They are not after a break-out, if partners have drifted or only a part of the positions was solved,
        and where a pass yields.
        """
        if not rows or solved_round.drifts:
            return 0
        last = rows[-1]
        parted = last["broken_out"] or last["solved"] != len(solved_round.passes)
        yields = self.is_yielding(max(last["yielded"], solved_round.yielded))
        return 0 if parted or yields else int(last["jump"])

    def jump(
        self, bodies: tuple[LifeBody, ...], solved_round: Round, done: int, before: int = 0
    ) -> tuple[tuple[LifeBody, ...], int, tuple[Rates, ...]]:
        """Jump with the rates of a solved round, up to the allowed wear or damage or the next break-out.

        `done`: passes before it. `before`: passes of the previous jump if the rates are continuous since;
        else 0.

        Returns
        -------
        jump
            Passes of the jump, including the solved ones.
        """
        rates, max_passes = solved_round.rates(bodies), self.passes - done
        if before:
            rates = tuple(
                rate.continued((body.wear_rate, body.damage_rate, body.volume_rate), before, body.column_area)
                for rate, body in zip(rates, bodies, strict=True)
            )
            max_passes = min(max_passes, int(MAX_EXTRAPOLATION * before))
        pairs = list(zip(bodies, rates, strict=True))
        jump = self._allowed(pairs, solved_round, max_passes)
        return tuple(body.after(rate, jump, done, self.life.break_out) for body, rate in pairs), jump, rates

    def _allowed(self, pairs: list[tuple[LifeBody, Rates]], solved_round: Round, left: int) -> int:
        """Passes until the allowed wear or damage is reached or a cell breaks out, `left` at most."""
        passes: float = 1 if self.is_yielding(solved_round.yielded) else left
        for body, rate in pairs:
            passes = min(passes, body.passes_to(rate, self.wear_allowed, self.life.damage_jump))
        passes = max(int(passes), 1)
        if (rule := self.life.break_out) != "none":
            late = min(left, int(BREAK_OUT_DELAY * passes))
            ends = min(body.passes_to_break_out(rate, late, rule) for body, rate in pairs)
            passes = ends if ends < late else passes
        return min(left, max(int(passes), len(solved_round.passes)))
