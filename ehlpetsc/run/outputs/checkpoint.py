"""State of a run in a restart file: saving, loading, checks against the case, conversion to other scales."""

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
CORE_HALF_WIDTH = 0.5  # in a: the approach changes by the mean change of the film between -0.5 and 0.5
STATE_PREFIXES = ("", "smooth_")  # of the names of the states that are converted to other scales
HISTORY = ("m", "m_older", "earlier_travelled", "earlier_q", "earlier_h", "earlier_contact_pressure")
Pair = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Checkpoint:
    """State from which a run continues.

    Attributes
    ----------
    state
        Its `m` is None if the size of the contact has changed since it was saved; it then follows from q, w.
    baseline
        Steady q and w for the predictor.
    contact_count
        Steps in contact of each node.
    totals
        Totals of all steps so far, for the summary.
    positions
        Positions at the beginning of the run (saved) or at the state (loaded).
    """

    state: State
    baseline: Pair
    contact_count: np.ndarray
    totals: dict[str, float]
    positions: SurfacePositions
    pass_number: int = 1

    @classmethod
    def of(cls, simulation: Simulation, contact_count: np.ndarray, totals: dict[str, float]) -> Checkpoint:
        """Checkpoint of a simulation at its last state."""
        state, baseline = simulation.solution, simulation.stepper.baseline
        if state is None or baseline is None:
            raise ValueError("no state yet")
        positions = simulation.scene.positions
        return cls(state, baseline, contact_count, totals, positions, simulation.pass_number)


def save(path: Path, checkpoint: Checkpoint, case: Case, scales: Scales, model: ContactModel) -> None:
    """Write the restart file of a run."""
    state, positions = checkpoint.state, checkpoint.positions
    arrays = {"x": scales.x * scales.a, "contact_count": checkpoint.contact_count}
    arrays |= _fields(model, "", state.q, state.w) | _fields(model, "smooth_", *checkpoint.baseline)
    arrays |= {name: getattr(state, name) for name in ("m", "m_older") if getattr(state, name) is not None}
    if state.earlier:
        arrays["earlier_travelled"] = np.array([level.travelled for level in state.earlier])
        levels = [_fields(model, "earlier_", level.q, level.w) for level in state.earlier]
        arrays |= {name: np.array([level[name] for level in levels]) for name in levels[0]}
    attributes = {
        "case": case.text,
        "pass_number": checkpoint.pass_number,
        "time": state.time,
        "dt": state.dt or 0.0,
        "step": state.step,
        "retries": state.retries,
        "h00": state.h00,
        "a": scales.a,
        "p0": scales.p0,
        "h_scale": scales.h,
        "speeds": (scales.u1, scales.u2),
        "travelled": state.travelled,
        "domain_ends_at_entry": positions.domain_ends_at_entry,
        "profile_offsets": positions.profile_offsets,
    }
    for name, record in state.records.items():
        attributes[RECORD + name] = 1
        for key, value in flat(record, name).items():
            (arrays if isinstance(value, np.ndarray) else attributes)[key] = value
    totals = {TOTAL + name: value for name, value in checkpoint.totals.items()}
    save_restart(path, arrays, attributes | totals)


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

        rescale(arrays, attributes, scales)
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


def advice_on_resuming(restart: Path, case: Case, step: int | None) -> str:
    """End of a sentence on a failed write: how to continue once the cause is removed.

    The restart file may be missing or belong to another case; `step` is the last complete one in the result.
    """
    try:
        attributes = load_restart(restart)[1]
        if step is not None and attributes["case"] == case.text and attributes["step"] <= step:
            return f"once this is mended, continue with --restart {restart} (step {attributes['step']})"
    except OutputError:
        pass  # none, or a damaged one
    again = "repeat it with --overwrite" if restart.exists() else "the same command begins at time 0"
    return f"there is no restart file of it: once this is mended, {again}"


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


def rescale(arrays: dict[str, np.ndarray], attributes: dict[str, Any], scales: Scales) -> None:
    r"""Convert the content of a restart file to the load, radius or elasticity of a case, in place.

    Fields keep their position x/a, that is, their node:

    * pressures in p0 do not change: their sum over the nodes carries the new load;
    * the excess of the film over the gap outside Hertz' dry contact keeps its thickness in metres, and the
      gap is that of the new contact, :math:`h=g+r(h_0-g)` in a^2/R, :math:`r` the old a^2/R over the new one
      and g as in :func:`ehlpetsc.physics.exact_solutions.hertz_gap`;
    * a cavity keeps its oil film in metres, :math:`(1+q)h=r(1+q_0)h_0`.

    Earlier masses per area do not apply to the new contact: the next step is a step of backward Euler from
    the mass of the converted state, without earlier levels.
    """
    from ehlpetsc.physics.exact_solutions import hertz_gap

    old = np.array([attributes[name] for name in ("a", "p0", "h_scale")])
    new = np.array([scales.a, scales.p0, scales.h])
    if (np.abs(old - new) <= SCALE_TOLERANCE * new).all():
        return
    ratio, x = attributes["h_scale"] / scales.h, scales.x
    gap = hertz_gap(x, 1.0, 1.0)
    core = np.abs(x) <= CORE_HALF_WIDTH
    if core.any():
        attributes["h00"] += (ratio - 1.0) * (arrays["h"] - gap)[core].mean()
    for prefix in STATE_PREFIXES:
        q, h = arrays[prefix + "q"], arrays[prefix + "h"]
        arrays[prefix + "q"], arrays[prefix + "h"] = _converted(q, h, gap, ratio)
    for name in HISTORY:
        arrays.pop(name, None)
    attributes["dt"] = 0.0


def _converted(q: np.ndarray, h: np.ndarray, gap: np.ndarray, ratio: float) -> Pair:
    film = np.maximum(gap + ratio * (h - gap), 0.0)
    oil = ratio * (1.0 + q) * h
    void = np.clip(oil / np.where(film > 0.0, film, np.inf) - 1.0, -1.0, 0.0)
    return np.where((q < 0.0) & (film > 0.0), void, q), film
