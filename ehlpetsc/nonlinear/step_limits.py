"""What Newton's steps are kept to: compiled loops over the pairs (q, h).

Steps are limited to `STEP_LIMIT` p0 in any pressure, because the viscosity is exponential in p, and scaled as
a whole, so that linear rows stay satisfied; at cavities and in dry contacts single entries are changed. A
step is what is taken off: the new values are `now - step`, both of shape (nodes, 2).
"""

from ehlpetsc.compiled import compiled

STEP_LIMIT = 0.3  # largest pressure change of one Newton step, in p0
REFILLED = 1e-9  # pressure in p0 that a cavity, or a gap, gets in the iteration that closes it
OIL_KEPT = 0.2  # of the oil in a cavity that one iteration must leave


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
