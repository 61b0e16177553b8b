"""Error bars of `ehlpetsc converge` in seven mixed contacts, against runs with twice the nodes.

``python3 tests/benchmarks/bars.py [CONTACT ...] [--nodes 8 12 16 32]``: nodes to the shortest wave;
``--damage`` adds the mean damage of both surfaces 0.05 a deep, for a multiple of the time. The limit
is extrapolated from the third and the last mesh with the order that the first, the third and the last show,
within the bounds of the command. Prints, for each contact and quantity, the errors on the first and on the
third mesh, that of the limit by the first three, and its bar, all over the limit.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
from ehlpetsc.base import environment

environment.prepare()
import petsc4py

petsc4py.init(sys.argv[:1])

from support.waves import FOR_DAMAGE, mean_damage

from ehlpetsc.analysis.convergence import (
    HIGHEST_ORDER,
    LEAST_ORDER,
    OF_SPOTS,
    SPOT_ORDER,
    extrapolated,
    limit_of,
    observed_order,
)
from ehlpetsc.analysis.summary import run_scalars
from ehlpetsc.api import read_result, solve
from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales

CASE = ROOT / "cases" / "compliant_mixed.toml"
QUANTITIES = "friction_coefficient", "contact_share", "film_central"


class Contact(NamedTuple):
    """Changes of `CASE`, and the shortest wave [m]."""

    wave: float
    changes: dict


def made(
    sq: float, roll_off: float, wave: float, seeds: tuple[int, int], rough: float = 1.0, travel: float = 4.0
) -> Contact:
    """Self-affine surfaces; the second is `rough` times as high."""
    spec = {"kind": "self-affine", "hurst": 0.8, "roll_off": roll_off, "short_cutoff": wave}
    sides = zip("12", seeds, (sq, rough * sq), strict=True)
    surfaces = {side: {"synthetic": spec | {"seed": seed, "sq": height}} for side, seed, height in sides}
    return Contact(wave, {"surface": surfaces, "time.travel": travel})


def measured(wave: float, scale: float, sides: str = "12") -> Contact:
    """The profile of `CASE` above a wave, with other heights; the second of two surfaces is turned."""
    keys = {"file": "profiles/alicona_meander_profile.csv", "short_cutoff": wave, "scale": scale}
    surfaces = {side: keys | {"flip": side > sides[0]} for side in sides}
    return Contact(wave, {"surface": surfaces, "time.travel": 4.0})


def with_keys(contact: Contact, layer: float, slide_roll: float, viscosity: float, **mesh: float) -> Contact:
    """A contact with a layer of a height [m], a slide/roll ratio and a viscosity [Pa s]."""
    keys = {"contact.asperity_height": layer, "motion.slide_roll_ratio": slide_roll}
    keys |= {"fluid.viscosity": viscosity} | {f"mesh.{key}": value for key, value in mesh.items()}
    return contact._replace(changes=contact.changes | keys)


CONTACTS = {
    "compliant_mixed": Contact(25e-6, {}),
    "layer 6 nm": with_keys(made(0.3e-6, 100e-6, 40e-6, (1, 2)), 6e-9, 0.1, 0.003),
    "layer 50 nm": with_keys(made(0.25e-6, 150e-6, 30e-6, (3, 4), 0.4), 50e-9, 1.0, 0.002),
    "two profiles": with_keys(measured(40e-6, 3.5), 20e-9, 0.5, 0.002),
    "one profile": with_keys(measured(30e-6, 3.0, "2"), 10e-9, 0.3, 0.003),
    "strip": with_keys(made(0.3e-6, 150e-6, 90e-6, (1, 2), 0.5, travel=3.3), 20e-9, 0.25, 0.0015, width=0.5),
    "thin film": with_keys(made(0.3e-6, 200e-6, 50e-6, (5, 6)), 30e-9, 0.25, 0.001, inlet=-1.7, outlet=1.7),
}


def means(contact: Contact, nodes: int, damage: bool) -> dict[str, float]:
    """Means of a run on so many nodes to the shortest wave."""
    points = round(nodes * Scales.of(load(CASE, contact.changes)).a / contact.wave)
    changes = {"mesh.points_per_half_width": points} | (FOR_DAMAGE if damage else {})
    case = load(CASE, contact.changes | changes)
    with tempfile.TemporaryDirectory() as folder:
        solve(case, output=(path := Path(folder) / "run.h5")).close()
        with read_result(path) as result:
            return run_scalars(result) | ({"damage": mean_damage(path)} if damage else {})


def line(quantity: str, nodes: list[int], values: list[float]) -> str:
    """Errors over the limit: on the first and on the third mesh, by three meshes, its bar; and the order."""
    least = SPOT_ORDER if quantity in OF_SPOTS else LEAST_ORDER
    kept = [0, 2, 3]
    order = observed_order([nodes[k] for k in kept], [values[k] for k in kept])
    fine = extrapolated(nodes[2:], values[2:], min(max(least, order), HIGHEST_ORDER))
    found = limit_of(quantity, nodes[:3], values[:3], SPOT_ORDER)
    errors = (f"{value / fine - 1.0:+.2%}" for value in (values[0], values[2], found.value))
    return ",".join([quantity, *errors, f"{found.bar / abs(fine):.2%}", f"{order:.2f}"])


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("contacts", nargs="*", default=list(CONTACTS), help="; ".join(CONTACTS))
    parser.add_argument("--nodes", nargs=4, type=int, default=[8, 12, 16, 32], help="to the wave")
    parser.add_argument("--damage", action="store_true", help="mean damage of both surfaces too")
    chosen = parser.parse_args()
    print("contact,quantity,first,third,extrapolated,bar,order")
    for name in chosen.contacts:
        if name not in CONTACTS:
            parser.error(f"no contact {name!r}; there are: {'; '.join(CONTACTS)}")
        runs = [means(CONTACTS[name], n, chosen.damage) for n in chosen.nodes]
        for quantity in (*QUANTITIES, *["damage"] * chosen.damage):
            print(f"{name},{line(quantity, chosen.nodes, [run[quantity] for run in runs])}", flush=True)


if __name__ == "__main__":
    main()
