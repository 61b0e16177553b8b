"""Cases at the edge of the ranges: ``python3 tests/benchmarks/extremes.py [--far] [--model MODEL]``.

One row each in the printed table and the CSV file: steps, halved steps, Newton iterations, film, pressure,
errors of load and oil, or the reason why there is no solution. `extremes.toml` lists the cases.
"""

from __future__ import annotations

import argparse
import csv
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import numpy as np

import ehlpetsc
from ehlpetsc.case.loading import load

PROFILES = ROOT / "cases" / "profiles"
COLUMNS = tuple(
    "axis value converged steps halved newton h_min_um p_max_GPa load_error mass_error seconds reason".split()
)
VARIANTS = {  # of the base case: changed keys of its oil; None: removed
    "table_1": {},
    "barus": {"law": "barus"},
    "roelands": {"law": "roelands", "roelands_z": 0.68, "roelands_pressure": 0.196e9},
    "newton": {"eyring_stress": None},
    "moes": {"law": "barus", "eyring_stress": None, "density": "incompressible"},
    "dry": None,
}
SHORT_DOMAIN = ("mesh.inlet=-1.5", "mesh.outlet=1.3")  # of cases with roughness
STORED = ("output.every=1000000", 'output.fields=["pressure"]')
MODELS = {  # overrides of a contact model
    "direct": ("contact.model=direct",),
    "mixed": ("contact.model=mixed",),
    "compliant": ("contact.model=mixed", "contact.asperity_height=10e-9"),
}


@dataclass(frozen=True)
class Extreme:
    """Case of the table; with `before`, it continues from a run with these overrides."""

    axis: str
    value: str
    base: dict
    overrides: tuple[str, ...]
    before: tuple[str, ...] | None = None


def extremes(far: bool = False, short: bool = False, model: str | None = None) -> list[Extreme]:
    """Cases at the edge of the ranges, or far beyond; `short`: some of them on coarser meshes."""
    tables = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    entries = tables["far"] if far else tables["steady"] + tables["time"]
    chosen = [entry for entry in entries if entry.get("short") or not short]
    return [_extreme(tables, entry, short, MODELS.get(model, ())) for entry in chosen]


def _extreme(tables: dict, entry: dict, short: bool, model: tuple[str, ...]) -> Extreme:
    fluid = VARIANTS[entry.get("base", "table_1")]
    base = {
        name: dict(table) for name, table in tables["base"].items() if name != "fluid" or fluid is not None
    }
    if fluid:
        values = base["fluid"] | fluid
        base["fluid"] = {key: value for key, value in values.items() if value is not None}
    shared = () if any(word.startswith("contact.model") for word in entry.get("set", ())) else model
    if "travel" in entry:
        shared += (*SHORT_DOMAIN, *STORED, f"time.travel={entry['travel']}")
    for side in ("1", "2"):
        if f"surface_{side}" in entry:
            shared += (f"surface.{side}.synthetic={tables['synthetic'][entry[f'surface_{side}']]}",)

    def overrides(words: list[str], first: bool = False) -> tuple[str, ...]:
        settings = (*shared, *(word.replace("{profiles}", str(PROFILES)) for word in words))
        return settings + (_coarser(settings, first) if short else ())

    before = overrides(entry["before"], True) if "before" in entry else None
    return Extreme(
        entry["axis"], entry["value"], {"title": "extreme", **base}, overrides(entry.get("set", [])), before
    )


def _coarser(settings: tuple[str, ...], first: bool) -> tuple[str, ...]:
    """Overrides of the short form: a/50, and a travel at which roughness just reaches the contact."""
    keys = {word.partition("=")[0] for word in settings}
    added = () if "mesh.points_per_half_width" in keys else ("mesh.points_per_half_width=50",)
    if "time.travel" in keys:
        added += () if first else ("time.travel=1.0",)
        added += () if "time.courant" in keys else ("time.courant=1.0",)
    return added


def row(case: Extreme, folder: Path) -> dict[str, object]:
    """Row of one case, by column."""
    begun, found = time.monotonic(), {"converged": "yes"}
    try:
        restart = None
        if case.before:
            first = folder / "before.h5"
            ehlpetsc.solve(load(case.base, case.before), first, overwrite=True, progress=False)
            restart = first.with_suffix(".restart.h5")
        result = ehlpetsc.solve(load(case.base, case.overrides), restart=restart, progress=False)
        found |= _figures(result)
    except ehlpetsc.NotConverged as error:
        found = {"converged": "no", "reason": str(error)}
    return {"axis": case.axis, "value": case.value, **found, "seconds": f"{time.monotonic() - begun:.1f}"}


def _figures(result: ehlpetsc.Result) -> dict[str, object]:
    steps = result.steps
    maximum = {name: np.nanmax(np.append(steps(name), 0.0)) for name in ("load_error", "mass_error")}
    return {
        "steps": int(steps("step")[-1]),
        "halved": int(steps("retries").sum()),
        "newton": int(steps("newton").sum()),
        "h_min_um": f"{1e6 * steps('h_min').min():.4g}",
        "p_max_GPa": f"{1e-9 * steps('p_max').max():.4g}",
        **{name: f"{value:.1e}" for name, value in maximum.items()},
    }


def table(cases: list[Extreme], path: Path) -> list[dict[str, object]]:
    """Run the cases; the rows, printed and written one by one."""
    rows = []
    print(" ".join(COLUMNS), flush=True)
    with open(path, "w", newline="") as file, tempfile.TemporaryDirectory() as folder:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for case in cases:
            rows.append(row(case, Path(folder)))
            writer.writerow(rows[-1])
            file.flush()
            print(*rows[-1].values(), flush=True)
    done = sum(found["converged"] == "yes" for found in rows)
    print(f"{done} of {len(rows)} cases converged")
    return rows


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--far", action="store_true", help="forty cases far beyond the ranges instead")
    parser.add_argument("--short", action="store_true", help="some of the cases, on coarser meshes")
    parser.add_argument("--model", choices=MODELS, help="contact model of all cases")
    parser.add_argument("-o", "--output", type=Path, default=Path("extremes.csv"))
    chosen = parser.parse_args()
    table(extremes(chosen.far, chosen.short, chosen.model), chosen.output)


if __name__ == "__main__":
    main()
