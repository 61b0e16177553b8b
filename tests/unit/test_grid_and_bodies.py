"""Nodes of a contact; depth fields fixed to bodies that slide through it, also those of earlier passes."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.effects.depths import PlasticDeformation, PlasticRecord, Wear, WearRecord
from ehlpetsc.effects.effect import Step
from ehlpetsc.effects.scene import Scene
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.shape import CYLINDER, STRAIGHT, Shape
from ehlpetsc.physics.scales import Scales
from ehlpetsc.surfaces.motion.body_field import CELLS_PER_MESH_CELL, BodyField, BodyFields, MeshOnBodies

A = 2e-4  # half-width [m]
X, Y = np.linspace(-1.5, 1.0, 26), np.linspace(-0.6, 0.6, 7)
AXES = {"line": (X,), "strip": (Y, X), "point": (Y, X)}
DX, DY = X[1] - X[0], Y[1] - Y[0]
SHAPES = {"line": (CYLINDER,), "strip": (STRAIGHT, CYLINDER), "point": (Shape(0.5), Shape(1.5))}
SPACINGS = {"line": (DX * A,), "strip": (DY * A, DX * A), "point": (DY * A, DX * A)}


def grid_of(kind):
    axes, shapes = AXES[kind], SHAPES[kind]
    half_widths = {"line": (1.0,), "strip": (np.inf, 1.0), "point": (0.4, 1.0)}
    parts = SPACINGS[kind], half_widths[kind], shapes
    return Grid(axes, *parts, load=1.0, periodic=kind == "strip")


@pytest.mark.parametrize(
    ("kind", "shape", "cell", "node_size", "distance", "undeformed"),
    [  # the last two at y = -0.4 and x = -1.2
        ("line", (26,), DX, DX * A, 1.2, 0.72),
        ("strip", (7, 26), DX * DY, DX * A / 7, 1.2, 0.72),
        ("point", (7, 26), DX * DY, DX * DY * A**2, np.hypot(1.2, 1.0), 0.25 * 0.16 + 0.75 * 1.44),
    ],
)
def test_grid(kind, shape, cell, node_size, distance, undeformed):
    grid, near = grid_of(kind), pytest.approx
    assert (grid.shape, grid.n) == (shape, np.prod(shape))
    assert grid.x is X and grid.dx == near(0.1) and grid.increments[-1] == near(0.1)
    assert grid.increments == near([axis[1] - axis[0] for axis in AXES[kind]])
    assert (grid.growth, grid.breadth) == (1.0, 1.0)
    assert (grid.cell, grid.node_size) == (near(cell, rel=1e-12), near(node_size, rel=1e-12))
    node = np.ravel_multi_index((1, 3)[-len(shape) :], shape)
    assert [c[node] for c in grid.coordinates] == near([-0.4, -1.2][-len(shape) :])
    assert grid.distance[node] == near(distance)
    assert grid.undeformed()[node] == near(undeformed)
    np.testing.assert_array_equal(grid.rows(np.arange(grid.n))[-1], np.arange(grid.n)[-26:])
    edges, first = grid.edges(), 26 * np.arange(grid.n // 26)
    np.testing.assert_array_equal(edges.pop("inlet"), first)
    np.testing.assert_array_equal(edges.pop("outlet"), first + 25)
    if kind == "point":
        sides = np.concatenate([np.arange(26), np.arange(26) + 6 * 26])
        np.testing.assert_array_equal(edges.pop("width"), sides)
    assert not edges


def test_nodes_inside_and_interpolation_along_both_axes():
    grid = grid_of("point")
    assert grid.inside(1.0).sum() == (grid.distance <= 1.0).sum() > 50
    between = Grid((X + 0.04,), (DX * A,), (1.0,), (CYLINDER,), 1.0)  # no node in the middle
    assert np.flatnonzero(between.inside(0.0)).tolist() == [np.argmin(np.abs(X + 0.04))]
    np.testing.assert_array_equal(between.inside(0.2), np.abs(X + 0.04) <= 0.2)
    grid = grid_of("point")
    axes = np.linspace(-0.7, 0.7, 15), np.linspace(-2.0, 0.9, 30)
    fine = Grid(axes, (1.0, 1.0), (1.0, 1.0), (CYLINDER, CYLINDER), 1.0)
    y, x = grid.coordinates
    field = np.exp(-(x**2) - 2.0 * y**2)
    found = grid.interpolated(field, fine).reshape(fine.shape)
    rows = PchipInterpolator(Y, field.reshape(grid.shape), axis=0)(np.clip(fine.axes[0], -0.6, 0.6))
    expected = PchipInterpolator(X, rows, axis=1)(np.clip(fine.x, -1.5, 1.0))
    np.testing.assert_allclose(found, expected, rtol=1e-13)


@pytest.mark.parametrize("kind", AXES)
def test_growing_field_of_sliding_bodies_conserves_volume(kind):
    grid = grid_of(kind)
    offsets = (0.31 * DX * A, -0.17 * DX * A)
    mesh = MeshOnBodies(SimpleNamespace(grid=grid, spacing=DX * A, x=X, a=A), offsets)
    rng, fields, whole = np.random.default_rng(4), mesh.zero, 0.0
    cell = DX * A * ({"line": 1.0, "strip": 1.0 / 7, "point": DY * A}[kind])
    for step in range(40):
        travelled = (0.37 * step * DX * A, -1.45 * step * DX * A)
        depths = [np.where(np.abs(np.tile(X, grid.n // 26)) < 0.8, rng.random(grid.n), 0.0) for _ in range(2)]
        before = mesh.means(fields, travelled)
        fields = mesh.add(fields, travelled, depths)
        whole += sum(depth.sum() for depth in depths)
        assert mesh.volume(fields) == pytest.approx(cell * whole, rel=1e-12)
        for now, then, depth in zip(mesh.means(fields, travelled), before, depths, strict=True):
            sums = [part.reshape(-1, 26).sum(axis=1) for part in (now - then, depth)]
            np.testing.assert_allclose(*sums, rtol=1e-12)  # a row keeps to itself
    ends = A * np.append(X - 0.5 * DX, X[-1] + 0.5 * DX)
    for faces, distance, offset in zip(mesh.faces(travelled), travelled, offsets, strict=True):
        np.testing.assert_allclose(faces, ends - distance + offset, rtol=0.0, atol=1e-12 * A)
    assert all(field.depth.min() >= 0.0 for field in fields)
    for field in fields:  # within the mesh and what has passed, no more than two cells on either side
        assert field.cells <= CELLS_PER_MESH_CELL * (16 + 1.45 * 39 + 2) + 4
    centres = [field.edges[:-1] + 0.5 * field.spacing - o for field, o in zip(fields, offsets, strict=True)]
    for found, field in zip(mesh.at_points(fields, [*centres]), fields, strict=True):
        np.testing.assert_allclose(found, field.depth, rtol=1e-9, atol=1e-12)
    assert mesh.at_points(fields, [None, None]) == [None, None]


def test_cells_of_a_body():
    field = BodyField.zero(1.0)
    assert (field.spacing, field.cells, field.volume) == (0.25, 0, 0.0)
    assert field.means(np.arange(3.0)).tolist() == [0.0, 0.0]
    assert field.add(np.arange(3.0), np.zeros(2)) is field
    one = field.add(np.arange(5.0), np.array([0.0, 2.0, 3.0, 0.0]))  # from 1 to 3
    assert (one.first, one.cells) == (3, 10)
    np.testing.assert_allclose(one.depth, [0.0, *[2.0] * 4, *[3.0] * 4, 0.0])
    np.testing.assert_allclose(one.edges, np.arange(3, 14) * 0.25)
    assert one.add(np.array([1.0, 3.0]), np.array([1.0])).first == 3
    both = one.add(np.array([-1.1, -0.6]), np.array([4.0])).add(np.array([5.1, 5.35]), np.array([6.0]))
    assert (both.first, both.first + both.cells) == (-6, 23)
    assert both.volume == pytest.approx(5.0 + 2.0 + 1.5, rel=1e-14)
    np.testing.assert_allclose(both.depth[:5], [0.0, 1.6, 4.0, 2.4, 0.0], atol=1e-14)
    np.testing.assert_allclose(both.depth[-4:], [0.0, 3.6, 2.4, 0.0], atol=1e-14)


PASS, SHIFT = 4, 50e-6  # m
ROUNDING = 1e-17  # m
KEYS = ["mesh.points_per_half_width=40", f"time.pass_shift={SHIFT}"]


def made(kind, *keys):
    """The effect in pass `PASS`, and a record of pits 40 nm deep all over both bodies."""
    case = load(CASES / "running_in.toml", [*KEYS, *keys])
    scales = Scales.of(case)
    effect = kind(Scene.of_pass(case, scales, operation_of(case, scales), PASS))
    zero, reach = BodyFields.zero(scales.spacing), 6.0 * scales.a
    faces = np.arange(-reach, reach, 0.25 * scales.spacing)
    pits = 40e-9 * (np.arange(len(faces) - 1) % 12 < 5)
    depth = BodyFields(*(BodyField.zero(scales.spacing).add(faces, pits) for _ in range(2)))
    record = PlasticRecord(depth, np.zeros(scales.nx), zero)
    return effect, record if kind is PlasticDeformation else WearRecord(depth, zero)


def in_gap(effect, record, way=0.0):
    return effect.in_gap(record, Step(0.0, None, (way, way), None))


@pytest.mark.parametrize("kind", [PlasticDeformation, Wear])
def test_steady_start_has_no_depth_ahead_of_a_shifted_profile(kind):
    effect, before = made(kind)
    one, other = in_gap(effect, before)
    assert one.max() > 20e-9 and other.max() > 20e-9, "all that is there"
    record = effect.start(before)
    after, ahead = in_gap(effect, record)
    np.testing.assert_allclose(after, one, atol=ROUNDING, err_msg="surface 1 begins where it did before")
    np.testing.assert_allclose(ahead, 0.0, atol=ROUNDING)
    assert record.depth is before.depth, "hidden, not removed"


def test_depth_enters_with_the_profile_or_is_everywhere():
    effect, before = made(PlasticDeformation)
    record, scales = effect.start(before), effect.scene.scales
    way = 1.5 * scales.a
    there, seen = in_gap(effect, before, way)[1], in_gap(effect, record, way)[1]
    behind = effect.scene.roughness.surface_2.entered(scales.x * scales.a - way)
    inside, ahead = behind == 1.0, behind == 0.0
    assert inside.sum() > 40 and ahead.sum() > 40
    np.testing.assert_allclose(seen[inside], there[inside], atol=ROUNDING)
    np.testing.assert_allclose(seen[ahead], 0.0, atol=ROUNDING)
    assert np.all(seen <= there + ROUNDING)
    effect, before = made(PlasticDeformation)
    record = effect.start(before)
    added = np.full(effect.scene.scales.nx, 1e-8)
    depth = effect.scene.mesh_on_bodies.add(record.depth, (0.0, 0.0), [added, added])
    np.testing.assert_allclose(in_gap(effect, record._replace(depth=depth))[1][1:-1], 1e-8, rtol=1e-9)
    effect, before = made(PlasticDeformation, "time.pass_shift=0.0")
    assert effect.start(before).hidden.volume == 0.0
    effect, before = made(Wear)
    even = before.depth.surface_2._replace(depth=np.full_like(before.depth.surface_2.depth, 2e-6))
    record = effect.start(before._replace(depth=before.depth._replace(surface_2=even)))
    np.testing.assert_allclose(in_gap(effect, record)[1], 2e-6, rtol=1e-9)
