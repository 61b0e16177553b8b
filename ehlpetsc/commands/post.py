"""The command ``ehlpetsc post RESULT.h5 [...]``: options, messages and exit status."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from ehlpetsc.base.command_line import CommandParser, ProgressLine, exit_status
from ehlpetsc.base.compiled import announce_compilation
from ehlpetsc.base.errors import ExitStatus, OutputError, UsageError
from ehlpetsc.base.materials import MEAN_STRESSES
from ehlpetsc.post.criteria import CRITERIA
from ehlpetsc.post.level import standard_line
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.index import files_of
from ehlpetsc.results.output_guard import check_new, check_output_path
from ehlpetsc.results.post_result import UPPER_FIRST, PostResult, post_path

DESCRIPTION = (
    "Stress histories of body points, rainflow cycles, fatigue damage and its statistics from result files. "
    "Material and depths come from the case in the file, table [post]."
)


def main(words: Sequence[str]) -> int:
    """Process each file and draw the processed results; returns the exit status."""
    parser = CommandParser("post", DESCRIPTION)
    add = parser.add_argument
    several = "several; OUTPUT.series.json: its members; OUTPUT.passes.json: its passes"
    add("results", nargs="+", metavar="RESULT.h5", help=several)
    output = "result, of a single input (default: RESULT.post.h5 beside it)"
    add("-o", "--output", metavar="FILE", help=output)
    add("--surface", choices=("both", *UPPER_FIRST), default="both", help="processed surface (default both)")
    add("--depths", nargs="+", type=float, metavar="Z/A", help="instead of those of [post]")
    key = "a key of [post], or contact.material, instead of that of the case; may be repeated"
    add("--set", action="append", default=[], metavar="TABLE.KEY=VALUE", help=key)
    add("--mean-stress", choices=MEAN_STRESSES, help="instead of post.mean_stress")
    also = "also compute, beside the paper's damage: " + ", ".join(CRITERIA)
    add("--criterion", nargs="+", choices=CRITERIA, default=(), metavar="NAME", help=also)
    add("--jobs", type=int, default=1, metavar="N", help="threads (default 1)")
    weibull = "draw the Weibull distributions of the damage at asperities with their confidence bounds"
    add("--weibull", action="store_true", help=weibull)
    pictures = "also draw PNG and SVG, in FOLDER or beside the result"
    add("--pictures", nargs="?", const="", metavar="FOLDER", help=pictures)
    chosen = parser.parse_args(words)
    return exit_status("post", lambda: _run(chosen))


def _run(chosen: argparse.Namespace) -> int:
    announce_compilation(_say)
    files = [str(file) for path in chosen.results for file in files_of(path)]
    _check(chosen, files)
    jobs = [_job(path, chosen) for path in files]
    work = [partial(_process, job, files, chosen.overwrite) for job in jobs]
    statuses = [exit_status("post", one, output=job.output) for one, job in zip(work, jobs, strict=True)]
    done = [job for job, status in zip(jobs, statuses, strict=True) if status == ExitStatus.DONE]
    if done and (chosen.weibull or chosen.pictures is not None):
        statuses.append(exit_status("post", partial(_draw, done, chosen), output="pictures"))
    return max(statuses)


def _check(chosen: argparse.Namespace, files: Sequence[str]) -> None:
    """Raise UsageError for options that do not fit each other."""
    if chosen.output and len(files) > 1:
        raise UsageError("-o names one file: give one RESULT.h5, or leave it out")
    for setting in chosen.set:
        if not setting.startswith(("post.", "contact.material=")):
            raise UsageError(f"--set {setting}: allowed: post.KEY=VALUE and contact.material=NAME")
    if chosen.jobs < 1:
        raise UsageError(f"--jobs {chosen.jobs}: must be 1 or more")


def _say(text: str) -> None:
    print(f"ehlpetsc post: {text}", file=sys.stderr)


def _job(path: str, chosen: argparse.Namespace) -> Job:
    settings = list(chosen.set)
    if chosen.depths:
        settings.append(f"post.depths={chosen.depths}")
    if chosen.mean_stress:
        settings.append(f"post.mean_stress={chosen.mean_stress}")
    return Job(
        path,
        chosen.output or str(post_path(path)),
        UPPER_FIRST if chosen.surface == "both" else (chosen.surface,),
        jobs=chosen.jobs,
        criteria=tuple(sorted(chosen.criterion)),
        settings=tuple(settings),
    )


def _process(job: Job, inputs: Sequence[str], overwrite: bool) -> None:
    start = time.perf_counter()
    if not overwrite and job.is_done():
        _say(f"{job.output}: already there, of the same file and options")
    else:
        _check_output(Path(job.output), inputs, overwrite)
        line = ProgressLine(f"post {Path(job.path).name}", 1.0)

        def report(text: str) -> None:
            line.clear()
            _say(f"{job.path}: {text}")

        try:
            run(job, report, line.reach)
        finally:
            line.clear()
    _summary(job.output, time.perf_counter() - start)


def _check_output(output: Path, inputs: Sequence[str], overwrite: bool) -> None:
    """Raise OutputError if an output must not be written."""
    check_output_path(output, map(Path, inputs), "-o")
    if not output.parent.is_dir():
        raise OutputError(f"the folder of the output {output} does not exist")
    check_new(output, overwrite)


def _summary(output: str, wall: float) -> None:
    """Print one line for each depth and one for the result."""
    result = PostResult(output)
    surfaces = sorted(result.surfaces)
    for k, z in enumerate(result.z):
        words = [f"z/a={z:<6g}"]
        for surface in surfaces:
            if not result.complete[surface].any():
                continue
            words.append(f"{surface}: D_max={result.passed(surface)[k].max():.3e}")
            words += [f"{name}={result.passed(surface, name)[k].max():.3g}" for name in result.criteria]
        if (fit := result.fits[k]).beta > 0:
            words.append(f"weibull of surface {result.main}:")
            words.append(f"alpha={fit.alpha:.4g} beta={fit.beta:.4g} r2={fit.r_squared:.4f}")
        print(" ".join(words))
    for name, contacts in result.smooth.items():
        for surface in surfaces:
            life, depth = contacts[surface].life, contacts[surface].depth
            print(
                f"smooth contact, surface {surface}, {name or 'D'}: smooth_life={life:.4g} passes "
                f"smooth_depth={depth:.3g} m"
            )
    print(standard_line(result.attrs["smooth_pressure"]))
    for surface in surfaces:
        if surface in result.temperatures and result.complete[surface].any():
            highest, mean, flash = result.temperatures[surface]
            print(
                f"surface {surface} temperature: highest={np.nanmax(highest):.5g} K "
                f"mean={np.nanmean(mean):.5g} K flash_max={np.nanmax(flash):.4g} K "
                f"flash_median={np.nanmedian(flash):.4g} K"
            )
    points = " ".join(f"{name}={result.complete[name].sum()}" for name in surfaces)
    print(
        f"ehlpetsc post: done {output} points {points} depths={len(result.z)} "
        f"asperities={len(result.height)} wall={wall:.2f}"
    )


def _draw(jobs: Sequence[Job], chosen: argparse.Namespace) -> None:
    from ehlpetsc.pictures.damage_maps import draw, pictures, weibull_pictures

    inputs, outputs = [job.path for job in jobs], [job.output for job in jobs]
    for kind in [pictures] * (chosen.pictures is not None) + [weibull_pictures] * chosen.weibull:
        for name in draw(inputs, outputs, chosen.pictures or "", kind):
            print(name)
