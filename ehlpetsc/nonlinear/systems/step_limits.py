"""What Newton's steps are kept to: compiled loops over the pairs (q, h).

Steps are limited to `STEP_LIMIT` p0 in any pressure, because the viscosity is exponential in p, and scaled as
a whole, so that linear rows stay satisfied; at cavities and in dry contacts single entries are changed. A
step is what is taken off: the new values are `now - step`, both of shape (nodes, 2).
"""

import numpy as np

from ehlpetsc.compiled import compiled

STEP_LIMIT = 0.3  # largest pressure change of one Newton step, in p0
REFILLED = 1e-9  # pressure in p0 that a cavity, or a gap, gets in the iteration that closes it
OIL_KEPT = 0.2  # of the oil in a cavity that one iteration must leave


def change(model, dry, now, step):
    """Largest change of pressure that a step makes, by the contact model.

    Parameters
    ----------
    model : contact_model.DirectContact or MixedContact
    dry : bool
    now, step : ndarray, shape (nodes, 2)
    """
    if model.yields:
        return yielding_change(now, step, model.stiffness, model.yield_pressure)
    if model.is_mixed:
        return mixed_change(now, step, model.stiffness)
    return largest_change(now, step, model.bound, -np.inf if dry else 0.0)


def keep(model, dry, now, step, opened):
    """Change single entries of a step in place, by the contact model; `opened` as of :func:`cross_gently`."""
    if model.is_mixed:
        cross_gently(now, step, model.stiffness, opened)
        if model.yields:
            yield_gently(now, step, model.stiffness, model.yield_pressure)
    else:
        (let_overlaps_touch if dry else keep_oil)(now, step, model.bound)


@compiled
def largest_change(now, step, bound, least):
    """Largest change of pressure max(q, least), but at nodes that stay in contact: there is no viscosity."""
    largest = 0.0
    for i in range(len(now)):
        q, h, dq, dh = now[i, 0], now[i, 1], step[i, 0], step[i, 1]
        if h > bound or h - dh > bound:
            largest = max(largest, abs(max(q - dq, least) - max(q, least)))
    return largest


@compiled
def keep_oil(now, step, bound):
    """Change steps in place where a cavity fills or would be emptied.

    A cavity that fills gets the pressure `REFILLED`. A void takes at most a part of the oil left: at q = -1
    on a closed gap every derivative is zero. Solids that touch are not held apart by a void.
    """
    for i in range(len(now)):
        q, dq = now[i, 0], step[i, 0]
        if q < 0.0 and q - dq > REFILLED:
            step[i, 0] = q - REFILLED
        elif q - dq < 0.0:
            step[i, 0] = min(dq, q + 1.0 - OIL_KEPT * (1.0 + min(q, 0.0)))
            if now[i, 1] - step[i, 1] <= bound:
                step[i, 0] = q - REFILLED


@compiled
def let_overlaps_touch(now, step, bound):
    """Give nodes of a dry contact a pressure, in place, where the step would make solids overlap.

    SNES puts h = 0 there and then goes by the sign of F = p, which would be rounding.
    """
    for i in range(len(now)):
        if now[i, 1] - step[i, 1] < bound:
            step[i, 0] = min(step[i, 0], now[i, 0] - REFILLED)


@compiled
def mixed_change(now, step, stiffness):
    """Largest change of total pressure in mixed contact, what crosses between gap and contact held there."""
    largest = 0.0
    for i in range(len(now)):
        q, w, new_q, new_w = now[i, 0], now[i, 1], now[i, 0] - step[i, 0], now[i, 1] - step[i, 1]
        solids = 0.0 if w >= 0.0 else stiffness * (max(-new_w, 0.0) + w)
        largest = max(largest, abs(max(new_q, 0.0) - max(q, 0.0) + solids))
    return largest


@compiled
def cross_gently(now, step, stiffness, opened):
    """Change steps in place where solids come to touch or part: both stop just beyond.

    Solids that touch begin with the pressure `REFILLED`; those that part with at most the film `opened`:
    their derivatives are those of the other side. A cavity that fills or empties is held as in
    :func:`keep_oil`.
    """
    for i in range(len(now)):
        q, dq, w, dw = now[i, 0], step[i, 0], now[i, 1], step[i, 1]
        if q < 0.0 and q - dq > REFILLED:
            step[i, 0] = q - REFILLED
        elif q - dq < 0.0:
            step[i, 0] = min(dq, q + 1.0 - OIL_KEPT * (1.0 + min(q, 0.0)))
        if w >= 0.0 and w - dw < 0.0:
            step[i, 1] = w + REFILLED / stiffness
        elif w < 0.0 and w - dw > opened:
            step[i, 1] = w - opened


@compiled
def yielding_change(now, step, stiffness, limit):
    """As :func:`mixed_change`, the pressure bounded by `limit`; where it stays there, the solids' part."""
    largest = 0.0
    for i in range(len(now)):
        new_q, new_w = now[i, 0] - step[i, 0], now[i, 1] - step[i, 1]
        solids = min(stiffness * max(-now[i, 1], 0.0), limit)
        # what crosses to solids that touch is held there, as in mixed_change
        new_solids = min(stiffness * max(-new_w, 0.0), limit) if now[i, 1] < 0.0 else 0.0
        total = min(max(now[i, 0], 0.0) + solids, limit)
        new_total = min(max(new_q, 0.0) + new_solids, limit)
        change = abs(new_total - total)
        if total == limit and new_total == limit:
            change = abs(new_solids - solids)
        largest = max(largest, change)
    return largest


@compiled
def yield_gently(now, step, stiffness, limit):
    """Change steps in place where solids begin or cease to yield: both stop just beyond.

    The excess is what oil and solids would carry over `limit`. Where they yield and there is oil, q tells
    of the excess and the oil has what the solids leave; oil that they leave nothing is a void from then on,
    under which w tells of the excess, and the other way round.
    """
    for i in range(len(now)):
        q, new_q = now[i, 0], now[i, 0] - step[i, 0]
        solids, new_solids = stiffness * max(-now[i, 1], 0.0), stiffness * max(-now[i, 1] + step[i, 1], 0.0)
        yields = max(q, 0.0) + solids > limit
        by_oil = yields and q > 0.0
        excess = (new_q if by_oil else max(new_q, 0.0)) + new_solids - limit
        if not yields and excess <= 0.0:
            continue
        if yields != (excess > 0.0):
            excess = -REFILLED if yields else REFILLED
            if (solids > 0.0) != (new_solids > 0.0):  # both at once would be taken back in the next one
                excess, new_solids = REFILLED, max(solids, REFILLED)
        if by_oil or new_q > 0.0:
            if new_solids < limit - REFILLED:
                new_q = limit + excess - new_solids
            elif by_oil:
                new_q, new_solids = -REFILLED, limit + excess
            else:
                new_solids = limit - REFILLED
                new_q = excess + REFILLED
        else:
            new_solids = limit + excess
        step[i, 0] = q - new_q
        if new_solids > 0.0:
            step[i, 1] = now[i, 1] + new_solids / stiffness
