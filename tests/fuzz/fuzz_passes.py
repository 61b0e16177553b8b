"""Passes and series that are stopped, killed or robbed of a file at any time, and the same command once more.

In the end every result must be that of a run left alone, or the command must say why it refuses; files of
others in the folder stay as they are.
"""

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
from sandbox import word_of
from support import ROOT

from ehlpetsc.errors import OutputError
from ehlpetsc.results.reader import read_result

COARSE = ("mesh.points_per_half_width=20", "output.every=1")
SCENES = {
    "running_in.toml": (*COARSE, "time.travel=0.8", "time.passes=3", "contact.yield_pressure=0.95e9"),
    "stribeck.toml": (*COARSE, "time.travel=0.8", "series.values=[10.0,5.0,2.0]"),
    "ridge.toml": (*COARSE, "time.travel=2.5"),
}
STOPS = (signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
FOREIGN = {"notes.txt": b"mine", "other.h5": b"\x89HDF\r\n\x1a\nmine", "other.restart.h5": b"mine"}
LIMIT = 120  # s
SAME = 1e-9
ROBBED = ("*.passes.json", "*.series.json", "*.pass1.restart.h5", "*.restart.h5", "*.pass2.h5", "*_5.0.h5")


class Draw:
    """One accident after the other."""

    def __init__(self, folder):
        self.folder, self.whole, self.lasts = folder / "run", {}, {}

    def _run_alone(self, name):
        """Run a scene to its end without an accident, at its first draw."""
        place = self.folder.with_name(name)
        place.mkdir()
        begun = time.monotonic()
        status, report = self._run(name, place)
        assert status == 0, report
        self.lasts[name] = time.monotonic() - begun
        self.whole[name] = place

    def __call__(self, rng):
        """Outcome and what was done."""
        name = str(rng.choice(list(SCENES)))
        if name not in self.whole:
            self._run_alone(name)
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir()
        for other, content in FOREIGN.items():
            (self.folder / other).write_bytes(content)
        actions, report = [name], ""
        often = ("output.checkpoint=1e-5",) if rng.random() < 0.5 else ()
        for _ in range(int(rng.integers(1, 4))):
            after, stop = self.lasts[name] * rng.random(), STOPS[int(rng.integers(len(STOPS)))]
            status, report = self._run(name, self.folder, after, stop, often)
            actions.append(f"{stop.name} after {after:.2f} s: {status}")
            if status not in (0, 4, -stop.value):
                return word_of(status, report) if status in (
                    2,
                    3,
                ) else "traceback", f"{actions} {report[-1500:]}"
            if rng.random() < 0.25:
                actions.append(self._rob(rng))
        status, report = self._run(name, self.folder, often=often)
        what = f"{actions}: {status} {report[-1500:]}"
        word = word_of(status, report)
        if word == "done" and not often and not self._is_whole(name):
            word = "different"
        if any((self.folder / other).read_bytes() != content for other, content in FOREIGN.items()):
            word = "changed"
        if list(self.folder.glob("*.lock")):
            word = "changed"
        return word, what

    def keep(self, place):
        """Copy the folder of the last draw."""
        shutil.copytree(self.folder, place)

    def _run(self, name, folder, after=LIMIT, stop=signal.SIGKILL, often=()):
        words = [word for key in (*SCENES[name], *often) for word in ("-ehl_set", key)]
        run = subprocess.Popen(
            [sys.executable, "-m", "ehlpetsc", str(ROOT / "cases" / name), *words],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": f"{ROOT}:{os.environ.get('PYTHONPATH', '')}"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        try:
            report, _ = run.communicate(timeout=after)
        except subprocess.TimeoutExpired:
            run.send_signal(stop)
            try:
                report, _ = run.communicate(timeout=LIMIT)
            except subprocess.TimeoutExpired:
                run.kill()
                return None, run.communicate()[0]
            return (None if after == LIMIT else run.returncode), report
        return run.returncode, report

    def _rob(self, rng):
        pattern = str(rng.choice(ROBBED))
        for path in self.folder.glob(pattern):
            if path.name not in FOREIGN:
                path.unlink()
        return f"without {pattern}"

    def _is_whole(self, name):
        """Whether results and index are those of a run left alone."""
        for path in self.whole[name].glob("*.json"):
            one, other = (json.loads((place / path.name).read_text()) for place in (self.folder, path.parent))
            rows = "passes" if "passes" in one else "members"
            if [row["file"] for row in one[rows]] != [row["file"] for row in other[rows]]:
                return False
        for path in self.whole[name].glob("*.h5"):
            if ".restart" in path.name:
                continue
            with contextlib.suppress(OutputError):
                with read_result(path) as one, read_result(self.folder / path.name) as other:
                    if other.attrs["status"] != "done" or list(one.step) != list(other.step):
                        return False
                    apart = np.abs(one.pressure - other.pressure).max()
                    if apart > SAME * one.attrs["p0"]:
                        return False
                continue
            return False
        return True
