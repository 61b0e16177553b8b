"""Linear solves of short rough runs: GMRES iterations, convolutions and preconditioners built, bounded."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.contact.node_state import NodeState, PlasticState
from ehlpetsc.nonlinear.plane.reduction import (
    BOUND,
    CONTACT,
    MIN_SLOPE,
    PRESSURE,
    STIFF,
    STIFF_SLOPE,
    VOID,
    reduction_of,
)
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation

STEPS = 30
SOLIDS = {"youngs_modulus": [207e9, 207e9], "poisson_ratio": [0.3, 0.3], "boundary_friction": 0.1}
OIL = {"viscosity": 0.04, "law": "roelands", "pressure_viscosity": 18e-9, "eyring_stress": 6e6}
CONTACTS = {"rigid": {"boundary_film": 5e-9}, "layer": {"asperity_height": 30e-9}}
LINE, POINT = {"radius": 0.012, "load": 350e3}, {"radius": [0.012, 0.012], "load": 100.0}
ENDS, BOTH = {"inlet": -1.5, "outlet": 1.25}, ["wavelength", "wavelength_across"]
KINDS = {  # contact, mesh, waves of surface 2 in half-widths
    "line": (LINE, {"inlet": -2.0, "outlet": 1.5, "points_per_half_width": 25}, ["wavelength"]),
    "strip": (LINE, ENDS | {"points_per_half_width": 16, "width": 1.0}, BOTH),
    "point": (POINT, ENDS | {"points_per_half_width": 12, "width": 2.5}, BOTH),
}


def tables(kind, contact):
    """Case of a wavy surface that slides through a contact with a thin film."""
    load_of, mesh, waves = KINDS[kind]
    case = {"title": kind, "contact": SOLIDS | load_of | CONTACTS[contact] | {"model": "mixed"}, "mesh": mesh}
    half_wave = 0.5 * Scales.of(load(case)).a
    surface = {"kind": "sine", "amplitude": 0.3e-6} | dict.fromkeys(waves, half_wave)
    case |= {"fluid": OIL | {"density": "dowson-higginson"}, "time": {"travel": 3.0}}
    motion = {"entrainment_speed": 0.1, "slide_roll_ratio": 0.4}
    return case | {"motion": motion, "surface": {"2": {"synthetic": surface}}}


@pytest.mark.parametrize(
    ("kind", "contact", "newton", "iterations", "builds"),
    [  # of all steps
        ("line", "rigid", 87, 177, 0),
        ("line", "layer", 120, 286, 0),
        ("strip", "rigid", 147, 1010, 45),
        ("strip", "layer", 161, 1407, 26),
        ("point", "rigid", 183, 868, 87),
        ("point", "layer", 207, 1351, 104),
    ],
)
def test_cost(kind, contact, newton, iterations, builds):
    """Measured counts of Newton's and GMRES' iterations and of builds, 4 % left for rounding."""
    simulation = Simulation(load(tables(kind, contact)))
    simulation.advance()
    solver = simulation.stepper.solver
    elimination = getattr(solver.system.matrices, "elimination", None)
    before = elimination.builds if elimination else 0
    convolutions = counted_convolutions(solver.problem.deflection) if elimination else [0]
    states = [simulation.advance() for _ in range(STEPS)]
    assert states[-1].scalars["contact_share"] > 0.0 or kind == "line"
    assert sum(s.scalars["newton"] for s in states) <= 1.04 * newton
    assert sum(s.scalars["gmres"] for s in states) <= 1.04 * iterations
    assert (elimination.builds if elimination else 0) - before <= 1.04 * builds
    # one for each residual, those of guesses and of the kept factors included, and for each GMRES iteration
    assert convolutions[0] <= sum(s.scalars["newton"] + s.scalars["gmres"] for s in states) + STEPS + 1


def counted_convolutions(deflection):
    """Number of convolutions from now on, in a list."""
    count, convolution = [0], deflection.convolution

    def counted(values):
        count[0] += 1
        return convolution(values)

    deflection.convolution = counted
    return count


def nodes_of_all_kinds():
    """State of a node of each kind, with general derivatives: its kinds, and which w are left out."""
    rng = np.random.default_rng(5)
    # p_q, p_w, r_q, r_w, h_w, depth_q, depth_w: separation_q is -depth_q, separation_w is h_w - depth_w
    a, b, c, d, e = rng.uniform(0.4, 1.6, (5, 1))[:, 0]
    rows = {
        "independent": (PRESSURE, a, -b, c, d, e, -0.3, 0.4),
        "oil": (PRESSURE, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0),
        "yielding cavity": (VOID, 0.0, 0.0, c, -d, e, 0.0, 0.2),
        "yielding, r by w alone": (VOID, 0.0, 0.0, 0.0, -d, e, -0.5, e),
        "yielding, r by nothing": (VOID, 0.0, 0.0, 0.0, 0.0, e, -0.5, e),
        "at the slope": (VOID, 0.0, -STIFF_SLOPE, c, 0.0, e, 0.0, 0.2),
        "asperities": (STIFF, 0.0, -b, c, 0.0, e, 0.0, 0.2),
        "solids": (CONTACT, 0.0, -b, c, 0.0, 0.0, 0.0, 0.0),
        "bound": (BOUND, a, 0.0, c, 0.0, e, 0.0, 0.0),
    }
    kinds, p_q, p_w, r_q, r_w, h_w, depth_q, depth_w = map(np.array, zip(*rows.values(), strict=True))
    zero = np.zeros(len(kinds))
    plastic = PlasticState(zero, zero > 0.0, depth_q, depth_w, r_q, r_w)
    return list(rows), NodeState(zero, zero, zero, p_q, p_w, h_w, plastic), kinds


def test_reduction_of_all_kinds_of_nodes():
    names, state, kinds = nodes_of_all_kinds()
    reduced = reduction_of(state.derivatives(), kinds == BOUND)
    np.testing.assert_array_equal(reduced.kind, kinds)
    by = state.derivatives()
    change = np.random.default_rng(6).standard_normal((2, len(kinds)))
    for i, name in enumerate(names):
        dq, dw = change[:, i]
        dp, dr, dh, ds = by[:, 0, i] * dq + by[:, 1, i] * dw
        kind, back = kinds[i], reduced.back[:, i]
        if name == "yielding, r by nothing":
            dr = -MIN_SLOPE * dw
        if kind == BOUND:  # w is not in the system
            dr, dp, dq, dw = by[1, 0, i] * dq, dq, dq, 0.0
            first, second = dp, 0.0
        else:
            first = dr if kind == VOID else dp
            second = dr if kind in (STIFF, CONTACT) else ds
        found = [back[0] * first + back[1] * second, back[2] * first + back[3] * second]
        assert found == pytest.approx([dq, dw], rel=1e-12, abs=1e-12), name
        if kind in (PRESSURE, BOUND):
            assert reduced.r_v[i] * dp + reduced.r_s[i] * ds == pytest.approx(dr, abs=1e-12), name
        if kind == PRESSURE:
            assert reduced.h_v[i] * dp + reduced.h_s[i] * ds == pytest.approx(dh, abs=1e-12), name
        if kind in (VOID, STIFF):
            assert reduced.h_v[i] * dr + reduced.h_s[i] * ds == pytest.approx(dh, abs=1e-12), name
        expected = by[0, 1, i] / by[3, 1, i] if kind == STIFF else 0.0
        assert reduced.p_s[i] == pytest.approx(expected, rel=1e-12), name
