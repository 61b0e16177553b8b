"""The command ``ehlpetsc.post``: steps, messages and exit status."""

import os
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np

from ehlpetsc.compiled import COMPILED
from ehlpetsc.errors import CaseError, ExitStatus, OutputError, PostError, not_written
from ehlpetsc.post.arguments import arguments
from ehlpetsc.post.criteria import CRITERIA
from ehlpetsc.post.fatigue.accumulate import Counting
from ehlpetsc.post.outputs.passes_file import store_passes
from ehlpetsc.post.outputs.passes_index import note_damage
from ehlpetsc.post.outputs.result_file import check_output
from ehlpetsc.post.run import Job, run
from ehlpetsc.post.subprocess_guard import SubprocessGuard
from ehlpetsc.results.hdf5.opening import open_for_reading
from ehlpetsc.results.post_result import SURFACES, PostResult, post_path

SEVERITY = (ExitStatus.DONE, ExitStatus.BAD_INPUT, ExitStatus.BUG, ExitStatus.STOPPED)


class Progress:
    """Progress in percent, rewritten in place; on terminals only."""

    def __init__(self, name):
        self.name, self.last = name, 0.0
        self.shown, self.parent = sys.stderr.isatty(), os.getppid()

    def __call__(self, done, total):
        """Show the finished fraction of the work, at most five times a second."""
        if os.getppid() != self.parent:  # the parent process was killed
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
    """Print lines to standard error."""
    for line in text.splitlines():
        print(f"ehlpetsc.post: {line}", file=sys.stderr)


def _output(path, chosen):
    return chosen.output or str(post_path(path))


def _process(path, chosen):
    output = _output(path, chosen)
    open_for_reading(path).close()
    check_output(output, chosen.results)
    surfaces = SURFACES if chosen.surface == "both" else (chosen.surface,)
    counting = Counting(chosen.count, chosen.residue, chosen.ranges, chosen.mean_stress)
    depths = None if chosen.depths is None else tuple(chosen.depths)
    criteria = tuple(name for name in CRITERIA if name in chosen.criterion)
    strain = () if chosen.strain is None else (f'post.strain="{chosen.strain}"',)
    job = Job(
        path,
        output,
        surfaces,
        depths,
        counting,
        chosen.regression,
        chosen.jobs,
        criteria,
        chosen.within,
        (*chosen.set, *strain),
    )
    start = time.perf_counter()
    run(job, lambda text: say(text if text.startswith(output) else f"{path}: {text}"), Progress(path))
    _summary(output, time.perf_counter() - start)


def _summary(output, wall):
    """Print one line for each depth and one for the result."""
    result = PostResult(output)
    for k, z in enumerate(result.z):
        print(
            f"z/a={z:<6g}"
            + "".join(f" {surface}: D_max={result.largest(surface, k):.3e}" for surface in result.surfaces)
            + _weibull(result.fits[k])
        )
    for surface, temperatures in result.temperatures.items():
        if result.complete[surface].any():
            print(_temperatures(surface, temperatures))
    points = " ".join(f"{name}={result.complete[name].sum()}" for name in result.surfaces)
    print(
        f"ehlpetsc.post: done {output} points {points} depths={len(result.z)} "
        f"asperities={len(result.height)} wall={wall:.2f}"
    )


def _temperatures(surface, temperatures):
    """Text of the surface temperatures of body points."""
    flash = temperatures.flash[~np.isnan(temperatures.flash)]
    mean = temperatures.mean[~np.isnan(temperatures.mean)]
    return (
        f"surface {surface} temperature: highest={np.nanmax(temperatures.highest):.5g} K "
        f"mean={mean.mean():.5g} K flash_max={flash.max():.4g} K flash_median={np.median(flash):.4g} K"
    )


def _weibull(fit):
    """Text of the Weibull distribution over asperities; "" if they are too few."""
    if not fit.beta > 0:
        return ""
    return f" weibull alpha={fit.alpha:.4g} beta={fit.beta:.4g} r2={fit.r_squared:.4f}"


def _passes_file(chosen):
    first = Path(_output(chosen.results[0], chosen))
    return str(first.with_name(f"passes_{chosen.passes}.post.h5"))


def _store_passes(paths, chosen):
    """Store mean and scatter over passes in a separate file, and print one line for each depth."""
    if len(paths) < len(chosen.results):
        raise PostError("not all of the passes could be processed")
    results = [PostResult(_output(path, chosen)) for path in paths]
    passes = store_passes(_passes_file(chosen), results, chosen.passes)
    for k, z in enumerate(results[0].z):
        worst = passes.mean[k].argmax()
        print(
            f"z/a={z:<6g} {chosen.passes}: mean D_max={passes.mean[k, worst]:.3e} "
            f"deviation={passes.deviation[k, worst]:.3e} largest={passes.largest[k].max():.3e} "
            f"first failure after {passes.life[k, worst]:.4g} passes"
        )
    print(
        f"ehlpetsc.post: done {_passes_file(chosen)} passes={len(results)} points={passes.mean.shape[1]} "
        f"depths={passes.mean.shape[0]}"
    )


def _note_damage(index):
    """Add the damage of every pass to the index of a run, and print one line for each pass."""
    passes = note_damage(index)
    for number, damage in passes:
        print(f"pass {number}: {' '.join(_pass_figures(damage))}")
    print(f"ehlpetsc.post: done {index} passes={len(passes)}")


def _pass_figures(damage):
    """Maximum damage of each surface and, with [heat], maximum flash temperature."""
    for side in ("1", "2"):
        if side in damage:
            yield f"{side} D_max={max(damage[side]['largest']):.3e}"
            if "flash_temperature" in damage[side]:
                yield f"flash_max={damage[side]['flash_temperature']:.4g} K"


def _draw(paths, chosen):
    from ehlpetsc.pictures.damage import draw

    outputs = [_output(path, chosen) for path in paths]
    try:
        names = draw(paths, outputs, chosen.pictures, chosen.point, chosen.frame, chosen.passes)
    except OSError as fault:
        raise PostError(f"{not_written(fault)}; pictures before it are whole") from None
    for name in names:
        print(name)


def _status(work, path, output):
    """Run work(), print its faults and return the exit status; `path` is its input, `output` its output."""
    try:
        work()
    except (PostError, OutputError, CaseError) as fault:
        for line in str(fault).splitlines():
            say(line if line.startswith(str(path)) else f"{path}: {line}")
        return ExitStatus.BAD_INPUT
    except BrokenPipeError:  # closed by the reader, as `| head`
        sys.stdout = None
        return ExitStatus.STOPPED
    except OSError as fault:
        say(f"{not_written(fault, output)}; nothing is left of it")
        return ExitStatus.BAD_INPUT
    except KeyboardInterrupt:
        say("interrupted; the same command continues from the finished depths")
        return ExitStatus.STOPPED
    return ExitStatus.DONE


def main(argv, call=lambda name, work: work()):
    """Process each file and draw the processed results; returns the exit status.

    Parameters
    ----------
    argv : list of str
    call : callable(name, work), optional
        Runs the function `work` for the file `name` and returns its exit status.
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
    for index in chosen.indexes if done else ():
        statuses.append(call(index, partial(_status, partial(_note_damage, index), index, index)))
    if chosen.passes:
        work = partial(_status, partial(_store_passes, done, chosen), "--passes", _passes_file(chosen))
        statuses.append(call("passes", work))
        if statuses[-1] != ExitStatus.DONE:
            return max(statuses, key=SEVERITY.index)
    if chosen.pictures is not None and done:
        where = chosen.pictures or "pictures"
        statuses.append(call("pictures", partial(_status, partial(_draw, done, chosen), "pictures", where)))
    return max(statuses, key=SEVERITY.index)


def command(words):
    """Run as a command, every file in a separate process, so that a crash leaves the others unaffected."""
    status = main(words, call=SubprocessGuard(say))
    sys.stdout.flush()
    os._exit(status)  # faster than Python's end, which collects cycles
