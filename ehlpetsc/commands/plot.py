"""Draw results: ``ehlpetsc plot RESULT.h5 [...]``, or the index of a series or of passes,
OUTPUT.series.json, OUTPUT.passes.json; or the profiles of a CASE.toml as they will be used.

Pressure and film of one frame, of a point contact or strip as maps with sections through the middle, by
default that with the maximum load on the solids from when both surfaces fill the contact or, without load on
solids, the maximum pressure; several results at the same travel in one picture, points and strips by their
sections along y = 0. With --field any stored field in the place of the film. The file name after -o
determines the format (png, svg, pdf, eps ...).
Input files are never overwritten.

Exit status: 0 drawn, 2 bad input.
"""

from __future__ import annotations

import argparse
import contextlib
import re
from collections.abc import Callable
from pathlib import Path

from ehlpetsc.base.command_line import CommandParser, exit_status, number
from ehlpetsc.base.errors import OutputError
from ehlpetsc.pictures import style
from ehlpetsc.pictures.case_surfaces import draw_case
from ehlpetsc.pictures.frames import choice as frames
from ehlpetsc.pictures.frames.data import described
from ehlpetsc.pictures.frames.line import draw_courses, draw_map, draw_scalar, draw_temperatures
from ehlpetsc.pictures.report import save_report
from ehlpetsc.pictures.series import draw_running_in, draw_stribeck, draw_traction
from ehlpetsc.results.index import in_order, open_all
from ehlpetsc.results.output_guard import PAGES, PICTURES, check_derived
from ehlpetsc.results.reader import Result

FIGURES = {
    "over_time": (draw_courses, "film, pressure, friction of every step over time"),
    "map": (draw_map, "pressure or another field over x and time, contacts marked"),
    "stribeck": (draw_stribeck, "friction over speed, of a series"),
    "traction": (draw_traction, "friction over slide/roll ratio, of a series"),
    "temperatures": (draw_temperatures, "temperatures of film and surfaces, with [heat]"),
    "running_in": (draw_running_in, "surfaces and pressure pass by pass"),
}
MAPS = {  # of a point contact or strip
    "fringes": "film as interference fringes, of a point or strip",
    "contacts": "share of the steps in which nodes are in contact, of a point or strip",
}
NOT_DRAWN = {  # that are no pictures: endings of their files, help
    "report": (PAGES, "one result as one HTML page with slider and zoom"),
    "movie": ((".gif",), "pressure and film over time, as a GIF"),
}
OF_ONE = ("over_time", "map", "temperatures", "report", *MAPS)  # kinds of a single result
OF_SCALARS = ("over_time", "steps", "stribeck", "traction")  # kinds that show no field
IN_PLANE = (None, "movie", "report", *MAPS)  # kinds that show a point contact or strip in both directions
OF_FIELDS = (None, "map", "movie", "report")  # kinds that show another field in the place of the film


def arguments() -> CommandParser:
    """Parser of the command line."""
    parser = CommandParser("plot", __doc__, "output set")
    shown = "results, an index; or one CASE.toml"
    parser.add_argument("results", nargs="+", metavar="RESULT.h5", help=shown)
    parser.add_argument("-o", "--output", type=Path, help="picture [RESULT.png, RESULT.map.png ...]")
    instant = parser.add_mutually_exclusive_group()
    instant.add_argument("--step", type=int, help="number of the time step [maximum load on solids]")
    instant.add_argument("--time", type=float, help="time [s]")
    parser.add_argument("--window", type=float, nargs=2, metavar=("LOW", "HIGH"), help="limits of x/a")
    parser.add_argument("--section", type=float, metavar="Y", help="y/a of a point or strip, drawn as a line")
    parser.add_argument("--field", metavar="NAME", help="stored field to draw instead of the film")
    dots = "dots per inch of a png [%(default)s]"
    parser.add_argument("--dpi", type=number(1.0, 1e4), default=style.DPI, help=dots)
    parser.add_argument(
        "--size", type=number(0.1, 100.0), nargs=2, metavar=("WIDTH", "HEIGHT"), help="inches"
    )
    parser.add_argument("--no-title", action="store_true", help="without the title above the panels")
    kind = parser.add_mutually_exclusive_group()
    for name, (*_, text) in (FIGURES | {name: (text,) for name, text in MAPS.items()} | NOT_DRAWN).items():
        option = f"--{name.replace('_', '-')}"
        kind.add_argument(option, dest="kind", action="store_const", const=name, help=text)
    kind.add_argument(
        "--steps", metavar="NAME", help="one scalar of every step over time, as friction_coefficient"
    )
    return parser


def main(words: list[str]) -> int:
    """Run the command; returns its exit status."""
    options = arguments().parse_args(words)
    if options.steps:
        options = argparse.Namespace(**vars(options) | {"kind": "steps"})
    allowed = NOT_DRAWN[options.kind][0] if options.kind in NOT_DRAWN else PICTURES
    kind = f".{options.kind}" if options.kind in FIGURES | MAPS else ""
    kind = kind or ("" if options.section is None else ".section")
    kind += "".join(f".{name}" for name in (options.steps, options.field) if name)
    output = options.output or Path(_stem(options.results) + kind + allowed[0])
    return exit_status("plot", lambda: _run(options, output, allowed), (ValueError,), output)


def _run(options: argparse.Namespace, output: Path, allowed: tuple[str, ...]) -> None:
    inputs = list(map(Path, options.results))
    if any(path.suffix == ".toml" for path in inputs):
        if len(inputs) > 1 or options.kind:
            raise OutputError(f"{inputs[0]}: a case is drawn alone, without results and kinds of pictures")
        check_derived(output, inputs, allowed)
        with style.fonts(options.size):
            style.save(draw_case(inputs[0], options.set), output, chosen=options)
    else:
        with contextlib.ExitStack() as stack, style.fonts(options.size):
            results = in_order(open_all(options.results, stack))
            check_derived(output, [*inputs, *(result.path for result in results)], allowed)
            draw(results, options, output)
    print(output)


def draw(results: list[Result], options: argparse.Namespace, output: Path) -> None:
    """Draw one picture or movie into a file."""
    kind = f"--{(options.kind or '').replace('_', '-')}"
    if options.kind in OF_ONE and len(results) > 1:
        raise OutputError(f"{len(results)} results; allowed: {kind} of one")
    if options.field and options.kind not in OF_FIELDS:
        raise OutputError(f"--field: of pictures of an instant, --map, --movie and --report, not of {kind}")
    low, high = frames.view(results, options.window)
    if not low < high:
        raise OutputError(f"--window {low:g} {high:g}: allowed: LOW below HIGH")
    for result in results:
        if not len(result.time):
            raise OutputError(f"{result.path}: no frame in it")
        if options.field:
            described(result, options.field)
        if frames.nodes_in_view(result, (low, high)) < 2:
            raise OutputError(f"{result.path}: fewer than two nodes from {low:g} a to {high:g} a")
    planes = [result for result in results if result.y is not None]
    if not planes and (options.kind in MAPS or options.section is not None):
        word = "section" if options.section is not None else options.kind
        raise OutputError(f"{results[0].path}: a line contact; allowed: --{word} of a point contact or strip")
    whole = len(results) == 1 and options.section is None and options.kind in IN_PLANE
    if options.kind in OF_SCALARS and options.section is not None:
        raise OutputError(f"--section: of pictures over x, not of {kind}")
    if options.kind not in OF_SCALARS and not whole:
        results = [section_of(result, options.section or 0.0) for result in results]
    if options.kind == "movie":
        frames.save_movie(results, options, output)
    elif options.kind == "report":
        save_report(results[0], output, options.field)
    else:
        style.save(_function(options.kind)(results, options), output, chosen=options)


def _function(kind: str | None) -> Callable:
    """Function of the results and the options that draws a kind of picture."""
    if kind in MAPS:
        from ehlpetsc.pictures.frames import plane  # which no line contact needs

        return plane.draw_fringes if kind == "fringes" else plane.draw_contacts
    if kind == "steps":
        return draw_scalar
    return FIGURES[kind][0] if kind else frames.draw_instant


def section_of(result: Result, y: float) -> Result:
    """Section of a point contact or strip at y [half-widths]; a line contact as it is."""
    return result if result.y is None else result.section(y * result.attrs["a"])


def _stem(paths: list[str]) -> str:
    """Name of a picture without its suffix, from the names of the results."""
    first, *others = (re.sub(r"(\.(series|passes)\.json|\.h5)$", "", path) for path in paths)
    if not others:
        return f"{Path(first).stem}.case" if first.endswith(".toml") else first
    return f"{first}_and_{Path(others[0]).name if len(others) == 1 else f'{len(others)}_more'}"
