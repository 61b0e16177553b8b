"""LU of a block tridiagonal matrix against numpy's dense solve."""

import numpy as np
import pytest

from ehlpetsc.nonlinear.line.banded_jacobian import FILMS, GROUP, TERMS
from ehlpetsc.nonlinear.line.block_lu import (
    FROM_LEFT,
    FROM_RIGHT,
    LEFT,
    RIGHT,
    ROW_WIDTH,
    SIZE,
    STRIDE,
    BlockLU,
    backward_transposed,
    forward,
)


def by_columns(rows):
    columns = np.zeros((len(rows), ROW_WIDTH, STRIDE))
    columns[:, :, :SIZE] = rows.transpose(0, 2, 1)
    return columns


def solved(lu, b, first=0):
    """Solution for `b` (groups, SIZE); what stands in the room behind them must not matter."""
    room = np.full((len(b), STRIDE), 7.0)
    room[:first], room[:, :SIZE] = 0.0, b
    lu.solve(room.ravel(), first)
    return room[:, :SIZE]


def dense(rows):
    groups = len(rows)
    matrix = np.zeros((groups * SIZE, (groups + 2) * SIZE))
    for i, row in enumerate(rows):
        here, before, behind = (np.arange(SIZE) + (i + k) * SIZE for k in (1, 0, 2))
        at = np.concatenate([before[FROM_LEFT:], here, behind[FROM_RIGHT : FROM_RIGHT + RIGHT]])
        matrix[i * SIZE : (i + 1) * SIZE, at] = row
    return matrix[:, SIZE:-SIZE]


def test_compiled_sizes_equal_group_sizes():
    assert SIZE == TERMS + 2 * GROUP
    assert LEFT == TERMS + GROUP + 2  # sums, pressures and, upwind, two films
    assert RIGHT == LEFT and FROM_RIGHT == SIZE - FROM_LEFT - RIGHT  # the same from the right end
    assert len(FILMS) == GROUP
    assert STRIDE == 12 >= SIZE  # what take_off takes off


@pytest.mark.parametrize("groups", [1, 2, 30])
@pytest.mark.parametrize("sparse", [False, True])
def test_block_lu_solves(groups, sparse):
    """Without dominance of the diagonal, so that rows are exchanged; `sparse`: with zeros there too."""
    rng = np.random.default_rng(groups)
    rows = rng.standard_normal((groups, SIZE, ROW_WIDTH))
    if sparse:
        rows[rng.random(rows.shape) < 0.6] = 0.0
        rows[:, np.arange(SIZE), LEFT + (np.arange(SIZE) + 1) % SIZE] = 3.0
    lu, matrix = BlockLU(groups), dense(rows)
    lu.factor(by_columns(rng.standard_normal(rows.shape)))  # what it leaves must not matter
    lu.factor(by_columns(rows))
    for first in {0, groups // 2, groups - 1}:
        b = rng.standard_normal((groups, SIZE))
        b[:first] = 0.0
        expected = np.linalg.solve(matrix, b.ravel())
        found = solved(lu, b, first)
        solution, coefficients = np.zeros((2, groups, STRIDE))
        solution[:, :SIZE], coefficients[:, :SIZE] = b, rng.standard_normal(b.shape)
        forward(lu.factors, solution.ravel(), first)
        product = (coefficients[:, :SIZE] * found).sum()
        rows = np.stack([coefficients.ravel(), 2.0 * coefficients.ravel(), -coefficients.ravel()])
        backward_transposed(lu.factors[2], rows)  # the same sums over what is not substituted yet
        expected_sums = pytest.approx(np.array([1.0, 2.0, -1.0]) * product, rel=1e-6, abs=1e-6)
        assert rows @ solution.ravel() == expected_sums
        np.testing.assert_allclose(found.ravel(), expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def test_singular_blocks_leave_finite_solutions():
    """A node whose rows know nothing of it: the preconditioner may be off, not infinite."""
    rows = np.random.default_rng(3).standard_normal((4, SIZE, ROW_WIDTH))
    rows[2, 5] = 0.0
    rows[1, :, LEFT + 4] = 0.0
    rows[0, :, LEFT + SIZE + 4 - FROM_RIGHT] = rows[2, :, 4 - FROM_LEFT] = 0.0
    lu, b = BlockLU(4), np.ones((4, SIZE))
    lu.factor(by_columns(rows))
    assert np.isfinite(solved(lu, b)).all()
