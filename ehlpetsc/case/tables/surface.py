"""Keys of `[surface]`: measured and synthetic profiles."""

from __future__ import annotations

from typing import Any

from ehlpetsc.keys import Key, KeyTable, Refused, Values

UNITS = ("m", "mm", "um", "nm")  # of profile files
SIDES = ("1", "2")
SOURCES = ("file", "synthetic", "z")


def _length(text: str, **more: Any) -> Key:
    return Key(text, unit="m", ge=1e-9, le=1, **more)


def _synthetic(*kinds: str, text: str, keys: dict[str, Key]) -> dict[str, KeyTable]:
    kind = Key("kind of profile", str, choices=kinds, required=True)
    table = KeyTable("surface.1.synthetic", text, {"kind": kind} | keys)
    return dict.fromkeys(kinds, table)


SYNTHETIC = (
    _synthetic(
        "ground",
        text="random profile with prescribed Ra, correlation length and skewness",
        keys={
            "ra": Key("mean height deviation", unit="m", ge=1e-12, le=1e-3, required=True),
            "correlation": _length(
                "lag at which the autocorrelation is 1/e",
                required=True,
                equation="autocorrelation exp(-(lag/correlation)^2)",
            ),
            "skewness": Key("negative: plateaus with valleys", ge=-3, le=3, default=0.0),
            "seed": Key("of the random numbers", int, ge=0, le=2**32 - 1, required=True),
        },
    )
    | _synthetic(
        "sine",
        "square",
        text="cosine or square wave with a crest at profile abscissa 0",
        keys={
            "amplitude": Key("half of the peak to valley height", unit="m", ge=1e-12, le=1e-2, required=True),
            "wavelength": _length(
                "crest to crest", required=True, equation="sine: z = amplitude cos(2 pi X/wavelength)"
            ),
        },
    )
    | _synthetic(
        "ridge",
        "dent",
        text="single ridge or dent of Gaussian shape",
        keys={
            "amplitude": Key(
                "height of the ridge, depth of the dent", unit="m", ge=1e-12, le=1e-2, required=True
            ),
            "wavelength": _length("full width at 1/e", required=True),
            "position": Key(
                "abscissa of the centre; left out: 2 wavelengths",
                unit="m",
                ge=0,
                le=10,
                equation="z = +- amplitude exp(-(2 (X - position)/wavelength)^2)",
            ),
        },
    )
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
    if profile.x is not None and len(profile.x) != len(profile.z):
        raise Refused(f"x has {len(profile.x)} values, z {len(profile.z)}; allowed: as many")
    of_text = [key for key in ("columns", "decimal", "header_lines") if key in given]
    if profile.z is not None and of_text:
        raise Refused(f"{', '.join(of_text)}: for a file, not for heights z")
    for_a_file = [key for key in values if key not in (*SOURCES, "scale")]
    if profile.synthetic and given & set(for_a_file):
        raise Refused(f"{', '.join(for_a_file)} are for a file, not for a synthetic profile")
    return {}


PROFILE = KeyTable(
    "surface.1",
    "measured or synthetic profile; surface 1 moves at u (1 + xi/2), surface 2 at u (1 - xi/2)",
    {
        "file": Key("profile file, beside the case file", str),
        "unit": Key("unit of the heights in the file; left out: m", str, choices=UNITS),
        "x_unit": Key("unit of x in the file; left out: as unit", str, choices=UNITS),
        "spacing": _length("distance of points without x in the file"),
        "columns": Key(
            "of x and z in the file, or of z alone, counted from 1",
            int,
            ge=1,
            le=1000,
            many="list",
            max_items=2,
        ),
        "decimal": Key("decimal sign; left out: found from the file", str, choices=(".", ",")),
        "header_lines": Key("lines before the numbers; left out: found from the file", int, ge=0, le=100_000),
        "fill_gaps": Key("longest gap of missing heights that the spline bridges", unit="m", ge=0, le=1),
        "z": Key("heights in unit, here instead of in a file", ge=-1e9, le=1e9, many="list", min_items=4),
        "x": Key(
            "of the heights z, in x_unit; with spacing left out", ge=-1e9, le=1e9, many="list", min_items=4
        ),
        "level": Key("subtract the least-squares line", bool, default=False),
        "cutoff": _length(
            "Gaussian high-pass, ISO 16610-21",
            equation="a wave of length L loses 2^-(cutoff/L)^2 of its amplitude",
        ),
        "short_cutoff": _length(
            "Gaussian low-pass, S-filter of ISO 3274",
            below="cutoff",
            equation="a wave of length L keeps 2^-(short_cutoff/L)^2 of its amplitude",
        ),
        "flip": Key("run the profile from its other end", bool, default=False),
        "synthetic": Key('{ kind = "' + '" | "'.join(SYNTHETIC) + '", ... }', dict, variants=SYNTHETIC),
        "scale": Key("factor on the heights; negative: turned over", ge=-1e4, le=1e4, default=1.0),
    },
    complete=_check_source,
)


class Surface(Values):
    """`[surface]`: a missing surface is smooth."""

    def side(self, name: str) -> Any:
        """Profile of surface "1" or "2"; None: smooth."""
        return {"1": self.body_1, "2": self.body_2}[name]


SURFACE = KeyTable(
    "surface",
    "left out: smooth",
    {side: PROFILE.key for side in SIDES},
    always=True,
    values=Surface,
)
