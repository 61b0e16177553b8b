"""Initial guesses of steady solutions: dry pressure with an even film, and yielding solids.

The dry contact is Hertz's where bodies and shapes are his, and solved (:mod:`ehlpetsc.elasticity.dry`) where
they are not, and where solids yield under Hertz's pressure: where nearly all nodes in contact yield, Newton's
method alone does not find the set of elastic nodes.
"""

import numpy as np

from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.line.deflection import fast_length
from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.physics.contact.grid import Grid

SMOOTHING = 0.2  # width of the smoothing of the pressure in lengths of the inlet sweep
MAX_DIRECT_REACH = 1000  # nodes on either side: for longer weights a transform is faster than the sum
START_FILM = 1.3  # over the expected film
AMBIENT_PRESSURE = 1e-6  # p0: pressure of full oil at ambient pressure in a guess
STEP_TOLERANCE = 1e-5  # of the yield pressure: smaller changes end the iteration
GUESS_TOLERANCE = 1e-4  # p0: the same without yielding, whose guess oil smooths


def undeformed_gap(problem: EHLProblem, inputs: StepInputs) -> np.ndarray:
    """Undeformed gap of a step without the shapes of the reference radius, in a^2/R."""
    change = problem.scales.R / inputs.conditions.radius - 1.0
    return inputs.phi + change * problem.grid.parabolas


def dry_contact(problem: EHLProblem, inputs: StepInputs) -> tuple[np.ndarray, np.ndarray]:
    """Dry pressure in p0, and the mask of the nodes outside the contact.

    Of homogeneous bodies Hertz's line and ellipse, of a roller by slices; of other shapes and bodies solved.
    """
    grid = problem.grid
    room = grid.room(problem.balance.share(inputs), inputs.conditions.radius / problem.scales.R)
    p = np.sqrt(np.maximum(room, 0.0))
    if grid.is_hertzian and problem.deflection.is_homogeneous:
        return p, room < 0.0
    p = _solved_pressure(problem, inputs, p, GUESS_TOLERANCE)
    return p, p == 0.0


def _solved_pressure(
    problem: EHLProblem, inputs: StepInputs, guess: np.ndarray, tolerance: float, limit: float = np.inf
) -> np.ndarray:
    """Pressure of the dry contact of any shape and bodies in p0."""
    from ehlpetsc.elasticity.dry import dry_pressure  # few contacts are not Hertz's

    balance, deflection = problem.balance, problem.deflection
    gap = balance.gap(balance.uniform(0.0)) + problem.grid.undeformed() + undeformed_gap(problem, inputs)
    total, eigenvalue = balance.load(inputs) / problem.grid.cell, deflection.largest_eigenvalue
    return dry_pressure(gap, total, deflection.integral, eigenvalue, guess, tolerance, limit)


def hertz_start(problem: EHLProblem, film: float, inputs: StepInputs) -> Unknowns:
    """Dry pressure with a film above the expected one at every node; downstream of the contact a cavity.

    The pressure is smoothed over `SMOOTHING` times the length of the inlet sweep, film^(2/3): the infinite
    slope at the edge of the Hertz pressure would dominate the flow through a thick film. `film` is the
    expected one in a^2/R.

    Without entrainment the solids carry the load, in oil at ambient pressure: no flow fills a cavity.
    """
    grid, balance = problem.grid, problem.balance
    p, is_outside = dry_contact(problem, inputs)
    oil_carries = problem.fluid is not None and not inputs.rests
    if oil_carries:
        p = smoothed_over(grid, p, SMOOTHING * film ** (2.0 / 3.0))
    p *= balance.load(inputs) / (grid.cell * p.sum())
    h = problem.film(p, balance.uniform(0.0), undeformed_gap(problem, inputs))
    if not oil_carries:
        lowest = 0.0 if problem.fluid is None else problem.model.minimum_film
        gap = lowest + np.where(p > 0.0, 0.0, np.maximum(h - h[np.argmax(p)], 0.0))
        q, w = problem.model.dry_start(p, gap)
        return Unknowns(q, w, balance.uniform(lowest - h[np.argmax(p)]))
    raised = problem.model.start_film(START_FILM * film) - h.min()
    h += raised
    oil, w = problem.model.oil_start(p, h)
    behind = (problem.x > 0.0) & is_outside & (p < AMBIENT_PRESSURE)
    entrained = film + np.repeat(grid.rows(h).min(axis=1) - h.min(), len(grid.x))  # beside the contact more
    q = np.where(behind, np.minimum(entrained / h - 1.0, 0.0), np.maximum(oil, AMBIENT_PRESSURE))
    return Unknowns(q, w, balance.uniform(raised))


def smoothed_over(grid: Grid, p: np.ndarray, width: float) -> np.ndarray:
    """Flat field p smoothed along each axis by a Gaussian of a width in half-widths."""
    values = p.reshape(grid.shape)
    for axis, step in enumerate(grid.increments):
        values = np.apply_along_axis(smoothed, axis, values, width / step)
    return values.ravel()


def smoothed(p: np.ndarray, width: float) -> np.ndarray:
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


def starved_start(problem: EHLProblem, film: float, inputs: StepInputs) -> Unknowns:
    """Hertz pressure and the oil film of the inlet, with void where the gap of the inlet is wider."""
    oil = inputs.inlet_film
    begin = hertz_start(problem, min(film, oil), inputs)
    h = problem.model.film(begin.q, begin.w)
    void = (problem.x < 0.0) & (problem.grid.distance > 1.0) & (h > oil)
    return begin._replace(q=np.where(void, oil / h - 1.0, begin.q))


def bounded_pressure(problem: EHLProblem, inputs: StepInputs) -> tuple[np.ndarray, np.ndarray]:
    """Pressure of the dry contact of yielding solids in p0, and its gap without the approach in a^2/R."""
    limit, border = problem.model.yield_pressure, problem.balance.uniform(0.0)
    guess = np.sqrt(np.maximum(problem.grid.room(problem.balance.share(inputs), 1.0), 0.0))
    p = _solved_pressure(problem, inputs, guess, STEP_TOLERANCE * limit, limit)
    return p, problem.film(p, border, undeformed_gap(problem, inputs))


def bounded_start(problem: EHLProblem, film: float, inputs: StepInputs, smoothing: float) -> Unknowns:
    """Unknowns of the dry contact; with entrained oil, the oil carries the load on an even film in a^2/R.

    `smoothing` is the width of the smoothing of the oil pressure in lengths of the inlet sweep, film^(2/3).
    """
    model, limit = problem.model, problem.model.yield_pressure
    p, gap = bounded_pressure(problem, inputs)
    oil_carries = problem.fluid is not None and not inputs.rests
    lowest = max(film, model.minimum_film) if oil_carries else model.minimum_film
    elastic = (p > 0.0) & (p < limit)
    raised = lowest - gap[elastic if elastic.any() else p > 0.0].max()
    border = problem.balance.uniform(raised)
    depth = np.where(p < limit, 0.0, np.maximum(lowest - gap - raised, 0.0))
    if not oil_carries:
        carried = p + depth / model.compliance
        return Unknowns(*model.dry_start(carried, gap + raised + depth), border)
    rows = problem.grid.rows
    edge = np.where(rows(p) > 0.0, rows(problem.x), 0.0).max(axis=1)
    if smoothing:
        p = smoothed_over(problem.grid, p, smoothing * film ** (2.0 / 3.0))
    depth[p < limit * (1.0 - 1e-9)] = 0.0
    h = np.maximum(problem.film(p, border, undeformed_gap(problem, inputs)) + depth, lowest)
    behind = (rows(problem.x) > edge[:, None]).ravel() & (p < AMBIENT_PRESSURE)
    oil, w = model.oil_start(p + depth / model.compliance, h)
    q = np.where(behind, np.minimum(lowest / h - 1.0, 0.0), np.maximum(oil, AMBIENT_PRESSURE))
    return Unknowns(q, w, border)
