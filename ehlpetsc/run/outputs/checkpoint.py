"""State of a run in a restart file: saving, loading, checks against the case."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.errors import OutputError
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.effects import EFFECTS
from ehlpetsc.effects.effect import flat, unflat
from ehlpetsc.results.restart_file import load_restart, save_restart
from ehlpetsc.stepping.state import State, TimeLevel
from ehlpetsc.surfaces.roughness import SurfacePositions

if TYPE_CHECKING:
    from ehlpetsc.case.loading import Case
    from ehlpetsc.discretisation.contact.model import ContactModel
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.run.simulation import Simulation

TOTAL, RECORD = "total ", "record "  # prefixes of the names of totals and of effects with a record
NOT_PHYSICS = ("title", "output", "post", "petsc", "series")  # tables whose changes are not reported
NODE_TOLERANCE = 1e-9  # of the domain: difference in x/a of equal nodes
SCALE_TOLERANCE = 1e-12  # relative
SCALES = ("a", "p0", "h")  # of load, radius and elasticity
Pair = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Checkpoint:
    """State from which a run continues.

    `baseline` are steady q and w for the predictor, `contact_count` the steps in contact of each node,
    `totals` those of all steps so far, `positions` those at the state.
    """

    state: State
    baseline: Pair
    contact_count: np.ndarray
    totals: dict[str, float]
    positions: SurfacePositions
    pass_number: int


def save(path: Path, simulation: Simulation, contact_count: np.ndarray, totals: dict[str, float]) -> None:
    """Write the restart file of a simulation at its last state; other arguments as of `Checkpoint`."""
    case, scales, positions = simulation.case, simulation.scales, simulation.scene.positions
    state, model = simulation.solution, simulation.stepper.problem.model
    arrays = {"x": scales.x * scales.a, "contact_count": contact_count}
    arrays |= _fields(model, "", state.q, state.w) | _fields(model, "smooth_", *simulation.stepper.baseline)
    arrays |= {name: getattr(state, name) for name in ("m", "m_older") if getattr(state, name) is not None}
    if state.earlier:
        arrays["earlier_travelled"] = np.array([level.travelled for level in state.earlier])
        levels = [_fields(model, "earlier_", level.q, level.w) for level in state.earlier]
        arrays |= {name: np.array([level[name] for level in levels]) for name in levels[0]}
    attributes = {
        "case": case.text,
        "pass_number": simulation.pass_number,
        "dt": state.dt or 0.0,
        **{name: getattr(state, name) for name in ("time", "step", "retries", "h00", "travelled")},
        **{name: getattr(scales, name) for name in SCALES},
        "speeds": (scales.u1, scales.u2),
        "domain_ends_at_entry": positions.domain_ends_at_entry,
        "profile_offsets": positions.profile_offsets,
    }
    for name, record in state.records.items():
        attributes[RECORD + name] = 1
        for key, value in flat(record, name).items():
            (arrays if isinstance(value, np.ndarray) else attributes)[key] = value
    stored = {TOTAL + name: value for name, value in totals.items()}
    save_restart(path, arrays, attributes | stored)


def load(path: Path, case: Case, scales: Scales, model: ContactModel) -> tuple[Checkpoint, list[str]]:
    """Content of a restart file, and a message on each key of the case that has changed.

    An OutputError if the file is no restart file, is damaged, or does not fit the case.
    """
    if case.time is None:
        raise OutputError(f"{path}: the case is steady (no [time]); it has no time steps to continue")
    arrays, attributes = load_restart(path)
    try:
        earlier = tomllib.loads(attributes["case"])
        misfit = _misfit(arrays, attributes, earlier, case, scales)
        if misfit:
            raise OutputError(f"{path}: {misfit}")
        checkpoint = _checkpoint(arrays, attributes, model)
    except KeyError as missing:
        raise OutputError(f"{path}: restart file of another ehlpetsc, without {missing}") from None
    return checkpoint, changed_keys(earlier, tomllib.loads(case.text))


def pass_of(path: Path) -> int:
    """Number of the pass of a restart file; errors as in :func:`load`."""
    return int(load_restart(path)[1]["pass_number"])


def changed_keys(earlier: dict, now: dict) -> list[str]:
    """Messages ``fluid.viscosity was 0.002, is 0.004``, one for every changed key of the physics."""
    from ehlpetsc.results.index import flat_keys

    old, new = (flat_keys({k: v for k, v in d.items() if k not in NOT_PHYSICS}) for d in (earlier, now))
    keys = [key for key in {**old, **new} if old.get(key) != new.get(key)]
    return [f"{key} was {old.get(key, 'left out')}, is {new.get(key, 'left out')}" for key in keys]


def _checkpoint(arrays: dict[str, np.ndarray], attributes: dict[str, Any], model: ContactModel) -> Checkpoint:
    travelled, ends, offsets = (
        tuple(attributes[name].tolist()) for name in ("travelled", "domain_ends_at_entry", "profile_offsets")
    )
    values = arrays | attributes
    names = [effect for effect in EFFECTS if RECORD + effect.name in attributes]
    state = State(
        Unknowns(*_unknowns(model, arrays, ""), float(attributes["h00"])),
        m=arrays.get("m"),
        m_older=arrays.get("m_older"),
        time=float(attributes["time"]),
        dt=float(attributes["dt"]) or None,
        retries=int(attributes["retries"]),
        step=int(attributes["step"]),
        travelled=travelled,
        earlier=_earlier(model, arrays),
        records={effect.name: unflat(effect.record, values, effect.name) for effect in names},
    )
    totals = {n.removeprefix(TOTAL): v.item() for n, v in attributes.items() if n.startswith(TOTAL)}
    positions = SurfacePositions(travelled, ends, offsets)
    smooth, number = _unknowns(model, arrays, "smooth_"), int(attributes["pass_number"])
    return Checkpoint(state, smooth, arrays["contact_count"], totals, positions, number)


def _fields(model: ContactModel, name: str, q: np.ndarray, w: np.ndarray) -> dict[str, np.ndarray]:
    """Arrays that define q and w independently of the contact model, which may change at a restart."""
    film = model.state(q, w).film
    return {f"{name}q": q, f"{name}h": film, f"{name}contact_pressure": model.contact_pressure(w)}


def _unknowns(model: ContactModel, arrays: dict[str, np.ndarray], name: str) -> Pair:
    q, film, solids = (arrays[name + field] for field in ("q", "h", "contact_pressure"))
    return q, model.w_from_state(film, solids)


def _earlier(model: ContactModel, arrays: dict[str, np.ndarray]) -> tuple[TimeLevel, ...]:
    stored = {name: values for name, values in arrays.items() if name.startswith("earlier_")}
    count = len(arrays.get("earlier_travelled", ()))
    levels = [{name: values[k] for name, values in stored.items()} for k in range(count)]
    return tuple(
        TimeLevel(level["earlier_travelled"], *_unknowns(model, level, "earlier_")) for level in levels
    )


def _misfit(
    arrays: dict[str, np.ndarray], attributes: dict[str, Any], earlier: dict, case: Case, scales: Scales
) -> str | None:
    """Reason why a file does not fit the case; None if it fits."""
    x, now = arrays["x"] / attributes["a"], scales.x
    if len(x) != len(now):
        return f"has {len(x)} nodes, the case {len(now)}; [mesh] must be as it was"
    if np.abs(x - now).max() > NODE_TOLERANCE * np.ptp(now):
        was, is_now = (f"{ends[0]:.6g} to {ends[-1]:.6g} half widths" for ends in (x, now))
        return f"its nodes lie from {was}, those of the case from {is_now}; [mesh] must be as it was"
    if ("fluid" in earlier) != (case.fluid is not None):
        one, other = ("with", "without") if "fluid" in earlier else ("without", "with")
        return f"a run {one} [fluid] cannot continue {other} it"
    if not all(np.isclose(attributes[name], getattr(scales, name), rtol=SCALE_TOLERANCE) for name in SCALES):
        return "of another load, radius or elasticity; what changes with time is in [operation]"
    start = earlier.get("time", {}).get("start", "smooth")
    if case.time.start != start:
        return f'time.start was "{start}"; it must be as it was, or the profiles would jump'
    for side, was, speed in zip(("1", "2"), attributes["speeds"], (scales.u1, scales.u2), strict=True):
        if case.surface.side(side) and np.sign(was) != np.sign(speed):
            return (
                f"surface.{side} moved at {was:g} m/s, now at {speed:g} m/s: "
                "a rough surface can neither start, stop nor turn round in mid-run"
            )
    return None
