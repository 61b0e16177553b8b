"""A run's state in a restart file: what is saved, and whether it fits the case it is to go on with."""

import tomllib

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.restart_file import load_restart, save_restart
from ehlpetsc.stepping.time_stepping import Level, State

TOTAL = "total "  # before the names of totals among the attributes
NOT_PHYSICS = ("title", "output", "post", "petsc", "series")  # tables that may change without a word


def save(path, state, smooth, contact_count, totals, case, scales, model):
    """Write the restart file of a run.

    Parameters
    ----------
    path : path-like
    state : time_stepping.State
    smooth : pair of ndarray
        Steady q and w that the predictor starts from.
    contact_count : ndarray of int, shape (nx,)
    totals : dict of str to number
        Of all steps so far, for the summary.
    case, scales, model
        Of the run; the contact model.

    Raises
    ------
    OutputError
    """
    arrays = {
        "x": scales.x * scales.a,
        "contact_count": contact_count,
    }
    arrays |= _fields(model, "", state.q, state.w) | _fields(model, "smooth_", *smooth)
    arrays |= {name: getattr(state, name) for name in ("m", "m_older") if getattr(state, name) is not None}
    if state.earlier:
        times, q, w = (np.array(part) for part in zip(*state.earlier, strict=True))
        arrays |= {"earlier_time": times} | _fields(model, "earlier_", q, w)
    attributes = {
        "h00": state.h00,
        "time": state.time,
        "dt": state.dt or 0.0,
        "retries": state.retries,
        "step": state.step,
        "case": case.text,
    }
    attributes |= {"p0": scales.p0, "h_scale": scales.h}
    attributes |= {TOTAL + name: value for name, value in totals.items()}
    save_restart(path, arrays, attributes)


def load(path, case, scales, model):
    """State of a restart file, checked against the case.

    Returns
    -------
    state : time_stepping.State
    smooth : pair of ndarray
    contact_count : ndarray
    totals : dict
    notes : list of str
        Keys of the case that are not what they were, one line each.

    Raises
    ------
    OutputError
        Not a restart file, or it does not fit the case.
    """
    if case.time is None:
        raise OutputError(f"{path}: the case is steady (no [time]); it has no time steps to go on with")
    arrays, attributes = load_restart(path)
    try:
        earlier = tomllib.loads(attributes["case"])
        _check_fits(path, arrays["x"], earlier, case, scales)
        _rescale(arrays, attributes, scales)
        state = State(
            *_unknowns(model, arrays, ""),
            float(attributes["h00"]),
            m=arrays.get("m"),
            m_older=arrays.get("m_older"),
            time=float(attributes["time"]),
            dt=float(attributes["dt"]) or None,
            retries=int(attributes.get("retries", 0)),
            step=int(attributes["step"]),
            earlier=_earlier(model, arrays),
        )
        smooth = _unknowns(model, arrays, "smooth_")
        totals = {name.removeprefix(TOTAL): attributes[name].item() for name in attributes if TOTAL in name}
        return state, smooth, arrays["contact_count"], totals, changes(earlier, tomllib.loads(case.text))
    except KeyError as error:
        raise OutputError(f"{path}: damaged restart file ({error} is missing)") from error


def _fields(model, name, q, w):
    """Arrays that say what q and w stand for, so that a run may go on with another contact model."""
    film = model.relations(q, w).film
    return {f"{name}q": q, f"{name}h": film, f"{name}contact_pressure": model.contact_pressure(w)}


def _unknowns(model, arrays, name):
    q, film, solids = (arrays[name + field] for field in ("q", "h", "contact_pressure"))
    return q, model.second_unknown(film, solids)


def _earlier(model, arrays):
    if "earlier_time" not in arrays:
        return ()
    return tuple(map(Level, arrays["earlier_time"], *_unknowns(model, arrays, "earlier_")))


def _check_fits(path, x, earlier, case, scales):
    now = scales.x * scales.a
    if len(x) != len(now):
        raise OutputError(f"{path}: has {len(x)} nodes, the case {len(now)}; [mesh] must be as it was")
    if np.abs(x - now).max() > 1e-9 * np.ptp(now):
        was, is_now = (f"{1e3 * ends[0]:.6g} to {1e3 * ends[-1]:.6g} mm" for ends in (x, now))
        raise OutputError(
            f"{path}: its nodes lie from {was}, those of the case from {is_now}; "
            "[mesh], contact.load, radius and elasticity must be as they were"
        )
    if ("fluid" in earlier) != (case.fluid is not None):
        one, other = ("with", "without") if "fluid" in earlier else ("without", "with")
        raise OutputError(f"{path}: a run {one} [fluid] cannot go on {other} it")


def _rescale(arrays, attributes, scales):
    """Pressures and films in the units of the case: under another load those of Hertz are others."""
    pressure, film = attributes["p0"] / scales.p0, attributes["h_scale"] / scales.h
    if pressure == film == 1.0:
        return
    for name in {"q", "smooth_q", "earlier_q"} & arrays.keys():  # negative: a void fraction
        arrays[name] = np.where(arrays[name] > 0.0, pressure, 1.0) * arrays[name]
    for name in {"contact_pressure", "smooth_contact_pressure", "earlier_contact_pressure"} & arrays.keys():
        arrays[name] = pressure * arrays[name]
    for name in {"h", "smooth_h", "earlier_h", "m", "m_older"} & arrays.keys():
        arrays[name] = film * arrays[name]
    attributes["h00"] *= film


def changes(earlier, now):
    """``fluid.viscosity was 0.002, is 0.004``, a line each for every key of the physics that differs."""
    one, other = (dict(_flat({k: v for k, v in d.items() if k not in NOT_PHYSICS})) for d in (earlier, now))
    keys = [key for key in {**one, **other} if one.get(key) != other.get(key)]
    return [f"{key} was {one.get(key, 'left out')}, is {other.get(key, 'left out')}" for key in keys]


def _flat(table, where=""):
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{where}{key}.")
        else:
            yield where + key, value
