"""The command: its arguments, what it says, its exit status."""

import argparse
import math
import os
import sys
import time
from functools import partial
from pathlib import Path

from ehlpetsc.compiled import COMPILED
from ehlpetsc.environment import program
from ehlpetsc.errors import ExitStatus, PostError
from ehlpetsc.post.criteria import CRITERIA
from ehlpetsc.post.fatigue.accumulate import CHANNELS, MEAN_STRESSES, RANGES, Counting
from ehlpetsc.post.fatigue.cycles import RESIDUES
from ehlpetsc.post.fatigue.elastic_plastic import STRAINS
from ehlpetsc.post.fatigue.statistics import REGRESSIONS
from ehlpetsc.post.inputs.loads import SURFACES
from ehlpetsc.post.outputs.post_result import PostResult
from ehlpetsc.post.outputs.result_file import check_output
from ehlpetsc.post.run import WITHIN, Job, run
from ehlpetsc.post.supervised import Supervisor

SEVERITY = (ExitStatus.DONE, ExitStatus.BAD_INPUT, ExitStatus.BUG, ExitStatus.STOPPED)


def _jobs(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be 1 or more")
    return value


def arguments(argv=None):
    """Parse the command line."""
    parser = argparse.ArgumentParser(
        prog=program("ehlpetsc.post"),
        description="Stress histories of body points, rainflow cycles, fatigue damage and its statistics "
        "from result files. Material and depths come from the case text in the file, section [post].",
    )
    add = parser.add_argument
    add(
        "results",
        nargs="+",
        metavar="RESULT.h5",
        help="several, as of one slide/roll ratio each: also compared",
    )
    add(
        "-o", "--output", metavar="FILE", help="result, of a single input (default: RESULT.post.h5 beside it)"
    )
    add("--surface", choices=("both", *SURFACES), default="both")
    add("--depths", nargs="+", type=float, metavar="Z/A", help="instead of those of [post]")
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
        default="direct",
        help="how the elastic range enters the cyclic stress-strain curve: as it is (default, as in the "
        "paper), by Neuber's or by Glinka's rule",
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
        default=WITHIN,
        metavar="W/A",
        help=f"half widths either side of an asperity's peak in which its largest damage is sought "
        f"(default {WITHIN:g})",
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
        "with --pictures damage a pass, its scatter and Miner's sum to failure",
    )
    add(
        "--point",
        nargs=2,
        type=float,
        metavar=("S/A", "Z/A"),
        help="body point of the history picture (default: that of the largest damage)",
    )
    add("--frame", type=int, metavar="K", help="stored frame of the stress picture (default: the middle one)")
    chosen = parser.parse_args(argv)
    if chosen.output and len(chosen.results) > 1:
        parser.error("-o names one file: give one RESULT.h5, or leave it out")
    if chosen.point and not (math.isfinite(chosen.point[0]) and 0 <= chosen.point[1] < math.inf):
        parser.error(f"--point {chosen.point[0]:g} {chosen.point[1]:g}: the depth z/a must be 0 or more")
    if chosen.passes and len(chosen.results) < 2:
        parser.error("--passes: give the results of two passes or more")
    if not 0 <= chosen.within < math.inf:
        parser.error(f"--within {chosen.within:g}: must be 0 or more")
    return chosen


class Progress:
    """Share of the work done, rewritten in place on a terminal and nowhere else."""

    def __init__(self, name):
        self.name, self.last = name, 0.0
        self.shown, self.parent = sys.stderr.isatty(), os.getppid()

    def __call__(self, done, total):
        """Show done of total depths, at most five times a second."""
        if os.getppid() != self.parent:  # the process that answers for this one was killed
            raise KeyboardInterrupt
        now = time.monotonic()
        if self.shown and (now - self.last > 0.2 or done >= total):
            self.last = now
            end = "\n" if done >= total else ""
            print(
                f"\r{self.name}: {100 * done / total:5.1f} % of {total} depths",
                end=end,
                file=sys.stderr,
                flush=True,
            )


def say(text):
    """A line to standard error."""
    for line in text.splitlines():
        print(f"ehlpetsc.post: {line}", file=sys.stderr)


def _output(path, chosen):
    return chosen.output or str(Path(path).with_suffix("")) + ".post.h5"


def _process(path, chosen):
    output = _output(path, chosen)
    check_output(output, chosen.results)
    surfaces = SURFACES if chosen.surface == "both" else (chosen.surface,)
    counting = Counting(chosen.count, chosen.residue, chosen.ranges, chosen.mean_stress, chosen.strain)
    depths = None if chosen.depths is None else tuple(chosen.depths)
    criteria = tuple(name for name in CRITERIA if name in chosen.criterion)
    job = Job(
        path, output, surfaces, depths, counting, chosen.regression, chosen.jobs, criteria, chosen.within
    )
    start = time.perf_counter()
    run(job, lambda text: say(text if text.startswith(output) else f"{path}: {text}"), Progress(path))
    _summary(output, time.perf_counter() - start)


def _summary(output, wall):
    """One greppable line a result, and one a depth."""
    result = PostResult(output)
    for k, z in enumerate(result.z):
        print(
            f"z/a={z:<6g}"
            + "".join(f" {surface}: D_max={result.largest(surface, k):.3e}" for surface in result.surfaces)
            + f" weibull alpha={result.fits[k].alpha:.4g} beta={result.fits[k].beta:.4g}"
            f" r2={result.fits[k].r_squared:.4f}"
        )
    points = " ".join(f"{name}={result.complete[name].sum()}" for name in result.surfaces)
    print(
        f"ehlpetsc.post: done {output} points {points} depths={len(result.z)} "
        f"asperities={len(result.height)} wall={wall:.2f}"
    )


def _draw(paths, chosen):
    from ehlpetsc.post.pictures.gallery import draw

    outputs = [_output(path, chosen) for path in paths]
    for name in draw(paths, outputs, chosen.pictures, chosen.point, chosen.frame, chosen.passes):
        print(name)


def _status(work, path, output):
    """Exit status of work(), whose faults are told; `path` and `output` are what it reads and writes."""
    try:
        work()
    except PostError as fault:
        for line in str(fault).splitlines():
            say(f"{path}: {line}")
        return ExitStatus.BAD_INPUT
    except BrokenPipeError:  # as by `| head`: the reader went before all was done
        sys.stdout = None
        return ExitStatus.STOPPED
    except OSError as fault:
        say(f"{output}: not written, {fault.strerror or fault}; nothing is left of it")
        return ExitStatus.BAD_INPUT
    except KeyboardInterrupt:
        say("interrupted; the same command goes on from the finished depths")
        return ExitStatus.STOPPED
    return ExitStatus.DONE


def main(argv=None, call=lambda name, work: work()):
    """Process each file, draw what could be processed; returns the exit status.

    Parameters
    ----------
    argv : list of str, optional
    call : callable(name, work), optional
        Gets each piece of work, which returns its exit status, and what it is about.
    """
    chosen = arguments(argv)
    if not COMPILED:
        say("numba is not installed: the same results, a hundred times slower")
    outputs = [_output(path, chosen) for path in chosen.results]
    if len(set(outputs)) < len(set(chosen.results)):
        twice = max(outputs, key=outputs.count)
        say(f"two of the results would have one output, {twice}: give them one by one, with -o")
        return ExitStatus.BAD_INPUT
    statuses, done = [], []
    for path, output in zip(chosen.results, outputs, strict=True):
        status = call(path, partial(_status, partial(_process, path, chosen), path, output))
        if status == ExitStatus.STOPPED:
            return status
        statuses.append(status)
        if status == ExitStatus.DONE:
            done.append(path)
    if chosen.pictures is not None and done:
        where = chosen.pictures or "pictures"
        statuses.append(call("pictures", partial(_status, partial(_draw, done, chosen), "pictures", where)))
    return max(statuses, key=SEVERITY.index)


def command():
    """Run as a command: every file in a process of its own, so that none can take the others with it."""
    status = main(call=Supervisor(say))
    sys.stdout.flush()
    os._exit(status)  # the system frees all at once; Python would search it for cycles
