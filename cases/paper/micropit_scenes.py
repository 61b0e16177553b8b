"""Scenes of `micropits.py`: the strip of `cases/micropitting.toml`, and what each ensemble changes."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

PASSES, RING_PASSES = 1e6, 720e3  # of which shares are: of the scene, of the tests of rings
COMMON = {  # one pass of each seed, in one position
    "life.max_solved": 1,
    "life.damage_jump": 1.0,
    "life.break_out": "none",
    "time.pass_shift": 0.0,
    "wear.coefficient": 1e-19,
}
SEEDS = "surface.1.synthetic.seed", "surface.2.synthetic.seed"
WAVES = {"kind": "self-affine", "hurst": 0.8, "roll_off": 45e-6, "short_cutoff": 15e-6, "seed": 0}
LIMITED = {"fluid.eyring_stress": None, "fluid.limiting_shear": 0.054}  # as measured on oil N100
HALF_SPEED = 1.33  # over the speed of a contact of twice the radius, at an equal film


class Scene(NamedTuple):
    """Label, settings beside `COMMON`, seeds of surface 1; surface 2 has seeds 1000 above."""

    label: str
    settings: dict[str, Any] = {}
    seeds: tuple[int, ...] = (1, 2, 3)
    passes: float = PASSES

    def limited(self) -> Scene:
        """The scene with an oil whose shear stress is limited in proportion to the pressure."""
        return self._replace(label=f"{self.label}, limiting shear", settings=self.settings | LIMITED)

    def line(self) -> Scene:
        """The scene with ridges across the motion on a line contact, for a tenth of the cost."""
        settings = self.settings | {"mesh.width": None, "time.travel": 8.0}
        return self._replace(label=f"{self.label}, ridges", settings=settings)


def bearing(radius: float, viscosity: float, speed: float, ratio: float) -> dict[str, Any]:
    """Settings of a roller on an inner ring at 1.5 GPa, with half of its radius [m, Pa s, m/s]."""
    pressure, modulus = 1.5e9, 226.37e9
    return {
        "contact.radius": 0.5 * radius,
        "contact.load": np.pi * radius * pressure**2 / modulus,
        "fluid.viscosity": viscosity,
        "fluid.pressure_viscosity": 20.8e-9,
        "fluid.eyring_stress": 3e6,
        "motion.entrainment_speed": HALF_SPEED * speed,
        "motion.slide_roll_ratio": ratio,
        "mesh.width": 0.83,  # 50 um
        "mesh.points_per_half_width": 26,
        "mesh.inlet": -2.6,  # solids touch beyond the smooth contact
        "mesh.outlet": 2.2,
        "time.travel": 6.5,
    }


def pair(rq_1: float, rq_2: float) -> Scene:
    """Rings NU 209 of these roughnesses [um], of the spectrum of the scene, 1 m/s, 0.0094 Pa s."""
    surfaces = {f"surface.{k}.synthetic": WAVES | {"sq": 1e-6 * rq} for k, rq in enumerate((rq_1, rq_2), 1)}
    settings = bearing(4.576e-3, 0.0094, 1.0, 0.02) | surfaces
    return Scene(f"{rq_1:g} on {rq_2:g} µm", settings, passes=RING_PASSES)


def rings(celsius: int, viscosity: float) -> Scene:
    """Rings NU 211, VG 68 at a temperature [Pa s]."""
    surfaces = {f"surface.{k}.synthetic": WAVES | {"sq": rq} for k, rq in enumerate((0.33e-6, 0.073e-6), 1)}
    return Scene(f"{celsius} °C", bearing(5.077e-3, viscosity, 2.24, 0.015) | surfaces)


def lay(peklenik: float, **waves: float) -> dict[str, Any]:
    """Settings of a lay: length of asperities along over across, 0.25 across the motion and 4 along it."""
    return {"surface.1.synthetic.peklenik": peklenik} | {
        f"surface.1.synthetic.{k}": v for k, v in waves.items()
    }


SCENES = {
    "first": Scene("three seeds"),
    "second": Scene("three others", seeds=(4, 5, 6)),
    "third": Scene("four others", seeds=(7, 8, 9, 10)),
    "mirror": Scene("mirror", {"surface.1.synthetic.sq": 1e-9}, (1,)),
    "smoother": Scene("Sq 3 % less", {"surface.1.synthetic.sq": 0.097e-6}),
    "fine": Scene("a/48", {"mesh.points_per_half_width": 48}, (1,)),
    "wide": Scene("width 100 µm", {"mesh.width": 1.33}, (1, 2)),
    "long": Scene("travel 8 a", {"time.travel": 8.0}, (1, 2)),
    "drift": Scene("three positions", {"time.pass_shift": None, "life.partners": 3}, (1, 2)),
    "mises": Scene("von Mises", {"post.criterion": "von-mises"}),
    "full": Scene(
        "twice the radius, a/64",
        {
            "contact.radius": 0.005,
            "contact.load": 0.4e6,
            "motion.entrainment_speed": 2.48,  # an equal film
            "mesh.points_per_half_width": 64,
            "mesh.width": 0.335,
            "post.depths": [0.0, 0.0033, 0.0067, 0.0133, 0.02, 0.0267, 0.04, 0.0533],
        },
        (1,),
    ),
    "reversed": Scene("-0.25", {"motion.slide_roll_ratio": -0.25}),
    "rolling": Scene("0.02", {"motion.slide_roll_ratio": 0.02}),
    "thin": Scene("0.33", {"motion.entrainment_speed": 0.71}),
    "thick": Scene("3", {"motion.entrainment_speed": 16.5, "mesh.inlet": -3.0, "time.travel": 6.5}),
    "pair_1": pair(0.05, 0.26),
    "pair_2": pair(0.05, 1.0),
    "pair_3": pair(0.5, 0.05),
    "pair_4": pair(0.5, 0.5),
    "cold": rings(66, 0.0192),
    "warm": rings(73, 0.0151),
    "hot": rings(98, 0.0074),
    "transverse": Scene("across", lay(0.25)),
    "along": Scene("along", lay(4.0, roll_off=180e-6, short_cutoff=60e-6)),
}
OF_RINGS = "pair_1", "pair_2", "pair_3", "pair_4", "cold", "warm", "hot"
SCENES |= {f"{name}_line": SCENES[name].line() for name in OF_RINGS}
for _name in ("first", "reversed", "rolling", "thin", "thick", "transverse", "along"):
    SCENES[f"{_name}_limited"] = SCENES[_name]._replace(seeds=(1, 2, 3)).limited()
for _name in OF_RINGS:
    SCENES[f"{_name}_line_limited"] = SCENES[f"{_name}_line"].limited()
