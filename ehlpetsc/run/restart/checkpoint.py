"""State of a run in a restart file: saving, loading, checks against the case."""

import tomllib
from dataclasses import dataclass

import numpy as np

from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.effects import EFFECTS
from ehlpetsc.effects.effect import flat, unflat
from ehlpetsc.errors import OutputError
from ehlpetsc.names import current_name
from ehlpetsc.results.restart_file import load_restart, save_restart
from ehlpetsc.results.series_index import flat_keys
from ehlpetsc.run.restart.contents import RECORD, TOTAL, fault
from ehlpetsc.run.restart.rescaling import rescale
from ehlpetsc.stepping.state import State, TimeLevel
from ehlpetsc.surfaces.roughness import SurfacePositions

NOT_PHYSICS = ("title", "output", "post", "petsc", "series")  # tables whose changes are not reported
NODE_TOLERANCE = 1e-9  # of the domain: difference in x/a of equal nodes


@dataclass(frozen=True)
class Checkpoint:
    """State from which a run continues.

    Attributes
    ----------
    state : stepping.state.State
        `m` is None if the size of the contact has changed since it was saved; it then follows from q and w.
    baseline : pair of ndarray
        Steady q and w for the predictor.
    contact_count : ndarray of int, shape (nx,)
    totals : dict of str to number
        Totals of all steps so far, for the summary.
    positions : surfaces.roughness.SurfacePositions
        Positions at the beginning of the run (saved) or at the state (loaded).
    pass_number : int
    """

    state: State
    baseline: tuple
    contact_count: np.ndarray
    totals: dict
    positions: SurfacePositions
    pass_number: int = 1

    @classmethod
    def of(cls, simulation, contact_count, totals):
        """Checkpoint of a `run.simulation.Simulation` at its last state."""
        baseline, positions = simulation.stepper.baseline, simulation.scene.positions
        return cls(simulation.solution, baseline, contact_count, totals, positions, simulation.pass_number)


def save(path, checkpoint, case, scales, model):
    """Write the restart file of a run.

    Parameters
    ----------
    path : path-like
    checkpoint : Checkpoint
    case, scales, model
        Case, scales and contact model of the run.

    Raises
    ------
    OutputError
    """
    state, positions = checkpoint.state, checkpoint.positions
    arrays = {"x": scales.x * scales.a, "contact_count": checkpoint.contact_count}
    arrays |= _fields(model, "", state.q, state.w) | _fields(model, "smooth_", *checkpoint.baseline)
    arrays |= {name: getattr(state, name) for name in ("m", "m_older") if getattr(state, name) is not None}
    if state.earlier:
        arrays["earlier_travelled"] = np.array([level.travelled for level in state.earlier])
        levels = [_fields(model, "earlier_", level.q, level.w) for level in state.earlier]
        arrays |= {name: np.array([level[name] for level in levels]) for name in levels[0]}
    numbers = {"time": state.time, "dt": state.dt or 0.0, "h00": state.h00}
    numbers |= {"a": scales.a, "p0": scales.p0, "h_scale": scales.h, "u1": scales.u1, "u2": scales.u2}
    numbers |= dict(zip(("travelled_1", "travelled_2"), state.travelled, strict=True))
    numbers |= dict(zip(("entered_inlet", "entered_outlet"), positions.domain_ends_at_entry, strict=True))
    numbers |= dict(zip(("begin_1", "begin_2"), positions.profile_offsets, strict=True))
    attributes = {name: float(value) for name, value in numbers.items()}
    attributes |= {"retries": int(state.retries), "step": int(state.step), "case": case.text}
    attributes["pass_number"] = checkpoint.pass_number
    for name, record in state.records.items():
        attributes[RECORD + name] = 1
        for key, value in flat(record, name).items():
            (arrays if isinstance(value, np.ndarray) else attributes)[key] = value
    totals = {TOTAL + name: value for name, value in checkpoint.totals.items()}
    save_restart(path, arrays, attributes | totals)


def load(path, case, scales, model):
    """Content of a restart file, checked against the case.

    Returns
    -------
    checkpoint : Checkpoint
    notes : list of str
        Keys of the case that have changed, one message each.

    Raises
    ------
    OutputError
        Not a restart file, a damaged one, or one that does not fit the case.
    """
    if case.time is None:
        raise OutputError(f"{path}: the case is steady (no [time]); it has no time steps to continue")
    arrays, attributes = load_restart(path)
    damage = fault(arrays, attributes)
    if damage:
        raise OutputError(f"{path}: damaged restart file: {damage}")
    try:
        earlier = tomllib.loads(attributes["case"])
    except tomllib.TOMLDecodeError as error:
        raise OutputError(f"{path}: damaged restart file: its case cannot be read ({error})") from None
    misfit = _misfit(arrays, attributes, earlier, case, scales)
    if misfit:
        raise OutputError(f"{path}: {misfit}")
    try:
        records = _records(arrays | attributes)
    except ValueError as error:
        raise OutputError(f"{path}: damaged restart file, or of an earlier ehlpetsc: {error}") from None
    rescale(arrays, attributes, scales)
    positions = SurfacePositions(
        (float(attributes["travelled_1"]), float(attributes["travelled_2"])),
        (float(attributes["entered_inlet"]), float(attributes["entered_outlet"])),
        (float(attributes["begin_1"]), float(attributes["begin_2"])),
    )
    state = State(
        Unknowns(*_unknowns(model, arrays, ""), float(attributes["h00"])),
        m=arrays.get("m"),
        m_older=arrays.get("m_older"),
        time=float(attributes["time"]),
        dt=float(attributes["dt"]) or None,
        retries=int(attributes["retries"]),
        step=int(attributes["step"]),
        travelled=positions.travelled,
        earlier=_earlier(model, arrays),
        records=records,
    )
    totals = {
        current_name(n.removeprefix(TOTAL)): v.item() for n, v in attributes.items() if n.startswith(TOTAL)
    }
    notes = changed_keys(earlier, tomllib.loads(case.text))
    smooth, number = _unknowns(model, arrays, "smooth_"), _pass_number(attributes)
    return Checkpoint(state, smooth, arrays["contact_count"], totals, positions, number), notes


def _fields(model, name, q, w):
    """Arrays that define q and w independently of the contact model, which may change at a restart."""
    film = model.state(q, w).film
    return {f"{name}q": q, f"{name}h": film, f"{name}contact_pressure": model.contact_pressure(w)}


def _unknowns(model, arrays, name):
    q, film, solids = (arrays[name + field] for field in ("q", "h", "contact_pressure"))
    return q, model.w_from_state(film, solids)


def _records(values):
    """Records of effects in a file."""
    return {
        effect.name: unflat(effect.record, values, effect.name)
        for effect in EFFECTS
        if RECORD + effect.name in values
    }


def pass_of(path):
    """Number of the pass of a restart file; errors as in :func:`load`."""
    return _pass_number(load_restart(path)[1])


def _pass_number(attributes):
    return int(attributes.get("pass_number", 1))


def _earlier(model, arrays):
    if "earlier_travelled" not in arrays:
        return ()
    stored = {name: values for name, values in arrays.items() if name.startswith("earlier_")}
    levels = [{name: values[k] for name, values in stored.items()} for k in range(len(stored["earlier_q"]))]
    return tuple(
        TimeLevel(level["earlier_travelled"], *_unknowns(model, level, "earlier_")) for level in levels
    )


def _misfit(arrays, attributes, earlier, case, scales):
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
    if case.fluid is not None and attributes["dt"] and not {"m", "m_older"} <= arrays.keys():
        return "damaged restart file: its masses per area m, m_older are missing"
    for side, name, speed in (("1", "u1", scales.u1), ("2", "u2", scales.u2)):
        if case.surface.side(side) and np.sign(attributes[name]) != np.sign(speed):
            return (
                f"surface.{side} moved at {attributes[name]:g} m/s, now at {speed:g} m/s: "
                "a rough surface can neither start, stop nor turn round in mid-run"
            )
    return None


def changed_keys(earlier, now):
    """Messages ``fluid.viscosity was 0.002, is 0.004``, one for every changed key of the physics."""
    old, new = (flat_keys({k: v for k, v in d.items() if k not in NOT_PHYSICS}) for d in (earlier, now))
    keys = [key for key in {**old, **new} if old.get(key) != new.get(key)]
    return [f"{key} was {old.get(key, 'left out')}, is {new.get(key, 'left out')}" for key in keys]
