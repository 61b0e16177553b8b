"""Arguments of the command, checked before a file is opened."""

import argparse
import math
from pathlib import Path

from ehlpetsc.command_parser import CommandParser
from ehlpetsc.errors import OutputError
from ehlpetsc.post.criteria import CRITERIA
from ehlpetsc.post.fatigue.accumulate import CHANNELS, MEAN_STRESSES, RANGES
from ehlpetsc.post.fatigue.cycles import RESIDUES
from ehlpetsc.post.fatigue.elastic_plastic import STRAINS
from ehlpetsc.post.fatigue.statistics import REGRESSIONS
from ehlpetsc.post.outputs.passes_index import is_of_passes
from ehlpetsc.post.run import ASPERITY_HALF_WIDTH
from ehlpetsc.results.post_result import SURFACES
from ehlpetsc.results.series_index import files_of


def _jobs(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be 1 or more")
    return value


def arguments(argv):
    """Parse the command line."""
    parser = CommandParser(
        "post",
        "Stress histories of body points, rainflow cycles, fatigue damage and its statistics "
        "from result files. Material and depths come from the case text in the file, section [post].",
    )
    add = parser.add_argument
    add(
        "results",
        nargs="+",
        metavar="RESULT.h5",
        help="several, as of one slide/roll ratio each: also compared; OUTPUT.series.json: its members; "
        "OUTPUT.passes.json: its passes, whose damage is then added to it",
    )
    add(
        "-o", "--output", metavar="FILE", help="result, of a single input (default: RESULT.post.h5 beside it)"
    )
    add("--surface", choices=("both", *SURFACES), default="both")
    add("--depths", nargs="+", type=float, metavar="Z/A", help="instead of those of [post]")
    add(
        "--set",
        action="append",
        default=[],
        metavar="post.KEY=VALUE",
        help="a key of [post], or contact.material, instead of that of the case; may be repeated",
    )
    add(
        "--count",
        choices=CHANNELS,
        default="max3",
        help="counted scalar; max3: largest damage among counting sx, sz and txz (default)",
    )
    add("--residue", choices=RESIDUES, default="closed", help="history repeated (default), or half cycles")
    add(
        "--ranges",
        choices=RANGES,
        default="reversals",
        help="ranges of a cycle: between its reversals (default) or the widest in its closed loop",
    )
    add("--mean-stress", choices=MEAN_STRESSES, default="none", help="morrow: with a floor to compression")
    add(
        "--strain",
        choices=STRAINS,
        help="how the elastic range enters the cyclic stress-strain curve: by Neuber's or by Glinka's rule, "
        "or as it is, as in the paper (default: that of [post], neuber)",
    )
    add(
        "--criterion",
        nargs="+",
        choices=CRITERIA,
        default=(),
        metavar="NAME",
        help="also compute, beside the paper's damage: " + ", ".join(CRITERIA),
    )
    add(
        "--within",
        type=float,
        default=ASPERITY_HALF_WIDTH,
        metavar="W/A",
        help=f"half widths either side of an asperity's peak in which its largest damage is sought "
        f"(default {ASPERITY_HALF_WIDTH:g})",
    )
    add("--regression", choices=REGRESSIONS, default="x on y", help="of the median ranks")
    add("--jobs", type=_jobs, default=1, metavar="N", help="threads (default 1)")
    add(
        "--pictures",
        nargs="?",
        const="",
        metavar="FOLDER",
        help="also draw PNG and SVG, in FOLDER or beside the result",
    )
    add(
        "--passes",
        choices=SURFACES,
        help="the results are passes of this surface against other parts or alignments of the other one: "
        "also write passes_SURFACE.post.h5: damage a pass with its scatter, Miner's sum to failure",
    )
    add(
        "--point",
        nargs=2,
        type=float,
        metavar=("S/A", "Z/A"),
        help="body point of the history picture (default: that of the largest damage)",
    )
    add("--frame", type=int, metavar="K", help="stored frame of the stress picture (default: the middle one)")
    chosen = argparse.Namespace(**vars(parser.parse_args(argv)))
    chosen.indexes = [path for path in chosen.results if is_of_passes(path)]
    try:
        chosen.results = [str(file) for path in chosen.results for file in files_of(path)]
    except OutputError as fault:
        parser.error(str(fault))
    for path in chosen.results:
        if not Path(path).name:
            parser.error(f"{path!r}: not the name of a result file")
    if chosen.output and len(chosen.results) > 1:
        parser.error("-o names one file: give one RESULT.h5, or leave it out")
    if chosen.point and not (math.isfinite(chosen.point[0]) and 0 <= chosen.point[1] < math.inf):
        parser.error(f"--point {chosen.point[0]:g} {chosen.point[1]:g}: the depth z/a must be 0 or more")
    for setting in chosen.set:
        if not setting.startswith(("post.", "contact.material=")):
            parser.error(f"--set {setting}: allowed: post.KEY=VALUE and contact.material=NAME")
    if chosen.passes and len(chosen.results) < 2:
        parser.error("--passes: give the results of two passes or more")
    if not 0 <= chosen.within < math.inf:
        parser.error(f"--within {chosen.within:g}: must be 0 or more")
    return chosen
