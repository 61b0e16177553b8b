"""Result files for the tests of post-processing: Hertz pressure with ripples that travel with surfaces."""

from functools import cached_property

import h5py
import numpy as np

CASE = """title = "made up"
[contact]
radius = 0.0191
load = 527e3
youngs_modulus = [207e9, 207e9]
poisson_ratio = [0.3, 0.3]
[motion]
entrainment_speed = {mean}
slide_roll_ratio = {ratio}
[mesh]
inlet = -2.5
outlet = 1.5
points_per_half_width = {points}
{time}
[output]
every = {every}
[post]
depths = {depths}
{post}
"""
LOAD, A, P0 = 527e3, 0.335682e-3, 0.999455e9


def ground_profile(s, seed, correlation=12e-6, ra=0.1e-6):
    """Gaussian-filtered noise on s, m."""
    noise = np.random.default_rng(seed).normal(size=s.size)
    width = correlation / (s[1] - s[0])
    kernel = np.exp(-0.5 * (np.arange(-4 * width, 4 * width + 1) / width) ** 2)
    z = np.convolve(noise, kernel, "same")
    return z * ra / np.abs(z).mean()


class Scene:
    """Nodes, times, profiles and loads; `pressure(k)` of frame k, `pressures` of all.

    The pressure is Hertz's, times 1 + ripple of both profiles where they are at that time.
    """

    def __init__(
        self, per_width=50, steps=None, ratio=0.5, travel=6.0, mean=25.0, courant=0.5, ripple=3e6, seed=0
    ):
        self.x = A * np.arange(-2.5 * per_width, 1.5 * per_width + 0.5) / per_width
        self.points, self.dx, self.mean, self.ratio = per_width, A / per_width, mean, ratio
        self.ripple = ripple
        self.courant = courant
        self.u1, self.u2 = mean * (1 + ratio / 2), mean * (1 - ratio / 2)
        dt = courant * self.dx / self.u1
        count = steps or int(np.ceil(travel * A / self.u1 / dt)) + 1
        self.time = dt * np.arange(count)
        s = np.arange(self.x[0] - self.u1 * self.time[-1] - 20e-6, self.x[-1] + 20e-6, 2e-6)
        self.profiles = {"1": (s, ground_profile(s, seed + 1)), "2": (s, ground_profile(s, seed + 2))}
        self.hertz = P0 * np.sqrt(np.clip(1 - (self.x / A) ** 2, 0, None))

    def pressure(self, k):
        height = sum(
            np.interp(self.x - u * self.time[k], *self.profiles[name])
            for name, u in (("1", self.u1), ("2", self.u2))
        )
        p = np.clip(self.hertz * (1 + self.ripple * height), 0, None)
        return p * LOAD / (p.sum() * self.dx)  # as a run balances it

    @cached_property
    def pressures(self):
        """Pressure (frames, nodes), cached because many files are written of one scene."""
        return np.array([self.pressure(k) for k in range(self.time.size)])


def write(path, scene, *, every=1, depths=(0.0, 0.05, 0.5), post="", steady=False, frames=None, edit=None):
    """Write the scene's result file; `edit(file)` may damage it before it is closed."""
    kept, friction = np.arange(0, scene.time.size, every)[:frames], 0.05
    time = "" if steady else f"[time]\ntravel = 6.0\ncourant = {scene.courant}"
    keys = {"mean": scene.mean, "ratio": scene.ratio, "points": scene.points, "time": time}
    case = CASE.format(every=every, depths=list(depths), post=post, **keys)
    with h5py.File(path, "w") as file:
        file.attrs.update(format_version=1, title="made up", case=case, status="done", ranks=1)
        file.attrs.update(a=A, p0=P0, h_scale=A * A / 0.0191, u1=scene.u1, u2=scene.u2)
        file["x"], file["time"], file["step"] = scene.x, scene.time[kept], kept
        file["steps/time"], file["steps/step"] = scene.time, np.arange(scene.time.size)
        file["contact_count"] = np.zeros(scene.x.size, int)
        p, nx = scene.pressures[kept], scene.x.size
        loads = {"pressure": p, "shear_stress_2": friction * p, "shear_stress_1": -friction * p}
        for name, values in loads.items():
            file.create_dataset(name, data=values, maxshape=(None, nx), chunks=(8, nx))
        for name, u in (("1", scene.u1), ("2", scene.u2)):
            file[f"surface/{name}/s"], file[f"surface/{name}/z"] = scene.profiles[name]
            file[f"surface/{name}"].attrs["speed"] = u
        if edit:
            edit(file)
    return path
