r"""Roughness parameters of a profile and its Abbott curve.

Ra, Rq, Rsk and Rz after ISO 4287, over the whole profile and, for Rz, as the mean over five equal sampling
lengths; Rk, Rpk and Rvk after ISO 13565-2 from the material ratio curve.
"""

from __future__ import annotations

import numpy as np

SAMPLING_LENGTHS = 5
SECANT_WIDTH = 0.4  # of the material ratio: width of the secant whose least slope defines the core
CURVE_POINTS = 4001  # of the Abbott curve


def abbott_curve(X: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Material ratio curve: heights over the fraction of the profile's length above them.

    `X`, `z`: abscissas, increasing, and heights [m], shape (n,).

    Returns ratio from 0 to 1, heights falling [m], shape (POINTS,).
    """
    even = np.interp(np.linspace(X[0], X[-1], max(len(X), CURVE_POINTS)), X, z)
    ratio = np.linspace(0.0, 1.0, CURVE_POINTS)
    return ratio, np.quantile(even, 1.0 - ratio)


def core(ratio: np.ndarray, height: np.ndarray) -> dict[str, float]:
    r"""Core roughness after ISO 13565-2.

    The secant over 40 % of the material ratio with the least slope, continued to 0 and 100 %, bounds the
    core: :math:`R_k` is its height. :math:`R_{pk}` and :math:`R_{vk}` are the heights of triangles as large
    as the areas of peaks above and valleys below it.

    `ratio`, `height`: see :func:`abbott_curve`.
    Returns "rk", "rpk", "rvk" [m], "mr1", "mr2" (1), "top", "bottom" of the core [m].
    """
    width = round(SECANT_WIDTH * (len(ratio) - 1))
    begin = int(np.argmin(height[:-width] - height[width:]))
    slope = (height[begin + width] - height[begin]) / SECANT_WIDTH
    top = height[begin] - slope * ratio[begin]
    bottom = top + slope
    step = ratio[1] - ratio[0]
    above, below = np.maximum(height - top, 0.0).sum() * step, np.maximum(bottom - height, 0.0).sum() * step
    mr1 = float(np.interp(-top, -height, ratio))
    mr2 = float(np.interp(-bottom, -height, ratio))
    return {
        "rk": float(top - bottom),
        "rpk": float(2.0 * above / mr1) if mr1 > 0.0 else 0.0,
        "rvk": float(2.0 * below / (1.0 - mr2)) if mr2 < 1.0 else 0.0,
        "mr1": mr1,
        "mr2": mr2,
        "top": float(top),
        "bottom": float(bottom),
    }


def roughness_parameters(X: np.ndarray, z: np.ndarray) -> dict[str, float]:
    """Ra, Rq, Rz, Rk, Rpk, Rvk [m] and Rsk (1) of a profile, by lower-case name.

    `X`, `z`: abscissas, increasing, and heights [m], shape (n,).
    """
    deviation = z - z.mean()
    rq = float(np.sqrt((deviation**2).mean()))
    edges = np.linspace(X[0], X[-1], SAMPLING_LENGTHS + 1)
    sections = [z[(X >= low) & (X <= high)] for low, high in zip(edges, edges[1:], strict=False)]
    core_parameters = core(*abbott_curve(X, z))
    return {
        "ra": float(np.abs(deviation).mean()),
        "rq": rq,
        "rz": float(np.mean([np.ptp(section) for section in sections if section.size])),
        "rsk": float((deviation**3).mean() / rq**3) if rq > 0.0 else 0.0,
        **{name: core_parameters[name] for name in ("rk", "rpk", "rvk")},
    }
