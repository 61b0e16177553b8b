"""Initial guesses of steady solutions: Hertz pressure with an even film, flooded or starved."""

import numpy as np

from ehlpetsc.discretisation.elasticity import fast_length

SMOOTHING = 0.2  # width of the smoothing of the pressure in lengths of the inlet sweep
MAX_DIRECT_REACH = 1000  # nodes on either side: for longer weights a transform is faster than the sum
AMBIENT = 1e-6  # p0: pressure of full oil at ambient pressure in a guess


def undeformed_gap(problem, inputs):
    """Undeformed gap of a step without the parabola of the reference radius, in a^2/R."""
    change = problem.scales.R / inputs.conditions.radius - 1.0
    return inputs.phi + 0.5 * change * problem.x**2


def load_of(problem, inputs):
    """Load of a step over the load of the scales."""
    return inputs.load_share * (inputs.conditions.load / problem.scales.load)


def hertz_start(problem, film, inputs, thick=1.3):
    """Hertz pressure with a film above the expected one at every node; downstream of the contact a cavity.

    The pressure is smoothed over `SMOOTHING` times the length of the inlet sweep, film^(2/3): the infinite
    slope at the edge of the Hertz pressure would dominate the flow through a thick film.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    film : float
        Expected film in a^2/R.
    inputs : ehl_problem.StepInputs
    thick : float
        Film over the expected film.

    Returns
    -------
    q, w : ndarray, shape (nx,)
    h00 : float
    """
    x, load = problem.x, load_of(problem, inputs)
    width_2 = load * (inputs.conditions.radius / problem.scales.R)
    p = np.sqrt(np.maximum(width_2 - x**2, 0.0))
    if problem.fluid is not None:
        p = smoothed(p, SMOOTHING * film ** (2.0 / 3.0) / problem.dx)
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
    """Convolution of p, zero outside the mesh, with a Gaussian of a width in nodes.

    `scipy.ndimage.gaussian_filter1d` would load 14 MB that a smooth contact does not need otherwise.
    """
    reach = min(int(4.0 * width + 0.5), len(p) - 1)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    weights /= weights.sum()
    if reach <= MAX_DIRECT_REACH:
        return np.convolve(p, weights)[reach : reach + len(p)]
    length = fast_length(len(p) + 2 * reach)
    product = np.fft.irfft(np.fft.rfft(p, length) * np.fft.rfft(weights, length), length)
    return np.maximum(product[reach : reach + len(p)], 0.0)


def starved_start(problem, film, inputs):
    """Hertz pressure and the oil film of the inlet, with void where the gap of the inlet is wider."""
    oil = inputs.inlet_film
    q, w, h00 = hertz_start(problem, min(film, oil), inputs)
    h = problem.model.state(q, w).film
    void = (problem.x < -1.0) & (h > oil)
    return np.where(void, oil / h - 1.0, q), w, h00
