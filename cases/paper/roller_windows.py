"""Errors of windows of a rough roller over their size, at its loaded end and in its middle.

``./run_mpi.sh python cases/paper/roller_windows.py`` moves one map of roughness through a whole roller of 4
mm and through windows of it, on the same nodes, and prints how far the windows are from the whole roller in
the quarter of a millimetre next to its end, or in its middle. Means over the last half-width of the travel;
minimum film and maximum pressure are those of all its steps. It takes two minutes of processor time.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

LENGTH, COMPARED = 4e-3, 0.25e-3  # m
SIZES = 1.25e-3, 0.625e-3, 0.3125e-3  # m, of the windows
HEIGHT, LONGEST, SHORTEST, SPACING, POINTS = 0.12e-6, 200e-6, 80e-6, 10e-6, 410  # of the map, in m
CASE: dict[str, Any] = {
    "title": "a rough roller",
    "contact": {"radius": 6e-3, "length": LENGTH, "load": 800.0, "tilt": -5e-4},
    "fluid": {
        "viscosity": 0.02,
        "law": "roelands",
        "pressure_viscosity": 2e-8,
        "density": "dowson-higginson",
        "eyring_stress": 5e6,
    },
    "motion": {"entrainment_speed": 0.4, "slide_roll_ratio": 0.1},
    "mesh": {"inlet": -2.2, "outlet": 1.7, "points_per_half_width": [16, 128]},
    "time": {"travel": 2.0, "start": "rough"},
}
CASE["contact"] |= {"youngs_modulus": 207e9, "poisson_ratio": 0.3}
CASE["contact"] |= {"profile": {"kind": "circular", "radius": 0.02, "straight": 3e-3}, "model": "mixed"}
CASE["contact"] |= {"asperity_height": 20e-9, "asperity_stiffness": 0.008, "adsorbed_film": 1e-9}


def heights() -> np.ndarray:
    """Random map of waves between two lengths, shape (POINTS, POINTS) [m]."""
    random = np.random.default_rng(3)
    wave = np.hypot(np.fft.fftfreq(POINTS, SPACING)[:, None], np.fft.rfftfreq(POINTS, SPACING)[None])
    size = np.where((wave > 0.0) & (wave < 1.0 / SHORTEST), np.maximum(wave, 1.0 / LONGEST) ** -1.8, 0.0)
    z = np.fft.irfft2(size * np.exp(2j * np.pi * random.random(wave.shape)), (POINTS, POINTS))
    return HEIGHT / z.std() * z


def run(begin: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Rows [m] and their sums and extremes over the last steps of a window; of the whole roller by its ends.

    Shape (steps, 5, rows): pressure, shear stress, pressure of the solids; minimum film, maximum pressure.
    """
    middle, x = 0.5 * (begin + end), SPACING * np.arange(POINTS)
    surface = {"x": x.tolist(), "y": x.tolist(), "z": heights().tolist()}
    tables = CASE | {"surface": {"1": surface | {"position_across": 0.5 * x[-1] - middle}}}
    if end - begin < LENGTH:
        window = {"from": begin, "to": end, "coarsening": [1, 2]}
        tables = tables | {"mesh": CASE["mesh"] | {"window": window}}
    simulation, found = Simulation(load(tables)), []
    for state in simulation:
        shear = 0.5 * (state.shear_stress_2 - state.shear_stress_1)
        sums = [field.sum(axis=1) for field in (state.pressure, shear, state.contact_pressure)]
        found.append(np.array([*sums, state.film_thickness.min(axis=1), state.pressure.max(axis=1)]))
    return simulation.scales.a * simulation.scales.grid.axes[0], np.array(found[len(found) // 2 :])


def figures(y: np.ndarray, rows: np.ndarray, begin: float, end: float) -> np.ndarray:
    """Load, friction coefficient, share of the solids, minimum film, maximum pressure between two places."""
    part = rows[:, :, (y > begin) & (y < end)]
    load, shear, solids = part[:, :3].sum(axis=2).T
    means = load.mean(), (shear / load).mean(), (solids / load).mean()
    return np.array([*means, part[:, 3].min(), part[:, 4].max()])


def main() -> None:
    """Run all and print the table."""
    whole, half = run(-0.5 * LENGTH, 0.5 * LENGTH), 0.5 * LENGTH
    print("error in %         window   load  friction  share  minimum film  maximum pressure")
    for place, compared in (("end", (half - COMPARED, half)), ("middle", (-0.5 * COMPARED, 0.5 * COMPARED))):
        exact = figures(*whole, *compared)
        for size in SIZES:
            window = (half - size, half) if place == "end" else (-0.5 * size, 0.5 * size)
            errors = 100.0 * (figures(*run(*window), *compared) / exact - 1.0)
            print(f"{place:10} {1e3 * size:10.3f} mm" + "".join(f"{error:9.2f}" for error in errors))


if __name__ == "__main__":
    main()
