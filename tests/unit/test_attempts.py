"""Attempts of a steady start, what they have cost, and oil at rest beside a gap that it does not fill."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from ehlpetsc.base.errors import NoSteadyStart, SolveFailed
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.stepping import convergence_check, steady_start


@dataclass
class Inputs:
    """Inputs of a solve of oil at rest."""

    inlet_film: float | None
    rests: bool = True
    contact: str | None = None
    load_share: float = 1.0
    leaks: bool = False


def test_attempts_that_fail_and_succeed_count_their_iterations(monkeypatch):
    outcomes = iter([SolveFailed("SNES", "DIVERGED", 7), ("solved", 5), SolveFailed("SNES", "DIVERGED", 11)])

    def solved(*_):
        if isinstance(found := next(outcomes), SolveFailed):
            raise found
        return found

    monkeypatch.setattr(steady_start, "solve_checked", solved)
    monkeypatch.setattr(steady_start, "MAX_ATTEMPTS", 3)
    solver = SimpleNamespace(start_iterations=lambda most: most)
    attempts = steady_start.SolveAttempts(solver, 20, None, 2)
    assert [attempts(None, None) for _ in range(3)] == [None, "solved", None]
    assert attempts.spent == 2 + 7 + 5 + 11
    with pytest.raises(NoSteadyStart, match="3 attempts and 25 Newton iterations; the last .* after 11"):
        attempts(None, None)


def test_roughness_is_added_in_shares_to_the_smooth_solution(monkeypatch):
    """Of the half, less where that fails and more where it does not, up to the whole of both."""
    found = iter([None, "smooth", None, "first", "second", "third", "rough"])

    class Attempt:
        spent, seen = 9, []

        def __call__(self, begin, inputs):
            self.seen.append((begin, *inputs))
            return next(found)

    monkeypatch.setattr(steady_start, "easier", lambda inputs, *shares: shares)
    monkeypatch.setattr(steady_start, "SolveAttempts", lambda *_: Attempt())
    continuation = steady_start.Continuation(None, SimpleNamespace(phi=np.ones(1)))
    assert continuation.solve("guess") == ("rough", 9)
    begun, viscosity, roughness = zip(*Attempt.seen, strict=True)
    assert begun == ("guess", "guess", "smooth", "smooth", "first", "second", "third")
    assert roughness == pytest.approx((1.0, 0.0, 0.5, 0.2, 0.5, 0.95, 1.0))
    assert viscosity == (1.0,) * 7


def test_load_of_yielding_solids_increases_from_the_onset_to_the_whole(monkeypatch):
    """By a fifth, and by half of that where it fails, once guesses of the whole load have failed."""
    failed = (SolveFailed("SNES", "DIVERGED", 5),)
    seen, outcomes = [], iter([*failed * 3, "first", "second", *failed, "third", "whole"])

    def solved(solver, guess, inputs, max_it, watch):
        seen.append((guess, inputs.load_share, inputs.leaks))
        if isinstance(found := next(outcomes), SolveFailed):
            raise found
        return found, 4

    monkeypatch.setattr(steady_start, "solve_checked", solved)
    monkeypatch.setattr(steady_start, "bounded_start", lambda problem, film, inputs, width: width)
    monkeypatch.setattr(steady_start, "hertz_start", lambda problem, film, inputs: "onset")
    problem = SimpleNamespace(model=SimpleNamespace(yield_pressure=0.9))
    solver = SimpleNamespace(problem=problem, start_iterations=lambda most: most)
    assert steady_start.yielding_start(solver, 0.1, Inputs(None)) == ("whole", 4 * 5 + 4 * 4)
    guesses, loads, leaks = zip(*seen, strict=True)
    assert guesses == (0.2, 0.0, 0.2, "onset", "first", "second", "second", "third")
    assert loads == pytest.approx((1, 1, 1, 0.648, 0.7776, 0.93312, 0.85536, 1))
    assert leaks == (False, False, True) + (False,) * 5


def test_step_of_yielding_solids_counts_the_iterations_of_all_its_solves(monkeypatch):
    """It fails, elastic solids are solved for, and it is solved from there."""
    outcomes, seen = iter([SolveFailed("SNES", "DIVERGED", 5), ("elastic", 3), ("solved", 4)]), []

    def solved(solver, guess, inputs, max_it, watch):
        seen.append((guess, inputs.contact))
        if isinstance(found := next(outcomes), SolveFailed):
            raise found
        return found

    monkeypatch.setattr(convergence_check, "solve_checked", solved)
    model = SimpleNamespace(elastic=lambda: "no yield")
    solver = SimpleNamespace(problem=SimpleNamespace(model=model))
    assert convergence_check.solve_step(solver, "guess", Inputs(None)) == ("solved", 12)
    assert seen == [("guess", None), ("guess", "no yield"), ("elastic", None)]


def test_gap_beyond_the_oil_at_rest_is_void(monkeypatch):
    """The oil of an inlet film of 2 fills half of a gap of 4; the solve itself is of a flooded contact."""
    seen, given = [], Unknowns(np.array([0.3, 0.1, -0.2]), np.array([1.0, 2.0, 4.0]), np.zeros(1))

    def solve(guess, inputs, **_):
        seen.append((guess.q.min(), inputs.inlet_film))
        return given._replace(q=np.array([0.5, 0.0, 0.0])), 4

    model = SimpleNamespace(film=lambda q, w: w)
    solver = SimpleNamespace(problem=SimpleNamespace(model=model), solve=solve, residual=None, tolerance=1.0)
    solver.residual = lambda: None
    monkeypatch.setattr(convergence_check, "find_fault", lambda *_: None)
    solution, iterations = convergence_check.solve_checked(solver, given, Inputs(2.0), 20, None)
    np.testing.assert_allclose(solution.q, [0.5, 0.0, -0.5])
    assert seen == [(0.0, None)] and iterations == 4
