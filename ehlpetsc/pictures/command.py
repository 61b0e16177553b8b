"""Draw results: ``ehlpetsc plot RESULT.h5 [...]``, or the index of a series or of passes,
OUTPUT.series.json, OUTPUT.passes.json.

Pressure and film of one frame, by default that with the largest fraction of the load on the solids or,
without load on the solids, of the highest pressure; several results at the same travel in one picture. Or a
map of pressure over x and time, a movie; of a series its Stribeck curve, traction curves; of one result its
temperatures or an HTML page. The file name after -o determines the
format (png, svg, pdf; of a movie gif, mp4, webm; of a page html). Input files are never overwritten.

Exit status: 0 drawn, 2 bad input.
"""

import contextlib
import re
from pathlib import Path

import numpy as np

from ehlpetsc.command_parser import CommandParser, exit_status
from ehlpetsc.errors import OutputError
from ehlpetsc.pictures.figures import AROUND_WIDTH, FIGURES, draw_frame, window
from ehlpetsc.results.atomic_write import replacing
from ehlpetsc.results.index import in_order, open_all
from ehlpetsc.results.output_guard import MOVIES, PAGES, PICTURES, check_derived

DPI = 160  # of pictures
ENDINGS = {"movie": ".gif", "report": ".html"}  # of outputs that are not pictures
SIGNATURES = {"movie": MOVIES, "report": PAGES}
WITHOUT_FRAMES = ("stribeck", "traction", "ensemble")  # kinds that need the scalars of the steps alone


def _check(results, kind, options):
    for result in results:
        if not len(result.time):
            raise OutputError(f"{result.path}: no frame in it")
        if kind in WITHOUT_FRAMES:
            continue
        missing = {"pressure", "film_thickness"} - set(result.fields)
        if missing:
            raise OutputError(f"{result.path}: does not store {' and '.join(sorted(missing))}")
        low, high = window([result], options)
        x = result.x / result.attrs["a"]
        if np.count_nonzero((x >= low) & (x <= high)) < 2:
            raise OutputError(f"{result.path}: fewer than two nodes from {low:g} a to {high:g} a")


def _parser():
    description = "Draw results, a series by its index, or the profiles of a case as they will be used."
    parser = CommandParser("plot", description)
    parser.add_argument("results", nargs="+", metavar="RESULT.h5", help="results, an index; or one CASE.toml")
    parser.add_argument("-o", "--output", type=Path, help="picture [RESULT.png, RESULT.map.png ...]")
    instant = parser.add_mutually_exclusive_group()
    instant.add_argument("--step", type=int, help="number of the time step [largest share on solids]")
    instant.add_argument("--time", type=float, help="time [s]")
    parser.add_argument("--around", type=float, metavar="X", help="centre of the view, x/a [half widths]")
    view = f"width of the view [{AROUND_WIDTH}]"
    parser.add_argument("--width", type=float, help=view)
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--map", action="store_true", help="pressure over x and time, contacts marked")
    kind.add_argument("--stribeck", action="store_true", help="friction against speed, of a series over it")
    kind.add_argument("--traction", action="store_true", help="friction against slide/roll, of a series")
    kind.add_argument("--temperatures", action="store_true", help="of film and surfaces, of one with [heat]")
    kind.add_argument("--ensemble", action="store_true", help="figures of runs that differ in their seeds")
    kind.add_argument("--running-in", action="store_true", help="surfaces and pressure pass by pass")
    kind.add_argument("--report", action="store_true", help="all of one result as one HTML page")
    kind.add_argument("--movie", action="store_true", help="pressure and film over time, as a GIF, MP4, WebM")
    return parser


def draw(results, kind, options, output):
    """Draw one picture or movie into a file."""
    _check(results, kind, options)
    if kind == "movie":
        from ehlpetsc.pictures.movies import save_movie

        save_movie(results, options, output)
    elif kind == "report":
        from ehlpetsc.pictures.page.report import save_report

        if len(results) > 1:
            raise OutputError(f"{len(results)} results; allowed: --report of one")
        save_report(results[0], output)
    else:
        figure = FIGURES.get(kind, draw_frame)(results, options)
        with replacing(output, keep_ending=True) as temporary:
            figure.savefig(temporary, dpi=DPI)


def _draw_case(options, cases):
    """Picture of the profiles of one case file."""
    from ehlpetsc.pictures.case_profiles import draw_case

    if len(options.results) > 1:
        raise OutputError(f"{cases[0]}: a case is drawn alone, without results")
    output = options.output or Path(Path(cases[0]).stem + ".case.png")
    check_derived(output, [Path(cases[0])], PICTURES)
    figure = draw_case(cases[0], options.set)
    with replacing(output, keep_ending=True) as temporary:
        figure.savefig(temporary, dpi=DPI)
    print(output)


def _stem(paths):
    """Name of a picture without its suffix, from the names of the results."""
    first, *others = (re.sub(r"(\.(series|passes)\.json|\.h5)$", "", path) for path in map(str, paths))
    if not others:
        return first
    return f"{first}_and_{Path(others[0]).name if len(others) == 1 else f'{len(others)}_more'}"


def main(words):
    """Run the command; returns its exit status."""
    options = _parser().parse_args(words)
    kind = next((k for k in (*FIGURES, *ENDINGS) if getattr(options, k) not in (None, False)), None)
    ending = ENDINGS.get(kind, f".{kind}.png" if kind else ".png")
    output = options.output or Path(_stem(options.results) + ending)
    return exit_status("plot", lambda: _run(options, kind, output), (ValueError,), output)


def _run(options, kind, output):
    cases = [path for path in options.results if path.endswith(".toml")]
    if cases:
        _draw_case(options, cases)
        return
    with contextlib.ExitStack() as stack:
        results = in_order(open_all(options.results, stack))
        inputs = [*map(Path, options.results), *(r.path for r in results)]
        check_derived(output, inputs, SIGNATURES.get(kind, PICTURES))
        draw(results, kind, options, output)
    print(output)
