"""Layout of a post-processing result, and checks of its path."""

import hashlib
import io
import json
from pathlib import Path

import h5py

from ehlpetsc import __version__
from ehlpetsc.errors import OutputError
from ehlpetsc.results.atomic_write import atomic_write
from ehlpetsc.results.output_guard import check_output_path
from ehlpetsc.results.post_result import PostResult

FORMAT_VERSION = 1
DESCRIPTIONS = {
    "damage/s": ("m", "body coordinate, x = s + speed * time"),
    "damage/z_over_a": ("1", "depth over half width"),
    "damage/2": (
        "1",
        "fatigue damage of one pass, surface 2; nan where a point did not pass the whole contact",
    ),
    "damage/1": (
        "1",
        "fatigue damage of one pass, surface 1; nan where a point did not pass the whole contact",
    ),
    "damage/2_complete": ("1", "1 where a point of surface 2 entered and left the domain"),
    "damage/1_complete": ("1", "1 where a point of surface 1 entered and left the domain"),
    "damage/2_missed": ("1", "frames missing while a point of surface 2 was among the nodes"),
    "damage/1_missed": ("1", "frames missing while a point of surface 1 was among the nodes"),
    "damage/mean": ("1", "fatigue damage of a pass, mean of the passes"),
    "damage/deviation": ("1", "standard deviation of the damage of a pass, with n - 1"),
    "damage/largest": ("1", "largest damage of a pass"),
    "damage/count": ("1", "passes"),
    "damage/life": ("1", "passes to failure by Miner's sum, 1/mean"),
    "damage/cycles": ("1", "counted cycles of a pass"),
    "damage/peak_range": ("Pa", "largest equivalent stress range"),
    "asperities/s": ("m", "body coordinate of asperity peaks"),
    "asperities/height": ("m", "height of asperity peaks"),
    "asperities/damage": ("1", "damage under asperity peaks, at the nearest body point"),
    "asperities/largest": ("1", "largest damage near asperity peaks, within the root attribute within (z/a)"),
    "criteria/damage": ("1", "damage of one pass on the worst plane"),
    "criteria/inclination": ("degrees", "of the worst plane's normal, from x towards z in the section"),
    "criteria/tilt": ("degrees", "of the worst plane's normal, out of the section"),
    "criteria/utilisation": ("1", "of the fatigue limit; up to 1 no crack starts"),
    "criteria/rank_correlation": ("1", "Spearman's, with the damage of the paper's criterion, by depth"),
    "weibull/alpha": ("1", "Weibull scale of -log10 of damage"),
    "weibull/beta": ("1", "Weibull shape"),
    "weibull/alpha_likelihood": ("1", "Weibull scale of the largest likelihood"),
    "weibull/beta_likelihood": ("1", "Weibull shape of the largest likelihood"),
    "weibull/alpha_low": ("1", "lower bound of alpha, by resampling, at the root attribute bounds_level"),
    "weibull/alpha_high": ("1", "upper bound of alpha"),
    "weibull/beta_low": ("1", "lower bound of beta, by resampling, at the root attribute bounds_level"),
    "weibull/beta_high": ("1", "upper bound of beta"),
    "weibull/r_squared": ("1", "squared correlation of the median rank regression"),
    "weibull/at_least_one": ("1", "asperities with damage of 1 or more"),
    "weibull/undamaged": ("1", "asperities without damage, censored in the fit"),
    "temperature/highest": ("K", "highest surface temperature of a point in one pass"),
    "temperature/mean": ("K", "surface temperature of a point, mean over its time in the Hertz contact"),
    "temperature/flash": ("K", "flash temperature of a point: its highest over that of the body"),
    "profile/s": ("m", "body coordinate"),
    "profile/z": ("m", "profile height, positive out of the metal"),
}


def fingerprint(*items):
    """Hash of all inputs of a result: digest of the loads, settings, version of the program."""
    return hashlib.sha256(json.dumps([__version__, FORMAT_VERSION, items], default=repr).encode()).hexdigest()


def check_output(path, inputs):
    """Refuse an output that would overwrite a file other than a result of post-processing.

    Raises
    ------
    OutputError
        The path is one of `inputs` or another existing file, or its folder does not exist.
    """
    path = Path(path)
    if not path.parent.is_dir():
        raise OutputError(f"the folder of the output {path} does not exist")
    if path.is_symlink() and not path.exists():
        raise OutputError(f"the output {path} is a link to nowhere")
    check_output_path(path, map(Path, inputs), "-o")
    if path.exists() and stored_fingerprint(path) is None:
        raise OutputError(
            f"the output {path} exists and is not a result of post-processing: remove it or give another -o"
        )


def write_result(path, datasets, attrs, group_attrs):
    """Write a result atomically: in memory, then to a temporary file, which is renamed.

    HDF5 crashes on a full disk, a plain write does not.

    Parameters
    ----------
    path : path-like
    datasets : dict
        Arrays by name; the second surface is before the last part of the name, as in ``weibull/1/alpha``.
    attrs, group_attrs : dict
        Root attributes; attributes by group name.

    Raises
    ------
    OSError
        The disk is full or the folder is read-only; no file is left.
    """
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        file.attrs.update({"format_version": FORMAT_VERSION, **attrs})
        for name, values in datasets.items():
            units, long_name = DESCRIPTIONS[_plain(name)]
            file[name] = values
            file[name].attrs.update(units=units, long_name=long_name)
        for name, values in group_attrs.items():
            file.require_group(name).attrs.update(values)
        _scales(file)
    atomic_write(path, image.getbuffer())


def _plain(name):
    """Key of a dataset in DESCRIPTIONS: its name without the second surface."""
    group, *_, last = name.split("/")
    plain = f"{group}/{last}"
    return plain if plain in DESCRIPTIONS else f"{group}/{last.partition('_')[2]}"


def _scales(file):
    s, z = file["damage/s"], file["damage/z_over_a"]
    s.make_scale("s")
    z.make_scale("z_over_a")
    for group in file.get("criteria", {}).values():
        for dataset in group.values():
            dataset.dims[0].attach_scale(z)
            if dataset.ndim == 2:
                dataset.dims[1].attach_scale(s)
    for dataset in file.get("temperature", {}).values():
        dataset.dims[0].attach_scale(s)
    for dataset in file["damage"].values():
        if isinstance(dataset, h5py.Dataset) and dataset.ndim == 2:
            dataset.dims[0].attach_scale(z)
            dataset.dims[1].attach_scale(s)
        elif isinstance(dataset, h5py.Dataset) and dataset not in (s, z):
            dataset.dims[0].attach_scale(s)


def stored_fingerprint(path):
    """Fingerprint of a finished result; None for other files."""
    try:
        return PostResult(path).attrs.get("fingerprint")
    except OutputError:
        return None
