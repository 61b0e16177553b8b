"""First guesses of steady solutions: Hertz pressure under an even film, or behind a starved inlet."""

import numpy as np

from ehlpetsc.discretisation.elasticity import fast_length

SMOOTHED = 0.2
DIRECT = 1000  # nodes on either side: beyond it a transform is quicker than the sum
AMBIENT = 1e-6  # pressure in p0 of oil that is not to begin as a cavity


def undeformed_gap(problem, inputs):
    """Gap of a step's inputs beyond the parabola of the reference radius, in a^2/R."""
    change = problem.scales.R / inputs.conditions.radius - 1.0
    return inputs.phi + 0.5 * change * problem.x**2


def load_of(problem, inputs):
    """Load of a step's inputs over that of the scales."""
    return inputs.load_share * (inputs.conditions.load / problem.scales.load)


def hertz_start(problem, film, inputs, thick=1.3):
    """Hertz pressure and a film everywhere above the expected one; behind the outlet a cavity.

    The pressure is smoothed over `SMOOTHED` times the length of the inlet sweep, film^(2/3): the infinite
    slope at Hertz' edge drives more oil through a thick film than all that follows.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    film : float
        Expected film in a^2/R.
    inputs : ehl_problem.StepInputs
    thick : float
        Times the expected film.

    Returns
    -------
    q, w : ndarray, shape (nx,)
    h00 : float
    """
    x, load = problem.x, load_of(problem, inputs)
    width_2 = load * (inputs.conditions.radius / problem.scales.R)
    p = np.sqrt(np.maximum(width_2 - x**2, 0.0))
    if problem.fluid is not None:
        p = smoothed(p, SMOOTHED * film ** (2.0 / 3.0) / problem.dx)
    p *= 0.5 * np.pi * load / (problem.dx * p.sum())
    h = problem.film(p, 0.0, undeformed_gap(problem, inputs))
    if problem.fluid is None:
        gap = np.where(p > 0.0, 0.0, np.maximum(h - h[np.argmax(p)], 0.0))
        return *problem.model.dry_start(p, gap), -h[np.argmax(p)]
    h00 = problem.model.start_film(thick * film) - h.min()
    h += h00
    oil, w = problem.model.oil_start(p, h)
    behind = (x > np.sqrt(width_2)) & (p < AMBIENT)
    q = np.where(behind, np.minimum(film / h - 1.0, 0.0), np.maximum(oil, AMBIENT))
    return q, w, h00


def smoothed(p, width):
    """Mean of p, zero beyond its ends, under a Gaussian of a width in nodes, cut off at the mesh's length.

    (scipy.ndimage has it, but loads 14 MB, which a smooth contact has no other need of.)
    """
    reach = min(int(4.0 * width + 0.5), len(p) - 1)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    weights /= weights.sum()
    if reach <= DIRECT:
        return np.convolve(p, weights)[reach : reach + len(p)]
    length = fast_length(len(p) + 2 * reach)
    product = np.fft.irfft(np.fft.rfft(p, length) * np.fft.rfft(weights, length), length)
    return np.maximum(product[reach : reach + len(p)], 0.0)


def starved_start(problem, film, inputs):
    """Hertz pressure and the oil film of the inlet, void wherever the gap is wider."""
    oil = inputs.inlet_film
    q, w, h00 = hertz_start(problem, min(film, oil), inputs)
    h = problem.model.state(q, w).film
    void = (problem.x < -1.0) & (h > oil)
    return np.where(void, oil / h - 1.0, q), w, h00
