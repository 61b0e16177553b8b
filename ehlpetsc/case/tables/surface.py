"""Keys of `[surface]`: measured and synthetic profiles."""

from __future__ import annotations

from hashlib import file_digest
from typing import Any

from ehlpetsc.base.case import KINDS, Case, changed_files
from ehlpetsc.base.declarations import Key, KeyTable, Refused, Required, Values
from ehlpetsc.base.errors import CaseError

HEIGHT_UNITS = ("m", "mm", "um", "nm", "angstrom", "inch", "microinch", "mil")  # of profile files
SIDES = ("1", "2")
LENGTH, HEIGHT = ("m", 1e-9, 1), ("m", 1e-12, 1e-2)
SOURCES = ("file", "synthetic", "z")
AREAL = tuple(name for name, kind in KINDS.items() if kind.is_areal)  # kinds of contact


def _kinds(*kinds: str, text: str, keys: dict[str, Key]) -> dict[str, KeyTable]:
    """The same table for several kinds of synthetic profiles."""
    kind = Required("kind of profile", choices=kinds)
    return dict.fromkeys(kinds, KeyTable("surface.1.synthetic", text, {"kind": kind} | keys))


GROUND_KEYS = {
    "ra": Required("mean height deviation", "m", 1e-12, 1e-3),
    "correlation": Required("`l` of the autocorrelation `exp(-(lag/l)^2)`", *LENGTH),
    "skewness": Key("negative: plateaus with valleys", "", -3, 3, default=0.0),
    "seed": Required("of the random numbers", "", 0, 2**32 - 1, kind=int),
    "correlation_across": Key(
        "`l` across, of an areal surface with a lay; left out: ridges", *LENGTH, contacts=AREAL
    ),
}
SELF_AFFINE_KEYS = {
    "sq": Required("root mean square height", "m", 1e-12, 1e-3),
    "hurst": Required(
        "`H`: the spectrum `C` falls with `q^(-2 H - 1)`, of a map `q^(-2 H - 2)`", "", gt=0, le=1
    ),
    "roll_off": Required("wavelength above which `C` is constant", *LENGTH),
    "short_cutoff": Required("shortest wavelength", *LENGTH, below="roll_off"),
    "peklenik": Key(
        "of a map: waves along its rows, of unchanged spectrum, over those across",
        "",
        0.01,
        100,
        default=1.0,
        contacts=AREAL,
    ),
    "seed": GROUND_KEYS["seed"],
}
WAVE_KEYS = {
    "amplitude": Required("half of the peak to valley height", *HEIGHT),
    "wavelength": Required("crest to crest; sine: `z = amplitude cos(2 pi X/wavelength)`", *LENGTH),
}
SINE_KEYS = WAVE_KEYS | {
    "wavelength_across": Key(
        "of an areal surface, `z = amplitude cos(2 pi X/wavelength) cos(2 pi y/wavelength_across)`; "
        "left out: ridges",
        *LENGTH,
        contacts=AREAL,
    )
}
BUMP_KEYS = {
    "amplitude": Required("height of the ridge, depth of the dent", *HEIGHT),
    "wavelength": Required("full width at 1/e, `exp(-(2 (X - position)/wavelength)^2)`", *LENGTH),
    "position": Key("abscissa of the centre; left out: 2 wavelengths", "m", 0, 10),
    "wavelength_across": Key(
        "full width across; left out: endless ridge, round dent", *LENGTH, contacts=AREAL
    ),
}
SYNTHETIC = (
    _kinds("ground", text="random profile with prescribed Ra and skewness", keys=GROUND_KEYS)
    | _kinds("sine", text="wave with a crest at profile abscissa 0", keys=SINE_KEYS)
    | _kinds("square", text="wave with a crest at profile abscissa 0", keys=WAVE_KEYS)
    | _kinds("ridge", "dent", text="single ridge or dent of Gaussian shape", keys=BUMP_KEYS)
    | _kinds("self-affine", text="random profile or map with a self-affine spectrum", keys=SELF_AFFINE_KEYS)
)


def _check_source(profile: Values) -> dict[str, Any]:
    """Refuse keys that do not belong to the one source of the profile."""
    values = profile.as_dict()
    given = {key for key, value in values.items() if value is not None and value is not False}
    if len(given & set(SOURCES)) != 1:
        raise Refused("needs either file or synthetic, or the heights z: one of them")
    if profile.z is None and profile.x is not None:
        raise Refused("x is for heights z")
    if profile.z is not None and (profile.x is None) == (profile.spacing is None):
        raise Refused("heights z need either x or spacing")
    is_matrix = profile.z is not None and isinstance(profile.z[0], list)
    columns = len(profile.z[0]) if is_matrix else len(profile.z or ())
    if profile.x is not None and len(profile.x) != columns:
        raise Refused(f"x has {len(profile.x)} values, z {columns}; allowed: as many")
    if (profile.y is not None) != (is_matrix and profile.x is not None):
        raise Refused("x and y are both for the rows and columns of a matrix z, y for no other z")
    if profile.y is not None and len(profile.y) != len(profile.z):
        raise Refused(f"y has {len(profile.y)} values, z {len(profile.z)} rows; allowed: as many")
    if profile.level and profile.form:
        raise Refused("level is the form of degree 1: write one of them")
    of_file = [key for key in ("columns", "decimal", "header_lines", "mask") if key in given]
    if profile.z is not None and of_file:
        raise Refused(f"{', '.join(of_file)}: for a file, not for heights z")
    for_a_file = [key for key in values if key in given and key not in (*SOURCES, "scale", "direction")]
    if profile.synthetic and for_a_file:
        raise Refused(f"{', '.join(for_a_file)}: for a file, not for a synthetic profile")
    return {}


PROFILE_KEYS = {
    "file": Key("profile file, beside the case file", kind=str),
    "unit": Key("of the heights in the file; left out: m", choices=HEIGHT_UNITS),
    "x_unit": Key("of x in the file; left out: as unit", choices=HEIGHT_UNITS),
    "spacing": Key("distance of points without x in the file", *LENGTH),
    "spacing_across": Key("distance of the rows of a map; left out: as spacing", *LENGTH, contacts=AREAL),
    "columns": Key("of x and z, or of z, counted from 1", "", 1, 1000, kind=int, many="list", max_items=2),
    "decimal": Key("decimal sign; left out: found from the file", choices=(".", ",")),
    "header_lines": Key("lines before the numbers; left out: found from the file", "", 0, 100_000, kind=int),
    "fill_gaps": Key("longest gap of missing heights that is filled", "m", 0, 1),
    "bridge_spikes": Key("take spikes of at most five points for missing heights", kind=bool, default=False),
    "z": Key(
        "heights in unit, here instead of in a file; of a map: its rows",
        "",
        -1e9,
        1e9,
        many="list or matrix",
        min_items=4,
    ),
    "x": Key("of the heights z, in x_unit; with spacing left out", "", -1e9, 1e9, many="list", min_items=4),
    "y": Key("of the rows of z, in x_unit; with spacing left out", "", -1e9, 1e9, many="list", min_items=4),
    "level": Key(
        'subtract the least-squares line or plane; "rows": the line of each row',
        kind=bool,
        default=False,
        words=("rows",),
    ),
    "mask": Key(
        "of a map: file of a matrix beside it; where it is not 0, heights are missing",
        kind=str,
        contacts=AREAL,
    ),
    "form": Key("degree of the least-squares polynomial subtracted", "", 1, 12, kind=int),
    "cutoff": Key("Gaussian high-pass, ISO 16610-21: a wave `L` loses `2^(-(cutoff/L)^2)` of it", *LENGTH),
    "short_cutoff": Key(
        "Gaussian low-pass, ISO 3274: a wave `L` keeps `2^(-(short_cutoff/L)^2)`", *LENGTH, below="cutoff"
    ),
    "direction": Key("of the rows of a map against x, towards y", "degrees", -360, 360, contacts=AREAL),
    "position_across": Key(
        "of a map: its Y that runs along y = 0; left out: its middle", "m", 0, 10, contacts=AREAL
    ),
    "flip": Key("run the profile from its other end", kind=bool, default=False),
    "synthetic": Key('{ kind = "' + '" | "'.join(SYNTHETIC) + '", ... }', kind=dict, variants=SYNTHETIC),
    "scale": Key("factor on the heights; negative: turned over", "", -1e4, 1e4, default=1.0),
}
PROFILE = KeyTable(
    "surface.1",
    "measured or synthetic profile; surface 1 moves at u (1 + xi/2), surface 2 at u (1 - xi/2)",
    PROFILE_KEYS,
    complete=_check_source,
)


def file_digests(case: Case) -> dict[str, str]:
    """SHA-256 of the present surface files of a case by their keys; "" of a missing one."""
    digests = {}
    for side in SIDES:
        table = case.surface.side(side)
        names = {"file": table.file, "mask": table.mask} if table and table.file else {}
        for key, name in names.items():
            if name:
                try:
                    with open((case.path.parent / table.file).parent / name, "rb") as file:
                        digests[f"surface.{side}.{key}"] = file_digest(file, "sha256").hexdigest()
                except OSError:
                    digests[f"surface.{side}.{key}"] = ""
    return digests


def check_unchanged(case: Case) -> None:
    """Refuse a case whose surface files are no longer as they were read: CaseError."""
    if changed := changed_files(case.digests, file_digests(case)):
        raise CaseError([f"{case.path}: {changed}: changed since the case was read; load the case again"])


class Surface(Values):
    """`[surface]`: a missing surface is smooth."""

    def side(self, name: str) -> Any:
        """Profile of surface "1" or "2"; None: smooth."""
        return {"1": self.body_1, "2": self.body_2}[name]


SIDE_KEYS = {side: PROFILE.key for side in SIDES}
SURFACE = KeyTable("surface", "left out: smooth", SIDE_KEYS, always=True, values=Surface)
