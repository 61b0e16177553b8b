"""State of a run in a restart file: saving, loading, checks against the case.

The file is HDF5 after a header with a checksum of the content: the user block of the file, 512 bytes that
HDF5 does not use. A file with any wrong byte is refused before HDF5 reads it.
"""

from __future__ import annotations

import hashlib
import io
import json
import tomllib
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

from ehlpetsc.base.case import changed_files
from ehlpetsc.base.errors import OutputError
from ehlpetsc.base.toml_file import plain
from ehlpetsc.case.conditions import with_file
from ehlpetsc.case.tables import CASE
from ehlpetsc.case.values import show
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.effects import EFFECTS
from ehlpetsc.effects.effect import flat, unflat
from ehlpetsc.physics.scales import NODE_TOLERANCE, Scales
from ehlpetsc.results.hdf5_file import LIBVER, attributes, open_for_reading
from ehlpetsc.results.index import flat_keys
from ehlpetsc.results.output_guard import OVERWRITE_ADVICE, atomic_write
from ehlpetsc.stepping.state import State, TimeLevel

if TYPE_CHECKING:
    from ehlpetsc.case.loading import Case
    from ehlpetsc.run.simulation import Simulation


TOTAL, RECORD = "total ", "record "  # prefixes of the names of totals and of effects with a record
EARLIER = "earlier {}"  # prefix of the values of an earlier level
OF_STATE = ("m", "m_older", "time", "dt", "step", "retries", "travelled", "error")
NOT_PHYSICS = ("title", "output", "post", "petsc", "series")  # tables whose changes are not reported
SCALE_TOLERANCE = 1e-12  # relative
SCALE_NAMES = ("a", "p0", "h")  # of load, radius and elasticity
MAX_NAMED = 3  # changed keys in a refusal
SPEEDS = ("motion", "operation", "gears")  # tables


class Checkpoint(NamedTuple):
    """State from which a run continues.

    `baseline` are steady q and w for the predictor, `contact_count` the steps in contact of each node,
    `totals` those of all steps so far.
    """

    state: State
    baseline: tuple[np.ndarray, np.ndarray]
    contact_count: np.ndarray
    totals: dict[str, float]


def axes_of(scales: Scales) -> dict[str, np.ndarray]:
    """Nodes in half-widths by the name of their axis."""
    return dict(zip("xy", reversed(scales.grid.axes), strict=False))


def save(path: Path, simulation: Simulation, contact_count: np.ndarray, totals: dict[str, float]) -> None:
    """Write the restart file of a simulation at its last state; other arguments as of `Checkpoint`."""
    case, scales, state = simulation.case, simulation.scales, simulation.dimensionless
    baseline_q, baseline_w = simulation.stepper.baseline
    values: dict[str, Any] = {"contact_count": contact_count}
    values |= {name: nodes * scales.a for name, nodes in axes_of(scales).items()}
    values |= {"baseline_q": baseline_q, "baseline_w": baseline_w, "pass_number": simulation.pass_number}
    values |= {"case": case.text, "digests": json.dumps(case.digests), "contact_law": case.contact.law}
    values |= {name: getattr(scales, name) for name in SCALE_NAMES} | flat(state.unknowns, "unknowns")
    values |= {name: value for name in OF_STATE if (value := getattr(state, name)) is not None}
    for number, level in enumerate(state.earlier):
        values |= flat(level, EARLIER.format(number))
    for name, record in state.records.items():
        values |= {RECORD + name: 1} | flat(record, name)
    save_restart(path, values | {TOTAL + name: value for name, value in totals.items()})


def load(path: Path, case: Case, scales: Scales) -> tuple[Checkpoint, list[str]]:
    """Content of a restart file, and a message on each key of the case that has changed.

    An OutputError if the file is no restart file, is damaged, or does not fit the case.
    """
    if case.time is None:
        raise OutputError(f"{path}: the case is steady (no [time]); it has no time steps to continue")
    values = load_restart(path)
    earlier = tomllib.loads(values["case"])
    if misfit := _misfit(values, earlier, case, scales):
        raise OutputError(f"{path}: {misfit}")
    changes = changed_keys(earlier, tomllib.loads(case.text), case)
    named = " ".join(changes)  # a change of the file that a key names is reported
    check_surfaces(path, values, {key: one for key, one in case.digests.items() if key not in named})
    return _checkpoint(values), changes


def pass_of(path: Path) -> int:
    """Number of the pass of a restart file; errors as in :func:`load`."""
    return load_restart(path)["pass_number"]


def changed_keys(earlier: dict, now: dict, case: Case) -> list[str]:
    """Messages ``fluid.viscosity was 0.002, is 0.004``, one for every changed key of the physics.

    `case`: of now.
    """
    old, new = (flat_keys({k: v for k, v in d.items() if k not in NOT_PHYSICS}) for d in (earlier, now))
    keys = [key for key in {**old, **new} if old.get(key) != new.get(key)]
    shown = [[show(of[key]) if key in of else "left out" for key in keys] for of in (old, new)]
    changes = zip(keys, *shown, strict=True)
    return [f"{with_file(key, case)} was {before}, is {after}" for key, before, after in changes]


def _checkpoint(values: dict[str, Any]) -> Checkpoint:
    effects = [effect for effect in EFFECTS if RECORD + effect.name in values]
    levels = [name for name in map(EARLIER.format, range(2)) if f"{name}.q" in values]
    of_state = {name: values[name] for name in OF_STATE if name in values}
    state = State(
        unflat(Unknowns, values, "unknowns"),
        **of_state | {"travelled": tuple(values["travelled"])},
        earlier=tuple(unflat(TimeLevel, values, name) for name in levels),
        records={effect.name: unflat(effect.record, values, effect.name) for effect in effects},
    )
    totals = {name.removeprefix(TOTAL): value for name, value in values.items() if name.startswith(TOTAL)}
    baseline = values["baseline_q"], values["baseline_w"]
    return Checkpoint(state, baseline, values["contact_count"], totals)


def _misfit(values: dict[str, Any], earlier: dict, case: Case, scales: Scales) -> str | None:
    """Reason why a file does not fit the case; None if it fits."""
    now_table = tomllib.loads(case.text)
    if not all(np.isclose(values[name], getattr(scales, name), rtol=SCALE_TOLERANCE) for name in SCALE_NAMES):
        changes = _changes_of(("contact", "operation", "gears"), earlier, now_table, case)
        return f"of another load, radius or elasticity{changes}; what changes with time is in [operation]"
    for axis, now in axes_of(scales).items():
        x, where = values.get(axis, np.zeros(1)) / values["a"], " across" if axis == "y" else ""
        if len(x) != len(now):
            return f"has {len(x)} nodes{where}, the case {len(now)}; [mesh] must be as it was"
        if np.abs(x - now).max() > NODE_TOLERANCE * np.ptp(now):
            return (
                f"begins at {x[0]:.6g} half-widths{where}, the case at {now[0]:.6g}; [mesh] must be as it was"
            )
    if ("fluid" in earlier) != (case.fluid is not None) or values["contact_law"] != case.contact.law:
        return "of another contact model, or of oil where there is none now; both must be as they were"
    start = earlier.get("time", {}).get("start", "smooth")
    if case.time.start != start:
        return f'time.start was "{start}"; it must be as it was, or the profiles would jump'
    if any(now_table.get(name) != earlier.get(name) for name in SPEEDS):
        changes = _changes_of(SPEEDS, earlier, now_table, case)
        as_before = f"{', '.join(SPEEDS)} must be as they were, or the profiles would jump"
        return f"of other speeds{changes}; {as_before}"
    return None


def _changes_of(names: Collection[str], earlier: dict, now: dict, case: Case) -> str:
    """Changed keys of some tables after a colon; "": none."""
    before, after = ({name: of[name] for name in names if name in of} for of in (earlier, now))
    changes = changed_keys(before, after, case)
    more = f" and {len(changes) - MAX_NAMED} more" if len(changes) > MAX_NAMED else ""
    return f": {', '.join(changes[:MAX_NAMED])}{more}" if changes else ""


VERSION = 9  # of the format
HEADER_BYTES = 512
SIGNATURE = b"ehlpetsc restart file %d\n" % VERSION


def save_restart(path: Path, values: dict[str, object]) -> None:
    """Save arrays, numbers and texts to a temporary file, synchronised to disk, then renamed; OutputError."""
    content = io.BytesIO()
    with h5py.File(content, "w", libver=LIBVER, userblock_size=HEADER_BYTES) as file:
        for name, value in values.items():
            (file if isinstance(value, np.ndarray) else file.attrs)[name] = value
    body = content.getbuffer()[HEADER_BYTES:]
    atomic_write(path, _header(body) + bytes(body))


def load_restart(path: Path) -> dict[str, Any]:
    """Values of a file of :func:`save_restart`.

    An OutputError if the file is missing, damaged, no restart file, or of another version.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise OutputError(f"{path}: not read, {error.strerror}") from error
    if not content.startswith(SIGNATURE):
        raise OutputError(f"{path}: not a restart file of this ehlpetsc")
    if content[:HEADER_BYTES] != _header(memoryview(content)[HEADER_BYTES:]):
        raise OutputError(f"{path}: damaged restart file: its content does not agree with its checksum")
    with h5py.File(io.BytesIO(content), "r") as file:
        return {name: file[name][()] for name in file} | plain(dict(file.attrs))


def is_restart_of(path: Path, case: Case) -> bool:
    """Whether a file is an undamaged restart file of a case; an OutputError if a surface file has changed."""
    try:
        values = load_restart(path)
    except OutputError:
        return False
    return _is_of_same(path, values, case)


def _is_of_same(path: Path, values: dict[str, Any], case: Case) -> bool:
    if values["case"] != case.text:
        return False
    check_surfaces(path, values, case.digests)
    return True


def is_earlier_part(path: Path, restart: Path) -> bool:
    """Whether the result at a path holds the steps before those of a restart file, by the case of its run."""
    values = load_restart(restart)
    try:
        with open_for_reading(path) as file:
            attrs = attributes(file)
        runs = [*json.loads(attrs["history"]), {"case": attrs["case"], "up_to_step": np.inf}]
    except (OutputError, OSError, KeyError):
        return False
    ends = [run["up_to_step"] for run in runs]
    of_step = [begin <= values["step"] <= end for begin, end in zip([0, *ends], ends, strict=False)]
    return any(here and run["case"] == values["case"] for here, run in zip(of_step, runs, strict=True))


def check_surfaces(path: Path, values: dict[str, Any], digests: dict[str, str]) -> None:
    """Refuse values of a restart file of surface files with another content: OutputError."""
    if changed := changed_files(json.loads(values.get("digests", "{}")), digests):
        reason = f"{changed} changed since it was written, and the surface would jump"
        raise OutputError(f"{path}: {reason}; put the file back, {OVERWRITE_ADVICE}")


def restart_of_same(path: Path, restart: Path, case: Case) -> Path | None:
    """Restart file from which the same command continues an unfinished run; None: it begins at time 0.

    A run begins at time 0 if the result of the same case is complete, or if the run was killed before its
    first restart file. Any other file at the path of the result or of the restart file is refused.
    """
    status = None
    if path.exists():
        try:
            with open_for_reading(path) as file:
                attrs = attributes(file)
            status, text = attrs["status"], attrs["case"]
        except (OutputError, KeyError):
            raise OutputError(f"{path}: exists and is not a result of ehlpetsc; {OVERWRITE_ADVICE}") from None
        if text != case.text:
            changes = _changes_of(CASE.keys, tomllib.loads(text), tomllib.loads(case.text), case)
            reason = f"holds a run of another case, or of other --set{changes}"
            raise OutputError(f"{path}: {reason}; {OVERWRITE_ADVICE}")
    if status == "done" or not restart.exists():
        return None
    try:
        values = load_restart(restart)
    except OutputError as error:
        raise OutputError(f"{error}; remove it, {OVERWRITE_ADVICE}") from None
    same = _is_of_same(restart, values, case)
    if not same or status is None:
        kind = "whose result is gone" if same else "of another case, or of other --set"
        advice = f"continue with --restart {restart}, {OVERWRITE_ADVICE}"
        raise OutputError(f"{restart}: a restart file waits there, {kind}; {advice}")
    return restart


def _header(body: memoryview) -> bytes:
    checksum = hashlib.sha256(body).hexdigest().encode()
    return (SIGNATURE + b"sha256 %s\n" % checksum).ljust(HEADER_BYTES, b"\0")
