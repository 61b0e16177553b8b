"""Histories at body points, and with them damage, on ripples of ten nodes."""

import numpy as np
import pytest
from support.histories import history_at
from support.made_loads import P0, A, Scene, write

from ehlpetsc.post import Material, damage, stress
from ehlpetsc.post.loads import Loads, passage
from ehlpetsc.post.run import Job, run
from ehlpetsc.post.stresses.body_stress import QUANTA, BodyStress, offset_weights
from ehlpetsc.results.post_result import PostResult

FINE = 16  # elements of the reference a node spacing
DEPTHS = (0.0, 0.02, 0.05, 0.1)  # z/a: 0 to 5 elements
WAVE = 10  # nodes


class Ripples(Scene):
    """Hertz times 1 + half a ripple of ten nodes that surface 1 carries."""

    def load(self, x, k):
        phase = 2 * np.pi * (x - self.u1 * self.time[k]) / (WAVE * self.dx)
        return P0 * np.clip(1 - (x / A) ** 2, 0, None) ** 1.5 * (4 + 2 * np.cos(phase)) / 3  # Hertz's load

    def pressure(self, k):
        return self.load(self.x, k)


@pytest.fixture(scope="module")
def scene():
    return Ripples(per_width=50, ratio=0.5, travel=8.5)


@pytest.fixture(scope="module")
def loads(scene, tmp_path_factory):
    with Loads(write(tmp_path_factory.mktemp("ripples") / "a.h5", scene, depths=DEPTHS)) as opened:
        yield opened


def reference(scene, s, frames):
    """Histories (3, nz, frames) at body point s from the continuous pressure on a mesh FINE times finer."""
    fine = np.arange(scene.x[0], scene.x[-1] + scene.dx / 2 / FINE, scene.dx / FINE)
    n = fine.size
    x, one = scene.dx / FINE * np.arange(2 * n - 1), np.zeros(2 * n - 1)
    one[n - 1] = 1.0
    influence = np.array(
        stress(x, np.array(DEPTHS) * A, one, 0.05 * one, 0.3)
    )  # stresses round a node with a load of 1
    out = np.empty((3, len(DEPTHS), frames.size))
    for k, frame in enumerate(frames):
        place = s + scene.u2 * scene.time[frame]
        shifted = fine + (place - fine[0]) % (scene.dx / FINE)  # a node of the reference at the point
        node = int(np.rint((place - shifted[0]) / (scene.dx / FINE)))
        out[..., k] = influence[..., node : node + n] @ scene.load(shifted, frame)[::-1]
    return out


@pytest.mark.slow
def test_damage_on_ripples_of_ten_nodes_within_a_fifth_of_a_percent(scene, loads):
    motion_s = scene.x[0] - np.array([10.0, 25.37, 41.81]) * scene.dx
    for s in motion_s:
        place = s + scene.u2 * scene.time
        frames = np.flatnonzero((place >= scene.x[0]) & (place <= scene.x[-1]))
        assert frames[0] > 0 and frames[-1] < scene.time.size - 1
        exact = damage(*reference(scene, s, frames), Material()).damage
        ours = [damage(*history_at(loads, "2", s, z * A)[1], Material()).damage for z in DEPTHS]
        assert ours == pytest.approx(exact, rel=0.002)


@pytest.mark.slow
def test_sweep_gives_the_histories_of_single_points(scene, loads, tmp_path):
    """To rounding, but for equal ripples that pair otherwise where one rounds up and one down."""
    output = tmp_path / "a.post.h5"
    run(Job(str(loads.path), str(output)))
    result = PostResult(output)
    differences = []
    for surface in ("2", "1"):
        points = np.flatnonzero(result.complete[surface])
        for j in points[[0, points.size // 3, -1]]:
            for k, z in enumerate(DEPTHS):
                values = history_at(loads, surface, result.s[j], z * A, QUANTA["float32"] * P0)[1]
                single = damage(*values, Material()).damage
                differences.append(abs(result.damage[surface][k, j] / single - 1))
    assert np.median(differences) < 1e-6
    assert max(differences) < 5e-3


def test_signs_of_the_two_bodies(loads):
    """Traction +0.05 p on surface 2, -0.05 p on the fast one: at the surface txz = -q."""
    for surface, sign in (("2", -1), ("1", 1)):
        s = loads.x[0] - 30 * loads.dx
        _, values = history_at(loads, surface, s, 0.0)
        assert values[2] == pytest.approx(-sign * 0.05 * values[1], abs=1e-6 * P0)
        assert values[1].min() < -0.6 * P0


def test_exact_at_nodes_and_offsets_for_a_smooth_load():
    """The load between nodes against a mesh 16 times finer, where hats would err by a percent."""
    errors = []
    for nodes in (20, 10):
        x = np.arange(0, 400.0)
        fine = np.arange(0, 399.01, 1 / 16)

        def load(y, nodes=nodes):
            return np.exp(-(((y - 200) / 60) ** 2)) * (1 + 0.5 * np.cos(2 * np.pi * y / nodes))

        body = BodyStress(400, np.array([0.0, 2.0]))
        spectra = body.transform(load(x)[None], 0.1 * load(x)[None])
        worst = 0.0
        for depth, z in enumerate((0.0, 2.0)):
            exact = stress(fine, z, load(fine), 0.1 * load(fine), 0.3)
            for offset in (0.0, 0.25, 0.4375):
                found = body(depth, spectra, offset_weights(np.array([offset])))[0, :, 100:300]
                at = np.rint((x[100:300] + offset) * 16).astype(int)
                worst = max(worst, max(np.abs(f - e[at]).max() for f, e in zip(found, exact, strict=True)))
        errors.append(worst)
    assert errors[1] < 1e-3
    assert errors[0] < 3e-4


def test_skipped_frames_reduce_damage(tmp_path):
    """The more the fewer frames: why results stored with every > 1 are warned of."""
    scene = Ripples(per_width=50, ratio=1.0, travel=14.5)
    found = []
    for every in (1, 2, 4, 8):
        path = write(tmp_path / f"{every}.h5", scene, every=every, depths=(0.0, 0.02))
        run(Job(str(path), str(tmp_path / "out.h5"), surfaces=("2",)))
        result = PostResult(tmp_path / "out.h5")
        found.append(result.damage["2"][:, result.complete["2"]].mean())
    kept = np.array(found) / found[0]
    assert kept[1] < 0.99 and kept[2] < 0.95 and kept[3] < 0.85
    assert (np.diff(kept) < 0).all()


def test_points_need_entry_and_exit(scene):
    time = scene.time
    s = scene.x[0] + scene.dx * np.arange(-900, scene.x.size)
    for speed in (scene.u1, scene.u2, -scene.u2):
        motion = passage(s, scene.x, scene.dx, speed * time)
        first, last = s + speed * time[0], s + speed * time[-1]
        tiny = 1e-6 * scene.dx
        through = np.sort([first, last], axis=0)
        expected = (through[0] <= scene.x[0] + tiny) & (through[1] >= scene.x[-1] - tiny)
        assert (motion.complete == expected).all() and (expected.any() or speed < 0)
        for j in np.flatnonzero(expected)[::40]:
            place = (s[j] + speed * time - scene.x[0]) / scene.dx
            inside = np.flatnonzero((place >= -1e-6) & (place <= scene.x.size - 1 + 1e-6))
            assert (motion.enter[j], motion.leave[j]) == (inside[0], inside[-1])


def test_no_point_passes_at_rest(scene):
    motion = passage(scene.x, scene.x, scene.dx, 0.0 * scene.time)
    assert not motion.complete.any()


def test_counting_settings_change_the_result(loads, tmp_path):
    values = {}
    for name in ("none", "morrow"):
        depths = ("post.depths=[0.05]",)
        settings = (*depths, f"post.mean_stress={name}")
        run(Job(str(loads.path), str(tmp_path / "o.h5"), ("2",), settings=settings))
        values[name] = np.nanmax(PostResult(tmp_path / "o.h5").damage["2"])
    assert values["morrow"] < values["none"]
