"""Result files damaged: single bits, and datasets, groups and attributes replaced by something else."""

from pathlib import Path

import h5py
import numpy as np

LARGEST = 1_000_000  # values that a dataset may have to be read and changed here


def raw_bytes(path):
    """Which bytes of the file are raw data, a mask."""
    mask = np.zeros(Path(path).stat().st_size, bool)

    def mark(_, item):
        if not isinstance(item, h5py.Dataset):
            return
        if item.chunks is None:
            begin = item.id.get_offset()
            if begin is not None:
                mask[begin : begin + item.id.get_storage_size()] = True
            return
        for k in range(item.id.get_num_chunks()):
            chunk = item.id.get_chunk_info(k)
            mask[chunk.byte_offset : chunk.byte_offset + chunk.size] = True

    with h5py.File(path) as file:
        file.visititems(mark)
    return mask


class Flips:
    """One bit of the base file turned over: every second time in what is not raw data."""

    def __init__(self, base):
        self.content, raw = bytearray(base.read_bytes()), raw_bytes(base)
        used = np.frombuffer(self.content, np.uint8) != 0  # much of the rest is room in reserve
        self.places = np.flatnonzero(~raw & used), np.arange(len(raw))

    def __call__(self, rng, number, path):
        """Write spoiled file `number`; returns what was done to it."""
        place, bit = int(rng.choice(self.places[number % 2])), int(rng.integers(8))
        content = bytearray(self.content)
        content[place] ^= 1 << bit
        path.write_bytes(content)
        return f"byte {place} bit {bit}"


DATASETS = ("x", "time", "step", "pressure", "shear_stress_2", "shear_stress_1")
DEEPER = ("surface/2/s", "surface/2/z", "surface/1/s", "steps/load", "steps/p_max", "steps/step")
GROUPS = ("surface", "surface/2", "steps")
ATTRIBUTES = ("case", "a", "p0", "u1", "u2", "status", "title", "format_version")
STRANGE = (
    lambda shape: np.zeros(shape, complex),
    lambda shape: np.zeros(shape, bool),
    lambda shape: np.zeros(shape, "S3"),
    lambda shape: np.full(shape, np.nan),
    lambda shape: np.full(shape, np.inf),
    lambda shape: np.full(shape, 1e308),
    lambda shape: np.full(shape, -1.0),
    lambda shape: np.zeros(shape),
    lambda shape: np.zeros(shape, "u8") + np.uint64(2**63),
    lambda shape: np.zeros(shape, "f2"),
    lambda shape: np.zeros(shape, [("a", "f8"), ("b", "i4")]),
    lambda shape: np.zeros((*shape, 2)),
    lambda shape: np.zeros(shape[:1]),
    lambda shape: np.zeros((0, *shape[1:])),
    lambda shape: np.zeros((1, *shape[1:])),
    lambda shape: np.zeros(shape[::-1]),
    lambda shape: np.float64(1.0),
    lambda shape: "a text",
    lambda shape: np.random.default_rng(0).normal(size=shape) * 1e9,
    lambda shape: h5py.Empty("f8"),
)
VALUES = (
    *(np.nan, np.inf, -1.0, 0.0, 1e300, 1e-300, 2**70 * 1.0, -(2**60), True, "a text", "", b"\xff\xfe"),
    *(np.zeros(3), np.zeros((0,)), np.zeros((2, 2)), 1 + 2j, h5py.Empty("f8"), ["a", "b"]),
    *("[" * 3000, "a = " + "9" * 5000, "[contact]\n", "contact = 3", "[post]\ndepths = [[1]]", "\x01" * 50),
    *("[contact]\nload = inf\n", "[contact]\nload = 0\nradius = -1\n", "a = 1\na = 2", "time = [1]"),
)
SLIPS = (
    ("load = 527e3", "load = true", 'load = "much"', "load = 1e400", "load = -1"),
    ("poisson_ratio = [0.3, 0.3]", "poisson_ratio = 0.3", "poisson_ratio = [0.3]", "poisson_ratio = [1, 1]"),
    (
        "depths = [0.1]",
        "depths = 0.1",
        "depths = [[0.1]]",
        "depths = [1e300]",
        "depths = [nan]",
        "depths = []",
    ),
    (
        "b = -0.09",
        "b = 1e-320",
        "b = -1e300",
        "c = -1e-300",
        "fatigue_strength = 1e-300",
        "cyclic_strength = 0",
        "cyclic_hardening = 1e-300",
        "fatigue_ductility = 1e300",
    ),
    ("slide_roll_ratio = 0.5", "slide_roll_ratio = 1e308", "slide_roll_ratio = []", "slide_roll_ratio = nan"),
    ("travel = 7.0", "courant = 0", "courant = 1e-300", 'courant = "x"', "courant = 1e300"),
    (
        "[output]",
        "[mesh]\npoints_per_half_width = 0\ninlet = -2.5\n[output]",
        "[mesh]\ninlet = 1e308\npoints_per_half_width = 1e-300\n[output]",
        "[output.x]",
    ),
)


def remove(rng, file):
    name = str(rng.choice(DATASETS + DEEPER + GROUPS))
    if name in file:
        del file[name]
    return f"without {name}"


def other_values(rng, file):
    name, which = str(rng.choice(DATASETS + DEEPER)), int(rng.integers(len(STRANGE)))
    item = file.get(name)
    shape = item.shape if isinstance(item, h5py.Dataset) and (item.size or 0) <= LARGEST else (5,)
    if name in file:
        del file[name]
    file[name] = STRANGE[which](shape or (5,))
    return f"{name}: strange values {which}"


def other_rows(rng, file):
    name = str(rng.choice(DATASETS + DEEPER))
    item = file.get(name)
    if not isinstance(item, h5py.Dataset) or not item.shape or item.size > LARGEST:
        return "nothing"
    values, how = item[:], int(rng.integers(6))
    del file[name]
    take = (
        lambda v: v[: len(v) // 2],
        lambda v: v[::-1],
        lambda v: np.concatenate([v, v]),
        lambda v: np.roll(v, 1, axis=0),
        lambda v: v * 10.0 ** rng.integers(-12, 12),
        lambda v: v.astype(rng.choice(["f4", "i4", "i8", "u1"])),
    )[how]
    with np.errstate(all="ignore"):
        file[name] = take(values)
    return f"{name}: rows {how}"


def one_value(rng, file):
    name = str(rng.choice(DATASETS + DEEPER))
    item = file.get(name)
    if (
        not isinstance(item, h5py.Dataset)
        or item.dtype.kind not in "fiu"
        or not 0 < (item.size or 0) <= LARGEST
    ):
        return "nothing"
    values = item[...]
    place = int(rng.integers(values.size))
    with np.errstate(all="ignore"):
        value = rng.choice([np.nan, np.inf, -np.inf, 1e308, -1e9, 0.0, 1e-320, -1.0])
        values.flat[place] = np.array(value).astype(values.dtype)
    item[...] = values
    return f"{name}[{place}]"


def other_attribute(rng, file):
    name, which = str(rng.choice(ATTRIBUTES)), int(rng.integers(len(VALUES)))
    holder = file
    if rng.random() < 0.3:
        place = str(rng.choice(DATASETS + GROUPS[1:]))
        holder, name = file.get(place, file), str(rng.choice(["units", "speed"]))
    holder.attrs.pop(name, None)
    try:
        holder.attrs[name] = VALUES[which]
    except (OSError, ValueError, TypeError, RuntimeError):  # not to be stored
        return "nothing"
    return f"attribute {name}: value {which}"


def without_attribute(rng, file):
    name = str(rng.choice(ATTRIBUTES))
    file.attrs.pop(name, None)
    return f"without attribute {name}"


def other_case(rng, file):
    case = file.attrs.get("case")
    if not isinstance(case, str):
        return "nothing"
    slip = SLIPS[rng.integers(len(SLIPS))]
    wrong = str(rng.choice(slip[1:]))
    if rng.random() < 0.4:
        place = int(rng.integers(len(case)))
        case = case[:place] + str(rng.choice(list('\x00"[]{}=.9eé\n'))) + case[place + 1 :]
    file.attrs["case"] = case.replace(slip[0], wrong)
    return f"case: {wrong}"


def linked(rng, file):
    name = str(rng.choice(DATASETS + DEEPER + GROUPS))
    if name in file:
        del file[name]
    kind = int(rng.integers(5))
    if kind == 0:
        file[name] = h5py.SoftLink("/nowhere")
    elif kind == 1:
        file[name] = h5py.SoftLink(f"/{name}")
    elif kind == 2:
        file[name] = h5py.ExternalLink("nowhere.h5", "/x")
    elif kind == 3:
        file[name] = file  # a group, the root itself
    else:
        file.require_group(name)
    return f"{name}: link {kind}"


def huge(rng, file):
    name = str(rng.choice(DATASETS + DEEPER))
    if name in file:
        del file[name]
    frames = int(10 ** rng.integers(7, 16))
    shape = (frames, 41) if name.startswith(("pressure", "shear")) else (frames,)
    file.create_dataset(name, shape, "f8", chunks=(1000, 41)[: len(shape)])
    return f"{name}: {frames} rows"


STRUCTURES = (
    *(remove, other_values, other_values, other_rows, one_value, other_attribute, without_attribute),
    *(other_case, other_case, linked, huge),
)


class Structures:
    """One to three changes of the base file's structure."""

    def __init__(self, base):
        self.content = base.read_bytes()

    def __call__(self, rng, number, path):
        """Write spoiled file `number`; returns what was done to it."""
        path.write_bytes(self.content)
        changes = []
        with h5py.File(path, "r+") as file:
            for _ in range(1 + int(rng.integers(3))):
                change = STRUCTURES[rng.integers(len(STRUCTURES))]
                try:
                    changes.append(change(rng, file))
                except Exception as fault:  # what is spoiled already cannot be changed in every way
                    changes.append(f"{change.__name__} stopped by {type(fault).__name__}")
        return ", ".join(changes)


class Strange:
    """One dataset of the base file, of whatever name, away or with strange values in its place."""

    def __init__(self, base):
        self.content, self.names = base.read_bytes(), []
        with h5py.File(base) as file:
            file.visititems(lambda name, item: self.names.append(name) if hasattr(item, "shape") else None)

    def __call__(self, rng, number, path):
        """Write spoiled file `number`; returns what was done to it."""
        path.write_bytes(self.content)
        name, which = str(rng.choice(self.names)), int(rng.integers(-1, len(STRANGE)))
        with h5py.File(path, "r+") as file:
            shape = file[name].shape
            del file[name]
            if which >= 0:
                file[name] = STRANGE[which](shape or (5,))
        return f"{name}: strange values {which}"
